// What meets: walls, and what two materials do to each other. Plain data, on any device.
#pragma once

#include "base/rows.hpp"
#include "contact/laws.hpp"

namespace rattlebox::dem {

enum Partner : int { particle = 0, wall = 1 };

// A wall, seen from the centre of its cavity.
struct Wall {
    enum Form : int { plane = 0, cylinder = 1, sphere = 2 };
    Row axis{}; // outward normal of a plane, axis of a cylinder; the last number is the distance or the
                // radius
    Form form = plane;
    int kind = 0; // of its material
};

// What two materials do to each other; laws hold for a reference pair and are scaled to the sizes that meet.
struct Encounter {
    NormalLaw normal;
    RestitutionLaw restitution;
    real radius = 1, mass = 1;     // R* [m] and m* [kg] of the reference pair
    bool by_time = false;          // linear spring of given contact time: stiffness grows with m*
    real friction = 0;             // mu
    real shear = 0;                // 8 G* [Pa]: Mindlin's stiffness is 8 G* a, a = sqrt(R* d)
    real tangential_stiffness = 0; // [N/m] of a linear spring
    real tangential_ratio = 0;     // of a linear spring: to the stiffness of the pair's own linear contact
    real tangential_damping = 1;   // damping ratio of the tangential dashpot over that of the normal one
    real rolling = 0;              // mu_r
    real rolling_stiffness = 0;    // over k_t R*^2
    real rolling_damping = 0;      // damping ratio
    real constant_zeta = not_a_number; // where neither speed nor size changes it
};

// How the laws of a list of contacts are computed.
struct Contacting {
    real dt = 0;
    bool mindlin = true;     // tangential stiffness grows with the contact
    bool never_pulls = true; // normal force
};

// How deep those are in each other that were found to touch: not less than rounding leaves, which may find
// otherwise by another way. With none at all Mindlin's spring would have no stiffness.
template <class T> RATTLEBOX_INLINE T overlap(const T& reach, const T& distance) {
    return larger(reach - distance, all(reach, 0x1p-53) * reach);
}

struct Kind {
    enum Normal : int { hertz, linear, plastic } normal = hertz;
    bool rough = false, rolls = false;
    Contacting how;
};

} // namespace rattlebox::dem
