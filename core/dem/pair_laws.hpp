// The contact laws between two species, or a species and a wall. Plain data.
#pragma once

#include "contact/laws.hpp"
#include "math/rows.hpp"

namespace rattlebox::dem {

enum Partner : int { particle = 0, wall = 1 };

// The laws between two species, or a species and a wall. They hold for a reference pair and are resized to
// the pair that touches.
struct PairLaw {
    NormalLaw normal;
    RestitutionLaw restitution;
    TangentialLaw tangential;
    RollingResistance rolling;
    PairSize size{1, 1};                  // of the reference pair
    real constant_damping = not_a_number; // law.damping(e), where neither speed nor size changes it

    real friction() const {
        return tangential.visit([](const auto& law) { return law.friction; });
    }
};

// How deep those are in each other that were found to touch: not less than rounding leaves, which may find
// otherwise by another way. With none at all Mindlin's spring would have no stiffness.
template <class T> RATTLEBOX_INLINE T overlap(const T& reach, const T& distance) {
    return larger(reach - distance, all(reach, 0x1p-53) * reach);
}

// How the contacts of a list are computed: all have the same kinds of laws.
struct ContactLaws {
    NormalLaw normal;   // its parameters that do not belong to one contact
    int tangential = 0; // place in the table of laws
    bool rough = false, rolls = false;
    bool never_pulls = true; // normal force
    bool hysteretic = false; // contacts remember their deepest overlap
    real dt = 0;
    real enduring = infinity; // age beyond which a contact counts as enduring, in steps
};

} // namespace rattlebox::dem
