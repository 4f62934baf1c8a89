// What the contacts of one particle do in a step: begin, push and rub, end.
#pragma once

#include "dem/contact_step.hpp"
#include "dem/touch.hpp"
#include "dem/wide/world.hpp"

namespace rattlebox::dem::wide {

inline Vector<real> vector(Row r) { return {r[0], r[1], r[2]}; }
inline Row row(const Vector<real>& v, real w = 0) { return rattlebox::row(v.x, v.y, v.z, w); }
inline Row row(const Four<real>& f) { return rattlebox::row(f.x, f.y, f.z, f.w); }

inline Kind kind_of(const Bed& bed, int partner) { return known(partner < 0 ? bed.at_wall : bed.pair); }

// Are there losses beside those in normal direction and by sliding?
inline bool loses_more(const Bed& bed) {
    const Kind pair = known(bed.pair), at_wall = known(bed.at_wall);
    return pair.rolls || at_wall.rolls || pair.normal == Kind::plastic || at_wall.normal == Kind::plastic;
}

// Of own contacts of particle i, from the start.
inline LossSum losses(const Bed& bed, int i) {
    const Row lost = bed.lost[i], more = loses_more(bed) ? bed.lost_more[i] : Row{};
    return {{{lost[0], lost[1]}, {more[0], more[1]}, {lost[2], lost[3]}, {more[2], more[3]}}};
}

// A particle that owns contacts, and its partners: others or, below zero, walls.
struct Owner {
    const World* world;
    Bed* bed;
    int i;

    Body body(int p) const { return {bed->position[p], bed->velocity[p], bed->spin[p]}; }
    Near near(int w) const { return nearest(bed->wall[w], bed->position[i] - bed->motion.displacement); }
    Account& account() const { return bed->account[bed->name[i]]; }

    const Encounter& encounter(int partner) const {
        const bool many = bed->kinds > 1;
        const int own = many ? bed->kind[i] : 0;
        if (partner < 0)
            return world->encounter[bed->wall_entry[own * bed->wall_kinds + bed->wall[-1 - partner].kind]];
        return world->encounter[bed->particle_entry[many ? own * bed->kinds + bed->kind[partner] : 0]];
    }

    Touch touch(int partner) const {
        if (partner >= 0) return dem::touch(encounter(partner), body(i), body(partner));
        const Near at = near(-1 - partner);
        real mobility = bed->velocity[i][3];
        for (int m = 0; m < world->structure.modes; ++m) mobility += square(dot(bed->shape[m], at.normal));
        return dem::touch(encounter(partner), body(i), at, bed->motion.velocity, mobility);
    }
};

// ---- now and then: these take an owner by value, so that what the others work with stays in registers

template <class Team> RATTLEBOX_COLD void stop(Team& team, Owner own, Status status, int wall, real speed) {
    Account& account = own.account();
    if (account.status != Status::finished) return;
    account.status = status, account.wall = wall, account.speed = speed;
    team.least(own.bed->stopped, own.bed->name[own.i]);
}

struct First {
    Late late;
    real lost = 0;
};

template <class Team> RATTLEBOX_COLD First begin(Team& team, Owner own, int s, int partner) {
    Bed& bed = *own.bed;
    const Kind kind = kind_of(bed, partner);
    const Touch t = own.touch(partner);
    const Begun b = dem::begin(t, own.world->structure.dt);
    bed.kept[s] = b.kept;
    if (kind.rolls) bed.rolling[s] = b.rolling;
    if (kind.normal == Kind::plastic) bed.dent[s] = b.dent;
    Account& account = own.account();
    ++account.touches[partner < 0 ? wall : particle];
    account.extrapolated += b.extrapolated;
    account.fastest = larger(account.fastest, t.speed);
    if (b.status != Status::finished) stop(team, own, b.status, -1, t.speed);
    return {b.late, b.lost};
}

// What finding a new curve to unload from has cost.
RATTLEBOX_COLD inline real settle(Owner own, int s, int partner) {
    return dem::settle(own.bed->dent[s], own.touch(partner));
}

struct Last {
    real plastic = 0, sliding = 0, rolling = 0;
};

RATTLEBOX_COLD inline Last end(Owner own, int s, int partner) {
    const Bed& bed = *own.bed;
    const Kind k = kind_of(bed, partner);
    Last lost;
    if (k.normal == Kind::plastic && bed.dent[s][3] != bed.dent[s][0]) lost.plastic = settle(own, s, partner);
    if (k.rough) lost.sliding = held(bed.kept[s].friction);
    if (k.rolls) lost.rolling = held(bed.rolling[s].spring);
    return lost;
}

// ---- in every step

// The contacts that particle i owns; only its own slots and what is its own change.
template <bool sampled> class OwnContacts {
    const World& world_;
    Bed& bed_;
    const int i_;
    const Row place_;
    Row lost_{}; // in this step
    real deepest_ = 0;

    Owner own() const { return {&world_, &bed_, i_}; }
    int slot(int k) const { return k * bed_.particles + i_; }

    // Positive where they touch.
    real room(int partner, int& outside) const {
        if (partner < 0) {
            const real distance = own().near(-1 - partner).distance;
            if (distance < 0) outside = -1 - partner;
            return place_[3] - distance;
        }
        const Row other = bed_.position[partner], apart = place_ - other;
        return square(place_[3] + other[3]) - dot(apart, apart);
    }

    void lose(int partner, real normal, real sliding) {
        if (partner < 0)
            lost_ += rattlebox::row(0, normal, 0, sliding);
        else
            lost_ += rattlebox::row(normal, 0, sliding, 0);
    }
    void lose_more(int partner, real plastic, real rolling) const {
        if (!loses_more(bed_)) return;
        const bool at_wall = partner < 0;
        real* lost = reinterpret_cast<real*>(bed_.lost_more + i_) + at_wall;
        lost[0] += plastic, lost[2] += rolling;
    }

    template <bool spins> Meeting<real> meeting(int partner) const {
        const auto ball = [&](int i) -> Ball<real> {
            const Row x = bed_.position[i];
            return {vector(x), vector(bed_.velocity[i]), spins ? vector(bed_.spin[i]) : Vector<real>{}, x[3]};
        };
        if (partner >= 0) return meet<spins>(facing(ball(i_), ball(partner)));
        const Near at = own().near(-1 - partner);
        return meet<spins>(ball(i_), vector(at.normal), at.distance, vector(bed_.motion.velocity));
    }

    template <class Law> void collide(int s, int partner, const Late& late) {
        const Kind k = kind_of(bed_, partner);
        const real dt = world_.structure.dt;
        real stored = 0, slid = 0, rolled = 0;
        const auto m = k.rough ? meeting<true>(partner) : meeting<false>(partner);
        Four<real> dent{};
        if constexpr (Law::plastic) {
            Row& d = bed_.dent[s];
            if (sampled) d[0] = larger(d[0], m.overlap);
            if (d[3] != d[0] && (m.overlap < d[0] || sampled))
                lose_more(partner, settle(own(), s, partner), 0);
            dent = four(d);
        }
        const Four<real> law = four(bed_.kept[s].law);
        const real rate = dot(m.velocity, m.normal);
        auto push = Law::push(law, dent, m.overlap, rate);
        if (k.how.never_pulls) push.force = larger(push.force, 0.0);
        lose(partner, dt * (push.force - push.elastic) * rate, 0);
        deepest_ = larger(deepest_, m.overlap / m.radius);
        Vector<real> force = (-push.force) * m.normal;
        if (sampled) stored = Law::stored(law, dent, m.overlap);
        if constexpr (Law::plastic) bed_.dent[s][0] = larger(dent.x, m.overlap);
        Row torque{};
        if (k.rough) {
            const real mu = own().encounter(partner).friction;
            const auto h =
                rub(m, push, rate, law, mu, four(bed_.kept[s].friction), !Law::plastic, k.how.mindlin, dt);
            bed_.kept[s].friction = row(h.friction);
            force = force + h.force;
            bed_.action[s].couple = row((1 + late.share) * h.couple);
            lose(partner, 0, h.lost - late.share * dt * dot(row(force), late.slip));
            stored += h.stored, slid = h.beyond;
            if (k.rolls) {
                KeptRolling& kept = bed_.rolling[s];
                const auto r =
                    roll(m, push, h.stiffness, four(kept.law), four(kept.spring), k.how.mindlin, dt);
                kept.spring = row(r.rolling);
                bed_.torque[s] = torque = row(r.torque);
                lose_more(partner, 0, r.lost);
                stored += r.stored, rolled = r.beyond;
            }
        }
        const Row whole = row(force) * rattlebox::row(1 + late.share);
        bed_.action[s].force = whole;
        if constexpr (sampled) {
            ContactSum& seen = bed_.seen[i_];
            const Partner with = partner < 0 ? wall : particle;
            seen.stored += stored, seen.slid[with] += slid, seen.rolled[with] += rolled;
            ++seen.contacts[with];
            if (partner >= 0) return;
            const Near at = own().near(-1 - partner);
            const Row arm = place_ - bed_.motion.displacement + at.normal * at.distance;
            const Row twist = cross(arm, whole) + torque;
            for (int a = 0; a < 3; ++a) seen.twist[a] -= twist[a];
        }
    }

    void step(int s, int partner, const Late& late) {
        const Kind::Normal normal = kind_of(bed_, partner).normal;
        if (normal == Kind::hertz)
            collide<HertzStep>(s, partner, late);
        else if (normal == Kind::linear)
            collide<LinearStep>(s, partner, late);
        else
            collide<PlasticStep>(s, partner, late);
    }

    void book() const {
        bed_.lost[i_] += lost_;
        if (deepest_ > bed_.deepest[i_]) bed_.deepest[i_] = deepest_;
    }

public:
    OwnContacts(const World& world, Bed& bed, int i)
        : world_(world), bed_(bed), i_(i), place_(bed.position[i]) {}

    template <class Team> void step(Team& team) {
        if (sampled) bed_.seen[i_] = ContactSum{};
        const unsigned before = bed_.touching[i_];
        unsigned now = 0;
        int outside = -1;
        for (int k = 0; k < bed_.used[i_]; ++k) {
            const int partner = bed_.partner[slot(k)];
            if (partner != nobody && room(partner, outside) > 0) now |= 1u << k;
        }
        if (outside >= 0) stop(team, own(), Status::escaped, outside, 0);
        for (unsigned rest = before | now; rest != 0; rest &= rest - 1) {
            const int k = lowest_bit(rest), s = slot(k), partner = bed_.partner[s];
            if (!(now >> k & 1u)) {
                const Last lost = end(own(), s, partner);
                lose(partner, 0, lost.sliding), lose_more(partner, lost.plastic, lost.rolling);
                continue;
            }
            First first;
            if (!(before >> k & 1u)) {
                first = begin(team, own(), s, partner);
                lose(partner, first.lost, 0);
            }
            step(s, partner, first.late);
        }
        if (now != before) bed_.touching[i_] = now;
        if ((now | before) != 0) book();
    }
};

} // namespace rattlebox::dem::wide
