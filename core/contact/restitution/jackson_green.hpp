// Jackson and Green's elasto-plastic restitution, from finite elements.
//
//     e = 1                                                                      V* < 1
//     e = 1 - 0.1 ln V* ((V* - 1)/59)^0.156                                      1 <= V* < 60
//     e = 1 - 0.1 ln 60 - 0.11 ln(V*/60) (V* - 60)^(2.36 eps_y)                  60 <= V* <= 1000
//
// V* = V / V_c, V_c = critical speed [m/s], eps_y = S_y / E of the body that yields first [-]. Undefined
// above V* = 1000.
//
// R. L. Jackson, I. Green, D. B. Marghitu, Predicting the coefficient of restitution of impacting
// elastic-perfectly plastic spheres, Nonlinear Dynamics 60 (2010) 217, doi:10.1007/s11071-009-9591-z.
#pragma once

#include "util/field.hpp"

namespace rattlebox {

struct JacksonGreenRestitution {
    real critical_speed = infinity; // V_c, m/s
    real yield_strain = 0;          // eps_y
    real extrapolate = 0;           // 1: use the last branch above V* = 1000
    real maximum = 1;

    static constexpr bool speed_scales_with_size = true;
    static constexpr const char* name = "jackson_green";
    static constexpr Field<JacksonGreenRestitution> fields[] = {
        {"critical_speed", &JacksonGreenRestitution::critical_speed},
        {"yield_strain", &JacksonGreenRestitution::yield_strain},
        {"extrapolate", &JacksonGreenRestitution::extrapolate},
        {"maximum", &JacksonGreenRestitution::maximum}};

    real limit() const { return 1000 * critical_speed; }
    bool beyond() const { return extrapolate != 0; }
    real value(real speed) const {
        const real v = speed / critical_speed;
        if (v <= 1) return 1;
        if (v < 60) return 1 - 0.1 * std::log(v) * std::pow((v - 1) / 59, 0.156);
        return 1 - 0.1 * std::log(60.0) - 0.11 * std::log(v / 60) * std::pow(v - 60, 2.36 * yield_strain);
    }
};

} // namespace rattlebox
