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

// Returns the sums of each wall over the chunks of its cavity, cavity after cavity.
inline std::vector<WallTotals> each_wall(const std::vector<Bed>& beds) {
    std::vector<WallTotals> sums;
    for (const Bed& bed : beds) {
        const std::size_t first = sums.size();
        for (const Chunk& c : bed.chunks) {
            sums.resize(first + c.each_wall.size());
            for (std::size_t w = 0; w < c.each_wall.size(); ++w) sums[first + w] += c.each_wall[w];
        }
    }
    return sums;
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
    std::vector<real> angle, speed, drive_work;          // of a cavity that turns; else zero
    std::vector<real> normal, plastic, sliding, rolling; // particles, walls
    std::vector<std::int64_t> contacts;
    // by sample and name of a wall, cavity after cavity; empty unless they are computed
    std::vector<real> wall_force, wall_moment, wall_impulse, wall_normal_force, wall_normal_impulse;
    std::vector<real> wall_normal, wall_plastic, wall_sliding, wall_rolling;
    std::vector<std::int64_t> wall_impacts;

    std::vector<Losses> losses_before_;
    std::vector<WallTotals> walls_before_;

    void begin_sample(std::vector<Bed>& beds) {
        losses_before_.clear();
        walls_before_ = each_wall(beds);
        for (Bed& bed : beds) {
            losses_before_.push_back(losses(bed));
            for (Chunk& c : bed.chunks) {
                c.diagnostics.begin_sample();
                for (WallTotals& wall : c.each_wall) wall.begin_sample();
            }
        }
    }

    void add_sample(real t, const std::vector<Bed>& beds, const Structure& structure, Row gravity) {
        time.push_back(t);
        for (const ModeState& m : structure.state) q.push_back(m.q), p.push_back(m.p);
        const auto append = [](std::vector<real>& to, const std::vector<real>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(load_work, structure.load_work), append(base_work, structure.base_work);
        append(viscous, structure.viscous);
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
            add_sample(sum, bed.frame, gravity);
        }
        add_walls(each_wall(beds));
    }

    // Half of the loss and of the impulse of a step counts at the sample, as for the sums over all walls.
    void add_walls(const std::vector<WallTotals>& walls) {
        for (std::size_t w = 0; w < walls.size(); ++w) {
            const WallTotals &then = walls_before_[w], &now = walls[w];
            for (int a = 0; a < 3; ++a) {
                wall_force.push_back(now.force[a]), wall_moment.push_back(now.moment[a]);
                wall_impulse.push_back(0.5 * (then.impulse[a] + now.impulse[a]));
            }
            wall_normal_force.push_back(now.normal_force);
            wall_normal_impulse.push_back(0.5 * (then.normal_impulse + now.normal_impulse));
            wall_normal.push_back(0.5 * (then.normal + now.normal));
            wall_plastic.push_back(now.plastic);
            wall_sliding.push_back(0.5 * (then.sliding + now.sliding) + now.sliding_correction);
            wall_rolling.push_back(0.5 * (then.rolling + now.rolling) + now.rolling_correction);
            wall_impacts.push_back(now.impacts);
        }
    }

    // Momentum, force and moment become vectors in the machine frame; the centre of mass stays in that of the
    // cavity. The potential energy of a cavity that turns is zero on the axis.
    void add_sample(Totals& sum, const Frame& frame, Row gravity) {
        for (Row* v : {&sum.momentum, &sum.force_on_cavity, &sum.moment_on_cavity}) *v = frame.to_machine(*v);
        angle.push_back(frame.now.angle), speed.push_back(frame.now.speed);
        drive_work.push_back(frame.drive_work);
        kinetic.push_back(sum.kinetic), rotation.push_back(sum.rotation), stored.push_back(sum.stored);
        potential.push_back(-dot(gravity, frame.moment_about_axis(sum.mass_moment, sum.mass)));
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
