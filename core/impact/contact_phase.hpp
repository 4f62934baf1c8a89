// State of one contact of the 1-D engine, and the phases of a contact law.
//
// The engine integrates x with d = origin + x^4. In the transformed time dt = x^3 dtau Hertz contact is
// polynomial in x, so that an integrator of high order has its full order from first touch on. A phase is a
// part of the contact in which the force is smooth; the functions below evaluate the law in a phase and
// detect its end.
#pragma once

#include "contact/laws.hpp"
#include "math/real.hpp"

namespace rattlebox {

struct ContactState {
    Coefficients<real> coefficients;
    History<real> history;
    enum Phase { loading, yielding, unloading } phase = loading;

    // Returns the overlap at which the force is zero.
    real origin() const { return phase == unloading ? history.origin : 0; }
};

enum class PhaseEnd {
    stay,    // the contact continues in another phase
    open,    // the overlap is zero, and the contact ends
    release, // the force is zero, and the contact ends, but the bodies still overlap
};

// Returns the state at first touch; e is the restitution of the impact.
template <class Law> ContactState initial_state(const Law& law, real e, real speed) {
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

// Returns the power lost in the dashpot.
template <class Law> real dashpot_power(const Law& law, const ContactState& s, real x, real rate) {
    if constexpr (Law::hysteretic) return 0;
    const NormalForce<real> f = contact_force(law, s, x, rate);
    return (f.total - f.elastic) * rate;
}

// Returns the energy that unloading from this state would recover.
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

// Returns the energy lost by yielding so far.
template <class Law> real plastic_loss(const Law& law, const ContactState& s, real x) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::loading) return 0;
        return law.plastic_loss(s.phase == ContactState::yielding ? square(x * x) : s.history.deepest);
    } else {
        return 0;
    }
}

// Returns the overlap at which the phase ends while it grows, or infinity.
template <class Law> real last_overlap(const Law& law, const ContactState& s) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::loading) return law.yield_overlap(s.coefficients);
        if (s.phase == ContactState::unloading) return s.history.deepest;
    }
    return infinity;
}

// For a law with hysteresis: distance in x to the end of the phase, at the yield overlap or at the deepest
// overlap.
template <class Law> real distance_to_end(const Law& law, const ContactState& s, real x) {
    const real limit = s.phase == ContactState::loading ? law.yield_overlap(s.coefficients)
                                                        : s.history.deepest - s.history.origin;
    return std::sqrt(std::sqrt(limit)) - x;
}

// Overlaps [m] between which a force is smooth.
struct Span {
    real low = -infinity, high = infinity;
};

// Returns the knots on both sides of x; beyond the last one the curve is a straight line.
inline Span knots_around(const PiecewiseCubic& curve, real x) {
    if (x > curve.last()) return {curve.last(), infinity};
    const int i = curve.piece(x);
    return {curve.knots[i], curve.knots[i + 1]};
}

// Returns the overlaps around `overlap` between which the force of the phase is smooth. Laws with measured
// curves have knots, over which an integrator must not step.
template <class Law> Span smooth_span(const Law& law, const ContactState& s, real overlap) {
    if constexpr (requires { law.loading().knots, law.unloading().knots; }) {
        const real deepest = s.history.deepest;
        if (s.phase == ContactState::unloading && !law.unloading().empty() && deepest > 0) {
            const Span parts = knots_around(law.unloading(), overlap / deepest);
            return {parts.low * deepest, parts.high * deepest};
        }
        return knots_around(law.loading(), overlap);
    }
    return {};
}

// Positive until the phase ends.
template <class Law> real phase_end(const Law& law, const ContactState& s, real x, real rate) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::yielding) return rate;
        return std::fmin(distance_to_end(law, s, x), x);
    } else {
        if (law.zero_overlap != 0 || s.coefficients.second == 0) return x;
        // The force over the magnitudes of its parts is between -1 and 1, and regular where both vanish with
        // x. With a dashpot that vanishes as fast as the elastic force the contact ends at zero overlap.
        const NormalForce<real> f = contact_force(law, s, std::fmax(x, 1e-15), rate);
        const real part = f.total / (f.elastic + std::fabs(f.total - f.elastic));
        return rate < 0 ? std::fmin(x, part) : part;
    }
}

// Ends the current phase at x, and sets the next one.
template <class Law> PhaseEnd next_phase(const Law& law, ContactState& s, real x) {
    if constexpr (Law::hysteretic) {
        if (s.phase == ContactState::yielding) {
            s.history = law.unloaded_from(square(x * x));
            s.phase = ContactState::unloading;
            return PhaseEnd::stay;
        }
        if (distance_to_end(law, s, x) <
            x) { // rather than by the rate, whose sign is uncertain if it is zero there
            s.phase = ContactState::yielding;
            return PhaseEnd::stay;
        }
        return s.phase == ContactState::loading ? PhaseEnd::open : PhaseEnd::release;
    } else {
        return law.zero_overlap != 0 ? PhaseEnd::open : PhaseEnd::release;
    }
}

} // namespace rattlebox
