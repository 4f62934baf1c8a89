// What is kept of a run: energies, forces and places at the instants of the samples.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

struct Losses {
    real normal[2] = {}, plastic[2] = {}, sliding[2] = {}, rolling[2] = {};
};

inline Losses losses(const Bed& bed) {
    Losses sum;
    for (const Chunk& c : bed.chunks)
        for (int p = 0; p < 2; ++p) {
            const Tally& t = c.tally;
            sum.normal[p] += total(t.normal[p]);
            sum.plastic[p] += t.plastic[p];
            sum.sliding[p] += total(t.sliding[p]);
            sum.rolling[p] += total(t.rolling[p]);
        }
    return sum;
}

struct Records {
    std::vector<real> time, q, p, load_work, base_work, viscous;
    // of each sample and cavity
    std::vector<real> kinetic, rotation, potential, stored, centre, momentum, force, moment;
    std::vector<real> normal, plastic, sliding, rolling; // particles, walls
    std::vector<std::int64_t> contacts;

    std::vector<Losses> before_;

    void before(std::vector<Bed>& beds) {
        before_.clear();
        for (Bed& bed : beds) {
            before_.push_back(losses(bed));
            for (Chunk& c : bed.chunks)
                c.tally.stored = Lanes{}, c.tally.contacts[0] = c.tally.contacts[1] = 0;
        }
    }

    void take(real t, const std::vector<Bed>& beds, const std::vector<ModeState>& modes, Row gravity,
              const std::vector<real>& loads, const std::vector<real>& base, const std::vector<real>& lost) {
        time.push_back(t);
        for (const ModeState& m : modes) q.push_back(m.q), p.push_back(m.p);
        load_work.insert(load_work.end(), loads.begin(), loads.end());
        base_work.insert(base_work.end(), base.begin(), base.end());
        viscous.insert(viscous.end(), lost.begin(), lost.end());
        for (std::size_t b = 0; b < beds.size(); ++b) {
            const Bed& bed = beds[b];
            real moving = 0, turning = 0, held = 0, mass = 0;
            Row place{}, going{}, push{}, twist{};
            std::int64_t touching[2] = {};
            for (const Chunk& c : bed.chunks) {
                const Tally& one = c.tally;
                moving += one.kinetic, turning += one.rotation, held += total(one.stored);
                place += one.mass_moment, going += one.momentum, push += one.wall_force,
                    twist += one.wall_moment;
                for (int k = 0; k < 2; ++k) touching[k] += one.contacts[k];
            }
            for (const real m : bed.cavity->mass) mass += m;
            kinetic.push_back(moving), rotation.push_back(turning), stored.push_back(held);
            potential.push_back(-dot(gravity, place));
            for (int a = 0; a < 3; ++a) {
                centre.push_back(place[a] / mass), momentum.push_back(going[a]);
                force.push_back(push[a]), moment.push_back(twist[a]);
            }
            // What a step loses is half lost at its instant.
            const Losses now = losses(bed), &then = before_[b];
            for (int k = 0; k < 2; ++k) {
                contacts.push_back(touching[k]);
                normal.push_back(0.5 * (then.normal[k] + now.normal[k]));
                plastic.push_back(now.plastic[k]);
                sliding.push_back(0.5 * (then.sliding[k] + now.sliding[k]));
                rolling.push_back(0.5 * (then.rolling[k] + now.rolling[k]));
            }
        }
    }
};

} // namespace rattlebox::dem
