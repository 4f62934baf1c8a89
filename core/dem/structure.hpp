// Time integration of the structure in the 3-D engine: operator splitting into kicks by the forces and exact
// propagation of the free modes between two kicks (second order).
//
// G. Strang, SIAM J. Numer. Anal. 5 (1968) 506, doi:10.1137/0705041.
//
// Holds pointers to arrays that the simulation owns.
#pragma once

#include "math/rows.hpp"
#include "structure/coupled_modes.hpp"
#include "structure/signal.hpp"

namespace rattlebox::dem {

struct CavityMotion {
    Row displacement{}, velocity{};
};

// State after one step that starts from displacement 1 (of_q) or velocity 1 (of_p).
struct ModeTransition {
    ModeState of_q, of_p;
};

inline ModeTransition mode_transition(const Mode& mode, real dt) {
    FreeMode of_q(mode), of_p(mode);
    of_q.start({1, 0});
    of_p.start({0, 1});
    return {of_q.at(dt), of_p.at(dt)};
}

struct Structure {
    int modes = 0, loads = 0;
    real dt = 0;
    Row gravity{};
    // by mode
    const Mode* mode = nullptr;
    const ModeTransition* mode_transitions = nullptr;
    const real* transition = nullptr; // matrix of all modes together if damping couples them; else null
    ModeState* propagated = nullptr;  // scratch
    ModeState* state = nullptr;       // at the next step
    ModeState* output = nullptr;      // at the last step whose forces are known
    real* force = nullptr;
    real* viscous = nullptr;
    // by load
    const Signal* signal = nullptr;
    const real* load_shape = nullptr; // force on each mode, by load and mode
    const int* base = nullptr;        // whether it is an acceleration of the base
    const Row* direction = nullptr;
    real* value = nullptr; // at the next step
    real* load_work = nullptr;
    real* base_work = nullptr;

    void load_values(real t) {
        for (int l = 0; l < loads; ++l) value[l] = signal[l].step_value(t, dt);
    }

    // Acceleration of all particles by gravity and the base.
    Row body_acceleration() const {
        Row b = gravity;
        for (int l = 0; l < loads; ++l)
            if (base[l]) b -= direction[l] * value[l];
        return b;
    }

    CavityMotion cavity_motion(const Row* shape) const {
        CavityMotion c;
        for (int m = 0; m < modes; ++m) {
            c.displacement += shape[m] * state[m].q;
            // The velocity is predicted for the end of the kick.
            c.velocity += shape[m] * (state[m].p + 0.5 * dt * force[m]);
        }
        return c;
    }

    // Modal forces: first the cavities, one by one, then the loads.
    void clear_forces() {
        for (int m = 0; m < modes; ++m) force[m] = 0;
    }
    void add_force(const Row* shape, Row on_cavity) {
        for (int m = 0; m < modes; ++m) force[m] += dot(shape[m], on_cavity);
    }
    void add_loads() {
        for (int l = 0; l < loads; ++l)
            for (int m = 0; m < modes; ++m) force[m] += load_shape[l * modes + m] * value[l];
    }

    // Applies the forces for half a step.
    void kick() {
        const real h = 0.5 * dt;
        for (int m = 0; m < modes; ++m) {
            const real mean = state[m].p + 0.5 * h * force[m];
            for (int l = 0; l < loads; ++l) {
                const real work = load_shape[l * modes + m] * value[l] * h * mean;
                (base[l] ? base_work : load_work)[l] += work;
            }
            state[m].p += h * force[m];
        }
    }

    void drift() {
        if (transition) return drift_coupled();
        for (int m = 0; m < modes; ++m) {
            const ModeState from = state[m];
            const auto& [of_q, of_p] = mode_transitions[m];
            state[m] = {of_q.q * from.q + of_p.q * from.p, of_q.p * from.q + of_p.p * from.p};
            if (mode[m].decay > 0) viscous[m] += from.energy(mode[m]) - state[m].energy(mode[m]);
        }
    }

    // The loss is not separable by mode; it is added to that of the first mode.
    void drift_coupled() {
        real energy = 0;
        for (int m = 0; m < modes; ++m) energy += state[m].energy(mode[m]);
        const int n = 2 * modes;
        for (int m = 0; m < modes; ++m) {
            propagated[m] = {};
            const real *q = transition + 2 * m * n, *p = q + n;
            for (int j = 0; j < modes; ++j) {
                propagated[m].q += q[2 * j] * state[j].q + q[2 * j + 1] * state[j].p;
                propagated[m].p += p[2 * j] * state[j].q + p[2 * j + 1] * state[j].p;
            }
        }
        for (int m = 0; m < modes; ++m) {
            state[m] = propagated[m];
            energy -= state[m].energy(mode[m]);
        }
        viscous[0] += energy;
    }

    // Adds half of the work of the base on the particles in this step.
    void work_on_particles(Row momentum) {
        for (int l = 0; l < loads; ++l)
            if (base[l]) base_work[l] -= 0.5 * dt * value[l] * dot(direction[l], momentum);
    }

    void store_output() {
        for (int m = 0; m < modes; ++m) output[m] = state[m];
    }
};

} // namespace rattlebox::dem
