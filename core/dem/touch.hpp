// The first touch of two bodies: the restitution of this impact, and the coefficients that hold until they
// part.
#pragma once

#include "base/status.hpp"
#include "dem/bed.hpp"
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

inline Lanes first_lane(real v) {
    alignas(64) real x[lane_count] = {v};
    return lanes(x);
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

// Writes what the contact in slot k remembers. False when the speed is beyond the restitution law.
inline bool begin(Contacts& list, int k, const Touch& t, real dt, Late& late, Tally& tally, Partner partner) {
    const Encounter& e = *t.encounter;
    Kept& kept = at(list.kept, k);
    const Rebound r = rebound(e, t);
    // Since the touch, at this speed; of what overlaps from the start nothing is known.
    const bool comes_late = t.speed > 0 && t.overlap < 1.01 * t.speed * dt;
    const real since = comes_late ? t.overlap / t.speed : 0.5 * dt;
    ++tally.first_touches[partner];
    tally.extrapolated += r.extrapolated;
    tally.fastest = std::fmax(tally.fastest, t.speed);
    scaled(e, t).visit([&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        // Without friction any stiffness will do.
        const real own = e.shear > 0 ? e.shear * std::sqrt(t.radius) : e.tangential_stiffness;
        const real tangential = own > 0 ? own : 1;
        if constexpr (std::is_same_v<Law, Thornton>) {
            kept.law = row(law.stiffness, law.plastic_slope(), tangential, law.yield_overlap());
            at(list.dent, k) = row(0, law.stiffness, 0, 0);
        } else {
            const Memory now = law.damped(std::isnan(e.constant_zeta) ? law.zeta(r.e) : e.constant_zeta);
            constexpr bool hertz = std::is_same_v<Law, HertzTsuji>;
            const real x = std::sqrt(std::sqrt(t.overlap)), theta = since / dt;
            const real force = law.force(now, x, t.speed), dashpot = force - law.force({}, x, 0);
            if (comes_late && dashpot > 0) {
                const real lost =
                    dashpot * (hertz ? missed_root(theta) / std::sqrt(std::sqrt(theta)) : theta - 0.5);
                late.share = lost / force;
                late.slip = t.slip;
                // The velocity of this step is already less than the one that the forces are computed from.
                const real slowed = 0.5 * (force + lost) * dt / t.mass;
                tally.normal[partner] += first_lane((lost * (t.speed - slowed) - dashpot * slowed) * dt);
            }
            const real share = hertz ? std::sqrt(5.0 / 6.0) : 1;
            const real drag = 2 * e.tangential_damping * share * now.zeta * std::sqrt(t.mass * tangential);
            kept.law = row(law.stiffness, now.damping, tangential, drag);
        }
        const real roll = e.rolling_stiffness > 0 ? e.rolling_stiffness * square(t.radius) : 1;
        if (list.rolls)
            at(list.rolling, k) =
                KeptRolling{Row{}, row(0, 0, 0, 1e290),
                            row(e.rolling * t.radius, roll,
                                2 * e.rolling_damping * std::sqrt(t.inertia * roll * tangential))};
    });
    kept.couple = row(0, 0, 0, e.friction);
    // The spring as if it had been stretched since half a step ago, which makes it stretched since the touch.
    const real stiffness = kept.law[2] * (e.shear > 0 ? std::sqrt(t.overlap) : 1);
    kept.friction = t.slip * (-stiffness * (since - 0.5 * dt));
    kept.friction[3] = stiffness;
    return !r.outside;
}

} // namespace rattlebox::dem
