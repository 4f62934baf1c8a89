// Samples of a run: energies, forces and positions at the output times.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

// Energy losses between particles and at walls.
struct Losses {
    real normal[2] = {}, plastic[2] = {}, sliding[2] = {}, rolling[2] = {};
};

inline Losses losses(const Bed& bed) {
    Losses sum;
    for (const Chunk& c : bed.chunks)
        for (int p = 0; p < 2; ++p) {
            const Diagnostics& t = c.diagnostics;
            sum.normal[p] += total(t.normal[p]);
            sum.plastic[p] += t.plastic[p];
            sum.sliding[p] += total(t.sliding[p]);
            sum.rolling[p] += total(t.rolling[p]);
        }
    return sum;
}

// Sums over a cavity at a sample.
struct Totals {
    Losses before, now; // at the start and the end of the step
    real kinetic = 0, rotation = 0, stored = 0, mass = 0;
    real sliding_correction[2] = {},
         rolling_correction[2] = {}; // loss by the sample less half of the loss of the step
    Row mass_moment{}, momentum{}, force_on_cavity{}, moment_on_cavity{};
    std::int64_t contacts[2] = {};
};

struct Records {
    std::vector<real> time, q, p, load_work, base_work, viscous;
    // by sample and cavity
    std::vector<real> kinetic, rotation, potential, stored, centre, momentum, force, moment;
    std::vector<real> normal, plastic, sliding, rolling; // particles, walls
    std::vector<std::int64_t> contacts;

    std::vector<Losses> losses_before_;

    void begin_sample(std::vector<Bed>& beds) {
        losses_before_.clear();
        for (Bed& bed : beds) {
            losses_before_.push_back(losses(bed));
            for (Chunk& c : bed.chunks) c.diagnostics.begin_sample();
        }
    }

    void add_sample(real t, const std::vector<Bed>& beds, const std::vector<ModeState>& modes, Row gravity,
                    const std::vector<real>& loads, const std::vector<real>& base,
                    const std::vector<real>& lost) {
        time.push_back(t);
        for (const ModeState& m : modes) q.push_back(m.q), p.push_back(m.p);
        load_work.insert(load_work.end(), loads.begin(), loads.end());
        base_work.insert(base_work.end(), base.begin(), base.end());
        viscous.insert(viscous.end(), lost.begin(), lost.end());
        for (std::size_t b = 0; b < beds.size(); ++b) {
            const Bed& bed = beds[b];
            Totals sum{.before = losses_before_[b], .now = losses(bed)};
            for (const ChunkMotion& one : bed.chunk_motion)
                sum.momentum += row(one.momentum), sum.force_on_cavity += row(one.force_on_cavity);
            for (const Chunk& c : bed.chunks) {
                const Diagnostics& one = c.diagnostics;
                sum.kinetic += one.kinetic, sum.rotation += one.rotation, sum.stored += total(one.stored);
                sum.mass_moment += one.mass_moment, sum.moment_on_cavity += one.wall_moment;
                for (int k = 0; k < 2; ++k) {
                    sum.contacts[k] += one.contacts[k];
                    sum.sliding_correction[k] += total(one.sliding_correction[k]),
                        sum.rolling_correction[k] += total(one.rolling_correction[k]);
                }
            }
            sum.mass = bed.mass;
            add_sample(sum, gravity);
        }
    }

    void add_sample(const Totals& sum, Row gravity) {
        kinetic.push_back(sum.kinetic), rotation.push_back(sum.rotation), stored.push_back(sum.stored);
        potential.push_back(-dot(gravity, sum.mass_moment));
        for (int a = 0; a < 3; ++a) {
            centre.push_back(sum.mass_moment[a] / sum.mass), momentum.push_back(sum.momentum[a]);
            force.push_back(sum.force_on_cavity[a]), moment.push_back(sum.moment_on_cavity[a]);
        }
        // Half of the loss of a step counts as lost at the sample; sliding and rolling losses have a
        // correction.
        const Losses &then = sum.before, &now = sum.now;
        for (int k = 0; k < 2; ++k) {
            contacts.push_back(sum.contacts[k]);
            normal.push_back(0.5 * (then.normal[k] + now.normal[k]));
            plastic.push_back(now.plastic[k]);
            sliding.push_back(0.5 * (then.sliding[k] + now.sliding[k]) + sum.sliding_correction[k]);
            rolling.push_back(0.5 * (then.rolling[k] + now.rolling[k]) + sum.rolling_correction[k]);
        }
    }
};

} // namespace rattlebox::dem
