// State vector and energy ledger of the 1-D engine.
//
// The state vector y holds q and p of each mode, then the positions of all balls, then their velocities, then
// the impulse that each stop has received since the start.
#pragma once

#include <algorithm>
#include <vector>

#include "impact/problem.hpp"

namespace rattlebox {

struct State {
    real t = 0;
    std::vector<real> y;

    explicit State(const Problem& p) : y(p.state_size()) {
        for (std::size_t k = 0; k < p.modes.size(); ++k) {
            y[2 * k] = p.start[k].q;
            y[2 * k + 1] = p.start[k].p;
        }
        const std::size_t first = 2 * p.modes.size(), b = p.ball_mass.size();
        for (std::size_t i = 0; i < b; ++i) {
            y[first + i] = p.ball_position[i];
            y[first + b + i] = p.ball_velocity[i];
        }
    }
};

inline const real* positions(const Problem& p, const real* y) { return y + 2 * p.modes.size(); }
inline const real* velocities(const Problem& p, const real* y) {
    return y + 2 * p.modes.size() + p.ball_mass.size();
}
inline real* positions(const Problem& p, real* y) { return y + 2 * p.modes.size(); }
inline real* velocities(const Problem& p, real* y) { return y + 2 * p.modes.size() + p.ball_mass.size(); }

// Index in y of the impulse of the stop with contact c; the ground, not a ball, is on its other side.
inline std::size_t impulse_index(const Problem& p, const Contact& c) {
    return p.motion_size() + static_cast<std::size_t>(c.damper) - p.first_stop();
}

// Position, velocity or acceleration of a ball or of the ground.
inline real of_body(const real* of_balls, int body) { return body == ground ? 0 : of_balls[body]; }

// Displacement and velocity of a cavity; with a derivative dy in place of y, velocity and acceleration.
inline ModeState cavity(const Damper& damper, const real* y) {
    ModeState z;
    for (std::size_t k = 0; k < damper.shape.size(); ++k) {
        z.q += damper.shape[k] * y[2 * k];
        z.p += damper.shape[k] * y[2 * k + 1];
    }
    return z;
}

// Gap between the two sides of a contact, negative if they overlap, and its rate.
struct Gap {
    real value = 0, rate = 0;
};

inline Gap gap(const Problem& problem, const Contact& contact, const real* y) {
    const real* s = positions(problem, y);
    const real* v = velocities(problem, y);
    if (contact.below != wall && contact.above != wall)
        return {s[contact.above] - s[contact.below], v[contact.above] - v[contact.below]};
    const Damper& damper = problem.dampers[static_cast<std::size_t>(contact.damper)];
    const ModeState z = cavity(damper, y);
    const real half = 0.5 * damper.clearance;
    if (contact.below == wall)
        return {(of_body(s, contact.above) - z.q) + half, of_body(v, contact.above) - z.p};
    return {half - (s[contact.below] - z.q), z.p - v[contact.below]};
}

// Returns the sum of the magnitudes of the terms of the gap of a stop, with the way of the point in the time
// t: the gap of a stop may be zero, and the time of a touch is known to its own rounding only.
inline real stop_terms(const Problem& problem, const Contact& contact, const real* y, real t) {
    const Damper& damper = problem.dampers[static_cast<std::size_t>(contact.damper)];
    real sum = damper.clearance + t * std::fabs(cavity(damper, y).p);
    for (std::size_t k = 0; k < damper.shape.size(); ++k) sum += std::fabs(damper.shape[k] * y[2 * k]);
    return sum;
}

// Work done and energy lost since the start of the run.
struct Ledger {
    real load_work = 0, base_work = 0, viscous = 0;
    std::vector<real> normal, plastic; // by damper

    explicit Ledger(const Problem& p) : normal(p.dampers.size(), 0.0), plastic(p.dampers.size(), 0.0) {}

    void clear() {
        load_work = base_work = viscous = 0;
        std::fill(normal.begin(), normal.end(), 0.0);
        std::fill(plastic.begin(), plastic.end(), 0.0);
    }
    void add(const Ledger& part) {
        load_work += part.load_work;
        base_work += part.base_work;
        viscous += part.viscous;
        for (std::size_t d = 0; d < normal.size(); ++d) {
            normal[d] += part.normal[d];
            plastic[d] += part.plastic[d];
        }
    }
};

} // namespace rattlebox
