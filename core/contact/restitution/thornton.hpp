// Restitution of Thornton's elastic, perfectly plastic contact in closed form.
//
//     e = sqrt(6 sqrt(3)/5) sqrt(1 - r^2/6) [r / (r + 2 sqrt(6/5 - r^2/5))]^(1/4)      V > V_y
//     e = 1                                                                                V <= V_y
//
// r = V_y / V, V_y = speed at which yield begins [m/s].
//
// C. Thornton, Coefficient of restitution for collinear collisions of elastic-perfectly plastic spheres,
// J. Appl. Mech. 64 (1997) 383-386, eq. 19, doi:10.1115/1.2787319.
#pragma once

#include "util/field.hpp"

namespace rattlebox {

struct ThorntonRestitution {
    real yield_speed = infinity; // V_y, m/s
    real maximum = 1;

    static constexpr bool speed_scales_with_size = true;
    static constexpr const char* name = "thornton";
    static constexpr Field<ThorntonRestitution> fields[] = {
        {"yield_speed", &ThorntonRestitution::yield_speed}, {"maximum", &ThorntonRestitution::maximum}};

    real limit() const { return infinity; }
    bool beyond() const { return true; }
    real value(real speed) const {
        if (speed <= yield_speed) return 1;
        const real r = yield_speed / speed;
        return std::sqrt(1.2 * std::sqrt(3.0)) * std::sqrt(1 - r * r / 6) *
               std::pow(r / (r + 2 * std::sqrt(1.2 - 0.2 * r * r)), 0.25);
    }
};

} // namespace rattlebox
