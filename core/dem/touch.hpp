// The first touch of two bodies: the restitution of this impact, and the coefficients that hold until they
// part.
#pragma once

#include "base/status.hpp"
#include "dem/walls.hpp"

namespace rattlebox::dem {

struct Touch {
    const Encounter* encounter;
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

inline Touch touch(const Encounter& e, const Body& a, const Body& b) {
    const Row way = b.place - a.place;
    const real radius = 1 / (1 / a.place[3] + 1 / b.place[3]);
    const real mass = 1 / (a.velocity[3] + b.velocity[3]);
    const real distance = std::sqrt(dot(way, way)), lever = distance / (a.place[3] + b.place[3]);
    const Row normal = way * row(1, 1, 1) / distance, velocity = a.velocity - b.velocity;
    const Row swirl = (a.spin * a.place[3] + b.spin * b.place[3]) * lever;
    const real speed = dot(velocity, normal);
    return {&e,     radius,
            mass,   1 / (1 / moment_at_edge(a) + 1 / moment_at_edge(b)),
            speed,  overlap(a.place[3] + b.place[3], distance),
            normal, velocity * row(1, 1, 1) - normal * speed + cross(swirl, normal)};
}

// At a wall of a cavity that is displaced and moves; `mobility` is 1 / mass of the particle and of the wall.
inline Touch touch(const Encounter& e, const Body& a, const Near& near, Row cavity_velocity, real mobility) {
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

// A law for the pair at hand, from that of the reference pair.
inline NormalLaw scaled(const Encounter& e, const Touch& t) {
    NormalLaw law = e.normal;
    law.visit([&](auto own) {
        using Law = decltype(own);
        own.mass = t.mass;
        if constexpr (std::is_same_v<Law, LinearDashpot>) {
            if (e.by_time) own.stiffness *= t.mass / e.mass;
        } else {
            own.stiffness *= std::sqrt(t.radius / e.radius);
            if constexpr (std::is_same_v<Law, Thornton>) own.radius = t.radius;
        }
        law.set(own);
    });
    return law;
}

// Speeds of plastic laws go as sqrt(R*^3 / m*).
inline Rebound rebound(const Encounter& e, const Touch& t) {
    const bool plastic = e.restitution.get_if<JacksonGreenRestitution>() ||
                         e.restitution.get_if<ThorntonRestitution>() ||
                         e.restitution.get_if<JohnsonRestitution>();
    const real scale = plastic ? std::sqrt(t.mass / e.mass * cube(e.radius / t.radius)) : 1;
    return rattlebox::rebound(e.restitution, std::fmax(t.speed, 0.0) * scale);
}

// The damping ratio of all impacts, where there is one.
inline real constant_zeta(const Encounter& e) {
    return e.normal.visit([&](const auto& law) {
        const bool constant = e.restitution.get_if<ConstantRestitution>() && law.needs_restitution();
        return constant ? law.zeta(rattlebox::rebound(e.restitution, 0).e) : not_a_number;
    });
}

// What the sum over steps of t^(1/4) misses of its integral from 0 on, the first step being at theta, for
// steps of length 1: minus Hurwitz' zeta function of -1/4 and theta.
inline real missed_root(real theta) {
    const auto fourth_root = [](real t) { return std::sqrt(std::sqrt(t)); };
    const real end = theta + 2, last = fourth_root(end);
    return last * (0.8 * end - 0.5 + 1 / (48 * end)) - fourth_root(theta) - fourth_root(theta + 1);
}

// What the first step within a contact would miss: the touch lies between two steps, and forces grow from it
// like roots of the time since, which the trapezoidal rule does not see.
struct Late {
    real share = 0; // of the force of the first step, missed on top of it
    Row slip{};     // of the first along the second
};

// What a contact remembers while it lasts: a line of memory.
struct alignas(64) Kept {
    Row friction; // force of the tangential spring on the first, and 1 / stiffness
    Row law;      // A, c, B, c_t: see contact_step.hpp
};

struct alignas(64) KeptRolling {
    Row spring; // torque of the rolling spring on the first, and 1 / stiffness
    Row law;    // mu_r R*, k_r / k_t, c_r
};

// What it does in a step.
struct alignas(64) Action {
    Row force;  // on the first, and 1 to be counted
    Row couple; // torque on the first over its radius; of a pair also that on the second over its own
};

// What it knows from its first touch on.
struct Begun {
    Kept kept{};
    KeptRolling rolling{};
    Row dent{};
    Late late;
    real lost = 0; // in the dashpot, on top of what the first step counts
    bool extrapolated = false;
    Status status = Status::finished;
};

inline Begun begin(const Touch& t, real dt) {
    const Encounter& e = *t.encounter;
    Rebound r = rebound(e, t);
    Begun b;
    b.extrapolated = r.extrapolated;
    if (r.outside)
        b.status = Status::law_domain;
    else if (!possible(e.normal, r))
        b.status = Status::no_rebound, r.e = 1; // any number will do: the run ends here
    // Since the touch, at this speed; of what overlaps from the start nothing is known.
    const bool comes_late = t.speed > 0 && t.overlap < 1.01 * t.speed * dt;
    const real since = comes_late ? t.overlap / t.speed : 0.5 * dt;
    scaled(e, t).visit([&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        // Without friction any stiffness will do.
        const real linear = e.tangential_stiffness + e.tangential_ratio * law.stiffness;
        const real own = e.shear > 0 ? e.shear * std::sqrt(t.radius) : linear;
        const real tangential = own > 0 ? own : 1;
        if constexpr (std::is_same_v<Law, Thornton>) {
            b.kept.law = row(law.stiffness, law.plastic_slope(), tangential, law.yield_overlap());
            b.dent = row(0, law.stiffness, 0, 0);
        } else {
            const Memory now = law.damped(std::isnan(e.constant_zeta) ? law.zeta(r.e) : e.constant_zeta);
            constexpr bool hertz = std::is_same_v<Law, HertzTsuji>;
            const real x = std::sqrt(std::sqrt(t.overlap)), theta = since / dt;
            const real force = law.force(now, x, t.speed), dashpot = force - law.force({}, x, 0);
            if (comes_late && dashpot > 0) {
                const real lost =
                    dashpot * (hertz ? missed_root(theta) / std::sqrt(std::sqrt(theta)) : theta - 0.5);
                b.late = {lost / force, t.slip};
                // The velocity of this step is already less than the one that the forces are computed from.
                const real slowed = 0.5 * (force + lost) * dt / t.mass;
                b.lost = (lost * (t.speed - slowed) - dashpot * slowed) * dt;
            }
            const real share = hertz ? std::sqrt(5.0 / 6.0) : 1;
            const real drag = 2 * e.tangential_damping * share * now.zeta * std::sqrt(t.mass * tangential);
            b.kept.law = row(law.stiffness, now.damping, tangential, drag);
        }
        const real roll = e.rolling_stiffness > 0 ? e.rolling_stiffness * square(t.radius) : 1;
        b.rolling = {Row{}, // nothing stretched yet
                     row(e.rolling * t.radius, roll,
                         2 * e.rolling_damping * std::sqrt(t.inertia * roll * tangential))};
    });
    // The spring as if it had been stretched since half a step ago, which makes it stretched since the touch.
    const real stiffness = b.kept.law[2] * (e.shear > 0 ? std::sqrt(t.overlap) : 1);
    b.kept.friction = t.slip * (-stiffness * (since - 0.5 * dt));
    b.kept.friction[3] = 1 / stiffness;
    return b;
}

// Energy that a spring of these rows holds.
inline real held(Row spring) { return 0.5 * dot(spring, spring) * spring[3]; }

// The curve that unloads from the deepest overlap so far; returns the energy that reaching it has cost.
inline real settle(Row& dent, const Touch& t) {
    real cost = 0;
    scaled(*t.encounter, t).visit([&](const auto& law) {
        if constexpr (std::is_same_v<std::decay_t<decltype(law)>, Thornton>) {
            if (dent[0] > law.yield_overlap()) {
                Memory now, before;
                now.phase = before.phase = Thornton::unloading;
                now.deepest = dent[0], before.deepest = dent[3];
                cost = law.plastic(now, 0) - law.plastic(before, 0);
                law.unloading_curve(dent[0], dent[1], dent[2]);
            }
        }
    });
    dent[3] = dent[0];
    return cost;
}

} // namespace rattlebox::dem
