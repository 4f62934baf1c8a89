// The number type and constants of all parts of the core.
#pragma once

#include <cmath>
#include <limits>

namespace rattlebox {

using real = double;

inline constexpr real pi = 3.14159265358979323846;
inline constexpr real epsilon = std::numeric_limits<real>::epsilon();
inline constexpr real infinity = std::numeric_limits<real>::infinity();
inline constexpr real not_a_number = std::numeric_limits<real>::quiet_NaN();

inline real square(real x) { return x * x; }
inline real cube(real x) { return x * x * x; }

} // namespace rattlebox
