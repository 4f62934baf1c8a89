// The structure in the steps of particle dampers: kicked by forces, propagated exactly between two kicks.
//
// Views of arrays that the simulation owns.
#pragma once

#include "math/rows.hpp"
#include "structure/coupled_modes.hpp"
#include "structure/signal.hpp"

namespace rattlebox::dem {

struct CavityMotion {
    Row displacement{}, velocity{};
};

// Where a step takes displacement 1 and velocity 1.
struct Turn {
    ModeState of_q, of_p;
};

inline Turn turn(const Mode& mode, real dt) {
    FreeMode of_q(mode), of_p(mode);
    of_q.begin({1, 0});
    of_p.begin({0, 1});
    return {of_q.at(dt), of_p.at(dt)};
}

struct Structure {
    int modes = 0, loads = 0;
    real dt = 0;
    Row gravity{};
    // of the modes
    const Mode* mode = nullptr;
    const Turn* turns = nullptr;
    const real* transition = nullptr; // of modes coupled by damping, all at once; else null
    ModeState* moved = nullptr;       // scratch
    ModeState* state = nullptr;       // at the step to come
    ModeState* shown = nullptr;       // at the last step whose forces are known
    real* force = nullptr;
    real* viscous = nullptr;
    // of the loads
    const Signal* signal = nullptr;
    const real* load_shape = nullptr; // force on each mode, load by load
    const int* base = nullptr;        // is it an acceleration of the base
    const Row* direction = nullptr;
    real* value = nullptr; // at the step to come
    real* load_work = nullptr;
    real* base_work = nullptr;

    void load_values(real t) {
        for (int l = 0; l < loads; ++l) value[l] = signal[l].around(t, dt);
    }

    // What accelerates all particles alike.
    Row body() const {
        Row b = gravity;
        for (int l = 0; l < loads; ++l)
            if (base[l]) b -= direction[l] * value[l];
        return b;
    }

    CavityMotion place(const Row* shape) const {
        CavityMotion c;
        for (int m = 0; m < modes; ++m) {
            c.displacement += shape[m] * state[m].q;
            // As it will be after the last force has acted for half a step more.
            c.velocity += shape[m] * (state[m].p + 0.5 * dt * force[m]);
        }
        return c;
    }

    // Forces on the modes: first of the cavities, one by one, then of the loads.
    void no_force() {
        for (int m = 0; m < modes; ++m) force[m] = 0;
    }
    void add_force(const Row* shape, Row on_cavity) {
        for (int m = 0; m < modes; ++m) force[m] += dot(shape[m], on_cavity);
    }
    void add_loads() {
        for (int l = 0; l < loads; ++l)
            for (int m = 0; m < modes; ++m) force[m] += load_shape[l * modes + m] * value[l];
    }

    // Half a step of force.
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
            const auto& [of_q, of_p] = turns[m];
            state[m] = {of_q.q * from.q + of_p.q * from.p, of_q.p * from.q + of_p.p * from.p};
            if (mode[m].decay > 0) viscous[m] += from.energy(mode[m]) - state[m].energy(mode[m]);
        }
    }

    // The energy that all modes lose together is booked on the first.
    void drift_coupled() {
        real energy = 0;
        for (int m = 0; m < modes; ++m) energy += state[m].energy(mode[m]);
        const int n = 2 * modes;
        for (int m = 0; m < modes; ++m) {
            moved[m] = {};
            const real *q = transition + 2 * m * n, *p = q + n;
            for (int j = 0; j < modes; ++j) {
                moved[m].q += q[2 * j] * state[j].q + q[2 * j + 1] * state[j].p;
                moved[m].p += p[2 * j] * state[j].q + p[2 * j + 1] * state[j].p;
            }
        }
        for (int m = 0; m < modes; ++m) {
            state[m] = moved[m];
            energy -= state[m].energy(mode[m]);
        }
        viscous[0] += energy;
    }

    // Half of the work of the base on the particles in this step: before its instant, or after it.
    void work_on_particles(Row momentum) {
        for (int l = 0; l < loads; ++l)
            if (base[l]) base_work[l] -= 0.5 * dt * value[l] * dot(direction[l], momentum);
    }

    void show() {
        for (int m = 0; m < modes; ++m) shown[m] = state[m];
    }
};

} // namespace rattlebox::dem
