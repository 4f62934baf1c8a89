// One step of the particles of one cavity, chunk by chunk.
//
// Velocity Verlet (verlet.hpp). A particle adds up the forces on it in the order of its contacts, whoever
// does it.
//
// Contacts belong to the lower of their partners, and their forces read no lower ones: in ascending order a
// chunk can move on as soon as its own forces are known, while all it needs is near.
#pragma once

#include "dem/ahead.hpp"
#include "dem/division.hpp"
#include "dem/forces.hpp"
#include "dem/neighbours.hpp"
#include "dem/verlet.hpp"

namespace rattlebox::dem {

class BedStep {
    Bed& bed_;
    const Problem& problem_;
    Kind pair_, wall_;
    std::vector<real> pair_mu_, wall_mu_; // by kinds
    bool curved_ = false;
    bool far_;

    const Encounter& between(int i, int j) const {
        const Cavity& c = *bed_.cavity;
        return at(problem_.encounters, at(c.particle_entry, at(bed_.kind, i) * c.kinds + at(bed_.kind, j)));
    }
    const Encounter& with_wall(int i, int w) const {
        const Cavity& c = *bed_.cavity;
        return at(problem_.encounters,
                  at(c.wall_entry, at(bed_.kind, i) * c.wall_kinds + at(c.walls, w).kind));
    }
    Body body(int i) const { return {at(bed_.position, i), at(bed_.velocity, i), at(bed_.spin, i)}; }

    Touch touch(const Contacts& list, int k, Partner partner) const {
        const int i = at(list.first, k), j = at(list.second, k);
        const Body a = body(i);
        if (partner == particle) return dem::touch(between(i, j), a, body(j));
        const Near near = nearest(at(bed_.cavity->walls, j), a.place - bed_.motion.displacement);
        real mobility = a.velocity[3];
        for (const Row& shape : bed_.cavity->shape) mobility += square(dot(shape, near.normal));
        return dem::touch(with_wall(i, j), a, near, bed_.motion.velocity, mobility);
    }

    void settle(Contacts& list, int k, const Kind& kind, Partner partner, Tally& tally) const {
        const int s = at(list.slot, k);
        const real cost = dem::settle(at(list.memory.dent, s), touch(list, k, partner));
        tally.plastic[partner] += cost;
        if (static_cast<real>(list.steps) - at(list.memory.since, s) > kind.enduring)
            tally.enduring[partner] += first_lane(cost);
    }

    template <class View>
    void visit(Contacts& list, const View& view, const Kind& kind, Partner partner, bool sampled,
               Chunk& chunk, const Ahead& ahead) {
        Tally& tally = chunk.tally;
        const auto begun = [&](int k) {
            const Touch t = touch(list, k, partner);
            const Begun b = begin(t, problem_.dt);
            at(list.slot, k) = list.memory.begin(b, static_cast<real>(list.steps));
            if (b.late.share != 0) chunk.late.push_back({k, b.late});
            if (b.lost != 0) tally.normal[partner] += first_lane(b.lost);
            ++tally.first_touches[partner];
            tally.extrapolated += b.extrapolated;
            tally.fastest = std::fmax(tally.fastest, t.speed);
            if (b.status != Status::finished && chunk.stopped.status == Status::finished)
                chunk.stopped = {b.status, at(list.first, k), -1, t.speed};
        };
        const auto ended = [&](int k) {
            const int s = at(list.slot, k);
            if (list.memory.dents && at(list.memory.dent, s)[3] != at(list.memory.dent, s)[0])
                settle(list, k, kind, partner, tally);
            // What the springs still hold is lost.
            if (kind.rough)
                tally.sliding[partner] += first_lane(spring_energy(at(list.memory.kept, s).friction));
            if (kind.rolls)
                tally.rolling[partner] += first_lane(spring_energy(at(list.memory.rolling, s).spring));
            list.memory.free.push_back(s);
            at(list.slot, k) = Contacts::none;
        };
        chunk.late.clear();
        find_touching(list, view, begun, ended, ahead);
        ahead.rest(list.size(), list.actives);
        if (list.actives == 0) return list.actions.all.clear();
        kind.normal.visit([&](const auto& law) {
            const auto settled = [&](int k) { settle(list, k, kind, partner, tally); };
            const auto compute = [&](auto rough, auto rolls) {
                collide<rough.value, rolls.value>(law, list, view, kind, sampled, partner, tally, settled,
                                                  ahead);
            };
            constexpr std::true_type yes;
            constexpr std::false_type no;
            kind.rolls ? compute(yes, yes) : kind.rough ? compute(yes, no) : compute(no, no);
        });
        for (const auto& [k, late] : chunk.late) {
            const auto touching = list.active.begin();
            const auto a = std::lower_bound(touching, touching + list.actives, k) - touching;
            Action& action = at(list.actions.all, static_cast<int>(a));
            if (kind.rough)
                tally.sliding[partner] +=
                    first_lane(-late.share * problem_.dt * dot(action.force, late.slip));
            action.force *= row(1 + late.share);
            action.couple *= row(1 + late.share);
        }
    }

    void add(Sums& sums, const Actions& actions, int a, int i, real sign, const Kind& kind) {
        const Action& action = at(actions.all, a);
        Action& sum = sums.of(i);
        sum.force += row(sign, sign, sign, 1) * action.force;
        sum.couple += action.couple;
        if (kind.rolls) sums.torque(i) += row(sign) * at(actions.torque, a);
    }

public:
    BedStep(Bed& bed, const Problem& problem, const Kind& pair, const Kind& wall)
        : bed_(bed), problem_(problem), pair_(pair), wall_(wall), far_(bed.particles() > Bed::cached) {
        for (const Wall& w : bed.cavity->walls) curved_ |= w.form != Wall::plane;
        for (const int e : bed.cavity->particle_entry)
            pair_mu_.push_back(at(problem.encounters, e).friction());
        for (const int e : bed.cavity->wall_entry) wall_mu_.push_back(at(problem.encounters, e).friction());
    }

    // Particles and contacts are more than caches hold.
    bool is_far() const { return far_; }

    // Forces of all pairs that touch and of which the chunk owns the first: of them it reads particles, and
    // what it writes is the chunk's alone.
    void pair_forces(const Neighbours& neighbours, Chunk& chunk, bool sampled, const Ahead& ahead) {
        const int own = chunk.begin / Bed::chunk_size, last = chunk.highest / Bed::chunk_size;
        real others = 0;
        for (int c = own; c <= last; ++c) others = larger(others, at(bed_.briefs, c).moved);
        const real moved = at(bed_.briefs, own).moved + others;
        Contacts& pairs = chunk.pairs;
        pairs.since += moved, ++pairs.age, ++pairs.steps;
        chunk.closed += moved;
        if (pairs.is_stale()) neighbours.scan_pairs(bed_, chunk), ++chunk.tally.scans;
        visit(pairs, PairView{bed_, pairs, pair_mu_}, pair_, particle, sampled, chunk, ahead);
    }

    // Forces on the chunk's particles at the walls.
    void wall_forces(const Neighbours& neighbours, Chunk& chunk, bool sampled) {
        chunk.walls.since += at(bed_.briefs, chunk.begin / Bed::chunk_size).moved + bed_.apart;
        ++chunk.walls.age, ++chunk.walls.steps;
        if (chunk.walls.is_stale()) neighbours.scan_walls(bed_, chunk);
        visit(chunk.walls, WallView{bed_, chunk.walls, wall_mu_, curved_}, wall_, wall, sampled, chunk,
              Ahead());
        Row total{}, moment{};
        const Contacts& list = chunk.walls;
        for (int a = 0; a < list.actives; ++a) {
            const int k = at(list.active, a), i = at(list.first, k);
            const Row f = at(list.actions.all, a).force;
            total -= f;
            if (sampled) {
                const Row place = at(bed_.position, i) - bed_.motion.displacement;
                const Near near = nearest(at(bed_.cavity->walls, at(list.second, k)), place);
                moment -= cross(place + near.normal * near.distance, f);
                if (wall_.rolls) moment -= at(list.actions.torque, a);
            }
        }
        Brief& brief = at(bed_.briefs, chunk.begin / Bed::chunk_size);
        for (int a = 0; a < 3; ++a) brief.push[a] = total[a];
        chunk.tally.wall_moment = moment;
    }

    // Adds the forces of contacts that a lower chunk owns, on particles from `first` to `until`.
    void add_incoming(Sums& sums, const Chunk& lower, int first, int until) {
        const Contacts& pairs = lower.pairs;
        for (int a = 0; a < pairs.actives; ++a)
            if (const int j = at(pairs.second, at(pairs.active, a)); j >= first && j < until)
                add(sums, pairs.actions, a, j, -1, pair_);
    }

    // Adds the forces of contacts that the chunk owns, on particles below `until`.
    void add_own(Sums& sums, const Chunk& chunk, int until) {
        const Contacts &pairs = chunk.pairs, &walls = chunk.walls;
        for (int a = 0; a < pairs.actives; ++a) {
            const int k = at(pairs.active, a), j = at(pairs.second, k);
            add(sums, pairs.actions, a, at(pairs.first, k), 1, pair_);
            if (j < until) add(sums, pairs.actions, a, j, -1, pair_);
        }
        for (int a = 0; a < walls.actives; ++a)
            add(sums, walls.actions, a, at(walls.first, at(walls.active, a)), 1, wall_);
    }

    void advance(Sums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first, bool sampled) {
        const auto with = [&](auto sampled, auto far) {
            advance<sampled.value, far.value>(sums, chunk, until, body, body_before, first);
        };
        constexpr std::true_type yes;
        constexpr std::false_type no;
        if (far_)
            sampled ? with(yes, yes) : with(no, yes);
        else
            sampled ? with(yes, no) : with(no, no);
    }

    real turning(int i) const { // twice the energy of spin
        const Row w = at(bed_.spin, i);
        return dot(w, w) * at(bed_.position, i)[3] / w[3];
    }

    // Velocities at this step, and on to the next. `body` is what accelerates all alike, `body_before` in the
    // step before; the first step has none before. The part ends at particle `until`.
    template <bool sampled, bool far>
    void advance(Sums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first) {
        Tally& tally = chunk.tally;
        const bool spins = pair_.rough || wall_.rough, rolls = pair_.rolls || wall_.rolls;
        const Verlet step(problem_.dt, body, body_before, first);
        const Row evenly = step.now(Row{}, body, body_before), reference = bed_.reference;
        Row momentum{}, mass_moment{};
        real drift = 0, kinetic = 0, rotation = 0;
        // Where the rows are is looked up once: what is written to `touched` might be anything to a compiler.
        Row *const position = bed_.position.data(), *const velocity = bed_.velocity.data(),
                   *const spin = bed_.spin.data();
        Rates* const rates = bed_.rates.data();
        char* const marks = bed_.touched.data();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            if constexpr (far) Ahead::moving(bed_, i, until);
            Row &x = position[i], &u = velocity[i];
            char& touched = marks[i];
            Action& sum = sums.of(i);
            Row a = body, v = u + evenly;
            const bool before = touched, now = sum.force[3] > 0;
            if (before || now) {
                if (now) a = sum.force * u[3] + body;
                v = step.now(u, a, before ? rates[i].velocity : body_before);
                rates[i].velocity = a;
                if (spins) {
                    Row &w = spin[i], rate = Row{}, rate_before = before ? rates[i].spin : Row{};
                    if (now) {
                        rate = sum.couple;
                        if (rolls) {
                            rate += sums.torque(i) / x[3];
                            sums.torque(i) = Row{};
                        }
                        rate *= w[3];
                    }
                    w = step.now(w, rate, rate_before);
                    if constexpr (sampled) rotation += dot(w, w) * x[3] / w[3];
                    w = step.next(w, rate);
                    rates[i].spin = rate;
                } else if constexpr (sampled) {
                    rotation += turning(i);
                }
                touched = now;
                if (now) sum = Action{};
            } else if constexpr (sampled) {
                rotation += turning(i);
            }
            const Row middle = step.middle(v, a), weighed = v / u[3];
            momentum += weighed;
            if constexpr (sampled) {
                kinetic += dot(v, weighed);
                mass_moment += x / u[3];
            }
            x = step.moved(x, middle);
            u = step.next(v, a);
            const Row moved = middle - reference;
            const real speed = dot(moved, moved);
            drift = drift > speed ? drift : speed;
        }
        Brief& brief = at(bed_.briefs, chunk.begin / Bed::chunk_size);
        const bool goes_on = chunk.stopped.status == Status::finished;
        brief.moved = goes_on ? problem_.dt * std::sqrt(drift) * (1 + 1e-9) : infinity;
        brief.closed = chunk.closed;
        for (int a = 0; a < 3; ++a) brief.momentum[a] = momentum[a];
        if constexpr (sampled) {
            tally.kinetic = 0.5 * kinetic;
            tally.rotation = 0.5 * rotation;
            tally.mass_moment = mass_moment;
        }
    }
};

} // namespace rattlebox::dem
