// Thornton's elastic, perfectly plastic contact: dissipation by yielding, not by a dashpot.
//
//     loading    F = A d^(3/2)                           to d_y = R (pi p_y / (2 E))^2
//     yielding   F = F_y + pi p_y R (d - d_y)
//     unloading  F = (4/3) E sqrt(R_p) (d - d_p)^(3/2)   R_p = 4 E / (3 F_max) ((2 F_max + F_y) / (2 pi
//     p_y))^(3/2)
//
// E = E* [Pa], R = R* [m], p_y = limiting contact pressure [Pa], d_p = d_max - (3 F_max / (4 E
// sqrt(R_p)))^(2/3) the dent that remains. Reloading follows the unloading curve to d_max, then yields on.
// Rate independent. C. Thornton, J. Appl. Mech. 64 (1997) 383, eqs 8 to 18; C. Thornton, Z. Ning, Powder
// Technology 99 (1998) 154.
#pragma once

#include "base/field.hpp"
#include "contact/memory.hpp"

namespace rattlebox {

struct Thornton {
    real stiffness = 0;      // A = (4/3) E sqrt(R), N/m^1.5
    real mass = 0;           // reduced mass, kg
    real radius = 0;         // R, m
    real modulus = 0;        // E, Pa
    real yield_pressure = 0; // p_y, Pa

    static constexpr const char* name = "thornton";
    static constexpr Field<Thornton> fields[] = {{"stiffness", &Thornton::stiffness},
                                                 {"mass", &Thornton::mass},
                                                 {"radius", &Thornton::radius},
                                                 {"modulus", &Thornton::modulus},
                                                 {"yield_pressure", &Thornton::yield_pressure}};
    enum Phase { loading, yielding, unloading };

    bool needs_restitution() const { return false; }
    real zeta(real) const { return 0; }

    Memory begin(real) const {
        Memory m;
        m.stiffness = stiffness;
        return m;
    }

    real overlap_scale(real speed) const { return std::pow(1.25 * mass * speed * speed / stiffness, 0.4); }
    real yield_overlap() const { return radius * square(pi * yield_pressure / (2 * modulus)); }
    real yield_force() const { return stiffness * std::pow(yield_overlap(), 1.5); }
    real plastic_slope() const { return pi * yield_pressure * radius; }

    real force(const Memory& m, real x, real) const {
        if (m.phase != yielding) return m.stiffness * square(cube(x));
        return yield_force() + plastic_slope() * (square(x * x) - yield_overlap());
    }
    real lost_power(const Memory&, real, real) const { return 0; }

    // The unloading curve from the deepest overlap d: its stiffness and the dent it ends at.
    void unloading_curve(real deepest, real& curve_stiffness, real& dent) const {
        const real top = yield_force() + plastic_slope() * (deepest - yield_overlap());
        const real contact_radius_squared = (2 * top + yield_force()) / (2 * pi * yield_pressure);
        const real plastic_radius = 4 * modulus / (3 * top) * std::pow(contact_radius_squared, 1.5);
        curve_stiffness = 4.0 / 3.0 * modulus * std::sqrt(plastic_radius);
        dent = deepest - std::pow(top / curve_stiffness, 2.0 / 3.0);
    }

    // Energy that unloading from here would give back.
    real stored(const Memory& m, real x) const {
        if (m.phase != yielding) return 0.4 * m.stiffness * square(cube(x) * x * x);
        real curve, dent;
        const real deepest = square(x * x);
        unloading_curve(deepest, curve, dent);
        return 0.4 * curve * std::pow(deepest - dent, 2.5);
    }

    // Work of loading to the deepest overlap less what unloading gives back.
    real plastic(const Memory& m, real x) const {
        const real deepest = m.phase == yielding ? square(x * x) : m.deepest;
        const real past = deepest - yield_overlap();
        if (m.phase == loading || past <= 0) return 0;
        real curve, dent;
        unloading_curve(deepest, curve, dent);
        const real work = 0.4 * stiffness * std::pow(yield_overlap(), 2.5) +
                          past * (yield_force() + 0.5 * plastic_slope() * past);
        return work - 0.4 * curve * std::pow(deepest - dent, 2.5);
    }

    // From x to where the curve ends: at the yield overlap, or at the deepest one so far.
    real room(const Memory& m, real x) const {
        const real limit = m.phase == loading ? yield_overlap() : m.deepest - m.offset;
        return std::sqrt(std::sqrt(limit)) - x;
    }

    real boundary(const Memory& m, real x, real rate) const {
        if (m.phase == yielding) return rate;
        const real above = room(m, x);
        return above < x ? above : x;
    }

    Next cross(Memory& m, real x, real) const {
        if (m.phase == yielding) {
            m.deepest = square(x * x);
            unloading_curve(m.deepest, m.stiffness, m.offset);
            m.phase = unloading;
            return Next::stay;
        }
        if (room(m, x) < x) { // whatever rounding has made of the rate, where it turns just there
            m.phase = yielding;
            m.offset = 0;
            return Next::stay;
        }
        return m.phase == loading ? Next::open : Next::release;
    }
};

} // namespace rattlebox
