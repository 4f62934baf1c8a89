// One step of the particles of one cavity, chunk by chunk.
//
// Velocity Verlet. Forces that depend on the velocity take the one predicted from the last acceleration, v +
// dt a, which keeps the second order:  v' = u + dt/2 (a' - a),  u' = v' + dt a',  x' = x + dt v' + dt^2/2 a',
// u predicted, a the last. A particle adds up the forces on it in the order of its contacts, whoever does it.
//
// Contacts belong to the lower of their partners, and their forces read no lower ones: in ascending order a
// chunk can move on as soon as its own forces are known, while all it needs is near.
#pragma once

#include "dem/forces.hpp"
#include "dem/neighbours.hpp"

namespace rattlebox::dem {

class BedStep {
    static constexpr char touched_before = 1, touched_now = 2;

    Bed& bed_;
    const Problem& problem_;
    Kind pair_, wall_;
    bool curved_ = false;
    bool far_; // particles and contacts are more than caches hold

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

    void settle(Contacts& list, int k, Partner partner, Tally& tally) const {
        tally.plastic[partner] += dem::settle(at(list.dent, at(list.slot, k)), touch(list, k, partner));
    }

    template <class View>
    void visit(Contacts& list, const View& view, int candidates, std::vector<int>& slot_of, const Kind& kind,
               Partner partner, bool sampled, Chunk& chunk) {
        Tally& tally = chunk.tally;
        const auto begun = [&](int k) {
            const int s = list.take();
            at(list.slot, k) = at(slot_of, at(list.origin, k)) = s;
            const Touch t = touch(list, k, partner);
            const Begun b = begin(t, problem_.dt);
            list.begin(s, b);
            if (b.late.share != 0) chunk.late.push_back({s, b.late});
            if (b.lost != 0) tally.normal[partner] += first_lane(b.lost);
            ++tally.first_touches[partner];
            tally.extrapolated += b.extrapolated;
            tally.fastest = std::fmax(tally.fastest, t.speed);
            if (b.outside && chunk.stopped.status == Status::finished)
                chunk.stopped = {Status::law_domain, at(list.first, k), -1, t.speed};
        };
        const auto ended = [&](int k) {
            const int s = at(list.slot, k);
            if (list.dents && at(list.dent, s)[3] != at(list.dent, s)[0]) settle(list, k, partner, tally);
            // What the springs still hold is lost.
            if (kind.rough) tally.sliding[partner] += first_lane(held(at(list.kept, s).friction));
            if (kind.rolls) tally.rolling[partner] += first_lane(held(at(list.rolling, s).spring));
            list.free.push_back(s);
            at(list.slot, k) = at(slot_of, at(list.origin, k)) = Contacts::none;
        };
        chunk.late.clear();
        find_touching(list, view, candidates, begun, ended);
        if (list.actives == 0) return;
        const auto with_law = [&](auto law) {
            using Law = decltype(law);
            const auto settled = [&](int k) { settle(list, k, partner, tally); };
            if (kind.rolls)
                collide<Law, true, true>(list, view, kind.how, sampled, partner, tally, settled);
            else if (kind.rough)
                collide<Law, true, false>(list, view, kind.how, sampled, partner, tally, settled);
            else
                collide<Law, false, false>(list, view, kind.how, sampled, partner, tally, settled);
        };
        if (kind.normal == Kind::hertz)
            with_law(HertzStep{});
        else if (kind.normal == Kind::linear)
            with_law(LinearStep{});
        else
            with_law(PlasticStep{});
        for (const auto& [slot, late] : chunk.late) {
            Kept& kept = at(list.kept, slot);
            if (kind.rough)
                tally.sliding[partner] += first_lane(-late.share * problem_.dt * dot(kept.force, late.slip));
            kept.force *= row(1 + late.share);
            kept.couple *= row(1 + late.share, 1 + late.share, 1 + late.share, 1);
        }
    }

    void add(const Contacts& list, int s, int i, real sign, const Kind& kind) {
        const Row both = row(sign);
        at(bed_.touched, i) |= touched_now;
        at(bed_.force, i) += both * at(list.kept, s).force;
        if (kind.rough) at(bed_.couple, i) += at(list.kept, s).couple;
        if (kind.rolls) at(bed_.roll, i) += both * at(list.rolling, s).torque;
    }

public:
    BedStep(Bed& bed, const Problem& problem, const Kind& pair, const Kind& wall)
        : bed_(bed), problem_(problem), pair_(pair), wall_(wall), far_(bed.particles() > 20'000) {
        for (const Wall& w : bed.cavity->walls) curved_ |= w.form != Wall::plane;
    }

    // Asks memory for what the chunk after this will need, and for the lists of the one after that. Inlined:
    // compilers take a call that only asks for one without effect.
    RATTLEBOX_INLINE void fetch(const Chunk& next, const Chunk& later) const {
        if (!far_) return;
        const auto fetch = [](const auto& what)
                               __attribute__((always_inline)) { __builtin_prefetch(&what, 1, 2); };
        const auto lines = [&](const auto& values) __attribute__((always_inline)) {
            for (std::size_t i = 0; i < values.size(); i += 64 / sizeof(values[0])) fetch(values[i]);
        };
        const Contacts &list = next.pairs, &then = later.pairs;
        lines(then.first), lines(then.second), lines(then.slot), lines(then.active);
        for (int k = 0; k < list.size(); ++k) {
            const int j = at(list.second, k), s = at(list.slot, k);
            fetch(at(bed_.position, j));
            if (s < 0) continue;
            for (const auto* rows : {&bed_.velocity, &bed_.spin, &bed_.force, &bed_.couple})
                fetch(at(*rows, j));
            fetch(at(list.kept, s)), fetch(at(list.kept, s).friction);
        }
        for (int i = next.begin; i < next.end; i += 2)
            fetch(at(bed_.acceleration, i)), fetch(at(bed_.spin_rate, i));
    }

    // Forces of all contacts that the chunk owns, and of its particles at the walls.
    void forces(Chunk& chunk, bool sampled) {
        // Those of tier t were at least t / tiers of the skin apart.
        const real closed = 2 * bed_.since_scan / bed_.skin * Contacts::tiers * (1 + 1e-9);
        const int tier = std::min(static_cast<int>(closed), Contacts::tiers - 1);
        visit(chunk.pairs, PairView{bed_, chunk.pairs}, chunk.pairs.tier_end[tier], chunk.near_slot, pair_,
              particle, sampled, chunk);
        visit(chunk.walls, WallView{bed_, chunk.walls, curved_}, chunk.walls.size(), chunk.wall_slot, wall_,
              wall, sampled, chunk);
        Row total{}, moment{};
        const Contacts& list = chunk.walls;
        for (int a = 0; a < list.actives; ++a) {
            const int k = at(list.active, a), s = at(list.slot, k), i = at(list.first, k);
            const Row f = at(list.kept, s).force;
            total -= f;
            if (sampled) {
                const Row place = at(bed_.position, i) - bed_.motion.displacement;
                const Near near = nearest(at(bed_.cavity->walls, at(list.second, k)), place);
                moment -= cross(place + near.normal * near.distance, f);
                if (wall_.rolls) moment -= at(list.rolling, s).torque;
            }
        }
        chunk.tally.wall_force = total;
        chunk.tally.wall_moment = moment;
    }

    // Adds the force of a candidate that a lower chunk owns on its second partner, if it touches.
    void add_incoming(const Contacts& list, int k) {
        const int s = at(list.slot, k);
        if (s >= 0) add(list, s, at(list.second, k), -1, pair_);
    }

    // Adds the forces of contacts that the chunk owns, on particles below `to`.
    void add_own(const Chunk& chunk, int to) {
        const Contacts &pairs = chunk.pairs, &walls = chunk.walls;
        for (int a = 0; a < pairs.actives; ++a) {
            const int k = at(pairs.active, a), s = at(pairs.slot, k), j = at(pairs.second, k);
            add(pairs, s, at(pairs.first, k), 1, pair_);
            if (j < to) add(pairs, s, j, -1, pair_);
        }
        for (int a = 0; a < walls.actives; ++a) {
            const int k = at(walls.active, a);
            add(walls, at(walls.slot, k), at(walls.first, k), 1, wall_);
        }
    }

    real turning(int i) const { // twice the energy of spin
        const Row w = at(bed_.spin, i);
        return dot(w, w) * at(bed_.position, i)[3] / w[3];
    }

    // Velocities at this step, and on to the next. `body` is what accelerates all alike, `body_before` in the
    // step before; displacements are counted from those that `reference` makes; the first step has no step
    // before.
    template <bool sampled> void advance(Chunk& chunk, Row body, Row body_before, Row reference, bool first) {
        Tally& tally = chunk.tally;
        const bool spins = pair_.rough || wall_.rough, rolls = pair_.rolls || wall_.rolls;
        const real dt = problem_.dt, h = 0.5 * dt, ever = first ? 0 : h;
        const Row back = row(ever, ever, ever), step = row(dt, dt, dt), half = row(h, h, h),
                  space = row(1, 1, 1);
        const Row evenly = back * (body - body_before);
        Row momentum{}, mass_moment{};
        real drift = 0, kinetic = 0, rotation = 0;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            Row &x = at(bed_.position, i), &u = at(bed_.velocity, i);
            char& touched = at(bed_.touched, i);
            Row a = body, v = u + evenly;
            if (touched) {
                const bool before = touched & touched_before, now = touched & touched_now;
                if (now) {
                    a = at(bed_.force, i) * u[3] + body;
                    at(bed_.force, i) = Row{};
                }
                v = u + back * (a - (before ? at(bed_.acceleration, i) : body_before));
                at(bed_.acceleration, i) = a;
                if (spins) {
                    Row &w = at(bed_.spin, i), rate = Row{},
                        rate_before = before ? at(bed_.spin_rate, i) : Row{};
                    if (now) {
                        rate = at(bed_.couple, i);
                        at(bed_.couple, i) = Row{};
                        if (rolls) {
                            rate += at(bed_.roll, i) / x[3];
                            at(bed_.roll, i) = Row{};
                        }
                        rate *= w[3];
                    }
                    w += back * (rate - rate_before);
                    if constexpr (sampled) rotation += dot(w, w) * x[3] / w[3];
                    w += step * rate;
                    at(bed_.spin_rate, i) = rate;
                } else if constexpr (sampled) {
                    rotation += turning(i);
                }
                touched = now ? touched_before : 0;
            } else if constexpr (sampled) {
                rotation += turning(i);
            }
            const Row middle = v + half * a, weighed = v / u[3];
            momentum += weighed;
            if constexpr (sampled) {
                kinetic += dot(v, weighed);
                mass_moment += x * space / u[3];
            }
            x += step * middle;
            u = v + step * a;
            const Row moved = middle - reference;
            const real speed = dot(moved, moved);
            drift = drift > speed ? drift : speed;
        }
        tally.momentum = momentum;
        tally.drift = drift;
        if constexpr (sampled) {
            tally.kinetic = 0.5 * kinetic;
            tally.rotation = 0.5 * rotation;
            tally.mass_moment = mass_moment;
        }
    }
};

} // namespace rattlebox::dem
