// Contact detection among the candidate pairs, and contact forces, in SIMD lanes.
//
// The loops compute as many contacts at once as a register holds: rows of positions, velocities and spins are
// transposed into lanes, and the laws of core/contact are evaluated for all lanes. Sums are accumulated in
// eight lanes with every instruction set, so that their order is the same. Measured on one core as time
// without lanes (one contact at a time) over time with four: 1.75 with 1000 particles shaken, 2.6 at rest,
// 1.95 and 2.15 with 100 000; as time with four over time with eight: 1.11 with 1000 shaken on AMD Zen 5,
// 1.00 on an Intel Xeon, whose square roots and divisions take twice as long in eight lanes.
#pragma once

#include "dem/contact_geometry.hpp"
#include "dem/prefetch.hpp"
#include "math/masks.hpp"

namespace rattlebox::dem {

template <class Entry> RATTLEBOX_INLINE Group by_species(const std::vector<real>& value, Entry&& entry) {
    if (value.size() == 1) return Group::all(value[0]);
    alignas(64) real of[group];
    for (int l = 0; l < group; ++l) of[l] = at(value, entry(l));
    return pack<group>(of);
}

// Access to candidate pairs of particles; `k` points to as many candidates as a register holds.
template <bool periodic> struct PairView {
    const Bed& bed;
    const ContactList& list;
    const std::vector<real>& mu; // friction coefficient by two species

    RATTLEBOX_INLINE void add_loss(real WallTotals::*, const int*, const Group&) const {}

    RATTLEBOX_INLINE Group friction(const int* k) const {
        return by_species(mu, [&](int l) {
            return at(bed.species, at(list.first, k[l])) * bed.cavity->species_count +
                   at(bed.species, at(list.second, k[l]));
        });
    }

    // Rows are combined before they are transposed, because transposing costs more.
    template <class Combine>
    RATTLEBOX_INLINE Columns both(const std::vector<Row>& rows, const int* k, Combine&& combine) const {
        return columns_of([&](int l) __attribute__((always_inline)) {
            const int i = at(list.first, k[l]), j = at(list.second, k[l]);
            return combine(at(rows, i), at(rows, j), i, j);
        });
    }

    // Branch vector from the first centre to the second, and the sum of the radii.
    RATTLEBOX_INLINE Columns branch(const int* k) const {
        const Columns apart = both(bed.position, k,
                                   [](Row a, Row b, int, int)
                                       __attribute__((always_inline)) { return b + row(-1, -1, -1, 1) * a; });
        if constexpr (periodic)
            return bed.periods.nearest_image(apart);
        else
            return apart;
    }

    // Returns a number that is positive if the pair overlaps.
    RATTLEBOX_INLINE Group overlap_sign(const int* k) const {
        const auto apart = branch(k);
        return apart.w * apart.w - dot(apart.vector(), apart.vector());
    }

    template <bool spins> RATTLEBOX_INLINE ContactKinematics<Group> kinematics(const int* k) const {
        const auto apart = branch(k);
        const auto place = [&](int i) __attribute__((always_inline)) { return at(bed.position, i); };
        // The fourth number is the smaller radius.
        const auto moving =
            both(bed.velocity, k, [&](Row a, Row b, int i, int j) __attribute__((always_inline)) {
                const Row p = place(i), q = place(j);
                return __builtin_shufflevector(a - b, p < q ? p : q, 0, 1, 2, 7);
            });
        if constexpr (!spins)
            return contact_kinematics<false>(
                RelativeMotion<Group>{apart.vector(), moving.vector(), {}, {}, apart.w, moving.w});
        const auto surface_spin =
            both(bed.spin, k, [&](Row a, Row b, int i, int j) __attribute__((always_inline)) {
                return row(place(i)[3]) * a + row(place(j)[3]) * b;
            });
        const auto spin =
            both(bed.spin, k, [](Row a, Row b, int, int) __attribute__((always_inline)) { return a - b; });
        return contact_kinematics<true>(RelativeMotion<Group>{apart.vector(), moving.vector(), spin.vector(),
                                                              surface_spin.vector(), apart.w, moving.w});
    }
};

struct WallView {
    const Bed& bed;
    const ContactList& list;
    const std::vector<real>& mu;
    bool curved;
    WallTotals* totals; // by label; null if they are not computed

    // Adds the losses of contacts to those of their walls.
    RATTLEBOX_INLINE void add_loss(real WallTotals::* sum, const int* k, const Group& lost) const {
        if (!totals) return;
        alignas(64) real of[group];
        pack<group>(of) = lost;
        for (int l = 0; l < group; ++l) totals[wall(k[l]).label].*sum += of[l];
    }

    RATTLEBOX_INLINE Group friction(const int* k) const {
        return by_species(mu, [&](int l) {
            return at(bed.species, at(list.first, k[l])) * bed.cavity->wall_material_count +
                   wall(k[l]).material;
        });
    }

    RATTLEBOX_INLINE Columns first(const std::vector<Row>& rows, const int* k) const {
        return columns([&](int l) { return &at(rows, at(list.first, k[l])); });
    }
    const Wall& wall(int k) const { return at(bed.cavity->walls, at(list.second, k)); }
    static Vector<Group> broadcast(Row r) { return {Group::all(r[0]), Group::all(r[1]), Group::all(r[2])}; }

    RATTLEBOX_INLINE void nearest_point(const int* k, const Columns& a, Vector<Group>& normal,
                                        Group& distance) const {
        if (!list.near.empty()) { // computed before (dem/solid_contacts.hpp)
            const auto near = columns([&](int l) { return &at(list.near, k[l]); });
            normal = near.vector(), distance = near.w;
            return;
        }
        const Vector<Group> place = a.vector() - broadcast(bed.motion.displacement);
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

    RATTLEBOX_INLINE Group overlap_sign(const int* k) const {
        Vector<Group> normal;
        Group distance;
        const auto a = first(bed.position, k);
        nearest_point(k, a, normal, distance);
        return a.w - distance;
    }

    template <bool spins> RATTLEBOX_INLINE ContactKinematics<Group> kinematics(const int* k) const {
        Vector<Group> normal;
        Group distance;
        const auto a = first(bed.position, k);
        nearest_point(k, a, normal, distance);
        Sphere<Group> sphere{a.vector(), first(bed.velocity, k).vector(), {}, a.w};
        if constexpr (spins) sphere.spin = first(bed.spin, k).vector();
        return contact_kinematics<spins>(sphere, normal, distance, broadcast(bed.motion.velocity));
    }
};

RATTLEBOX_INLINE Columns as_columns(const Vector4<Group>& f) { return {f.x, f.y, f.z, f.w}; }

// Lists the touching candidates; calls begun(k) and ended(k) for contacts that have begun or ended in this
// step.
template <class View, class Begun, class Ended>
void find_touching(ContactList& list, const View& view, Begun&& begun, Ended&& ended,
                   const Prefetch& prefetch) {
    const int to = list.size();
    int* touching = list.touching.data();
    const int* slot = list.slot.data();
    int count = 0;
    // Eight candidates at a time, as bits of a mask, because most candidates do not touch: what follows
    // visits set bits only.
    for (int base = 0; base < to; base += lane_count) {
        prefetch.for_candidates(base);
        const int used = std::min(lane_count, to - base);
        unsigned overlapping = 0;
        for (int part = 0; part < used; part += group) {
            int k[group];
            for (int l = 0; l < group; ++l) k[l] = base + part + l;
            overlapping |= positive(view.overlap_sign(k)) << part;
        }
        overlapping &= first_lanes(used);
        count += list_lanes(overlapping, base, touching + count);
        // A candidate with a history slot touched in the last step; where the two masks differ, a contact
        // begins or ends.
        const unsigned touched = ~negative(slot + base) & first_lanes(used);
        each_lane(overlapping ^ touched,
                  [&](int l) { overlapping >> l & 1 ? begun(base + l) : ended(base + l); });
    }
    list.touching_count = count;
}

// Losses of enduring contacts are sampled once in this many steps, which takes no measurable time.
constexpr int enduring_interval = 32;

template <bool rough, bool rolls, class Law, class View, class UpdateCurve>
void compute_contact_forces(const Law& normal_law, ContactList& list, const View& view,
                            const ContactLaws& laws, bool sampled, Partner partner, Diagnostics& diagnostics,
                            UpdateCurve&& update_unloading_curve, const Prefetch& prefetch) {
    const int count = list.touching_count;
    const int* touching = list.touching.data();
    const Group zero = Group::all(0), dt = Group::all(laws.dt);
    // Contacts that began before this step count as enduring. An age is compared instead of stored, so that a
    // contact costs nothing while it lasts.
    const bool samples_enduring = list.steps % enduring_interval == 0 && laws.enduring < infinity;
    const Group latest = Group::all(static_cast<real>(list.steps) - laws.enduring);
    ContactForces& contact_forces = list.contact_forces;
    contact_forces.all.resize(static_cast<std::size_t>(count));
    if constexpr (rolls) contact_forces.torque.resize(static_cast<std::size_t>(count));
    const int* const slot = list.slot.data();
    ContactState* const states = list.history.state.data();
    ContactForce* const forces = contact_forces.all.data();
    alignas(64) real used[group];
    for (int base = 0; base < count; base += group) {
        const int part = base % lane_count; // first of the eight lanes of the sums
        // The histories lie in the order in which contacts began, that is, anywhere in memory: they are
        // requested early.
        if (part == 0) prefetch.for_contacts(base);
        // The last lanes repeat the last contact, so that loads and stores need no mask; their weight of 0
        // removes them from all sums. Repeated stores write the same values.
        int a[group], k[group], s[group];
        for (int l = 0; l < group; ++l) {
            a[l] = std::min(base + l, count - 1);
            k[l] = touching[a[l]];
            s[l] = slot[k[l]];
            used[l] = base + l < count;
        }
        // A lane's row is found by contact (a), candidate (k) or history slot (s).
        const auto state = [&](Row ContactState::* part) {
            return [&, part](int l) { return &(states[s[l]].*part); };
        };
        const auto rolling = [&](Row RollingState::* part) {
            return [&, part](int l) { return &(at(list.history.rolling, s[l]).*part); };
        };
        const auto contact_force = [&](Row ContactForce::* part) {
            return [&, part](int l) { return &(forces[a[l]].*part); };
        };
        const auto yields = [&](int l) { return &at(list.history.yield_history, s[l]); };
        const Group weight = pack<group>(used);
        const auto m = view.template kinematics<rough>(k);
        const auto law = columns(state(&ContactState::law));
        Columns yield_history{};
        // Unloading follows a curve from the deepest overlap so far. It costs powers of the overlap, and so
        // is computed only where it is needed: at the turn from loading to unloading, and for a sample.
        if constexpr (Law::hysteretic) {
            alignas(64) real overlap[group];
            pack<group>(overlap) = m.overlap;
            for (int l = 0; l < group; ++l) {
                Row& d = at(list.history.yield_history, s[l]);
                if (sampled) d[0] = std::fmax(d[0], overlap[l]);
                if (d[3] != d[0] && (overlap[l] < d[0] || sampled)) update_unloading_curve(k[l]);
            }
            yield_history = columns(yields);
        }
        // The normal force. A law with a dashpot pulls at the end of a contact; whether that is cut off is
        // the choice of the case.
        const Group rate = dot(m.velocity, m.normal);
        const Depth<Group> depth = depth_from_overlap(m.overlap);
        const Coefficients<Group> k_normal{law.x, law.y};
        const History<Group> history{yield_history.x, yield_history.y, yield_history.z};
        auto normal = normal_force(normal_law, k_normal, depth, rate, history);
        if (laws.repulsive_only) normal.total = larger(normal.total, zero);
        // The loss is the power of the dissipative part of the force, at the velocities of this step: what
        // the ledger checks against the motion.
        Group lost = weight * dt * (normal.total - normal.elastic) * rate;
        // Each of the eight sums has its own contacts, whatever the width of the registers: sums are the same
        // on all machines.
        group_of(diagnostics.normal[partner], part) += lost;
        view.add_loss(&WallTotals::normal, k, lost);
        diagnostics.largest_overlap.update(m.overlap, m.radius, part);
        Vector<Group> force = (zero - normal.total) * m.normal;
        if (sampled)
            group_of(diagnostics.stored, part) +=
                weight * stored_energy(normal_law, k_normal, depth, history);
        if constexpr (Law::hysteretic) {
            yield_history.x = larger(yield_history.x, m.overlap);
            store(yield_history, yields);
        }
        if constexpr (rough) {
            // Friction is limited by the normal force of this step; the spring is half a step ahead, as in
            // the leapfrog of the velocities.
            const auto h = tangential_force(m, normal.total, rate, law.z, law.w, view.friction(k), depth,
                                            columns(state(&ContactState::friction)), laws.tangential, dt);
            store(as_columns(h.spring), state(&ContactState::friction));
            const Group slid = weight * h.loss;
            group_of(diagnostics.sliding[partner], part) += slid, lost += slid;
            view.add_loss(&WallTotals::sliding, k, slid);
            force = force + h.force;
            store(Columns{h.couple.x, h.couple.y, h.couple.z, zero}, contact_force(&ContactForce::couple));
            if (sampled) {
                group_of(diagnostics.stored, part) += weight * h.stored;
                const Group excess = weight * h.excess;
                group_of(diagnostics.sliding_correction[partner], part) += excess;
                view.add_loss(&WallTotals::sliding_correction, k, excess);
            }
            if constexpr (rolls) {
                // Rolling resistance is a spring of its own, with a limit in torque, and uses the tangential
                // stiffness of this step.
                const auto r =
                    rolling_torque(m, normal.total, h.stiffness, columns(rolling(&RollingState::law)), depth,
                                   columns(rolling(&RollingState::spring)), laws.tangential, dt);
                store(as_columns(r.spring), rolling(&RollingState::spring));
                store(Columns{r.torque.x, r.torque.y, r.torque.z, zero},
                      [&](int l) { return &at(contact_forces.torque, a[l]); });
                const Group rolled = weight * r.loss;
                group_of(diagnostics.rolling[partner], part) += rolled, lost += rolled;
                view.add_loss(&WallTotals::rolling, k, rolled);
                if (sampled) {
                    group_of(diagnostics.stored, part) += weight * r.stored;
                    const Group excess = weight * r.excess;
                    group_of(diagnostics.rolling_correction[partner], part) += excess;
                    view.add_loss(&WallTotals::rolling_correction, k, excess);
                }
            }
        } else
            store(Columns{zero, zero, zero, zero}, contact_force(&ContactForce::couple));
        if (samples_enduring) {
            // A sample stands for all steps of the interval.
            alignas(64) real since[group];
            for (int l = 0; l < group; ++l) since[l] = at(list.history.start_step, s[l]);
            group_of(diagnostics.enduring[partner], part) +=
                Group::all(enduring_interval) * choose(latest - pack<group>(since), lost, zero);
        }
        // The fourth number counts contacts when forces are summed: a particle without any skips its contact
        // terms.
        store(Columns{force.x, force.y, force.z, Group::all(1)}, contact_force(&ContactForce::force));
    }
    if (sampled) diagnostics.contacts[partner] += count;
}

// Adapts contacts to a change of the length of the next step: their springs, which are half a step ahead, and
// the losses of the second half of the last step. The bed is in its state at the last step.
template <bool rough, bool rolls, class Law, class View>
void change_step(const Law& normal_law, ContactList& list, const View& view, const ContactLaws& laws,
                 real dt_before, Partner partner, Diagnostics& diagnostics) {
    const int count = list.touching_count;
    const Group zero = Group::all(0), before = Group::all(dt_before), dt = Group::all(laws.dt);
    const Group more = Group::all(0.5 * (laws.dt - dt_before));
    alignas(64) real used[group];
    for (int base = 0; base < count; base += group) {
        const int part = base % lane_count;
        int k[group], s[group];
        for (int l = 0; l < group; ++l) {
            k[l] = at(list.touching, std::min(base + l, count - 1));
            s[l] = at(list.slot, k[l]);
            used[l] = base + l < count;
        }
        const auto state = [&](Row ContactState::* row) {
            return [&, row](int l) { return &(at(list.history.state, s[l]).*row); };
        };
        const auto rolling = [&](Row RollingState::* row) {
            return [&, row](int l) { return &(at(list.history.rolling, s[l]).*row); };
        };
        const Group weight = pack<group>(used);
        const auto m = view.template kinematics<rough>(k);
        const auto law = columns(state(&ContactState::law));
        Columns yield_history{};
        if constexpr (Law::hysteretic)
            yield_history = columns([&](int l) { return &at(list.history.yield_history, s[l]); });
        const Group rate = dot(m.velocity, m.normal);
        const Depth<Group> depth = depth_from_overlap(m.overlap);
        auto normal = normal_force(normal_law, Coefficients<Group>{law.x, law.y}, depth, rate,
                                   History<Group>{yield_history.x, yield_history.y, yield_history.z});
        if (laws.repulsive_only) normal.total = larger(normal.total, zero);
        const Group damped = weight * more * (normal.total - normal.elastic) * rate;
        group_of(diagnostics.normal[partner], part) += damped;
        view.add_loss(&WallTotals::normal, k, damped);
        const Group pushing = larger(normal.total, zero);
        const auto change = [&](const auto& place, const Group& coefficient, const Vector<Group>& velocity,
                                const Group& friction, Lanes& lost, real WallTotals::* at_wall) {
            const auto spring = columns(place);
            const auto h = change_half_step(spring.vector(), spring.w,
                                            tangential_dashpot(laws.tangential, coefficient, depth), velocity,
                                            friction * pushing, before, dt);
            store(Columns{h.next_spring.x, h.next_spring.y, h.next_spring.z, spring.w}, place);
            const Group more_lost = weight * h.loss;
            group_of(lost, part) += more_lost;
            view.add_loss(at_wall, k, more_lost);
        };
        if constexpr (rough)
            change(state(&ContactState::friction), law.w, slip_velocity(m, rate), view.friction(k),
                   diagnostics.sliding[partner], &WallTotals::sliding);
        if constexpr (rolls) {
            const auto own = columns(rolling(&RollingState::law));
            change(rolling(&RollingState::spring), own.z, rolling_velocity(m), own.x,
                   diagnostics.rolling[partner], &WallTotals::rolling);
        }
    }
}

} // namespace rattlebox::dem
