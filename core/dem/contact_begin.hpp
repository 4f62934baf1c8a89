// The begin of a contact: the restitution of this impact, and the coefficients that hold until it ends.
#pragma once

#include "dem/walls.hpp"
#include "util/status.hpp"

namespace rattlebox::dem {

struct Touch {
    const PairLaw* law;
    real radius, mass; // R*, m*
    real inertia;      // of rolling: both moments about the contact point in series
    real speed;        // approach
    real overlap;      // at the first step within
    Row normal, slip;  // towards the second; velocity of the first along the second
};

// A body, in rows: place and radius, velocity and 1 / mass, spin and radius / inertia.
struct Body {
    Row place, velocity, spin;
};

inline real moment_at_edge(const Body& b) {
    return b.place[3] / b.spin[3] + square(b.place[3]) / b.velocity[3];
}

inline Touch new_contact(const PairLaw& e, const Body& a, const Body& b) {
    const Row way = b.place - a.place;
    const real radius = 1 / (1 / a.place[3] + 1 / b.place[3]);
    const real mass = 1 / (a.velocity[3] + b.velocity[3]);
    const real distance = std::sqrt(dot(way, way)), lever = distance / (a.place[3] + b.place[3]);
    const Row normal = way * row(1, 1, 1) / distance, velocity = a.velocity - b.velocity;
    const Row surface_spin = (a.spin * a.place[3] + b.spin * b.place[3]) * lever;
    const real speed = dot(velocity, normal);
    return {&e,     radius,
            mass,   1 / (1 / moment_at_edge(a) + 1 / moment_at_edge(b)),
            speed,  overlap(a.place[3] + b.place[3], distance),
            normal, velocity * row(1, 1, 1) - normal * speed + cross(surface_spin, normal)};
}

// At a wall of a cavity that is displaced and moves; `mobility` is 1 / mass of the particle and of the wall.
inline Touch new_contact(const PairLaw& e, const Body& a, const WallPoint& near, Row cavity_velocity,
                         real mobility) {
    const Row velocity = a.velocity - cavity_velocity;
    const real speed = dot(velocity, near.normal);
    return {&e,
            a.place[3],
            1 / mobility,
            moment_at_edge(a),
            speed,
            overlap(a.place[3], near.distance),
            near.normal,
            velocity * row(1, 1, 1) - near.normal * speed + cross(a.spin * near.distance, near.normal)};
}

// The speeds at which materials yield go as sqrt(R*^3 / m*).
inline Rebound rebound(const PairLaw& e, const Touch& t) {
    const bool scales = e.restitution.visit([](const auto& law) { return law.speed_scales_with_size; });
    const real scale = scales ? std::sqrt(t.mass / e.size.mass * cube(e.size.radius / t.radius)) : 1;
    return rattlebox::rebound(e.restitution, std::fmax(t.speed, 0.0) * scale);
}

// The damping of all impacts, where restitution is constant.
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

// What the sum over steps of t^p misses of its integral from 0 on, the first step being at theta, for steps
// of length 1: minus Hurwitz' zeta function of -p and theta.
inline real missed_power(real p, real theta) {
    const real end = theta + 2;
    return std::pow(end, p) * (end / (p + 1) - 0.5 + p / (12 * end)) - std::pow(theta, p) -
           std::pow(theta + 1, p);
}

// What the first step within a contact would miss: the touch lies between two steps, and forces grow from it
// like powers of the time since, which the trapezoidal rule does not see.
struct FirstStepShare {
    real share = 0; // of the force of the first step, missed on top of it
    Row slip{};     // of the first along the second
};

// What a contact remembers while it lasts: a line of memory.
struct alignas(64) ContactState {
    Row friction; // force of the tangential spring on the first, and 1 / stiffness
    Row law;      // Coefficients of the normal law; of the tangential spring, and of its dashpot
};

struct alignas(64) RollingState {
    Row spring; // torque of the rolling spring on the first, and 1 / stiffness
    Row law;    // mu_r R*, k_r / k_t, c_r
};

// What it does in a step.
struct alignas(64) ContactForce {
    Row force;  // on the first, and 1 to be counted
    Row couple; // torque on the first over its radius; of a pair also that on the second over its own
};

// What it knows from its first touch on.
struct ContactStart {
    ContactState state{};
    RollingState rolling{};
    Row yield_history{};
    FirstStepShare first_step;
    real lost = 0; // in the dashpot, on top of what the first step counts
    bool extrapolated = false;
    Status status = Status::finished;
};

inline ContactStart begin(const Touch& t, real dt) {
    const PairLaw& e = *t.law;
    Rebound r = rebound(e, t);
    ContactStart b;
    b.extrapolated = r.extrapolated;
    if (r.outside)
        b.status = Status::law_domain;
    else if (!possible(e.normal, r))
        b.status = Status::no_rebound, r.e = 1; // any number will do: the run ends here
    // Since the touch, at this speed; of what overlaps from the start nothing is known.
    const bool begins_between_steps = t.speed > 0 && t.overlap < 1.01 * t.speed * dt;
    const real since = begins_between_steps ? t.overlap / t.speed : 0.5 * dt;
    const PairSize size{t.radius, t.mass};
    const Depth<real> depth = depth_from_overlap(t.overlap);
    real tangential = 0;
    e.normal.visit([&](const auto& reference) {
        using Law = std::decay_t<decltype(reference)>;
        const Law law = reference.resized(e.size, size);
        tangential =
            e.tangential.visit([&](const auto& own) { return own.coefficient(size, law.stiffness); });
        if (!(tangential > 0)) tangential = 1; // without friction any stiffness will do
        if constexpr (Law::hysteretic) {
            const Coefficients<real> k = law.coefficients(0, t.speed);
            const History<real> h = law.untouched();
            b.state.law = row(k.stiffness, k.second, tangential, 0);
            b.yield_history = row(h.deepest, h.stiffness, h.origin, h.deepest);
        } else {
            const real damping = std::isnan(e.constant_damping) ? law.damping(r.e) : e.constant_damping;
            const Coefficients<real> k = law.coefficients(damping, std::fmax(t.speed, 0.0));
            const NormalForce<real> force = law.force(k, depth, t.speed);
            const real dashpot = force.total - force.elastic;
            if (begins_between_steps && dashpot > 0) {
                const real p = law.dashpot_exponent(), theta = since / dt;
                const real lost = dashpot * missed_power(p, theta) / std::pow(theta, p);
                b.first_step = {lost / force.total, t.slip};
                // The velocity of this step is already less than the one that the forces are computed from.
                const real slowed = 0.5 * (force.total + lost) * dt / t.mass;
                b.lost = (lost * (t.speed - slowed) - dashpot * slowed) * dt;
            }
            const real share = e.tangential.visit([](const auto& own) { return own.damping; });
            const real drag = 2 * share * Law::tangential_share *
                              law.damping_ratio(damping, std::fmax(t.speed, 0.0)) *
                              std::sqrt(t.mass * tangential);
            b.state.law = row(k.stiffness, k.second, tangential, drag);
        }
    });
    b.rolling = {Row{}, e.rolling.coefficients(size, t.inertia, tangential)}; // nothing stretched yet
    // The spring as if it had been stretched since half a step ago, which makes it stretched since the touch.
    const real stiffness =
        e.tangential.visit([&](const auto& own) { return own.stiffness(tangential, depth); });
    b.state.friction = t.slip * (-stiffness * (since - 0.5 * dt));
    b.state.friction[3] = 1 / stiffness;
    return b;
}

// The curve that unloads from the deepest overlap so far; returns the energy that reaching it has cost.
inline real update_unloading_curve(Row& yield_history, const Touch& t) {
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
