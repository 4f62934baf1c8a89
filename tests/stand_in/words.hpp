// CUDA's words for kernels that a compiler of the processor reads; card.cpp runs them. Of no library, so that
// the core's own stand-ins for the standard library can take its place.
#pragma once

#define __global__
#define __device__
#define __shared__ thread_local // a block is a thread of the system, its threads take turns there
#define __align__(n) __attribute__((aligned(n)))
#define __noinline__ __attribute__((noinline))
#define __launch_bounds__(...)

#ifdef __CUDACC__ // what NVIDIA's compiler has built in
#include <cstddef>
#include <type_traits>

using std::ptrdiff_t, std::size_t;
inline void* operator new(std::size_t, void* place) noexcept { return place; }
namespace std {
template <class T> class initializer_list { // as GCC and Clang fill it
    const T* begin_ = nullptr;
    size_t size_ = 0;

    constexpr initializer_list(const T* begin, size_t size) : begin_(begin), size_(size) {}

public:
    constexpr initializer_list() = default;
    constexpr const T* begin() const { return begin_; }
    constexpr const T* end() const { return begin_ + size_; }
};
template <class T> constexpr remove_reference_t<T>&& move(T&& value) {
    return static_cast<remove_reference_t<T>&&>(value);
}
template <class T> constexpr T&& forward(remove_reference_t<T>& value) { return static_cast<T&&>(value); }
} // namespace std
#endif

struct Index {
    unsigned x, y, z;
};

extern "C" {
extern __thread Index threadIdx, blockIdx, blockDim, gridDim;
void stand_in_barrier();
void stand_in_lanes(unsigned mask, const void* own, void* other, int bytes, int from);
void stand_in_pause();
[[noreturn]] void stand_in_trap();

double acos(double), acosh(double), copysign(double, double), cos(double), exp(double), expm1(double),
    fabs(double), floor(double), fmax(double, double), fmin(double, double), hypot(double, double),
    log(double), log1p(double), pow(double, double), sin(double), sinh(double), sqrt(double);
}

inline void __syncthreads() { stand_in_barrier(); }
inline void __syncwarp(unsigned mask = ~0u) { stand_in_lanes(mask, nullptr, nullptr, 0, 0); }
template <class T> T __shfl_down_sync(unsigned mask, T value, int by) {
    T other = value;
    const unsigned lane = threadIdx.x % 32 + static_cast<unsigned>(by);
    stand_in_lanes(mask, &value, &other, sizeof(T), lane < 32 ? static_cast<int>(lane) : -1);
    return other;
}
// Others come to their turn at what many write to.
template <class T> T atomicAdd(T* to, T value) {
    const T before = __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
    stand_in_pause();
    return before;
}
inline int atomicMin(int* to, int value) {
    int before = __atomic_load_n(to, __ATOMIC_RELAXED);
    while (value < before &&
           !__atomic_compare_exchange_n(to, &before, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
    return before;
}
inline void __threadfence() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }
inline void __nanosleep(unsigned) { stand_in_pause(); }
inline int __ffs(int bits) { return __builtin_ffs(bits); }
[[noreturn]] inline void __trap() { stand_in_trap(); }

// What card.cpp has to know of a kernel.
struct StandInKernel {
    const char* name;
    int parameters;
    const int* sizes; // below zero: of a pointer
    void (*call)(const void* kernel, void** given);
    const void* kernel;
};

template <class T> constexpr int stand_in_size = sizeof(T);
template <class T> constexpr int stand_in_size<T*> = -static_cast<int>(sizeof(T*));

template <class... A> struct StandInCall {
    static constexpr int sizes[] = {stand_in_size<A>..., 0};
    template <class T> static T next(void**& given) { return *static_cast<T*>(*given++); }
    struct Made { // braces take arguments in their order
        Made(void (*f)(A...), A... a) { f(a...); }
    };
    static void call(const void* kernel, void** given) {
        Made{reinterpret_cast<void (*)(A...)>(const_cast<void*>(kernel)), next<A>(given)...};
    }
};
template <class... A> constexpr StandInKernel stand_in(const char* name, void (*f)(A...)) {
    return {name, sizeof...(A), StandInCall<A...>::sizes, StandInCall<A...>::call,
            reinterpret_cast<const void*>(f)};
}
