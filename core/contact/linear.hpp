// Linear spring and dashpot.
//
//     N = k d + c d'        c = 2 zeta sqrt(m k)
//
// k [N/m], m = reduced mass [kg], d = overlap [m], d' = approach rate [m/s]. Restitution follows from zeta
// alone (contact/damping.hpp). The contact ends at zero overlap (the dashpot may pull before) or at zero
// force.
#pragma once

#include "base/field.hpp"
#include "contact/damping.hpp"
#include "contact/memory.hpp"

namespace rattlebox {

struct LinearDashpot {
    real stiffness = 0;          // k, N/m
    real mass = 0;               // m, kg
    real damping = not_a_number; // c, N s/m; if not given it follows from the restitution
    real zero_overlap = 0;       // 1: ends at zero overlap; 0: ends at zero force

    static constexpr const char* name = "linear";
    static constexpr Field<LinearDashpot> fields[] = {{"stiffness", &LinearDashpot::stiffness},
                                                      {"mass", &LinearDashpot::mass},
                                                      {"damping", &LinearDashpot::damping},
                                                      {"zero_overlap", &LinearDashpot::zero_overlap}};

    bool needs_restitution() const { return std::isnan(damping); }
    real zeta(real e) const {
        return needs_restitution() ? damping_ratio(e, zero_overlap != 0)
                                   : 0.5 * damping / std::sqrt(mass * stiffness);
    }

    Memory begin(real e) const { return damped(zeta(e)); }
    Memory damped(real ratio) const {
        Memory m;
        m.zeta = ratio;
        m.damping = 2 * m.zeta * std::sqrt(mass * stiffness);
        return m;
    }

    real overlap_scale(real speed) const { return speed * std::sqrt(mass / stiffness); }

    real force(const Memory& m, real x, real rate) const {
        return stiffness * square(x * x) + m.damping * rate;
    }
    real lost_power(const Memory& m, real, real rate) const { return m.damping * rate * rate; }
    real stored(const Memory&, real x) const { return 0.5 * stiffness * square(square(x * x)); }
    real plastic(const Memory&, real) const { return 0; }

    real boundary(const Memory& m, real x, real rate) const {
        return zero_overlap != 0 || m.damping == 0 ? x
                                                   : stiffness * x * std::fabs(x) * x * x + m.damping * rate;
    }
    Next cross(Memory&, real, real) const { return zero_overlap != 0 ? Next::open : Next::release; }
};

} // namespace rattlebox
