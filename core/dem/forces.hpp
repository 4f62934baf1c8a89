// Which candidates of a chunk touch, and what those do to each other.
#pragma once

#include "math/masks.hpp"
#include "dem/ahead.hpp"
#include "dem/contact_step.hpp"

namespace rattlebox::dem {

template <class Entry> RATTLEBOX_INLINE Group of_kinds(const std::vector<real>& value, Entry&& entry) {
    if (value.size() == 1) return Group::all(value[0]);
    alignas(64) real of[group];
    for (int l = 0; l < group; ++l) of[l] = at(value, entry(l));
    return pack<group>(of);
}

// A pair of particles, and a particle at a wall, as many at once as a register holds.
struct PairView {
    const Bed& bed;
    const Contacts& list;
    const std::vector<real>& mu; // by kinds

    RATTLEBOX_INLINE Group friction(const int* k) const {
        return of_kinds(mu, [&](int l) {
            return at(bed.kind, at(list.first, k[l])) * bed.cavity->kinds +
                   at(bed.kind, at(list.second, k[l]));
        });
    }

    // Rows are combined before they are turned into lanes, which costs more.
    template <class Combine>
    RATTLEBOX_INLINE Columns both(const std::vector<Row>& rows, const int* k, Combine&& combine) const {
        return columns_of([&](int l) __attribute__((always_inline)) {
            const int i = at(list.first, k[l]), j = at(list.second, k[l]);
            return combine(at(rows, i), at(rows, j), i, j);
        });
    }

    // From the first centre to the second, and the sum of the radii.
    RATTLEBOX_INLINE Columns way(const int* k) const {
        return both(bed.position, k, [](Row a, Row b, int, int) __attribute__((always_inline)) {
            return b + row(-1, -1, -1, 1) * a;
        });
    }

    // Positive where the pair touches.
    RATTLEBOX_INLINE Group room(const int* k) const {
        const auto apart = way(k);
        return apart.w * apart.w - dot(apart.vector(), apart.vector());
    }

    template <bool spins> RATTLEBOX_INLINE Meeting<Group> meeting(const int* k) const {
        const auto apart = way(k);
        const auto place = [&](int i) __attribute__((always_inline)) { return at(bed.position, i); };
        // With the smaller radius as the fourth number.
        const auto moving =
            both(bed.velocity, k, [&](Row a, Row b, int i, int j) __attribute__((always_inline)) {
                const Row p = place(i), q = place(j);
                return __builtin_shufflevector(a - b, p < q ? p : q, 0, 1, 2, 7);
            });
        if constexpr (!spins)
            return meet<false>(Facing<Group>{apart.vector(), moving.vector(), {}, {}, apart.w, moving.w});
        const auto swirl = both(bed.spin, k, [&](Row a, Row b, int i, int j) __attribute__((always_inline)) {
            return row(place(i)[3]) * a + row(place(j)[3]) * b;
        });
        const auto spin =
            both(bed.spin, k, [](Row a, Row b, int, int) __attribute__((always_inline)) { return a - b; });
        return meet<true>(
            Facing<Group>{apart.vector(), moving.vector(), spin.vector(), swirl.vector(), apart.w, moving.w});
    }
};

struct WallView {
    const Bed& bed;
    const Contacts& list;
    const std::vector<real>& mu;
    bool curved;

    RATTLEBOX_INLINE Group friction(const int* k) const {
        return of_kinds(mu, [&](int l) {
            return at(bed.kind, at(list.first, k[l])) * bed.cavity->wall_kinds + wall(k[l]).kind;
        });
    }

    RATTLEBOX_INLINE Columns first(const std::vector<Row>& rows, const int* k) const {
        return columns([&](int l) { return &at(rows, at(list.first, k[l])); });
    }
    const Wall& wall(int k) const { return at(bed.cavity->walls, at(list.second, k)); }
    static Vector<Group> same(Row r) { return {Group::all(r[0]), Group::all(r[1]), Group::all(r[2])}; }

    RATTLEBOX_INLINE void near(const int* k, const Columns& a, Vector<Group>& normal, Group& distance) const {
        const Vector<Group> place = a.vector() - same(bed.motion.displacement);
        const auto axis = columns([&](int l) { return &wall(k[l]).axis; });
        const Group along = dot(axis.vector(), place);
        normal = axis.vector();
        distance = axis.w - along;
        if (!curved) return;
        alignas(64) real bent[group], straight[group];
        for (int l = 0; l < group; ++l) {
            bent[l] = wall(k[l]).form != Wall::plane;
            straight[l] = wall(k[l]).form == Wall::cylinder;
        }
        const Vector<Group> q = place - (pack<group>(straight) * along) * axis.vector();
        const Group out = root(dot(q, q)), one_over = Group::all(1) / (out + Group::all(1e-290));
        distance = choose(pack<group>(bent), axis.w - out, distance);
        normal = {choose(pack<group>(bent), one_over * q.x, normal.x),
                  choose(pack<group>(bent), one_over * q.y, normal.y),
                  choose(pack<group>(bent), one_over * q.z, normal.z)};
    }

    RATTLEBOX_INLINE Group room(const int* k) const {
        Vector<Group> normal;
        Group distance;
        const auto a = first(bed.position, k);
        near(k, a, normal, distance);
        return a.w - distance;
    }

    template <bool spins> RATTLEBOX_INLINE Meeting<Group> meeting(const int* k) const {
        Vector<Group> normal;
        Group distance;
        const auto a = first(bed.position, k);
        near(k, a, normal, distance);
        Ball<Group> ball{a.vector(), first(bed.velocity, k).vector(), {}, a.w};
        if constexpr (spins) ball.spin = first(bed.spin, k).vector();
        return meet<spins>(ball, normal, distance, same(bed.motion.velocity));
    }
};

RATTLEBOX_INLINE Columns lay(const Four<Group>& f) { return {f.x, f.y, f.z, f.w}; }

// Lists the candidates that touch; calls begun(k) and ended(k) for those that have just begun or
// ended to.
template <class View, class Begun, class Ended>
void find_touching(Contacts& list, const View& view, Begun&& begun, Ended&& ended, const Ahead& ahead) {
    const int to = list.size();
    int* active = list.active.data();
    const int* slot = list.slot.data();
    int count = 0;
    for (int base = 0; base < to; base += lane_count) {
        ahead.looking(base);
        const int used = std::min(lane_count, to - base);
        unsigned touching = 0;
        for (int part = 0; part < used; part += group) {
            int k[group];
            for (int l = 0; l < group; ++l) k[l] = base + part + l;
            touching |= positive(view.room(k)) << part;
        }
        touching &= first_lanes(used);
        count += list_lanes(touching, base, active + count);
        const unsigned touched = ~negative(slot + base) & first_lanes(used);
        each_lane(touching ^ touched, [&](int l) { touching >> l & 1 ? begun(base + l) : ended(base + l); });
    }
    list.actives = count;
}

// Losses of enduring contacts are sampled in every such step, which costs next to nothing.
constexpr int probe = 32;

template <bool rough, bool rolls, class Law, class View, class Settle>
void collide(const Law& normal_law, Contacts& list, const View& view, const Kind& how, bool sampled,
             Partner partner, Tally& tally, Settle&& settle, const Ahead& ahead) {
    const int count = list.actives;
    const int* active = list.active.data();
    const Group zero = Group::all(0), dt = Group::all(how.dt);
    const bool probing = list.steps % probe == 0 && how.enduring < infinity;
    const Group latest = Group::all(static_cast<real>(list.steps) - how.enduring);
    Actions& actions = list.actions;
    actions.all.resize(static_cast<std::size_t>(count));
    if constexpr (rolls) actions.torque.resize(static_cast<std::size_t>(count));
    const int* const slot = list.slot.data();
    Kept* const remembered = list.memory.kept.data();
    Action* const acts = actions.all.data();
    alignas(64) real used[group];
    for (int base = 0; base < count; base += group) {
        const int part = base % lane_count; // of the sums, which have the same order on every machine
        if (part == 0) ahead.colliding(base);
        int a[group], k[group], s[group];
        for (int l = 0; l < group; ++l) {
            a[l] = std::min(base + l, count - 1);
            k[l] = active[a[l]];
            s[l] = slot[k[l]];
            used[l] = base + l < count;
        }
        const auto kept = [&](Row Kept::* part) {
            return [&, part](int l) { return &(remembered[s[l]].*part); };
        };
        const auto rolling = [&](Row KeptRolling::* part) {
            return [&, part](int l) { return &(at(list.memory.rolling, s[l]).*part); };
        };
        const auto acting = [&](Row Action::* part) {
            return [&, part](int l) { return &(acts[a[l]].*part); };
        };
        const auto dents = [&](int l) { return &at(list.memory.dent, s[l]); };
        const Group weight = pack<group>(used);
        const auto m = view.template meeting<rough>(k);
        const auto law = columns(kept(&Kept::law));
        Columns dent{};
        if constexpr (Law::hysteretic) {
            alignas(64) real overlap[group];
            pack<group>(overlap) = m.overlap;
            for (int l = 0; l < group; ++l) {
                Row& d = at(list.memory.dent, s[l]);
                if (sampled) d[0] = std::fmax(d[0], overlap[l]);
                if (d[3] != d[0] && (overlap[l] < d[0] || sampled)) settle(k[l]);
            }
            dent = columns(dents);
        }
        const Group rate = dot(m.velocity, m.normal);
        const Depth<Group> depth = depth_from_overlap(m.overlap);
        const Coefficients<Group> k_normal{law.x, law.y};
        const History<Group> history{dent.x, dent.y, dent.z};
        auto normal = normal_force(normal_law, k_normal, depth, rate, history);
        if (how.never_pulls) normal.total = larger(normal.total, zero);
        Group lost = weight * dt * (normal.total - normal.elastic) * rate;
        group_of(tally.normal[partner], part) += lost;
        tally.deepest.see(m.overlap, m.radius, part);
        Vector<Group> force = (zero - normal.total) * m.normal;
        if (sampled)
            group_of(tally.stored, part) += weight * stored_energy(normal_law, k_normal, depth, history);
        if constexpr (Law::hysteretic) {
            dent.x = larger(dent.x, m.overlap);
            store(dent, dents);
        }
        if constexpr (rough) {
            const auto h = tangential_force(m, normal.total, rate, law.z, law.w, view.friction(k), depth,
                                            columns(kept(&Kept::friction)), how.tangential, dt);
            store(lay(h.spring), kept(&Kept::friction));
            const Group slid = weight * h.loss;
            group_of(tally.sliding[partner], part) += slid, lost += slid;
            force = force + h.force;
            store(Columns{h.couple.x, h.couple.y, h.couple.z, zero}, acting(&Action::couple));
            if (sampled) {
                group_of(tally.stored, part) += weight * h.stored;
                group_of(tally.slid[partner], part) += weight * h.excess;
            }
            if constexpr (rolls) {
                const auto r =
                    rolling_torque(m, normal.total, h.stiffness, columns(rolling(&KeptRolling::law)), depth,
                                   columns(rolling(&KeptRolling::spring)), how.tangential, dt);
                store(lay(r.spring), rolling(&KeptRolling::spring));
                store(Columns{r.torque.x, r.torque.y, r.torque.z, zero},
                      [&](int l) { return &at(actions.torque, a[l]); });
                const Group rolled = weight * r.loss;
                group_of(tally.rolling[partner], part) += rolled, lost += rolled;
                if (sampled) {
                    group_of(tally.stored, part) += weight * r.stored;
                    group_of(tally.rolled[partner], part) += weight * r.excess;
                }
            }
        } else
            store(Columns{zero, zero, zero, zero}, acting(&Action::couple));
        if (probing) {
            alignas(64) real since[group];
            for (int l = 0; l < group; ++l) since[l] = at(list.memory.since, s[l]);
            group_of(tally.enduring[partner], part) +=
                Group::all(probe) * choose(latest - pack<group>(since), lost, zero);
        }
        store(Columns{force.x, force.y, force.z, Group::all(1)}, acting(&Action::force));
    }
    if (sampled) tally.contacts[partner] += count;
}

} // namespace rattlebox::dem
