// Velocity Verlet for the particles of a chunk.
//
// Forces that depend on the velocity take the one predicted from the last acceleration, v + dt a, which keeps
// the second order:  v' = u + dt/2 (a' - a),  u' = v' + dt a',  x' = x + dt v' + dt^2/2 a',  u predicted, a
// the last. Rows carry a fourth number along, which stays as it is.
#pragma once

#include "dem/partition.hpp"
#include "dem/prefetch.hpp"

namespace rattlebox::dem {

struct Verlet {
    Row back, step, half;
    Row body, body_before; // acceleration of what touches nothing, in this step and in the one before

    // The first step has none before.
    Verlet(real dt, Row body, Row body_before, bool first)
        : back(row(first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt)), step(row(dt, dt, dt)),
          half(row(0.5 * dt, 0.5 * dt, 0.5 * dt)), body(body), body_before(body_before) {}

    Row now(Row predicted, Row a, Row before) const { return predicted + back * (a - before); }
    Row next(Row v, Row a) const { return v + step * a; }
    Row middle(Row v, Row a) const { return v + half * a; }
    Row moved(Row x, Row middle) const { return x + step * middle; }
};

class Integrator {
    Bed& bed_;
    real dt_;
    bool spins_, rolls_; // whether spins change, and whether contacts resist rolling
    bool far_;           // the bed exceeds the caches

    real twice_rotation_energy(int i) const {
        const Row w = at(bed_.spin, i);
        return dot(w, w) * at(bed_.position, i)[3] / w[3];
    }

    // Corrects velocities to this step, and predicts the next one. `body` accelerates all particles alike,
    // `body_before` did in the last step; the first step has no last one. The range ends at particle `until`.
    template <bool sampled, bool far>
    void advance(ForceSums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first) {
        Tally& tally = chunk.tally;
        const bool spins = spins_, rolls = rolls_;
        const Verlet step(dt_, body, body_before, first);
        const Row evenly = step.now(Row{}, body, body_before), reference = bed_.reference;
        Row momentum{}, mass_moment{};
        real drift = 0, kinetic = 0, rotation = 0;
        // Where the rows are is looked up once: what is written to `touched` might be anything to a compiler.
        Row *const position = bed_.position.data(), *const velocity = bed_.velocity.data(),
                   *const spin = bed_.spin.data();
        Rates* const rates = bed_.rates.data();
        char* const marks = bed_.touched.data();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            if constexpr (far) Prefetch::for_particle(bed_, i, until);
            Row &x = position[i], &u = velocity[i];
            char& touched = marks[i];
            ContactForce& sum = sums.of(i);
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
                    rotation += twice_rotation_energy(i);
                }
                touched = now;
                if (now) sum = ContactForce{};
            } else if constexpr (sampled) {
                rotation += twice_rotation_energy(i);
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
        ChunkMotion& motion = at(bed_.chunk_motion, chunk.begin / Bed::chunk_size);
        const bool continues = chunk.stopped.status == Status::finished;
        motion.moved = continues ? dt_ * std::sqrt(drift) * (1 + 1e-9) : infinity;
        motion.approached = chunk.approached;
        for (int a = 0; a < 3; ++a) motion.momentum[a] = momentum[a];
        if constexpr (sampled) {
            tally.kinetic = 0.5 * kinetic;
            tally.rotation = 0.5 * rotation;
            tally.mass_moment = mass_moment;
        }
    }

public:
    Integrator(Bed& bed, real dt, bool spins, bool rolls)
        : bed_(bed), dt_(dt), spins_(spins), rolls_(rolls), far_(bed.particles() > Bed::cached) {}

    bool is_far() const { return far_; }

    void advance(ForceSums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first,
                 bool sampled) {
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
};

} // namespace rattlebox::dem
