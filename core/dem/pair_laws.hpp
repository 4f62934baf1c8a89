// The contact laws of two species, or of a species and a wall. Plain data.
#pragma once

#include "contact/laws.hpp"
#include "math/rows.hpp"

namespace rattlebox::dem {

enum Partner : int { particle = 0, wall = 1 };

// The coefficients hold for a reference pair; each contact resizes them to its own effective radius and mass.
struct PairLaw {
    NormalLaw normal;
    RestitutionLaw restitution;
    TangentialLaw tangential;
    RollingResistance rolling;
    PairSize size{1, 1};                  // of the reference pair
    real constant_damping = not_a_number; // law.damping(e) if it depends on neither speed nor size

    real friction() const {
        return tangential.visit([](const auto& law) { return law.friction; });
    }
};

// Returns the overlap of a touching pair. The lower bound is the rounding error: the test for contact may
// differ in the last bit, and at zero overlap Mindlin's spring has no stiffness.
template <class T> RATTLEBOX_INLINE T overlap(const T& reach, const T& distance) {
    return larger(reach - distance, all(reach, 0x1p-53) * reach);
}

// Properties that all contacts of one list have in common, among them the types of their laws.
struct ContactLaws {
    NormalLaw normal;   // coefficients that do not depend on the contact
    int tangential = 0; // index in the table of laws
    bool rough = false, rolls = false;
    bool repulsive_only = true; // the normal force is never attractive
    bool hysteretic = false;    // the history holds the deepest overlap
    real dt = 0;
    real enduring = infinity; // age beyond which a contact counts as enduring, in steps
};

} // namespace rattlebox::dem
