// Restitution of a contact that is a linear oscillator in some variable, as a function of its damping ratio,
// and the inverse.
//
//     ends at zero overlap    ln e = -pi zeta / sqrt(1 - zeta^2)
//     ends at zero force      ln e = -2 b cot b,  zeta = cos b      (zeta < 1)
//                             ln e = -2                             (zeta = 1)
//                             ln e = -2 h coth h,  zeta = cosh h    (zeta > 1)
//
// zeta is the damping ratio of the oscillator. Valid for the linear spring and dashpot and, in overlap^(5/4),
// for Hertz contact with Tsuji's dashpot at every speed.
//
// T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, doi:10.1007/s10035-007-0065-z (linear, both ends);
// Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, doi:10.1016/0032-5910(92)88030-L (Hertz).
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

// Returns the damping ratio for restitution e, 0 < e <= 1.
inline real damping_ratio(real e, bool zero_overlap) {
    if (e >= 1) return 0;
    const real target = -std::log(e);
    if (zero_overlap) return target / std::sqrt(target * target + pi * pi);
    // Newton's method from the left on -ln e(zeta), which is smooth, increasing and concave, so the steps
    // cannot overshoot.
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
