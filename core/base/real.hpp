// The number type and the few constants that every room shares.
#pragma once

#include <cmath>
#include <limits>

// A function that a GPU calls: its compiler would copy it to every place that uses it.
#ifdef __CUDACC__
#define RATTLEBOX_CALL __noinline__
#else
#define RATTLEBOX_CALL
#endif

namespace rattlebox {

using real = double;

inline constexpr real pi = 3.14159265358979323846;
inline constexpr real epsilon = std::numeric_limits<real>::epsilon();
inline constexpr real infinity = std::numeric_limits<real>::infinity();
inline constexpr real not_a_number = std::numeric_limits<real>::quiet_NaN();

inline real square(real x) { return x * x; }
inline real cube(real x) { return x * x * x; }

} // namespace rattlebox
