// A table of numbers that is computed once.
#pragma once

namespace rattlebox {

#ifdef __CUDACC__
template <class T> struct alignas(T) Room {
    unsigned char bytes[sizeof(T)];
};
template <class T>
__device__ Room<T> room; // filled by a kernel that runs before all others (gpu/constants.hpp)
template <class T> const T& constant() { return *reinterpret_cast<const T*>(&room<T>); }
#else
template <class T> const T& constant() {
    static const T value;
    return value;
}
#endif

} // namespace rattlebox
