// The beginning of a contact: the restitution of the impact, and the coefficients that hold until the contact
// ends.
#pragma once

#include "dem/walls.hpp"
#include "util/status.hpp"

namespace rattlebox::dem {

struct NewContact {
    const PairLaw* law;
    real radius, mass; // R*, m*
    real inertia;      // for rolling: both moments of inertia about the contact point, in series
    real speed;        // approach speed
    real overlap;      // at the first step in contact
    Row normal, slip;  // from the first to the second; sliding velocity of the first on the second
};

// Position and radius, velocity and 1 / mass, spin and radius / inertia.
struct Body {
    Row position, velocity, spin;
};

inline real moment_at_edge(const Body& b) {
    return b.position[3] / b.spin[3] + square(b.position[3]) / b.velocity[3];
}

inline NewContact new_contact(const PairLaw& e, const Body& a, const Body& b) {
    const Row branch = b.position - a.position;
    const real radius = 1 / (1 / a.position[3] + 1 / b.position[3]);
    const real mass = 1 / (a.velocity[3] + b.velocity[3]);
    const real distance = std::sqrt(dot(branch, branch)), lever = distance / (a.position[3] + b.position[3]);
    const Row normal = branch * row(1, 1, 1) / distance, velocity = a.velocity - b.velocity;
    const Row surface_spin = (a.spin * a.position[3] + b.spin * b.position[3]) * lever;
    const real speed = dot(velocity, normal);
    return {&e,     radius,
            mass,   1 / (1 / moment_at_edge(a) + 1 / moment_at_edge(b)),
            speed,  overlap(a.position[3] + b.position[3], distance),
            normal, velocity * row(1, 1, 1) - normal * speed + cross(surface_spin, normal)};
}

// At a wall; `mobility` is the sum of 1 / mass of the particle and of the wall.
inline NewContact new_contact(const PairLaw& e, const Body& a, const WallPoint& near, Row cavity_velocity,
                              real mobility) {
    const Row velocity = a.velocity - cavity_velocity;
    const real speed = dot(velocity, near.normal);
    return {&e,
            a.position[3],
            1 / mobility,
            moment_at_edge(a),
            speed,
            overlap(a.position[3], near.distance),
            near.normal,
            velocity * row(1, 1, 1) - near.normal * speed + cross(a.spin * near.distance, near.normal)};
}

// The speed at which materials yield is proportional to sqrt(R*^3 / m*).
inline Rebound rebound(const PairLaw& e, const NewContact& t) {
    const bool scales = e.restitution.visit([](const auto& law) { return law.speed_scales_with_size; });
    const real scale = scales ? std::sqrt(t.mass / e.size.mass * cube(e.size.radius / t.radius)) : 1;
    return rattlebox::rebound(e.restitution, std::fmax(t.speed, 0.0) * scale);
}

// Returns the damping that all impacts have in common, or NaN if it depends on the impact.
inline real constant_damping(const PairLaw& e) {
    return e.normal.visit([&](const auto& law) {
        if constexpr (std::decay_t<decltype(law)>::hysteretic)
            return not_a_number;
        else {
            const bool constant = e.restitution.get_if<ConstantRestitution>() && law.needs_restitution();
            return constant ? law.damping(rattlebox::rebound(e.restitution, 0).e) : not_a_number;
        }
    });
}

// Returns the integral of t^p from 0 less its sum over steps of length 1, of which the first is at theta.
// This is minus the Hurwitz zeta function of -p and theta, by the Euler-Maclaurin formula (NIST Digital
// Library of Mathematical Functions, 2.10(i) and 25.11).
inline real quadrature_deficit(real p, real theta) {
    const real end = theta + 2;
    return std::pow(end, p) * (end / (p + 1) - 0.5 + p / (12 * end)) - std::pow(theta, p) -
           std::pow(theta + 1, p);
}

// Correction of the first step in a contact. The contact begins between two steps, and the force of the
// dashpot grows from there like a power of time, which the trapezoidal rule underestimates.
struct FirstStepShare {
    real share = 0; // of the force of the first step, to be added to it
    Row slip{};     // sliding velocity of the first on the second
};

// History variables of a contact; one cache line.
struct alignas(64) ContactState {
    Row friction; // force of the tangential spring on the first, and 1 / stiffness
    Row law;      // coefficients of the normal law (two), of the tangential spring and of its dashpot
};

struct alignas(64) RollingState {
    Row spring; // torque of the rolling spring on the first, and 1 / stiffness
    Row law;    // mu_r R*, k_r / k_t, c_r
};

// Force of a contact in one step; one cache line.
struct alignas(64) ContactForce {
    Row force;  // on the first partner, and 1, so that sums count contacts
    Row couple; // torque on each partner over its radius, the same for both; and the share of a first step
};

// The state of a contact at its first step.
struct ContactStart {
    ContactState state{};
    RollingState rolling{};
    Row yield_history{};
    FirstStepShare first_step;
    real lost = 0; // in the dashpot, in addition to the loss of the first step
    bool extrapolated = false;
    Status status = Status::finished;
};

// A contact without friction or rolling resistance, in a list of contacts that have them, gets a spring so
// soft that the energy in it is zero: the law would otherwise lose the energy of half a step of sliding.
inline constexpr real vanishing_stiffness = 1e-200;

inline ContactStart begin(const NewContact& t, real dt) {
    const PairLaw& e = *t.law;
    // The restitution that the law asks for at this speed decides on the damping. Beyond the range of the law
    // the run stops, with a status that names the contact.
    Rebound r = rebound(e, t);
    ContactStart b;
    b.extrapolated = r.extrapolated;
    if (r.outside)
        b.status = Status::law_domain;
    else if (!possible(e.normal, r))
        b.status = Status::no_rebound, r.e = 1; // any value, because the run stops here
    // Time since first touch, at constant speed. It is unknown for particles that overlap at the start of the
    // run.
    const bool begins_between_steps = t.speed > 0 && t.overlap < 1.01 * t.speed * dt;
    const real since = begins_between_steps ? t.overlap / t.speed : 0.5 * dt;
    const PairSize size{t.radius, t.mass};
    const Depth<real> depth = depth_from_overlap(t.overlap);
    real tangential = 0;
    e.normal.visit([&](const auto& reference) {
        using Law = std::decay_t<decltype(reference)>;
        // Laws are stored for one pair of the species; radii and masses of this pair scale them.
        const Law law = reference.resized(e.size, size);
        tangential =
            e.tangential.visit([&](const auto& own) { return own.coefficient(size, law.stiffness); });
        if (!(tangential > 0 && e.friction() > 0)) tangential = vanishing_stiffness;
        if constexpr (Law::hysteretic) {
            const Coefficients<real> k = law.coefficients(0, t.speed);
            const History<real> h = law.untouched();
            b.state.law = row(k.stiffness, k.second, tangential, 0);
            b.yield_history = row(h.deepest, h.stiffness, h.origin, h.deepest);
        } else {
            // The damping of a constant restitution is the same in all impacts, and its root has been found
            // once for the pair.
            const real damping = std::isnan(e.constant_damping) ? law.damping(r.e) : e.constant_damping;
            const Coefficients<real> k = law.coefficients(damping, std::fmax(t.speed, 0.0));
            const NormalForce<real> force = law.force(k, depth, t.speed);
            const real dashpot = force.total - force.elastic;
            if (begins_between_steps && dashpot > 0) {
                const real p = law.dashpot_exponent(), theta = since / dt;
                const real lost = dashpot * quadrature_deficit(p, theta) / std::pow(theta, p);
                b.first_step = {lost / force.total, t.slip};
                // The corrected velocity of this step is smaller than the predicted one that the forces are
                // computed from.
                const real slowed = 0.5 * (force.total + lost) * dt / t.mass;
                b.lost = (lost * (t.speed - slowed) - dashpot * slowed) * dt;
            }
            const real share = e.tangential.visit([](const auto& own) { return own.damping; });
            const real tangential_dashpot = 2 * share * law.tangential_share *
                                            law.damping_ratio(damping, std::fmax(t.speed, 0.0)) *
                                            std::sqrt(t.mass * tangential);
            b.state.law = row(k.stiffness, k.second, tangential, tangential_dashpot);
        }
    });
    b.rolling = {Row{}, e.rolling.coefficients(size, t.inertia, tangential)}; // unloaded
    if (!(e.rolling.coefficient > 0))
        b.rolling.law[1] = vanishing_stiffness / tangential, b.rolling.law[2] = 0;
    // The spring holds its force half a step before; the time since first touch is `since`.
    const real stiffness =
        e.tangential.visit([&](const auto& own) { return own.stiffness(tangential, depth); });
    b.state.friction = t.slip * (-stiffness * (since - 0.5 * dt));
    b.state.friction[3] = 1 / stiffness;
    return b;
}

// Updates the unloading curve to the deepest overlap so far; returns the plastic loss since the last update.
inline real update_unloading_curve(Row& yield_history, const NewContact& t) {
    const PairLaw& e = *t.law;
    real cost = 0;
    e.normal.visit([&](const auto& reference) {
        if constexpr (std::decay_t<decltype(reference)>::hysteretic) {
            const auto law = reference.resized(e.size, {t.radius, t.mass});
            cost = law.plastic_loss(yield_history[0]) - law.plastic_loss(yield_history[3]);
            const History<real> h = law.unloaded_from(yield_history[0]);
            yield_history[1] = h.stiffness, yield_history[2] = h.origin;
        }
    });
    yield_history[3] = yield_history[0];
    return cost;
}

} // namespace rattlebox::dem
