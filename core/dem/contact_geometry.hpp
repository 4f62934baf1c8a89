// The geometry of contacts between two spheres, or a sphere and a wall, and the laws of core/contact applied
// to it: for one number, or for as many contacts as a SIMD register holds.
#pragma once

#include "contact/tangential/spring_slider.hpp"
#include "dem/pair_laws.hpp"
#include "math/rows.hpp"

namespace rattlebox::dem {

// How two partners meet. `normal` points from the first to the second.
template <class T> struct Approach {
    Vector<T> normal;
    T overlap;
    Vector<T> velocity;     // of the first relative to the second, centres
    Vector<T> surface_spin; // sum of spin times lever
    Vector<T> spin;         // of the first relative to the second
    T lever;                // of the first over its radius, and of the second over its own
    T radius;               // of the first
};

// A sphere: where its centre is, and how it moves and turns.
template <class T> struct Ball {
    Vector<T> place, velocity, spin;
    T radius;
};

// Two spheres, seen from each other.
template <class T> struct RelativeMotion {
    Vector<T> way;            // from the first centre to the second
    Vector<T> velocity, spin; // of the first relative to the second
    Vector<T> surface_spin;   // sum of spin times radius
    T near, radius;           // sum of the radii, and the smaller of them
};

template <bool spins, class T> RATTLEBOX_INLINE Approach<T> approach_of(const RelativeMotion<T>& f) {
    const T distance = root(dot(f.way, f.way));
    const T per_both = all(distance, 1) / (distance * f.near); // one division for two
    Approach<T> m;
    m.normal = (f.near * per_both) * f.way;
    m.overlap = overlap(f.near, distance);
    m.radius = f.radius;
    m.velocity = f.velocity;
    if constexpr (spins) {
        m.lever = distance * distance * per_both;
        m.surface_spin = m.lever * f.surface_spin;
        m.spin = f.spin;
    }
    return m;
}

// A sphere and a wall in the direction `normal`.
template <bool spins, class T>
RATTLEBOX_INLINE Approach<T> approach_of(const Ball<T>& a, const Vector<T>& normal, const T& distance,
                                         const Vector<T>& velocity) {
    Approach<T> m;
    m.normal = normal;
    m.overlap = overlap(a.radius, distance);
    m.velocity = a.velocity - velocity;
    m.radius = a.radius;
    if constexpr (spins) {
        m.lever = distance / a.radius;
        m.spin = a.spin;
        m.surface_spin = distance * m.spin;
    }
    return m;
}

template <class T> struct Four {
    T x, y, z, w;
    RATTLEBOX_INLINE Vector<T> vector() const { return {x, y, z}; }
};

// ---- normal

// A law that yields, without branches: below the deepest overlap it follows the unloading curve.
template <class Law, class T>
RATTLEBOX_INLINE NormalForce<T> normal_force(const Law& law, const Coefficients<T>& k, const Depth<T>& d,
                                             const T& rate, const History<T>& h) {
    if constexpr (Law::hysteretic) {
        const T virgin =
            choose(d.overlap - law.yield_overlap(k), law.yielding_force(k, d), law.elastic_force(k, d));
        const T above = larger(d.overlap - h.origin, all(rate, 0));
        const T again = law.unloading_force(h, depth_from_overlap(above));
        const T force = choose(h.deepest - d.overlap, again, virgin);
        return {force, force};
    } else {
        return law.force(k, d, rate);
    }
}

// Energy that the contact gives back when it opens; the history is up to date.
template <class Law, class T>
RATTLEBOX_INLINE T stored_energy(const Law& law, const Coefficients<T>& k, const Depth<T>& d,
                                 const History<T>& h) {
    if constexpr (Law::hysteretic)
        return law.recovered(h, depth_from_overlap(larger(d.overlap - h.origin, all(d.overlap, 0))));
    else
        return law.stored(k, d);
}

// ---- tangential and rolling

// Stiffness and dashpot of the tangential law with this place in the table of laws.
template <class T> RATTLEBOX_INLINE T tangential_stiffness(int law, const T& coefficient, const Depth<T>& d) {
    T k = coefficient;
    TangentialLaw::each([&]<class Law>(int place) __attribute__((always_inline)) {
        if (law == place) k = Law::stiffness(coefficient, d);
    });
    return k;
}
template <class T> RATTLEBOX_INLINE T tangential_dashpot(int law, const T& coefficient, const Depth<T>& d) {
    T c = coefficient;
    TangentialLaw::each([&]<class Law>(int place) __attribute__((always_inline)) {
        if (law == place) c = Law::dashpot(coefficient, d);
    });
    return c;
}

template <class T> struct Tangential {
    Vector<T> force, couple; // on the first; the couple over its radius
    Four<T> spring;          // force half a step later, and compliance
    T stiffness;
    T loss, stored, excess;
};

// `coefficients` are those of the tangential spring and dashpot of the contact.
template <class T, class Row>
RATTLEBOX_INLINE Tangential<T> tangential_force(const Approach<T>& m, const T& normal_force, const T& rate,
                                                const T& spring, const T& dashpot, const T& friction,
                                                const Depth<T>& depth, const Row& history, int law,
                                                const T& dt) {
    const T zero = all(rate, 0);
    const T pressed = larger(normal_force, zero), stiffness = tangential_stiffness(law, spring, depth);
    const Vector<T> slip = m.velocity - rate * m.normal + cross(m.surface_spin, m.normal);
    const auto s =
        advance_spring_slider(history.vector(), history.w, m.normal, stiffness,
                              tangential_dashpot(law, dashpot, depth), slip, friction * pressed, dt);
    return {s.force,
            m.lever * cross(m.normal, s.force),
            {s.next_spring.x, s.next_spring.y, s.next_spring.z, s.compliance},
            stiffness,
            s.loss,
            s.stored,
            s.excess};
}

template <class T> struct Rolling {
    Vector<T> torque; // on the first
    Four<T> spring;   // torque half a step later, and compliance
    T loss, stored, excess;
};

// `coefficients` holds mu_r R*, k_r / k_t, c_r.
template <class T, class Row>
RATTLEBOX_INLINE Rolling<T> rolling_torque(const Approach<T>& m, const T& normal_force,
                                           const T& tangential_stiffness, const Row& coefficients,
                                           const Depth<T>& depth, const Row& history, int law, const T& dt) {
    const T zero = all(normal_force, 0), pressed = larger(normal_force, zero);
    const Vector<T> turning = m.spin - dot(m.spin, m.normal) * m.normal;
    const auto s = advance_spring_slider(
        history.vector(), history.w, m.normal, coefficients.y * tangential_stiffness,
        tangential_dashpot(law, coefficients.z, depth), turning, coefficients.x * pressed, dt);
    return {s.force,
            {s.next_spring.x, s.next_spring.y, s.next_spring.z, s.compliance},
            s.loss,
            s.stored,
            s.excess};
}

} // namespace rattlebox::dem
