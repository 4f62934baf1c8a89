// Restitution of a contact that is a linear oscillator in some variable, and its inverse.
//
//     ends at zero overlap    ln e = -pi zeta / sqrt(1 - zeta^2)
//     ends at zero force      ln e = -2 b cot b,  zeta = cos b      (zeta < 1)
//                             ln e = -2                             (zeta = 1)
//                             ln e = -2 h coth h,  zeta = cosh h    (zeta > 1)
//
// zeta is the damping ratio of that oscillator. Holds for the linear spring-dashpot and, in Y =
// overlap^(5/4), for Hertz contact with Tsuji's dashpot at every speed. Derived from the exact solution; see
// docs, contact laws.
#pragma once

#include "math/real.hpp"

namespace rattlebox {

inline real log_restitution(real zeta, bool zero_overlap) {
    if (zero_overlap) return zeta < 1 ? -pi * zeta / std::sqrt(1 - zeta * zeta) : -infinity;
    if (zeta == 1) return -2;
    if (zeta < 1) {
        const real b = std::acos(zeta);
        return -2 * b * zeta / std::sin(b);
    }
    const real h = std::acosh(zeta);
    return -2 * h * zeta / std::sinh(h);
}

// The damping ratio that gives restitution e, 0 < e <= 1.
inline real damping_ratio(real e, bool zero_overlap) {
    if (e >= 1) return 0;
    const real target = -std::log(e);
    if (zero_overlap) return target / std::sqrt(target * target + pi * pi);
    // Newton on -ln e(zeta), smooth, increasing and concave, from the left: each step stays there and grows.
    real zeta = std::fmin(target / pi, 1.0);
    for (int iteration = 0; iteration < 100; ++iteration) {
        const real square_of_sine = (1 - zeta) * (1 + zeta), sine = std::sqrt(std::fabs(square_of_sine));
        const real slope = sine < 1e-3          ? 4.0 / 3.0
                           : square_of_sine > 0 ? 2 * (std::acos(zeta) - zeta * sine) / cube(sine)
                                                : 2 * (zeta * sine - std::acosh(zeta)) / cube(sine);
        const real change = (target + log_restitution(zeta, false)) / slope;
        zeta += change;
        if (std::fabs(change) <= 4 * epsilon * zeta) break;
    }
    return zeta;
}

} // namespace rattlebox
