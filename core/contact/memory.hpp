// What one contact remembers between its first touch and its end, and what happens when a phase of it ends.
//
// All laws use the coordinate x with d = offset + x^4: it makes Hertz contact polynomial in time transformed
// by dt = x^3 dtau, so that an integrator of high order really has its order from first touch on.
#pragma once

#include "base/real.hpp"

namespace rattlebox {

struct Memory {
    real zeta = 0;      // damping ratio of this impact
    real damping = 0;   // dashpot coefficient of the law
    real offset = 0;    // overlap at which the force vanishes
    real stiffness = 0; // of the present curve, when the law changes it
    real deepest = 0;   // largest overlap so far
    int phase = 0;
};

enum class Next {
    stay,    // another phase of the same contact
    open,    // overlap is zero: contact is over
    release, // force is zero, overlap is not: contact is over, the dent or the overlap is still there
};

} // namespace rattlebox
