// What one contact of the 1-D engine remembers, and the phases that it passes through.
//
// The engine integrates x with d = origin + x^4: Hertz contact is polynomial in x in a time transformed by dt
// = x^3 dtau, so that an integrator of high order has its order from first touch on. A phase is a piece of
// the contact in which the force is smooth; the functions below pick the piece of the law's formula that
// holds in it, and find where it ends.
#pragma once

#include "contact/laws.hpp"
#include "math/real.hpp"

namespace rattlebox {

struct ContactState {
    Coefficients<real> coefficients;
    History<real> history;
    enum Phase { loading, yielding, unloading } phase = loading;

    // Overlap at which the force vanishes.
    real origin() const { return phase == unloading ? history.origin : 0; }
};

enum class Next {
    stay,    // another phase of the same contact
    open,    // overlap is zero: the contact is over
    release, // force is zero, overlap is not: the contact is over, the bodies still overlap
};

// First touch at this speed; e is the restitution of the impact.
template <class Law> ContactState first_touch(const Law& law, real e, real speed) {
    ContactState s;
    if constexpr (Law::hysteretic) {
        s.coefficients = law.coefficients(0, speed);
        s.history = law.untouched();
        if (law.yield_overlap(s.coefficients) <= 0) s.phase = ContactState::yielding;
    } else {
        s.coefficients = law.coefficients(law.damping(e), speed);
    }
    return s;
}

template <class Law>
NormalForce<real> contact_force(const Law& law, const ContactState& s, real x, real rate) {
    const Depth<real> d = depth_from_fourth_root(x);
    if constexpr (Law::hysteretic) {
        const real f = s.phase == ContactState::loading    ? law.elastic_force(s.coefficients, d)
                       : s.phase == ContactState::yielding ? law.yielding_force(s.coefficients, d)
                                                           : law.unloading_force(s.history, d);
        return {f, f};
    } else {
        return law.force(s.coefficients, d, rate);
    }
}

// Power that the dashpot takes.
template <class Law> real dashpot_power(const Law& law, const ContactState& s, real x, real rate) {
    if constexpr (Law::hysteretic) return 0;
    const NormalForce<real> f = contact_force(law, s, x, rate);
    return (f.total - f.elastic) * rate;
}

// Energy that unloading from here would give back.
template <class Law> real stored_energy(const Law& law, const ContactState& s, real x) {
    const Depth<real> d = depth_from_fourth_root(x);
    if constexpr (Law::hysteretic) {
        if (s.phase != ContactState::yielding) return law.recovered(s.history, d);
        const History<real> h = law.unloaded_from(d.overlap);
        return law.recovered(h, depth_from_overlap(d.overlap - h.origin));
    } else {
        return law.stored(s.coefficients, d);
    }
}

// Energy lost by yielding so far.
template <class Law> real plastic_loss(const Law& law, const ContactState& s, real x) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::loading) return 0;
        return law.plastic_loss(s.phase == ContactState::yielding ? square(x * x) : s.history.deepest);
    } else {
        return 0;
    }
}

// Of a law that yields: from x to where the present piece of the curve ends, at the yield overlap or at the
// deepest one so far.
template <class Law> real room(const Law& law, const ContactState& s, real x) {
    const real limit = s.phase == ContactState::loading ? law.yield_overlap(s.coefficients)
                                                        : s.history.deepest - s.history.origin;
    return std::sqrt(std::sqrt(limit)) - x;
}

// Positive until the phase ends.
template <class Law> real phase_end(const Law& law, const ContactState& s, real x, real rate) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::yielding) return rate;
        return std::fmin(room(law, s, x), x);
    } else {
        if (law.zero_overlap != 0 || s.coefficients.second == 0) return x;
        // The force over the sizes of its parts: between -1 and 1, and regular where both vanish with x. A
        // dashpot that vanishes as fast as the elastic force lets the bodies part at zero overlap.
        const NormalForce<real> f = contact_force(law, s, std::fmax(x, 1e-15), rate);
        const real part = f.total / (f.elastic + std::fabs(f.total - f.elastic));
        return rate < 0 ? std::fmin(x, part) : part;
    }
}

// Ends a phase at x.
template <class Law> Next next_phase(const Law& law, ContactState& s, real x) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::yielding) {
            s.history = law.unloaded_from(square(x * x));
            s.phase = ContactState::unloading;
            return Next::stay;
        }
        if (room(law, s, x) < x) { // whatever rounding has made of the rate where it turns just there
            s.phase = ContactState::yielding;
            return Next::stay;
        }
        return s.phase == ContactState::loading ? Next::open : Next::release;
    } else {
        return law.zero_overlap != 0 ? Next::open : Next::release;
    }
}

} // namespace rattlebox
