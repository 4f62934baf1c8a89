// Johnson's restitution of a fully plastic impact.
//
//     e = (V / V_0)^(-1/4), at most 1
//
// V_0 = speed scale [m/s], computed from the yield stress. Valid for V >> V_0.
//
// K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, section 11.5, eq. 11.47,
// doi:10.1017/CBO9781139171731.
#pragma once

#include "util/field.hpp"

namespace rattlebox {

struct JohnsonRestitution {
    real speed_scale = infinity; // V_0, m/s
    real maximum = 1;

    static constexpr bool speed_scales_with_size = true;
    static constexpr const char* name = "johnson";
    static constexpr Field<JohnsonRestitution> fields[] = {{"speed_scale", &JohnsonRestitution::speed_scale},
                                                           {"maximum", &JohnsonRestitution::maximum}};

    real limit() const { return infinity; }
    bool beyond() const { return true; }
    real value(real speed) const {
        return speed <= speed_scale ? 1 : std::sqrt(std::sqrt(speed_scale / speed));
    }
};

} // namespace rattlebox
