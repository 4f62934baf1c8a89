// The contact loop of one chunk: forces of pairs and at walls, and their sums on particles.
//
// A contact belongs to the chunk of the lower of its two particles, so that in ascending order a chunk can be
// integrated as soon as its own forces are computed, while its data are in the caches. The forces on a
// particle are added in the order of its contacts, whichever worker computes them.
#pragma once

#include "dem/contact_forces.hpp"
#include "dem/neighbour_list.hpp"
#include "dem/partition.hpp"
#include "dem/prefetch.hpp"
#include "dem/solid_contacts.hpp"

namespace rattlebox::dem {

class ContactLoop {
    Bed& bed_;
    const Problem& problem_;
    ContactLaws pair_, wall_;
    std::vector<real> pair_mu_, wall_mu_; // by two species, and by species and wall material
    bool curved_ = false;

    const PairLaw& pair_law(int i, int j) const {
        const Cavity& c = *bed_.cavity;
        return at(problem_.pair_laws,
                  at(c.particle_pair, at(bed_.species, i) * c.species_count + at(bed_.species, j)));
    }
    const PairLaw& wall_law(int i, int w) const {
        const Cavity& c = *bed_.cavity;
        return at(problem_.pair_laws,
                  at(c.wall_pair, at(bed_.species, i) * c.wall_material_count + at(c.walls, w).material));
    }
    Body body(int i) const { return {at(bed_.position, i), at(bed_.velocity, i), at(bed_.spin, i)}; }

    // Position of the first partner relative to the cavity, of its image inside.
    Row place(const ContactList& list, int k) const {
        Row place = at(bed_.position, at(list.first, k)) - bed_.motion.displacement;
        if (bed_.periods.any) place += bed_.periods.to_nearest_image(place);
        return place;
    }
    WallPoint wall_point(const ContactList& list, int k) const {
        if (!list.near.empty()) return {at(list.near, k) * row(1, 1, 1, 0), at(list.near, k)[3]};
        return nearest_wall_point(at(bed_.cavity->walls, at(list.second, k)), place(list, k));
    }

    NewContact new_contact_of(const ContactList& list, int k, Partner partner) const {
        const int i = at(list.first, k), j = at(list.second, k);
        const Body a = body(i);
        if (partner == particle) {
            Body b = body(j);
            if (bed_.periods.any) b.position += bed_.periods.to_nearest_image(b.position - a.position);
            return new_contact(pair_law(i, j), a, b);
        }
        const WallPoint near = wall_point(list, k);
        real mobility = a.velocity[3];
        const Row across = bed_.frame.to_structure(near.normal);
        for (const Row& shape : bed_.cavity->shape) mobility += square(dot(shape, across));
        return new_contact(wall_law(i, j), a, near, bed_.motion.velocity, mobility);
    }

    // Returns the sums over the contacts of a chunk with the wall of a contact, or null if they are not
    // computed.
    WallTotals* totals_of(Chunk& chunk, const ContactList& list, int k, Partner partner) const {
        if (partner == particle || chunk.each_wall.empty()) return nullptr;
        return &at(chunk.each_wall, at(bed_.cavity->walls, at(list.second, k)).label);
    }
    // Calls f with the view of pairs in a periodic cavity or in another one, which has no images to choose
    // from.
    template <class F> void with_pairs(const ContactList& pairs, F&& f) const {
        if (bed_.periods.any)
            f(PairView<true>{bed_, pairs, pair_mu_});
        else
            f(PairView<false>{bed_, pairs, pair_mu_});
    }
    WallView wall_view(Chunk& chunk) const {
        return {bed_, chunk.walls, wall_mu_, curved_,
                chunk.each_wall.empty() ? nullptr : chunk.each_wall.data()};
    }

    void update_unloading_curve(ContactList& list, int k, const ContactLaws& laws, Partner partner,
                                Chunk& chunk) const {
        Diagnostics& diagnostics = chunk.diagnostics;
        const int s = at(list.slot, k);
        NewContact contact = new_contact_of(list, k, partner);
        if (const int w = at(list.history.began_at, s); w != ContactList::none)
            contact.law = &wall_law(at(list.first, k), w);
        const real cost = dem::update_unloading_curve(at(list.history.yield_history, s), contact);
        diagnostics.plastic[partner] += cost;
        if (WallTotals* wall = totals_of(chunk, list, k, partner)) wall->plastic += cost;
        if (static_cast<real>(list.steps) - at(list.history.start_step, s) > laws.enduring)
            diagnostics.enduring[partner] += first_lane(cost);
    }

    // Gives a contact whose history has moved to another candidate the wall of that candidate. It keeps its
    // age, its springs, and the normal law with which it began, so that no energy comes from a change of
    // stiffness at constant overlap. Friction and rolling resistance are those of the new wall; the energy
    // that a softer spring cannot hold is lost in the next step (contact/tangential/spring_slider.hpp).
    void change_wall(ContactList& list, int from, int to) const {
        const int s = at(list.slot, to);
        if (list.history.yields && at(list.history.began_at, s) == ContactList::none)
            at(list.history.began_at, s) = at(list.second, from);
        const ContactStart begun = begin(new_contact_of(list, to, wall), problem_.dt);
        Row& law = at(list.history.state, s).law;
        law[2] = begun.state.law[2], law[3] = begun.state.law[3];
        if (list.history.rolls) at(list.history.rolling, s).law = begun.rolling.law;
    }

    // Calls f(normal law, whether there is friction, whether there is rolling resistance) with types for the
    // last two.
    template <class F> static void with_laws(const ContactLaws& laws, F&& f) {
        constexpr std::true_type on;
        constexpr std::false_type off;
        laws.normal.visit([&](const auto& law) {
            laws.rolls ? f(law, on, on) : laws.rough ? f(law, on, off) : f(law, off, off);
        });
    }

    template <class View>
    void compute(ContactList& list, const View& view, const ContactLaws& laws, Partner partner, bool sampled,
                 Chunk& chunk, const Prefetch& prefetch) {
        Diagnostics& diagnostics = chunk.diagnostics;
        // Few candidates begin or end a contact in a step: these functions stay out of the loop over all.
        const auto begun = [&](int k) __attribute__((noinline)) {
            // Coefficients of a law depend on the approach speed at most, so that they are computed once a
            // contact, here.
            const NewContact t = new_contact_of(list, k, partner);
            const ContactStart b = begin(t, problem_.dt);
            at(list.slot, k) = list.history.add(b, static_cast<real>(list.steps));
            if (b.first_step.share != 0) chunk.first_step.push_back({k, b.first_step});
            if (b.lost != 0) diagnostics.normal[partner] += first_lane(b.lost);
            ++diagnostics.first_touches[partner];
            if (WallTotals* wall = totals_of(chunk, list, k, partner))
                wall->normal += b.lost, ++wall->impacts;
            diagnostics.extrapolated += b.extrapolated;
            diagnostics.largest_approach_speed = std::fmax(diagnostics.largest_approach_speed, t.speed);
            if (b.status != Status::finished && chunk.stop_reason.status == Status::finished)
                chunk.stop_reason = {b.status, at(list.first, k), -1, t.speed};
        };
        const auto ended = [&](int k) __attribute__((noinline)) {
            const int s = at(list.slot, k);
            if (list.history.yields &&
                at(list.history.yield_history, s)[3] != at(list.history.yield_history, s)[0])
                update_unloading_curve(list, k, laws, partner, chunk);
            // The energy that remains in the springs is lost.
            const real slid = laws.rough ? spring_energy(at(list.history.state, s).friction) : 0;
            const real rolled = laws.rolls ? spring_energy(at(list.history.rolling, s).spring) : 0;
            if (laws.rough) diagnostics.sliding[partner] += first_lane(slid);
            if (laws.rolls) diagnostics.rolling[partner] += first_lane(rolled);
            if (WallTotals* wall = totals_of(chunk, list, k, partner))
                wall->sliding += slid, wall->rolling += rolled;
            list.history.free.push_back(s);
            at(list.slot, k) = ContactList::none;
        };
        chunk.first_step.clear();
        find_touching(list, view, begun, ended, prefetch);
        prefetch.remaining(list.size(), list.touching_count);
        if (list.touching_count == 0) return list.contact_forces.all.clear();
        const auto update_curve = [&](int k) { update_unloading_curve(list, k, laws, partner, chunk); };
        with_laws(laws, [&](const auto& law, auto rough, auto rolls) {
            compute_contact_forces<rough.value, rolls.value>(law, list, view, laws, sampled, partner,
                                                             diagnostics, update_curve, prefetch);
        });
        // Contacts of this step get the part of their dashpot's impulse that acted between first touch and
        // the step; it is known as a share of the force.
        for (const auto& [k, first_step] : chunk.first_step) {
            const auto touching = list.touching.begin();
            const auto a = std::lower_bound(touching, touching + list.touching_count, k) - touching;
            ContactForce& contact_force = at(list.contact_forces.all, static_cast<int>(a));
            if (laws.rough) {
                const real slid = -first_step.share * problem_.dt * dot(contact_force.force, first_step.slip);
                diagnostics.sliding[partner] += first_lane(slid);
                if (WallTotals* wall = totals_of(chunk, list, k, partner)) wall->sliding += slid;
            }
            contact_force.force *= row(1 + first_step.share);
            contact_force.couple *= row(1 + first_step.share);
            contact_force.couple[3] = first_step.share;
        }
    }

    // The correction of a first step is an impulse for the former step `dt_before`, half of which acts in the
    // next step.
    void change_first_steps(const Chunk& chunk, real dt_before) {
        const auto change = [&](const ContactList& list, auto&& apply) {
            for (int a = 0; a < list.touching_count; ++a) {
                const ContactForce& all = at(list.contact_forces.all, a);
                const real share = all.couple[3];
                if (share == 0) continue;
                const Row more = row(share / (1 + share) * (dt_before / problem_.dt - 1));
                apply(at(list.touching, a), all.force * more, all.couple * more);
            }
        };
        const auto accelerate = [&](int i, Row force, Row couple) {
            at(bed_.rates, i).velocity += force * at(bed_.velocity, i)[3];
            at(bed_.rates, i).spin += couple * at(bed_.spin, i)[3];
        };
        change(chunk.pairs, [&](int k, Row force, Row couple) {
            accelerate(at(chunk.pairs.first, k), force, couple);
            accelerate(at(chunk.pairs.second, k), -force, couple);
        });
        change(chunk.walls, [&](int k, Row force, Row couple) {
            accelerate(at(chunk.walls.first, k), force, couple);
            ChunkMotion& motion = at(bed_.chunk_motion, chunk.begin / Bed::chunk_size);
            for (int a = 0; a < 3; ++a) motion.force_on_cavity[a] -= force[a];
        });
    }

    // Half of the impulse on a wall in the last step belongs to the step that has changed; the corrections of
    // first steps are impulses that do not depend on it.
    void change_impulses(Chunk& chunk, real dt_before) {
        const ContactList& list = chunk.walls;
        for (int a = 0; a < list.touching_count; ++a) {
            const ContactForce& all = at(list.contact_forces.all, a);
            const int k = at(list.touching, a);
            const Row change = all.force * row(0.5 * (problem_.dt - dt_before) / (1 + all.couple[3]));
            WallTotals& of_wall = *totals_of(chunk, list, k, wall);
            of_wall.normal_impulse -= dot(change, wall_point(list, k).normal);
            for (int x = 0; x < 3; ++x) of_wall.impulse[x] -= change[x];
        }
    }

    void add(ForceSums& sums, const ContactForces& contact_forces, int a, int i, real sign,
             const ContactLaws& laws) {
        const ContactForce& contact_force = at(contact_forces.all, a);
        ContactForce& sum = sums.of(i);
        sum.force += row(sign, sign, sign, 1) * contact_force.force;
        sum.couple += contact_force.couple;
        if (laws.rolls) sums.torque(i) += row(sign) * at(contact_forces.torque, a);
    }

public:
    ContactLoop(Bed& bed, const Problem& problem, const ContactLaws& pair, const ContactLaws& wall)
        : bed_(bed), problem_(problem), pair_(pair), wall_(wall) {
        for (const Wall& w : bed.cavity->walls) curved_ |= w.form == Wall::cylinder || w.form == Wall::sphere;
        for (const int e : bed.cavity->particle_pair) pair_mu_.push_back(at(problem.pair_laws, e).friction());
        for (const int e : bed.cavity->wall_pair) wall_mu_.push_back(at(problem.pair_laws, e).friction());
    }

    // Adapts the laws to the time step of the problem.
    void update_step() {
        for (ContactLaws* laws : {&pair_, &wall_}) set_step(*laws, problem_);
    }

    // Adapts the contacts of a chunk to a change of the step from `dt_before`. The bed is in its state at the
    // last step; `has_forces` is whether the forces of this step are stored.
    void change_step(Chunk& chunk, real dt_before, bool has_forces) {
        if (has_forces) change_first_steps(chunk, dt_before);
        const auto change = [&](ContactList& list, const auto& view, const ContactLaws& laws,
                                Partner partner) {
            with_laws(laws, [&](const auto& law, auto rough, auto rolls) {
                dem::change_step<rough.value, rolls.value>(law, list, view, laws, dt_before, partner,
                                                           chunk.diagnostics);
            });
        };
        with_pairs(chunk.pairs, [&](const auto& view) { change(chunk.pairs, view, pair_, particle); });
        find_wall_points(chunk.walls, bed_, chunk.begin, false, [](int, int) {});
        change(chunk.walls, wall_view(chunk), wall_, wall);
        if (has_forces && !chunk.each_wall.empty()) change_impulses(chunk, dt_before);
    }

    bool has_friction() const { return pair_.rough || wall_.rough; }
    bool has_rolling() const { return pair_.rolls || wall_.rolls; }

    // Computes the forces of the pairs that belong to the chunk. Writes only to the chunk.
    void pair_forces(const NeighbourList& neighbours, Chunk& chunk, bool sampled, const Prefetch& prefetch) {
        const int own = chunk.begin / Bed::chunk_size, last = chunk.highest_neighbour / Bed::chunk_size;
        // A pair may approach by what its own chunk has moved and what the most mobile of its neighbours'
        // chunks has.
        real others = 0;
        for (int c = own; c <= last; ++c) others = larger(others, at(bed_.chunk_motion, c).moved);
        const real moved = at(bed_.chunk_motion, own).moved + others;
        ContactList& pairs = chunk.pairs;
        pairs.approach += moved, ++pairs.steps_since_scan, ++pairs.steps;
        chunk.approach += moved;
        if (pairs.is_stale()) neighbours.scan_pairs(bed_, chunk), ++chunk.diagnostics.scans;
        with_pairs(pairs, [&](const auto& view) {
            compute(pairs, view, pair_, particle, sampled, chunk, prefetch);
        });
    }

    // Computes the forces of the walls on the particles of the chunk.
    void wall_forces(const NeighbourList& neighbours, Chunk& chunk, bool sampled) {
        chunk.walls.approach +=
            at(bed_.chunk_motion, chunk.begin / Bed::chunk_size).moved + bed_.cavity_moved;
        ++chunk.walls.steps_since_scan, ++chunk.walls.steps;
        if (chunk.walls.is_stale()) neighbours.scan_walls(bed_, chunk);
        find_wall_points(chunk.walls, bed_, chunk.begin, true,
                         [&](int from, int to) { change_wall(chunk.walls, from, to); });
        compute(chunk.walls, wall_view(chunk), wall_, wall, sampled, chunk, Prefetch());
        // The reaction on the cavity. Its moment is a result, computed for samples, unless a drive turns the
        // cavity against it.
        const bool needs_moment = sampled || bed_.frame.turns();
        Row total{}, moment{};
        const ContactList& list = chunk.walls;
        for (int a = 0; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            const Row f = at(list.contact_forces.all, a).force;
            total -= f;
            WallTotals* const of_wall = totals_of(chunk, list, k, wall);
            if (!needs_moment && !of_wall) continue;
            const WallPoint near = wall_point(list, k);
            if (of_wall) {
                of_wall->normal_impulse -= problem_.dt * dot(f, near.normal);
                for (int x = 0; x < 3; ++x) of_wall->impulse[x] -= problem_.dt * f[x];
            }
            if (!needs_moment) continue;
            const Row turn = cross(place(list, k) + near.normal * near.distance, f),
                      twist = wall_.rolls ? at(list.contact_forces.torque, a) : Row{};
            moment -= turn;
            if (wall_.rolls) moment -= twist;
            if (sampled && of_wall) {
                of_wall->normal_force -= dot(f, near.normal);
                for (int x = 0; x < 3; ++x)
                    of_wall->force[x] -= f[x], of_wall->moment[x] -= turn[x] + twist[x];
            }
        }
        ChunkMotion& motion = at(bed_.chunk_motion, chunk.begin / Bed::chunk_size);
        for (int a = 0; a < 3; ++a) motion.force_on_cavity[a] = total[a];
        chunk.diagnostics.wall_moment = moment;
    }

    // Adds the forces of contacts of a lower chunk on the particles from `first` to `until`.
    void add_incoming(ForceSums& sums, const Chunk& owner, int first, int until) {
        const ContactList& pairs = owner.pairs;
        for (int a = 0; a < pairs.touching_count; ++a)
            if (const int j = at(pairs.second, at(pairs.touching, a)); j >= first && j < until)
                add(sums, pairs.contact_forces, a, j, -1, pair_);
    }

    // Adds the forces of the contacts of the chunk on particles below `until`.
    void add_own(ForceSums& sums, const Chunk& chunk, int until) {
        const ContactList &pairs = chunk.pairs, &walls = chunk.walls;
        for (int a = 0; a < pairs.touching_count; ++a) {
            const int k = at(pairs.touching, a), j = at(pairs.second, k);
            add(sums, pairs.contact_forces, a, at(pairs.first, k), 1, pair_);
            if (j < until) add(sums, pairs.contact_forces, a, j, -1, pair_);
        }
        for (int a = 0; a < walls.touching_count; ++a)
            add(sums, walls.contact_forces, a, at(walls.first, at(walls.touching, a)), 1, wall_);
    }
};

} // namespace rattlebox::dem
