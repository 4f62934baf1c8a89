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
    // `until`. Choices that a run never changes are types, since a loop over 100 particles takes 2 % longer
    // if it reads them.
    template <bool sampled, bool far, bool spins, bool rolls>
    void advance(ForceSums& sums, Chunk& chunk, int until, Row body, Row body_before, bool first) {
        Diagnostics& diagnostics = chunk.diagnostics;
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
                if constexpr (spins) {
                    Row &w = spin[i], rate = Row{}, rate_before = before ? rates[i].spin : Row{};
                    if (now) {
                        rate = sum.couple;
                        if constexpr (rolls) {
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

    // The same in a cavity that turns (frame.hpp).
    template <bool sampled> void advance_turning(ForceSums& sums, Chunk& chunk, bool first) {
        const Frame& frame = bed_.frame;
        const FrameStep& now = frame.now;
        const Row body = now.body, body_after = frame.body_ahead(now);
        const Verlet step(problem_.dt, body, frame.body_ahead(frame.before), first);
        // The velocity at the start is given relative to the cavity.
        const real rate = first ? now.speed : now.rate, per_step = 1 / problem_.dt;
        Row momentum{}, mass_moment{};
        real max_speed_squared = 0, kinetic = 0, rotation = 0;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            Row &x = at(bed_.position, i), &u = at(bed_.velocity, i), &w = at(bed_.spin, i);
            Rates& rates = at(bed_.rates, i);
            ContactForce& sum = sums.of(i);
            const bool before = at(bed_.touched, i), had_contact = sum.force[3] > 0;
            const Row r = frame.radius(x);
            const Rates last = before ? rates : Rates{step.body_before, Row{}};
            rates.velocity = body, rates.spin = Row{};
            if (had_contact) {
                rates.velocity += sum.force * u[3];
                if (spins_) rates.spin = sum.couple;
                if (rolls_) {
                    rates.spin += sums.torque(i) / x[3];
                    sums.torque(i) = Row{};
                }
                rates.spin *= w[3];
                sum = ContactForce{};
            }
            at(bed_.touched, i) = had_contact;
            const Row v = step.corrected(u + frame.point_velocity(r, rate), rates.velocity, last.velocity);
            const Row spin = step.corrected(w + frame.axis() * rate, rates.spin, last.spin);
            momentum += v / u[3], mass_moment += x / u[3];
            if constexpr (sampled) {
                kinetic += dot(v, v / u[3]);
                rotation += dot(spin, spin) * x[3] / w[3];
            }
            const auto moved = drift(step, i, r, v, spin, body_after - body);
            const Row velocity = moved * per_step - bed_.reference_velocity;
            max_speed_squared = larger(max_speed_squared, dot(velocity, velocity));
        }
        ChunkMotion& motion = at(bed_.chunk_motion, chunk.begin / Bed::chunk_size);
        const bool continues = chunk.stop_reason.status == Status::finished;
        motion.moved = continues ? moved_in_step(max_speed_squared) : infinity;
        motion.approach = chunk.approach;
        for (int a = 0; a < 3; ++a) motion.momentum[a] = momentum[a];
        chunk.diagnostics.mass_moment = mass_moment;
        if constexpr (sampled) {
            chunk.diagnostics.kinetic = 0.5 * kinetic;
            chunk.diagnostics.rotation = 0.5 * rotation;
        }
    }

    // Predicts the next step of a particle from its distance from the axis, its absolute velocity and spin,
    // and the rates of this step, which are those predicted for the next one afterwards. Contact forces are
    // predicted to turn with the cavity, others to change by `body_change`. Returns the motion relative to
    // the cavity.
    Row drift(const Verlet& step, int i, Row r, Row v, Row spin, Row body_change) {
        const Frame& frame = bed_.frame;
        const FrameStep& now = frame.now;
        Row &x = at(bed_.position, i), &u = at(bed_.velocity, i), &w = at(bed_.spin, i);
        Rates& rates = at(bed_.rates, i);
        const Row middle = step.half_step(v, rates.velocity), spin_middle = step.half_step(spin, rates.spin);
        const Row path = step.step * middle, moved = path + frame.ahead(r + path, now);
        x += moved;
        rates.velocity += body_change;
        u = step.half_step(middle + frame.ahead(middle, now), rates.velocity) -
            frame.point_velocity(frame.radius(x), now.next_rate);
        w = step.half_step(spin_middle + frame.ahead(spin_middle, now), rates.spin) -
            frame.axis() * now.next_rate;
        return moved;
    }

    void go_back_turning(const Chunk& chunk, real dt) {
        const Frame& frame = bed_.frame;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            Row &x = at(bed_.position, i), &u = at(bed_.velocity, i), &w = at(bed_.spin, i);
            Rates rates = bed_.predicted_rates(i);
            const AbsoluteMotion m = frame.undo(x, u, w, rates, dt);
            const Row r = frame.radius(m.position), fourth = row(0, 0, 0, 1);
            x = m.position + fourth * x;
            u = m.velocity - frame.point_velocity(r, frame.before.rate) + fourth * u;
            w = m.spin - frame.axis() * frame.before.rate + fourth * w;
            at(bed_.rates, i) = rates;
        }
    }

    void predict_turning(const Chunk& chunk) {
        const Frame& frame = bed_.frame;
        const Row body = frame.now.body, body_before = frame.before.body;
        const Verlet step(problem_.dt, body, body, true);
        real max_speed_squared = 0;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Row r = frame.radius(at(bed_.position, i));
            at(bed_.rates, i).velocity += body - body_before;
            // The drive may have another speed from now on.
            const Row v = at(bed_.velocity, i) + frame.point_velocity(r, frame.before.rate),
                      spin = at(bed_.spin, i) + frame.axis() * frame.before.rate;
            const Row moved = drift(step, i, r, v, spin, frame.body_ahead(frame.now) - body);
            const Row velocity = moved * (1 / problem_.dt) - bed_.reference_velocity;
            max_speed_squared = larger(max_speed_squared, dot(velocity, velocity));
        }
        at(bed_.chunk_motion, chunk.begin / Bed::chunk_size).moved = moved_in_step(max_speed_squared);
    }

public:
    Integrator(Bed& bed, const Problem& problem, bool spins, bool rolls)
        : bed_(bed), problem_(problem), spins_(spins), rolls_(rolls), far_(bed.particles() > Bed::cached) {}

    bool is_far() const { return far_; }

    // Returns the particles of a chunk to the last step, from which the next one was predicted with the step
    // dt and the acceleration `body` without contacts.
    void go_back(const Chunk& chunk, real dt, Row body) {
        if (bed_.frame.turns()) return go_back_turning(chunk, dt);
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
        if (bed_.frame.turns()) return predict_turning(chunk);
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
        if (bed_.frame.turns())
            return sampled ? advance_turning<true>(sums, chunk, first)
                           : advance_turning<false>(sums, chunk, first);
        constexpr std::true_type on;
        constexpr std::false_type off;
        const auto with = [&](auto sampled, auto far) {
            const auto of = [&](auto spins, auto rolls) {
                advance<sampled.value, far.value, spins.value, rolls.value>(sums, chunk, until, body,
                                                                            body_before, first);
            };
            rolls_ ? of(on, on) : spins_ ? of(on, off) : of(off, off);
        };
        if (far_)
            sampled ? with(on, on) : with(off, on);
        else
            sampled ? with(on, off) : with(off, off);
    }
};

} // namespace rattlebox::dem
