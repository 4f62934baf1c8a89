// Velocity-Verlet integration of the particles of a chunk.
//
//     v  = u + dt/2 (a - a_0)        u' = v + dt a        x' = x + dt v + dt^2/2 a
//
// Forces that depend on the velocity are computed from u = v_0 + dt a_0, predicted with the last acceleration
// a_0, which keeps second order. The fourth number of a row is not changed.
//
// W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76 (1982) 637,
// doi:10.1063/1.442716.
#pragma once

#include <bit>
#include <cstdint>

#include "dem/partition.hpp"
#include "dem/prefetch.hpp"

namespace rattlebox::dem {

struct Verlet {
    Row back, step, half;
    Row body, body_before; // acceleration without contacts, in this step and the previous one

    // In the first step there is no previous acceleration.
    Verlet(real dt, Row body, Row body_before, bool first)
        : back(row(first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt)), step(row(dt, dt, dt)),
          half(row(0.5 * dt, 0.5 * dt, 0.5 * dt)), body(body), body_before(body_before) {}

    Row corrected(Row prediction, Row a, Row before) const { return prediction + back * (a - before); }
    Row predicted(Row v, Row a) const { return v + step * a; }
    Row half_step(Row v, Row a) const { return v + half * a; }
    Row drifted(Row x, Row middle) const { return x + step * middle; }
};

// Whether contacts act on a particle. Their number is compared as an integer, which costs less.
RATTLEBOX_INLINE bool has_contact(const ContactForce& sum) {
    return std::bit_cast<std::int64_t>(sum.force[3]) != 0;
}

class Integrator {
    Bed& bed_;
    const Problem& problem_;
    bool spins_, rolls_; // whether contacts have friction, and rolling resistance
    bool far_;           // whether the bed exceeds the caches

    real moved_in_step(real max_speed_squared) const {
        return problem_.dt * std::sqrt(max_speed_squared) * (1 + 1e-9);
    }

    real twice_rotation_energy(int i) const {
        const Row w = at(bed_.spin, i);
        return dot(w, w) * at(bed_.position, i)[3] / w[3];
    }

    // Corrects the velocities of this step and predicts those of the next one. `body` is the acceleration
    // without contacts, `body_before` that of the previous step. The range of the worker ends at particle
    // `until`.
    template <bool sampled, bool far>
    void advance(ForceSums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first) {
        Diagnostics& diagnostics = chunk.diagnostics;
        const bool spins = spins_, rolls = rolls_;
        const Verlet step(problem_.dt, body, body_before, first);
        const Row evenly = step.corrected(Row{}, body, body_before),
                  reference_velocity = bed_.reference_velocity;
        Row momentum{}, mass_moment{};
        real max_speed_squared = 0, kinetic = 0, rotation = 0;
        // Pointers are loaded once: a compiler must assume that writes through the char pointer change them.
        Row *const position = bed_.position.data(), *const velocity = bed_.velocity.data(),
                   *const spin = bed_.spin.data();
        Rates* const rates = bed_.rates.data();
        char* const marks = bed_.touched.data();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            if constexpr (far) Prefetch::for_particle(bed_, i, until);
            Row &x = position[i], &u = velocity[i];
            char& touched = marks[i];
            ContactForce& sum = sums.of(i);
            // A particle without contact, in this step and in the last one, moves freely: it needs neither
            // its stored acceleration nor its spin.
            Row a = body, v = u + evenly;
            const bool before = touched, now = has_contact(sum);
            if (before | now) {
                if (now) a = sum.force * u[3] + body;
                // Velocity Verlet with the velocity predicted from the last acceleration, since forces depend
                // on velocities; it is corrected with the present one.
                v = step.corrected(u, a, before ? rates[i].velocity : body_before);
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
                    w = step.corrected(w, rate, rate_before);
                    if constexpr (sampled) rotation += dot(w, w) * x[3] / w[3];
                    w = step.predicted(w, rate);
                    rates[i].spin = rate;
                } else if constexpr (sampled) {
                    rotation += twice_rotation_energy(i);
                }
                touched = now;
                if (now) sum = ContactForce{};
            } else if constexpr (sampled) {
                rotation += twice_rotation_energy(i);
            }
            // The next step is predicted in the same pass, while the particle is in the registers.
            const Row middle = step.half_step(v, a), weighed = v / u[3];
            momentum += weighed;
            if constexpr (sampled) {
                kinetic += dot(v, weighed);
                mass_moment += x / u[3];
            }
            x = step.drifted(x, middle);
            u = step.predicted(v, a);
            // The largest speed relative to the bed bounds how far any particle of the chunk moves, and so
            // how long the lists hold.
            const Row moved = middle - reference_velocity;
            const real speed_squared = dot(moved, moved);
            max_speed_squared = max_speed_squared > speed_squared ? max_speed_squared : speed_squared;
        }
        ChunkMotion& motion = at(bed_.chunk_motion, chunk.begin / Bed::chunk_size);
        const bool continues = chunk.stop_reason.status == Status::finished;
        motion.moved = continues ? moved_in_step(max_speed_squared) : infinity;
        motion.approach = chunk.approach;
        for (int a = 0; a < 3; ++a) motion.momentum[a] = momentum[a];
        if constexpr (sampled) {
            diagnostics.kinetic = 0.5 * kinetic;
            diagnostics.rotation = 0.5 * rotation;
            diagnostics.mass_moment = mass_moment;
        }
    }

public:
    Integrator(Bed& bed, const Problem& problem, bool spins, bool rolls)
        : bed_(bed), problem_(problem), spins_(spins), rolls_(rolls), far_(bed.particles() > Bed::cached) {}

    bool is_far() const { return far_; }

    // Returns the particles of a chunk to the last step, from which the next one was predicted with the step
    // dt and the acceleration `body` without contacts.
    void go_back(const Chunk& chunk, real dt, Row body) {
        const Verlet step(dt, body, body, true);
        for (int i = chunk.begin; i < chunk.end; ++i) {
            Row &x = at(bed_.position, i), &u = at(bed_.velocity, i);
            const bool touched = at(bed_.touched, i);
            const Row a = touched ? at(bed_.rates, i).velocity : body;
            u -= step.step * a;
            x -= step.step * step.half_step(u, a);
            if (touched && spins_) at(bed_.spin, i) -= step.step * at(bed_.rates, i).spin;
        }
    }

    // Predicts the next step of the particles of a chunk from the last one, with another acceleration without
    // contacts.
    void predict(const Chunk& chunk, Row body_before, Row body) {
        const Verlet step(problem_.dt, body, body, true);
        real max_speed_squared = 0;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            Row &x = at(bed_.position, i), &v = at(bed_.velocity, i);
            Rates& rates = at(bed_.rates, i);
            const bool touched = at(bed_.touched, i);
            const Row a = touched ? rates.velocity + (body - body_before) : body,
                      middle = step.half_step(v, a);
            x = step.drifted(x, middle);
            v = step.predicted(v, a);
            if (touched) {
                rates.velocity = a;
                if (spins_) at(bed_.spin, i) += step.step * rates.spin;
            }
            const Row moved = middle - bed_.reference_velocity;
            max_speed_squared = larger(max_speed_squared, dot(moved, moved));
        }
        at(bed_.chunk_motion, chunk.begin / Bed::chunk_size).moved = moved_in_step(max_speed_squared);
    }

    void advance(ForceSums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first,
                 bool sampled) {
        const auto with = [&](auto sampled, auto far) {
            advance<sampled.value, far.value>(sums, chunk, until, body, body_before, first);
        };
        constexpr std::true_type on;
        constexpr std::false_type off;
        if (far_)
            sampled ? with(on, on) : with(off, on);
        else
            sampled ? with(on, off) : with(off, off);
    }
};

} // namespace rattlebox::dem
