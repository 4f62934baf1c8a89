// Kinematics of contacts between two spheres, or a sphere and a wall, and the contact laws of core/contact
// applied to them, for a number type T: one number, or one SIMD register of contacts.
//
//     approach rate   d' = v . n                    v = v_1 - v_2
//     slip            v - d' n + (l_1 w_1 + l_2 w_2) x n
//
// n = normal from the first to the second, w = spin, l = lever arm, the distance from a centre to the
// contact. The lever arms of two spheres have the ratio of their radii; that at a wall is the distance from
// the wall.
#pragma once

#include "contact/tangential/spring_slider.hpp"
#include "dem/pair_laws.hpp"
#include "math/rows.hpp"

namespace rattlebox::dem {

// Relative motion of two partners at their contact. `normal` points from the first to the second.
template <class T> struct ContactKinematics {
    Vector<T> normal;
    T overlap;
    Vector<T> velocity;     // of the centre of the first relative to that of the second
    Vector<T> surface_spin; // sum of spin times lever arm
    Vector<T> spin;         // of the first relative to the second
    T lever;                // lever arm over radius, the same for both
    T radius;               // of the first
};

template <class T> struct Sphere {
    Vector<T> position, velocity, spin;
    T radius;
};

// Two spheres relative to each other.
template <class T> struct RelativeMotion {
    Vector<T> branch;         // branch vector, from the first centre to the second
    Vector<T> velocity, spin; // of the first relative to the second
    Vector<T> surface_spin;   // sum of spin times radius
    T radius_sum, radius;     // sum of the radii, and the smaller radius
};

template <bool spins, class T>
RATTLEBOX_INLINE ContactKinematics<T> contact_kinematics(const RelativeMotion<T>& f) {
    const T distance = root(dot(f.branch, f.branch));
    const T per_both = all(distance, 1) / (distance * f.radius_sum); // one division instead of two
    ContactKinematics<T> m;
    m.normal = (f.radius_sum * per_both) * f.branch;
    m.overlap = overlap(f.radius_sum, distance);
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
RATTLEBOX_INLINE ContactKinematics<T> contact_kinematics(const Sphere<T>& a, const Vector<T>& normal,
                                                         const T& distance, const Vector<T>& velocity) {
    ContactKinematics<T> m;
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

template <class T> struct Vector4 {
    T x, y, z, w;
    RATTLEBOX_INLINE Vector<T> vector() const { return {x, y, z}; }
};

// ---- normal

// Normal force without branches. A law with hysteresis follows the unloading curve below the deepest overlap.
template <class Law, class T>
RATTLEBOX_INLINE NormalForce<T> normal_force(const Law& law, const Coefficients<T>& k, const Depth<T>& d,
                                             const T& rate, const History<T>& h) {
    if constexpr (Law::hysteretic) {
        const T loading =
            choose(d.overlap - law.yield_overlap(k), law.yielding_force(k, d), law.elastic_force(k, d));
        const T above = larger(d.overlap - h.origin, all(rate, 0));
        const T unloading = law.unloading_force(h, depth_from_overlap(above));
        const T force = choose(h.deepest - d.overlap, unloading, loading);
        return {force, force};
    } else {
        return law.force(k, d, rate);
    }
}

// Energy that the contact returns when it opens. The history must be up to date.
template <class Law, class T>
RATTLEBOX_INLINE T stored_energy(const Law& law, const Coefficients<T>& k, const Depth<T>& d,
                                 const History<T>& h) {
    if constexpr (Law::hysteretic)
        return law.recovered(h, depth_from_overlap(larger(d.overlap - h.origin, all(d.overlap, 0))));
    else
        return law.stored(k, d);
}

// ---- tangential and rolling

// Stiffness and dashpot of the tangential law with this index in the table of laws.
template <class T> RATTLEBOX_INLINE T tangential_stiffness(int law, const T& coefficient, const Depth<T>& d) {
    T k = coefficient;
    TangentialLaw::each([&]<class Law>(int position) __attribute__((always_inline)) {
        if (law == position) k = Law::stiffness(coefficient, d);
    });
    return k;
}
template <class T> RATTLEBOX_INLINE T tangential_dashpot(int law, const T& coefficient, const Depth<T>& d) {
    T c = coefficient;
    TangentialLaw::each([&]<class Law>(int position) __attribute__((always_inline)) {
        if (law == position) c = Law::dashpot(coefficient, d);
    });
    return c;
}

template <class T> RATTLEBOX_INLINE Vector<T> slip_velocity(const ContactKinematics<T>& m, const T& rate) {
    return m.velocity - rate * m.normal + cross(m.surface_spin, m.normal);
}
template <class T> RATTLEBOX_INLINE Vector<T> rolling_velocity(const ContactKinematics<T>& m) {
    return m.spin - dot(m.spin, m.normal) * m.normal;
}

template <class T> struct Tangential {
    Vector<T> force, couple; // on the first; the torque over its radius
    Vector4<T> spring;       // force half a step later, and compliance
    T stiffness;
    T loss, stored, excess;
};

// `spring` and `dashpot` are the coefficients of the contact, `history` the spring force half a step before.
template <class T, class Row>
RATTLEBOX_INLINE Tangential<T> tangential_force(const ContactKinematics<T>& m, const T& normal_force,
                                                const T& rate, const T& spring, const T& dashpot,
                                                const T& friction, const Depth<T>& depth, const Row& history,
                                                int law, const T& dt) {
    const T zero = all(rate, 0);
    const T pushing = larger(normal_force, zero), stiffness = tangential_stiffness(law, spring, depth);
    const Vector<T> slip = slip_velocity(m, rate);
    const auto s =
        advance_spring_slider(history.vector(), history.w, m.normal, stiffness,
                              tangential_dashpot(law, dashpot, depth), slip, friction * pushing, dt);
    return {s.force,
            m.lever * cross(m.normal, s.force),
            {s.next_spring.x, s.next_spring.y, s.next_spring.z, s.compliance},
            stiffness,
            s.loss,
            s.stored,
            s.excess};
}

template <class T> struct Rolling {
    Vector<T> torque;  // on the first
    Vector4<T> spring; // torque half a step later, and compliance
    T loss, stored, excess;
};

// `coefficients` holds mu_r R*, k_r / k_t and c_r; the torque acts on the first partner.
template <class T, class Row>
RATTLEBOX_INLINE Rolling<T> rolling_torque(const ContactKinematics<T>& m, const T& normal_force,
                                           const T& tangential_stiffness, const Row& coefficients,
                                           const Depth<T>& depth, const Row& history, int law, const T& dt) {
    const T zero = all(normal_force, 0), pushing = larger(normal_force, zero);
    const Vector<T> relative_spin = rolling_velocity(m);
    const auto s = advance_spring_slider(
        history.vector(), history.w, m.normal, coefficients.y * tangential_stiffness,
        tangential_dashpot(law, coefficients.z, depth), relative_spin, coefficients.x * pushing, dt);
    return {s.force,
            {s.next_spring.x, s.next_spring.y, s.next_spring.z, s.compliance},
            s.loss,
            s.stored,
            s.excess};
}

} // namespace rattlebox::dem
