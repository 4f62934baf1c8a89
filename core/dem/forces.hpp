// Which candidates of a chunk touch, and what those do to each other.
#pragma once

#include "dem/contact_step.hpp"
#include "dem/touch.hpp"

namespace rattlebox::dem {

// A pair of particles, and a particle at a wall, in lanes.
struct PairView {
    const Bed& bed;
    const Contacts& list;

    RATTLEBOX_INLINE Columns<8> first(const std::vector<Row>& rows, const int* k) const {
        return columns([&](int l) { return &at(rows, at(list.first, k[l])); });
    }
    RATTLEBOX_INLINE Columns<8> second(const std::vector<Row>& rows, const int* k) const {
        return columns([&](int l) { return &at(rows, at(list.second, k[l])); });
    }

    // Positive where the pair touches.
    RATTLEBOX_INLINE Lanes room(const int* k) const {
        const auto a = first(bed.position, k), b = second(bed.position, k);
        const auto apart = a.vector() - b.vector();
        const Lanes near = a.w + b.w;
        return near * near - dot(apart, apart);
    }

    template <bool spins> RATTLEBOX_INLINE Meeting<Lanes> meeting(const int* k) const {
        const auto a = first(bed.position, k), b = second(bed.position, k);
        const auto way = b.vector() - a.vector();
        const Lanes distance = root(dot(way, way)), near = a.w + b.w;
        Meeting<Lanes> m;
        m.normal = (Lanes::all(1) / distance) * way;
        m.overlap = near - distance;
        m.radius = smaller(a.w, b.w);
        m.velocity = first(bed.velocity, k).vector() - second(bed.velocity, k).vector();
        if constexpr (spins) {
            m.lever = distance / near;
            const auto u = first(bed.spin, k).vector(), v = second(bed.spin, k).vector();
            m.swirl = (m.lever * a.w) * u + (m.lever * b.w) * v;
            m.spin = u - v;
        }
        return m;
    }
};

struct WallView {
    const Bed& bed;
    const Contacts& list;
    bool curved;

    RATTLEBOX_INLINE Columns<8> first(const std::vector<Row>& rows, const int* k) const {
        return columns([&](int l) { return &at(rows, at(list.first, k[l])); });
    }
    const Wall& wall(int k) const { return at(bed.cavity->walls, at(list.second, k)); }
    static Vector<Lanes> same(Row r) { return {Lanes::all(r[0]), Lanes::all(r[1]), Lanes::all(r[2])}; }

    RATTLEBOX_INLINE void near(const int* k, const Columns<8>& a, Vector<Lanes>& normal,
                               Lanes& distance) const {
        const Vector<Lanes> place = a.vector() - same(bed.motion.displacement);
        const auto axis = columns([&](int l) { return &wall(k[l]).axis; });
        const Lanes along = dot(axis.vector(), place);
        normal = axis.vector();
        distance = axis.w - along;
        if (!curved) return;
        alignas(64) real bent[8], straight[8];
        for (int l = 0; l < 8; ++l) {
            bent[l] = wall(k[l]).form != Wall::plane;
            straight[l] = wall(k[l]).form == Wall::cylinder;
        }
        const Vector<Lanes> q = place - (lanes(straight) * along) * axis.vector();
        const Lanes out = root(dot(q, q)), one_over = Lanes::all(1) / (out + Lanes::all(1e-290));
        distance = choose(lanes(bent), axis.w - out, distance);
        normal = {choose(lanes(bent), one_over * q.x, normal.x),
                  choose(lanes(bent), one_over * q.y, normal.y),
                  choose(lanes(bent), one_over * q.z, normal.z)};
    }

    RATTLEBOX_INLINE Lanes room(const int* k) const {
        Vector<Lanes> normal;
        Lanes distance;
        const auto a = first(bed.position, k);
        near(k, a, normal, distance);
        return a.w - distance;
    }

    template <bool spins> RATTLEBOX_INLINE Meeting<Lanes> meeting(const int* k) const {
        Meeting<Lanes> m;
        Lanes distance;
        const auto a = first(bed.position, k);
        near(k, a, m.normal, distance);
        m.overlap = a.w - distance;
        m.velocity = first(bed.velocity, k).vector() - same(bed.motion.velocity);
        m.radius = a.w;
        if constexpr (spins) {
            m.lever = distance / a.w;
            m.spin = first(bed.spin, k).vector();
            m.swirl = distance * m.spin;
        }
        return m;
    }
};

// Lists the candidates up to `to` that touch; calls begun(k) and ended(k) for those that have just begun or
// ended to.
template <class View, class Begun, class Ended>
void find_touching(Contacts& list, const View& view, int to, Begun&& begun, Ended&& ended) {
    int* active = list.active.data();
    const int* slot = list.slot.data();
    int count = 0;
    for (int base = 0; base < to; base += lane_count) {
        int k[lane_count];
        for (int l = 0; l < lane_count; ++l) k[l] = base + l;
        alignas(64) real room[lane_count];
        lanes(room) = view.room(k);
        const int used = std::min(lane_count, to - base);
        int changed = 0;
        for (int l = 0; l < used; ++l) {
            const int touches = room[l] > 0;
            active[count] = base + l;
            count += touches;
            changed |= touches ^ (slot[base + l] >= 0);
        }
        if (changed) [[unlikely]]
            for (int l = 0; l < used; ++l) {
                const bool touches = room[l] > 0;
                if (touches != (slot[base + l] >= 0)) touches ? begun(base + l) : ended(base + l);
            }
    }
    list.actives = count;
}

struct Contacting {
    real dt = 0;
    bool mindlin = true;     // tangential stiffness grows with the contact
    bool never_pulls = true; // normal force
};

template <class Law, bool rough, bool rolls, class View, class Settle>
void collide(Contacts& list, const View& view, const Contacting& how, bool sampled, Partner partner,
             Tally& tally, Settle&& settle) {
    const int count = list.actives;
    const int* active = list.active.data();
    const Lanes zero = Lanes::all(0), one = Lanes::all(1), dt = Lanes::all(how.dt);
    alignas(64) real used[lane_count];
    for (int base = 0; base < count; base += lane_count) {
        int k[lane_count], s[lane_count];
        for (int l = 0; l < lane_count; ++l) {
            k[l] = active[std::min(base + l, count - 1)];
            s[l] = at(list.slot, k[l]);
            used[l] = base + l < count;
        }
        const auto kept = [&](Row Kept::* part) {
            return [&, part](int l) { return &(at(list.kept, s[l]).*part); };
        };
        const auto rolling = [&](Row KeptRolling::* part) {
            return [&, part](int l) { return &(at(list.rolling, s[l]).*part); };
        };
        const auto dents = [&](int l) { return &at(list.dent, s[l]); };
        const Lanes weight = lanes(used);
        const auto m = view.template meeting<rough>(k);
        const auto law = columns(kept(&Kept::law));
        Columns<8> dent{};
        if constexpr (Law::plastic) {
            alignas(64) real overlap[lane_count];
            lanes(overlap) = m.overlap;
            for (int l = 0; l < lane_count; ++l) {
                Row& d = at(list.dent, s[l]);
                if (sampled) d[0] = std::fmax(d[0], overlap[l]);
                if (d[3] != d[0] && (overlap[l] < d[0] || sampled)) settle(k[l]);
            }
            dent = columns(dents);
        }
        const Lanes rate = dot(m.velocity, m.normal);
        Push push = Law::push(law, dent, m.overlap, rate);
        if (how.never_pulls) push.force = larger(push.force, zero);
        tally.normal[partner] += weight * dt * (push.force - push.elastic) * rate;
        tally.deepest = larger(tally.deepest, m.overlap / m.radius);
        Vector<Lanes> force = (zero - push.force) * m.normal;
        if (sampled) tally.stored += weight * Law::stored(law, dent, m.overlap);
        if constexpr (Law::plastic) {
            dent.x = larger(dent.x, m.overlap);
            store(dent, dents);
        }
        if constexpr (rough) {
            const Lanes firm = how.mindlin ? push.root : one, drag = how.mindlin ? root(push.root) : one;
            const Lanes mu = columns(kept(&Kept::couple)).w;
            const auto history = columns(kept(&Kept::friction));
            const Lanes pressed = larger(push.force, zero), stiffness = law.z * firm;
            const Vector<Lanes> slip = m.velocity - rate * m.normal + cross(m.swirl, m.normal);
            const Lanes dashpot = Law::plastic ? zero : law.w * drag;
            const auto h =
                hold(history.vector(), history.w, m.normal, stiffness, dashpot, slip, mu * pressed, dt);
            store(Columns<8>{h.ahead.x, h.ahead.y, h.ahead.z, stiffness}, kept(&Kept::friction));
            tally.sliding[partner] += weight * h.loss;
            force = force + h.force;
            const Vector<Lanes> couple = m.lever * cross(m.normal, h.force);
            store(Columns<8>{couple.x, couple.y, couple.z, mu}, kept(&Kept::couple));
            if (sampled) tally.stored += weight * h.stored;
            if constexpr (rolls) {
                const auto past = columns(rolling(&KeptRolling::spring));
                const Vector<Lanes> turning = m.spin - dot(m.spin, m.normal) * m.normal;
                const auto own = columns(rolling(&KeptRolling::law));
                const Lanes spring = own.y * stiffness;
                const auto r =
                    hold(past.vector(), past.w, m.normal, spring, own.z * drag, turning, own.x * pressed, dt);
                store(Columns<8>{r.ahead.x, r.ahead.y, r.ahead.z, spring}, rolling(&KeptRolling::spring));
                store(Columns<8>{r.force.x, r.force.y, r.force.z, zero}, rolling(&KeptRolling::torque));
                tally.rolling[partner] += weight * r.loss;
                if (sampled) tally.stored += weight * r.stored;
            }
        }
        store(Columns<8>{force.x, force.y, force.z, zero}, kept(&Kept::force));
    }
    if (sampled) tally.contacts[partner] += count;
}

} // namespace rattlebox::dem
