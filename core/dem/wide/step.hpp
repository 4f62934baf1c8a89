// The steps of a simulation, by a wide team: see Simulation and BedStep of the other engine, whose order of
// things and whose formulas these are.
#pragma once

#include "dem/verlet.hpp"
#include "dem/wide/contacts.hpp"
#include "dem/wide/neighbours.hpp"

namespace rattlebox::dem::wide {

inline real now(const World& w) { return static_cast<real>(w.control.step) * w.structure.dt; }
inline bool sampled(const Control& c) { return c.step % c.every == 0 || c.step == c.steps; }

// ---- a particle

// Adds up what acts on it, its own contacts first, then those of others as these lie in memory.
inline bool gather(const Bed& bed, int i, Row& force, Row& turning, StepSum& sum) {
    const Kind pair = known(bed.pair), at_wall = known(bed.at_wall);
    const int n = bed.particles;
    bool touches = false;
    const auto add = [&](int s, real sign) {
        const Kind& kind = bed.partner[s] < 0 ? at_wall : pair;
        const Row f = bed.action[s].force;
        touches = true;
        force += f * rattlebox::row(sign);
        if (kind.rough) turning += bed.action[s].couple;
        if (kind.rolls) turning += bed.torque[s] * (sign / bed.position[i][3]);
        if (bed.partner[s] < 0)
            for (int a = 0; a < 3; ++a) sum.push[a] -= f[a];
    };
    for (unsigned rest = bed.touching[i]; rest != 0; rest &= rest - 1) add(lowest_bit(rest) * n + i, 1);
    for (int m = bed.incoming_begin[i]; m < bed.incoming_begin[i + 1]; ++m) {
        const int owner = bed.incoming[m] >> slot_bits, k = bed.incoming[m] & (most_slots - 1);
        if (bed.touching[owner] >> k & 1u) add(k * n + owner, -1);
    }
    return touches;
}

template <bool sampled> auto advance(Bed& bed, int i, const Verlet& step) {
    StepSum sum;
    real rotation = 0;
    Row force{}, turning{};
    const bool spins = known(bed.pair).rough || known(bed.at_wall).rough;
    const bool before = bed.touched[i], touches = gather(bed, i, force, turning, sum);
    Row x = bed.position[i], u = bed.velocity[i];
    const Row a = touches ? force * u[3] + step.body : step.body;
    const Row v = step.now(u, a, before ? bed.acceleration[i] : step.body_before);
    if (touches) bed.acceleration[i] = a;
    if (touches != before) bed.touched[i] = touches;
    if (spins && (touches || before)) {
        Row w = bed.spin[i];
        const Row rate = turning * w[3];
        w = step.now(w, rate, before ? bed.spin_rate[i] : Row{});
        if (sampled) rotation = 0.5 * dot(w, w) * x[3] / w[3];
        bed.spin[i] = step.next(w, rate);
        if (touches) bed.spin_rate[i] = rate;
    } else if (sampled) {
        const Row w = bed.spin[i];
        rotation = 0.5 * dot(w, w) * x[3] / w[3];
    }
    const Row weighed = v / u[3], middle = step.middle(v, a);
    bed.position[i] = step.moved(x, middle);
    bed.velocity[i] = step.next(v, a);
    const Row moved = middle - bed.motion.velocity;
    for (int k = 0; k < 3; ++k) sum.momentum[k] = weighed[k];
    sum.drift = dot(moved, moved);
    if constexpr (sampled)
        return MotionSum{sum, 0.5 * dot(v, weighed), rotation, {x[0] / u[3], x[1] / u[3], x[2] / u[3]}};
    else
        return sum;
}

// ---- the structure, by one of the team

using rattlebox::row;

inline void place_cavities(World& w) {
    for (int b = 0; b < w.beds; ++b) w.bed[b].motion = w.structure.place(w.bed[b].shape);
}

inline void show(World& w) {
    w.structure.show();
    for (int b = 0; b < w.beds; ++b) w.bed[b].shown = w.bed[b].motion.displacement;
}

// What all need to know of the step to come.
RATTLEBOX_COLD inline void prepare(World& w) {
    Control& c = w.control;
    w.structure.load_values(now(w));
    for (int b = 0; b < w.beds; ++b)
        if (is_stale(w.bed[b])) c.must_build = 1;
    if (sampled(c) && c.sample_count == c.sample_room) c.pause = Pause::samples;
}

inline void write_sample(World& w) {
    real* to = w.sample + static_cast<std::size_t>(w.control.sample_count++) *
                              static_cast<std::size_t>(w.sample_width());
    const auto put = [&](const real* from, int count) {
        for (int k = 0; k < count; ++k) *to++ = from[k];
    };
    const auto all = [&](const auto& sum) {
        put(reinterpret_cast<const real*>(&sum), static_cast<int>(sizeof(sum) / sizeof(real)));
    };
    const Structure& s = w.structure;
    *to++ = now(w);
    for (int m = 0; m < s.modes; ++m) *to++ = s.shown[m].q;
    for (int m = 0; m < s.modes; ++m) *to++ = s.shown[m].p;
    put(s.load_work, s.loads), put(s.base_work, s.loads), put(s.viscous, s.modes);
    for (int b = 0; b < w.beds; ++b)
        all(w.bed[b].before), all(w.bed[b].now), all(w.bed[b].contacts), all(w.bed[b].motions);
}

inline void check(World& w) {
    Control& c = w.control;
    for (int b = 0; b < w.beds && c.status == Status::finished; ++b) {
        Bed& bed = w.bed[b];
        if (bed.stopped == nowhere) continue;
        int i = 0;
        while (bed.name[i] != bed.stopped) ++i;
        const Account& why = bed.account[bed.stopped];
        const Row along = bed.velocity[i] - bed.motion.velocity;
        c.status = why.status, c.stopped_wall = why.wall;
        c.stopped_speed = why.status == Status::escaped ? std::sqrt(dot(along, along)) : why.speed;
        c.stopped_cavity = b, c.stopped_particle = bed.stopped;
    }
}

inline void move_on(World& w) {
    Structure& s = w.structure;
    s.kick();
    s.drift();
    for (int b = 0; b < w.beds; ++b) {
        Bed& bed = w.bed[b];
        const CavityMotion before = bed.motion;
        bed.motion = s.place(bed.shape);
        const StepSum& sum = bed.step;
        if (!(std::fabs(sum.momentum[0] + sum.momentum[1] + sum.momentum[2]) < infinity) ||
            !(sum.drift < infinity))
            w.control.status = Status::not_finite;
        const Row apart = bed.motion.displacement - before.displacement - before.velocity * s.dt;
        bed.since_build += s.dt * std::sqrt(sum.drift) + std::sqrt(dot(apart, apart));
    }
    ++w.control.step;
    ++w.control.since;
}

// What follows from the forces of this step.
RATTLEBOX_COLD inline void conclude(World& w) {
    Control& c = w.control;
    Structure& s = w.structure;
    const bool sample = sampled(c);
    s.no_force();
    for (int b = 0; b < w.beds; ++b) s.add_force(w.bed[b].shape, row(w.bed[b].step.push));
    s.add_loads();
    if (c.step > 0) s.kick();
    show(w);
    Row momentum{};
    for (int b = 0; b < w.beds; ++b) momentum += row(w.bed[b].step.momentum);
    if (c.step > 0) s.work_on_particles(momentum);
    if (sample) write_sample(w);
    s.work_on_particles(momentum);
    check(w);
    c.body_before = s.body();
    move_on(w);
}

// ---- all of it

template <bool sampled, class Team> RATTLEBOX_COLD void one_step(Team& team, World& w) {
    const auto beds = [&](auto&& f) {
        for (int b = 0; b < w.beds; ++b) f(w.bed[b]);
    };
    const auto find_losses = [&](Bed& bed) {
        team.reduce(bed.particles, bed.loss_part, [&](int i) { return losses(bed, i); });
    };
    if (sampled) {
        beds(find_losses);
        team.sync();
        beds([&](Bed& bed) { total(team, bed, &Bed::loss_part, &Bed::before); });
    }
    beds([&](Bed& bed) {
        team.each(bed.particles, [&](int i) { OwnContacts<sampled>(w, bed, i).step(team); });
    });
    team.sync();
    const Verlet step(w.structure.dt, w.structure.body(), w.control.body_before, w.control.step == 0);
    beds([&](Bed& bed) {
        const auto work = [&](int i) { return advance<sampled>(bed, i, step); };
        if constexpr (sampled) {
            find_losses(bed);
            team.reduce(bed.particles, bed.contact_part, [&](int i) { return bed.seen[i]; });
            team.reduce(bed.particles, bed.motion_part, work);
        } else {
            team.reduce(bed.particles, bed.step_part, work);
        }
    });
    team.sync();
    beds([&](Bed& bed) {
        if constexpr (sampled) {
            total(team, bed, &Bed::loss_part, &Bed::now);
            total(team, bed, &Bed::contact_part, &Bed::contacts);
            total(team, bed, &Bed::motion_part, &Bed::motions);
            if (team.leads() && team.first()) bed.step = bed.motions.step;
        } else {
            total(team, bed, &Bed::step_part, &Bed::step);
        }
    });
    if (team.leads() && team.first()) conclude(w), prepare(w);
    team.sync();
}

// Goes on until step `until` is done, or something stops or pauses it.
template <class Team> void run(Team& team, World& w, long until) {
    const Control& c = w.control;
    if (until > c.steps) until = c.steps;
    if (team.leads() && team.first()) {
        w.control.pause = Pause::none;
        prepare(w);
    }
    team.sync();
    while (c.step <= until && c.status == Status::finished && c.pause == Pause::none) {
        if (c.must_build) build(team, w);
        if (c.pause != Pause::none) break;
        if (sampled(c))
            one_step<true>(team, w);
        else
            one_step<false>(team, w);
    }
}

} // namespace rattlebox::dem::wide
