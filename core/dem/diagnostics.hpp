// Energy losses, counts and extremes of one chunk, over the run and at a sample. Sums over chunks are taken
// in the order of the chunks, so that the result has the same bits for any number of threads.
#pragma once

#include "dem/pair_laws.hpp"
#include "util/status.hpp"

namespace rattlebox::dem {

// Why a run stopped early.
struct StopReason {
    Status status = Status::finished;
    int particle = -1, wall = -1; // numbers in the case, or -1
    real value = 0;               // speed, m/s
};

// Returns lanes that hold v in the first lane and zero in the others.
inline Lanes first_lane(real v) {
    alignas(64) real x[lane_count] = {v};
    return lanes(x);
}

// The largest ratio of overlap to the smaller radius. Ratios are compared by cross-multiplication, because a
// division for each contact would cost more.
struct LargestOverlap {
    Lanes overlap{}, radius = Lanes::all(1);

    // `part` is the first of the lanes that are compared.
    RATTLEBOX_INLINE void update(const Group& other, const Group& its_radius, int part) {
        Group &own = group_of(overlap, part), &own_radius = group_of(radius, part);
        const Group deeper = other * own_radius - own * its_radius;
        own = choose(deeper, other, own), own_radius = choose(deeper, its_radius, own_radius);
    }
    real ratio() const { return largest(overlap / radius); }
};

struct alignas(64) Diagnostics {
    // over the run
    Lanes normal[2]{}, sliding[2]{}, rolling[2]{};
    Lanes enduring[2]{}; // all losses of enduring contacts
    real plastic[2]{};
    long first_touches[2]{}, extrapolated = 0, scans = 0;
    LargestOverlap largest_overlap;
    real largest_approach_speed = 0;

    // at a sample
    Row wall_moment{}, mass_moment{};
    real kinetic = 0, rotation = 0;
    Lanes stored{};
    // Energy lost by the time of the sample, less half of the loss of the step.
    Lanes sliding_correction[2]{}, rolling_correction[2]{};
    long contacts[2]{};

    // Counts and extremes, and losses of enduring contacts, count from now on.
    void reset_extremes() {
        for (int p = 0; p < 2; ++p) enduring[p] = Lanes{}, first_touches[p] = 0;
        extrapolated = scans = 0;
        largest_overlap = LargestOverlap{};
        largest_approach_speed = 0;
    }

    void begin_sample() {
        stored = Lanes{};
        for (int p = 0; p < 2; ++p) sliding_correction[p] = rolling_correction[p] = Lanes{}, contacts[p] = 0;
    }
};

// Sums over the contacts of one chunk with the walls of one name.
struct WallTotals {
    // over the run
    real impulse[3] = {}, normal_impulse = 0; // of the forces on the wall, and of their normal parts
    real normal = 0, plastic = 0, sliding = 0, rolling = 0;
    long impacts = 0;

    // at a sample
    real force[3] = {}, moment[3] = {}, normal_force = 0;
    real sliding_correction = 0, rolling_correction = 0;

    void begin_sample() {
        for (int a = 0; a < 3; ++a) force[a] = moment[a] = 0;
        normal_force = sliding_correction = rolling_correction = 0;
    }

    WallTotals& operator+=(const WallTotals& other) {
        for (int a = 0; a < 3; ++a)
            impulse[a] += other.impulse[a], force[a] += other.force[a], moment[a] += other.moment[a];
        normal += other.normal, plastic += other.plastic, sliding += other.sliding, rolling += other.rolling;
        sliding_correction += other.sliding_correction, rolling_correction += other.rolling_correction;
        normal_impulse += other.normal_impulse, normal_force += other.normal_force;
        impacts += other.impacts;
        return *this;
    }
};

} // namespace rattlebox::dem
