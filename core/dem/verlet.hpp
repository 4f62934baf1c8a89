// Velocity Verlet. Forces that depend on the velocity take the one predicted from the last acceleration, v +
// dt a, which keeps the second order:  v' = u + dt/2 (a' - a),  u' = v' + dt a',  x' = x + dt v' + dt^2/2 a',
// u predicted, a the last. Rows carry a fourth number along, which stays as it is.
#pragma once

#include "math/rows.hpp"

namespace rattlebox::dem {

struct Verlet {
    Row back, step, half;
    Row body, body_before; // acceleration of what touches nothing, in this step and in the one before

    // The first step has none before.
    Verlet(real dt, Row body, Row body_before, bool first)
        : back(row(first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt, first ? 0 : 0.5 * dt)), step(row(dt, dt, dt)),
          half(row(0.5 * dt, 0.5 * dt, 0.5 * dt)), body(body), body_before(body_before) {}

    Row now(Row predicted, Row a, Row before) const { return predicted + back * (a - before); }
    Row next(Row v, Row a) const { return v + step * a; }
    Row middle(Row v, Row a) const { return v + half * a; }
    Row moved(Row x, Row middle) const { return x + step * middle; }
};

} // namespace rattlebox::dem
