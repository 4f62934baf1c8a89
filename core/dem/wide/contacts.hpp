// What the contacts of one particle do in a step: begin, push and rub, end.
#pragma once

#include "dem/contact_step.hpp"
#include "dem/touch.hpp"
#include "dem/wide/world.hpp"

namespace rattlebox::dem::wide {

inline Vector<real> vector(Row r) { return {r[0], r[1], r[2]}; }
inline Row row(const Vector<real>& v, real w = 0) { return rattlebox::row(v.x, v.y, v.z, w); }
inline Row row(const Four<real>& f) { return rattlebox::row(f.x, f.y, f.z, f.w); }

// The contacts that particle i owns; only its own slots and its own account change.
template <bool sampled> class OwnContacts {
    const World& world_;
    Bed& bed_;
    const int i_;
    Account& account_;
    Row place_;

    int slot(int k) const { return k * bed_.particles + i_; }
    static Partner with(int partner) { return partner < 0 ? wall : particle; }
    Kind kind(int partner) const { return known(partner < 0 ? bed_.at_wall : bed_.pair); }
    Body body(int i) const { return {bed_.position[i], bed_.velocity[i], bed_.spin[i]}; }
    Near near(int w) const { return nearest(bed_.wall[w], place_ - bed_.motion.displacement); }

    const Encounter& encounter(int partner) const {
        const int own = bed_.kind[i_];
        return world_
            .encounter[partner < 0 ? bed_.wall_entry[own * bed_.wall_kinds + bed_.wall[-1 - partner].kind]
                                   : bed_.particle_entry[own * bed_.kinds + bed_.kind[partner]]];
    }

    Touch touch(int partner) const {
        if (partner >= 0) return dem::touch(encounter(partner), body(i_), body(partner));
        const Near at = near(-1 - partner);
        real mobility = bed_.velocity[i_][3];
        for (int m = 0; m < world_.structure.modes; ++m) mobility += square(dot(bed_.shape[m], at.normal));
        return dem::touch(encounter(partner), body(i_), at, bed_.motion.velocity, mobility);
    }

    // Positive where they touch.
    real room(int partner, int& outside) const {
        if (partner < 0) {
            const real distance = near(-1 - partner).distance;
            if (distance < 0) outside = -1 - partner;
            return place_[3] - distance;
        }
        const Row other = bed_.position[partner], apart = place_ - other;
        return square(place_[3] + other[3]) - dot(apart, apart);
    }

    template <class Team> RATTLEBOX_COLD void stop(Team& team, Status status, int wall, real speed) {
        if (account_.status != Status::finished) return;
        account_.status = status, account_.wall = wall, account_.speed = speed;
        team.least(bed_.stopped, bed_.name[i_]);
    }

    template <class Team> RATTLEBOX_COLD Late begin(Team& team, int s, int partner) {
        const Touch t = touch(partner);
        const Begun b = dem::begin(t, world_.structure.dt);
        bed_.kept[s] = b.kept;
        if (kind(partner).rolls) bed_.rolling[s] = b.rolling;
        if (kind(partner).normal == Kind::plastic) bed_.dent[s] = b.dent;
        account_.sum.lost.normal[with(partner)] += b.lost;
        ++account_.touches[with(partner)];
        account_.extrapolated += b.extrapolated;
        account_.fastest = larger(account_.fastest, t.speed);
        if (b.outside) stop(team, Status::law_domain, -1, t.speed);
        return b.late;
    }

    RATTLEBOX_COLD void settle(int s, int partner) {
        account_.sum.lost.plastic[with(partner)] += dem::settle(bed_.dent[s], touch(partner));
    }

    RATTLEBOX_COLD void end(int s, int partner) {
        const Kind k = kind(partner);
        Losses& lost = account_.sum.lost;
        if (k.normal == Kind::plastic && bed_.dent[s][3] != bed_.dent[s][0]) settle(s, partner);
        if (k.rough) lost.sliding[with(partner)] += held(bed_.kept[s].friction);
        if (k.rolls) lost.rolling[with(partner)] += held(bed_.rolling[s].spring);
    }

    template <bool spins> Meeting<real> meeting(int partner) const {
        const auto ball = [&](int i) -> Ball<real> {
            const Row x = bed_.position[i];
            return {vector(x), vector(bed_.velocity[i]), spins ? vector(bed_.spin[i]) : Vector<real>{}, x[3]};
        };
        if (partner >= 0) return meet<spins>(facing(ball(i_), ball(partner)));
        const Near at = near(-1 - partner);
        return meet<spins>(ball(i_), vector(at.normal), at.distance, vector(bed_.motion.velocity));
    }

    template <class Law> void collide(int s, int partner, const Late& late) {
        const Kind k = kind(partner);
        const Partner p = with(partner);
        const real dt = world_.structure.dt;
        SampleSum& sum = account_.sum;
        const auto m = k.rough ? meeting<true>(partner) : meeting<false>(partner);
        Four<real> dent{};
        if constexpr (Law::plastic) {
            Row& d = bed_.dent[s];
            if (sampled) d[0] = larger(d[0], m.overlap);
            if (d[3] != d[0] && (m.overlap < d[0] || sampled)) settle(s, partner);
            dent = four(d);
        }
        const Four<real> law = four(bed_.kept[s].law);
        const real rate = dot(m.velocity, m.normal);
        auto push = Law::push(law, dent, m.overlap, rate);
        if (k.how.never_pulls) push.force = larger(push.force, 0.0);
        sum.lost.normal[p] += dt * (push.force - push.elastic) * rate;
        account_.deepest = larger(account_.deepest, m.overlap / m.radius);
        Vector<real> force = (-push.force) * m.normal;
        if (sampled) sum.stored += Law::stored(law, dent, m.overlap), sum.contacts[p] += 1;
        if constexpr (Law::plastic) bed_.dent[s][0] = larger(dent.x, m.overlap);
        if (k.rough) {
            const real mu = encounter(partner).friction;
            const auto h =
                rub(m, push, rate, law, mu, four(bed_.kept[s].friction), !Law::plastic, k.how.mindlin, dt);
            bed_.kept[s].friction = row(h.friction);
            sum.lost.sliding[p] += h.lost;
            force = force + h.force;
            bed_.action[s].couple = row((1 + late.share) * h.couple);
            if (sampled) sum.stored += h.stored;
            if (k.rolls) {
                KeptRolling& rolling = bed_.rolling[s];
                const auto r =
                    roll(m, push, h.stiffness, four(rolling.law), four(rolling.spring), k.how.mindlin, dt);
                rolling.spring = row(r.rolling);
                bed_.torque[s] = row(r.torque);
                sum.lost.rolling[p] += r.lost;
                if (sampled) sum.stored += r.stored;
            }
            sum.lost.sliding[p] -= late.share * dt * dot(row(force), late.slip);
        }
        const Row whole = row(force) * rattlebox::row(1 + late.share);
        bed_.action[s].force = whole;
        if (sampled && partner < 0) {
            const Near at = near(-1 - partner);
            Row twist = cross(place_ - bed_.motion.displacement + at.normal * at.distance, whole);
            if (k.rolls) twist += bed_.torque[s];
            for (int a = 0; a < 3; ++a) sum.twist[a] -= twist[a];
        }
    }

public:
    OwnContacts(const World& world, Bed& bed, int i)
        : world_(world), bed_(bed), i_(i), account_(bed.account[i]), place_(bed.position[i]) {}

    template <class Team> void step(Team& team) {
        if constexpr (sampled) {
            SampleSum fresh;
            fresh.lost = account_.sum.lost;
            account_.sum = fresh;
        }
        const unsigned before = bed_.touching[i_];
        unsigned now = 0;
        int outside = -1;
        for (int k = 0; k < bed_.used[i_]; ++k) {
            const int partner = bed_.partner[slot(k)];
            if (partner != nobody && room(partner, outside) > 0) now |= 1u << k;
        }
        if (outside >= 0) stop(team, Status::escaped, outside, 0);
        for (unsigned rest = before | now; rest != 0; rest &= rest - 1) {
            const int k = lowest_bit(rest), s = slot(k), partner = bed_.partner[s];
            if (!(now >> k & 1u)) {
                end(s, partner);
                continue;
            }
            const Late late = before >> k & 1u ? Late{} : begin(team, s, partner);
            const Kind::Normal normal = kind(partner).normal;
            if (normal == Kind::hertz)
                collide<HertzStep>(s, partner, late);
            else if (normal == Kind::linear)
                collide<LinearStep>(s, partner, late);
            else
                collide<PlasticStep>(s, partner, late);
        }
        if (now != before) bed_.touching[i_] = now;
    }
};

} // namespace rattlebox::dem::wide
