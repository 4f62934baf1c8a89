// What one chunk of particles adds up in a step and over a run. Sums over chunks are taken in their order:
// the same bits for any number of threads.
#pragma once

#include "base/rows.hpp"
#include "base/status.hpp"

namespace rattlebox::dem {

enum Partner : int { particle = 0, wall = 1 };

// Why a run cannot go on.
struct Stopped {
    Status status = Status::finished;
    int particle = -1, wall = -1; // number in the case
    real value = 0;               // speed
};

// What the first step within a contact would miss: the touch lies between two steps, and forces grow from it
// like roots of the time since, which the trapezoidal rule does not see.
struct Late {
    int slot;
    real share = 0; // of the force of the first step, missed on top of it
    Row slip{};     // of the first along the second
};

struct alignas(64) Tally {
    // over the run
    Lanes normal[2]{}, sliding[2]{}, rolling[2]{};
    real plastic[2]{};
    long first_touches[2]{}, extrapolated = 0;
    Lanes deepest{};  // overlap over the radius of the first partner
    real fastest = 0; // approach

    // in this step
    Row wall_force{}, wall_moment{}, momentum{};
    real drift = 0; // largest speed squared relative to the reference

    // at a sample
    Row mass_moment{};
    real kinetic = 0, rotation = 0;
    Lanes stored{};
    long contacts[2]{};
};

} // namespace rattlebox::dem
