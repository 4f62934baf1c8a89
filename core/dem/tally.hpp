// What a chunk adds up in a step and over a run. Sums over chunks are taken in their order, so that they have
// the same bits for any number of threads.
#pragma once

#include "dem/pair_laws.hpp"
#include "util/status.hpp"

namespace rattlebox::dem {

// Why a run cannot go on.
struct Stopped {
    Status status = Status::finished;
    int particle = -1, wall = -1; // number in the case
    real value = 0;               // speed
};

// As lanes, the others zero.
inline Lanes first_lane(real v) {
    alignas(64) real x[lane_count] = {v};
    return lanes(x);
}

// The deepest overlap over the smaller radius, found without dividing.
struct Deepest {
    Lanes overlap{}, radius = Lanes::all(1);

    // In the lanes of a group.
    RATTLEBOX_INLINE void see(const Group& other, const Group& its_radius, int part) {
        Group &own = group_of(overlap, part), &own_radius = group_of(radius, part);
        const Group deeper = other * own_radius - own * its_radius;
        own = choose(deeper, other, own), own_radius = choose(deeper, its_radius, own_radius);
    }
    real ratio() const { return largest(overlap / radius); }
};

struct alignas(64) Tally {
    // over the run
    Lanes normal[2]{}, sliding[2]{}, rolling[2]{};
    Lanes enduring[2]{}; // in enduring contacts, of all kinds
    real plastic[2]{};
    long first_touches[2]{}, extrapolated = 0, scans = 0;
    Deepest deepest;
    real fastest = 0; // approach

    // at a sample
    Row wall_moment{}, mass_moment{};
    real kinetic = 0, rotation = 0;
    Lanes stored{}, slid[2]{}, rolled[2]{}; // lost by then, beyond half of what the step loses
    long contacts[2]{};

    void begin_sample() {
        stored = Lanes{};
        for (int p = 0; p < 2; ++p) slid[p] = rolled[p] = Lanes{}, contacts[p] = 0;
    }
};

} // namespace rattlebox::dem
