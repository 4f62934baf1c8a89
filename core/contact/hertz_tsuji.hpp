// Hertz contact with Tsuji's dashpot.
//
//     N = A d^(3/2) + 2 zeta' sqrt(m A) d^(1/4) d'      2 zeta' = alpha = sqrt(5) zeta
//
// A = (4/3) E* sqrt(R*) [N/m^1.5], m = reduced mass [kg], d = overlap [m], d' = approach rate [m/s]. With x =
// d^(1/4) the force is the polynomial A x^6 + c x d', c = alpha sqrt(m A). Restitution depends on alpha alone
// (contact/damping.hpp). Valid for d << R*. Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239,
// eqs 8 and 17; with the reduced mass of the pair. The contact ends at zero overlap (the dashpot may pull
// before) or at zero force (it never pulls).
#pragma once

#include "base/field.hpp"
#include "contact/damping.hpp"
#include "contact/memory.hpp"

namespace rattlebox {

struct HertzTsuji {
    real stiffness = 0;        // A, N/m^1.5
    real mass = 0;             // m, kg
    real alpha = not_a_number; // fixed damping; if not given it follows from the restitution
    real zero_overlap = 0;     // 1: ends at zero overlap; 0: ends at zero force

    static constexpr const char* name = "hertz_tsuji";
    static constexpr Field<HertzTsuji> fields[] = {{"stiffness", &HertzTsuji::stiffness},
                                                   {"mass", &HertzTsuji::mass},
                                                   {"alpha", &HertzTsuji::alpha},
                                                   {"zero_overlap", &HertzTsuji::zero_overlap}};

    bool needs_restitution() const { return std::isnan(alpha); }
    real zeta(real e) const {
        return needs_restitution() ? damping_ratio(e, zero_overlap != 0) : alpha / std::sqrt(5.0);
    }

    // First touch: e is the restitution of this impact.
    Memory begin(real e) const { return damped(zeta(e)); }
    Memory damped(real ratio) const {
        Memory m;
        m.zeta = ratio;
        m.damping = std::sqrt(5.0) * m.zeta * std::sqrt(mass * stiffness);
        return m;
    }

    // Largest overlap of an undamped impact at this speed.
    real overlap_scale(real speed) const { return std::pow(1.25 * mass * speed * speed / stiffness, 0.4); }

    real force(const Memory& m, real x, real rate) const {
        return x * (stiffness * x * square(x * x) + m.damping * rate);
    }
    real lost_power(const Memory& m, real x, real rate) const { return m.damping * x * rate * rate; }
    real stored(const Memory&, real x) const { return 0.4 * stiffness * square(cube(x) * x * x); }
    real plastic(const Memory&, real) const { return 0; }

    // Positive until the contact ends.
    real boundary(const Memory& m, real x, real rate) const {
        if (zero_overlap != 0 || m.damping == 0) return x;
        return stiffness * x * square(x * x) + m.damping * rate;
    }
    Next cross(Memory&, real, real) const { return zero_overlap != 0 ? Next::open : Next::release; }
};

} // namespace rattlebox
