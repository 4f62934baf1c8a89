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
    real inertia = 0;  // of rolling: both moments about the contact point in series
    real speed;        // approach
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

// The damping ratio of all impacts, where there is one.
inline real constant_zeta(const Encounter& e) {
    return e.normal.visit([&](const auto& law) {
        const bool constant = e.restitution.get_if<ConstantRestitution>() && law.needs_restitution();
        return constant ? law.zeta(rattlebox::rebound(e.restitution, 0).e) : not_a_number;
    });
}

// Writes what contact k remembers. False when the speed is beyond the restitution law.
inline bool begin(ContactList& list, int k, const Touch& t, Tally& tally, Partner partner) {
    const Encounter& e = *t.encounter;
    const Rebound r = rebound(e, t);
    ++tally.first_touches[partner];
    tally.extrapolated += r.extrapolated;
    tally.fastest = std::fmax(tally.fastest, t.speed);
    scaled(e, t).visit([&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        // Without friction any stiffness will do.
        const real own = e.shear > 0 ? e.shear * std::sqrt(t.radius) : e.tangential_stiffness;
        const real tangential = own > 0 ? own : 1;
        if constexpr (std::is_same_v<Law, Thornton>) {
            at(list.law, k) = row(law.stiffness, law.plastic_slope(), tangential, law.yield_overlap());
            at(list.dent, k) = row(0, law.stiffness, 0, 0);
        } else {
            const Memory m = law.damped(std::isnan(e.constant_zeta) ? law.zeta(r.e) : e.constant_zeta);
            const real share = std::is_same_v<Law, HertzTsuji> ? std::sqrt(5.0 / 6.0) : 1;
            const real drag = 2 * e.tangential_damping * share * m.zeta * std::sqrt(t.mass * tangential);
            at(list.law, k) = row(law.stiffness, m.damping, tangential, drag);
        }
        const real roll = e.rolling_stiffness > 0 ? e.rolling_stiffness * square(t.radius) : 1;
        at(list.limit, k) = row(e.friction, e.rolling * t.radius, roll,
                                2 * e.rolling_damping * std::sqrt(t.inertia * roll * tangential));
    });
    at(list.friction, k) = row(0, 0, 0, 1e290);
    if (list.rolls) at(list.rolling, k) = row(0, 0, 0, 1e290);
    at(list.touching, k) = 1;
    return !r.outside;
}

} // namespace rattlebox::dem
