// Rows of four numbers: a vector and one more number. Rows are transposed into SIMD lanes and back.
//
// The data of a particle or contact are stored together, so that a contact loads a few whole rows from memory
// instead of a dozen scattered numbers. Transposed into lanes, several contacts are computed at once.
#pragma once

#include "math/lanes.hpp"

namespace rattlebox {

// Lanes stay in registers only in inlined functions, and compilers do not inline large functions unless
// forced.
#define RATTLEBOX_INLINE __attribute__((always_inline)) inline

typedef real Row __attribute__((vector_size(4 * sizeof(real))));

inline Row row(real x, real y, real z, real w = 0) { return Row{x, y, z, w}; }
inline Row row(real all) { return Row{all, all, all, all}; }
inline Row row(const real* v) { return Row{v[0], v[1], v[2], 0}; }
inline real dot(Row a, Row b) {
    const Row c = a * b;
    return (c[0] + c[1]) + c[2];
}
inline Row cross(Row a, Row b) {
    return Row{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}

// ---- functions of one number or of lanes, in which the contact laws are written

inline real all(real, real v) { return v; }
inline real root(real a) { return std::sqrt(a); }
inline real larger(real a, real b) { return a > b ? a : b; }
inline real smaller(real a, real b) { return a < b ? a : b; }
inline real power(real a, real exponent) { return std::pow(a, exponent); }
// f of each number.
template <class F> inline real each(real a, F&& f) { return f(a); }

template <int n> RATTLEBOX_INLINE Pack<n> all(const Pack<n>&, real v) { return Pack<n>::all(v); }

template <int n> RATTLEBOX_INLINE Pack<n> root(const Pack<n>& a) {
    if constexpr (n > register_width) {
        return {root(a.low), root(a.high)};
    } else {
        Pack<n> r;
        for (int i = 0; i < n; ++i) r.v[i] = std::sqrt(a.v[i]);
        return r;
    }
}

template <int n> RATTLEBOX_INLINE Pack<n> smaller(const Pack<n>& a, const Pack<n>& b) {
    if constexpr (n > register_width)
        return {smaller(a.low, b.low), smaller(a.high, b.high)};
    else
        return {a.v < b.v ? a.v : b.v};
}

// Returns a in lanes where c > 0, else b.
template <int n> RATTLEBOX_INLINE Pack<n> choose(const Pack<n>& c, const Pack<n>& a, const Pack<n>& b) {
    if constexpr (n > register_width)
        return {choose(c.low, a.low, b.low), choose(c.high, a.high, b.high)};
    else
        return {c.v > 0 ? a.v : b.v};
}

template <int n, class F> RATTLEBOX_INLINE Pack<n> each(const Pack<n>& a, F&& f) {
    alignas(64) real x[n];
    pack<n>(x) = a;
    for (real& value : x) value = f(value);
    return read<n>(x);
}
template <int n> RATTLEBOX_INLINE Pack<n> power(const Pack<n>& a, real exponent) {
    return each(a, [&](real value) { return std::pow(value, exponent); });
}

template <int n> Pack<n> operator-(const Pack<n>& a) { return Pack<n>::all(0) - a; }

// ---- vectors of lanes

template <class T> struct Vector {
    T x, y, z;

    Vector() = default;
    RATTLEBOX_INLINE Vector(const T& x, const T& y, const T& z) : x(x), y(y), z(z) {}
    // Copies lane by lane. Compilers copy a struct in smaller pieces, which prevents store forwarding.
    RATTLEBOX_INLINE Vector(const Vector& v) : x(v.x), y(v.y), z(v.z) {}
    RATTLEBOX_INLINE Vector& operator=(const Vector& v) {
        x = v.x, y = v.y, z = v.z;
        return *this;
    }

    RATTLEBOX_INLINE friend Vector operator+(const Vector& a, const Vector& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    RATTLEBOX_INLINE friend Vector operator-(const Vector& a, const Vector& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    RATTLEBOX_INLINE friend Vector operator*(const T& s, const Vector& a) {
        return {s * a.x, s * a.y, s * a.z};
    }
    RATTLEBOX_INLINE friend T dot(const Vector& a, const Vector& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
    RATTLEBOX_INLINE friend Vector cross(const Vector& a, const Vector& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};

struct Columns {
    Group x, y, z, w;
    Vector<Group> vector() const { return {x, y, z}; }
};

// Transposes the rows of(0), of(1), ... into lanes.
template <class Of> RATTLEBOX_INLINE Columns columns_of(Of&& of) {
#if defined(__AVX512F__)
    const auto two = [&](int l) __attribute__((always_inline)) {
        return __builtin_shufflevector(of(l), of(l + 4), 0, 1, 2, 3, 4, 5, 6, 7);
    };
    const auto a = two(0), b = two(1), c = two(2), d = two(3);
    const auto xz = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto yw = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const auto zx = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto wy = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return {{__builtin_shufflevector(xz, zx, 0, 1, 8, 9, 4, 5, 12, 13)},
            {__builtin_shufflevector(yw, wy, 0, 1, 8, 9, 4, 5, 12, 13)},
            {__builtin_shufflevector(xz, zx, 2, 3, 10, 11, 6, 7, 14, 15)},
            {__builtin_shufflevector(yw, wy, 2, 3, 10, 11, 6, 7, 14, 15)}};
#elif defined(__AVX__)
    const Row a = of(0), b = of(1), c = of(2), d = of(3);
    const Row xz = __builtin_shufflevector(a, b, 0, 4, 2, 6), yw = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Row zx = __builtin_shufflevector(c, d, 0, 4, 2, 6), wy = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    return {{__builtin_shufflevector(xz, zx, 0, 1, 4, 5)},
            {__builtin_shufflevector(yw, wy, 0, 1, 4, 5)},
            {__builtin_shufflevector(xz, zx, 2, 3, 6, 7)},
            {__builtin_shufflevector(yw, wy, 2, 3, 6, 7)}};
#else
    const Row a = of(0), b = of(1);
    const auto both = [&](int k)
                          __attribute__((always_inline)) { return Group{Group::Register{a[k], b[k]}}; };
    return {both(0), both(1), both(2), both(3)};
#endif
}

// Transposes the rows that at(0), at(1), ... point to into lanes.
template <class At> RATTLEBOX_INLINE Columns columns(At&& at) {
    return columns_of([&](int l) __attribute__((always_inline)) { return *at(l); });
}

// Transposes back: lane l is stored in the row that at(l) points to. If lanes share a row, the last one
// remains.
template <class At> RATTLEBOX_INLINE void store(const Columns& c, At&& at) {
#if defined(__AVX512F__)
    const auto xz = __builtin_shufflevector(c.x.v, c.z.v, 0, 1, 8, 9, 4, 5, 12, 13);
    const auto yw = __builtin_shufflevector(c.y.v, c.w.v, 0, 1, 8, 9, 4, 5, 12, 13);
    const auto zx = __builtin_shufflevector(c.x.v, c.z.v, 2, 3, 10, 11, 6, 7, 14, 15);
    const auto wy = __builtin_shufflevector(c.y.v, c.w.v, 2, 3, 10, 11, 6, 7, 14, 15);
    const auto store_two = [&](int l, auto both) __attribute__((always_inline)) {
        *at(l) = __builtin_shufflevector(both, both, 0, 1, 2, 3);
        *at(l + 4) = __builtin_shufflevector(both, both, 4, 5, 6, 7);
    };
    store_two(0, __builtin_shufflevector(xz, yw, 0, 8, 2, 10, 4, 12, 6, 14));
    store_two(1, __builtin_shufflevector(xz, yw, 1, 9, 3, 11, 5, 13, 7, 15));
    store_two(2, __builtin_shufflevector(zx, wy, 0, 8, 2, 10, 4, 12, 6, 14));
    store_two(3, __builtin_shufflevector(zx, wy, 1, 9, 3, 11, 5, 13, 7, 15));
#elif defined(__AVX__)
    const auto xz = __builtin_shufflevector(c.x.v, c.z.v, 0, 1, 4, 5);
    const auto yw = __builtin_shufflevector(c.y.v, c.w.v, 0, 1, 4, 5);
    const auto zx = __builtin_shufflevector(c.x.v, c.z.v, 2, 3, 6, 7);
    const auto wy = __builtin_shufflevector(c.y.v, c.w.v, 2, 3, 6, 7);
    *at(0) = __builtin_shufflevector(xz, yw, 0, 4, 2, 6);
    *at(1) = __builtin_shufflevector(xz, yw, 1, 5, 3, 7);
    *at(2) = __builtin_shufflevector(zx, wy, 0, 4, 2, 6);
    *at(3) = __builtin_shufflevector(zx, wy, 1, 5, 3, 7);
#else
    for (int l = 0; l < group; ++l) *at(l) = Row{c.x.v[l], c.y.v[l], c.z.v[l], c.w.v[l]};
#endif
}

} // namespace rattlebox
