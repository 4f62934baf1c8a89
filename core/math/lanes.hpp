// SIMD: eight numbers in registers of the width that the instruction set has. A pack consists of two halves
// rather than of an array of registers, because compilers keep an array in memory; sums also have the same
// order for every width.
#pragma once

#include "math/real.hpp"

namespace rattlebox {

inline constexpr int lane_count = 8;

#if defined(__AVX512F__)
inline constexpr int register_width = 8;
#elif defined(__AVX__)
inline constexpr int register_width = 4;
#else
inline constexpr int register_width = 2;
#endif

// may_alias, because packs overlay arrays of numbers.
template <int n> struct __attribute__((may_alias)) Pack {
    Pack<n / 2> low, high;

    static Pack all(real v) { return {Pack<n / 2>::all(v), Pack<n / 2>::all(v)}; }
    friend Pack operator+(const Pack& a, const Pack& b) { return {a.low + b.low, a.high + b.high}; }
    friend Pack operator-(const Pack& a, const Pack& b) { return {a.low - b.low, a.high - b.high}; }
    friend Pack operator*(const Pack& a, const Pack& b) { return {a.low * b.low, a.high * b.high}; }
    friend Pack operator/(const Pack& a, const Pack& b) { return {a.low / b.low, a.high / b.high}; }
    friend Pack absolute(const Pack& a) { return {absolute(a.low), absolute(a.high)}; }
    friend Pack larger(const Pack& a, const Pack& b) {
        return {larger(a.low, b.low), larger(a.high, b.high)};
    }
    friend real total(const Pack& a) { return total(a.low + a.high); }
    friend real largest(const Pack& a) { return largest(larger(a.low, a.high)); }
};

template <int n> struct RegisterOf;
template <> struct RegisterOf<2> {
    typedef real type __attribute__((vector_size(2 * sizeof(real)), may_alias));
};
template <> struct RegisterOf<4> {
    typedef real type __attribute__((vector_size(4 * sizeof(real)), may_alias));
};
template <> struct RegisterOf<8> {
    typedef real type __attribute__((vector_size(8 * sizeof(real)), may_alias));
};

template <int n>
    requires(n <= register_width)
struct __attribute__((may_alias)) Pack<n> {
    using Register = typename RegisterOf<n>::type;
    Register v;

    // v - 0 rather than v + 0: compilers remove the subtraction, but not the addition, which turns -0 into 0.
    static Pack all(real v) { return {v - Register{}}; }
    friend Pack operator+(const Pack& a, const Pack& b) { return {a.v + b.v}; }
    friend Pack operator-(const Pack& a, const Pack& b) { return {a.v - b.v}; }
    friend Pack operator*(const Pack& a, const Pack& b) { return {a.v * b.v}; }
    friend Pack operator/(const Pack& a, const Pack& b) { return {a.v / b.v}; }
    friend Pack absolute(const Pack& a) { return {a.v < 0 ? -a.v : a.v}; }
    friend Pack larger(const Pack& a, const Pack& b) { return {a.v > b.v ? a.v : b.v}; }
    friend real total(const Pack& a) {
        real part[n];
        for (int i = 0; i < n; ++i) part[i] = a.v[i];
        for (int half = n / 2; half > 0; half /= 2)
            for (int i = 0; i < half; ++i) part[i] += part[i + half];
        return part[0];
    }
    friend real largest(const Pack& a) {
        real most = a.v[0];
        for (int i = 1; i < n; ++i) most = a.v[i] > most ? a.v[i] : most;
        return most;
    }
};

using Lanes = Pack<lane_count>;

template <int n> Pack<n> operator*(real a, const Pack<n>& b) { return Pack<n>::all(a) * b; }
template <int n> Pack<n>& operator+=(Pack<n>& a, const Pack<n>& b) { return a = a + b; }

// Consecutive numbers at an aligned address.
template <int n> const Pack<n>& pack(const real* p) { return *reinterpret_cast<const Pack<n>*>(p); }
template <int n> Pack<n>& pack(real* p) { return *reinterpret_cast<Pack<n>*>(p); }
// Their value, loaded register by register. Compilers copy a struct in smaller pieces, which prevents store
// forwarding.
template <int n> Pack<n> read(const real* p) {
    if constexpr (n <= register_width)
        return pack<n>(p);
    else
        return {read<n / 2>(p), read<n / 2>(p + n / 2)};
}
// Number of contacts that are computed at once: one register, because the many variables of a contact law do
// not fit into the registers otherwise.
inline constexpr int group = register_width;
using Group = Pack<group>;

// Consecutive numbers at any address.
inline Group unaligned(const real* p) {
    Group value;
    __builtin_memcpy(&value, p, sizeof(value));
    return value;
}

inline Group& group_of(Lanes& all, int first) { return pack<group>(reinterpret_cast<real*>(&all) + first); }

inline const Lanes& lanes(const real* p) { return pack<lane_count>(p); }
inline Lanes& lanes(real* p) { return pack<lane_count>(p); }

} // namespace rattlebox
