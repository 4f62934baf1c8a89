// Time integration of the structure in the 3-D engine: operator splitting into kicks by the forces and exact
// propagation of the free modes between two kicks (second order).
//
// G. Strang, SIAM J. Numer. Anal. 5 (1968) 506, doi:10.1137/0705041.
#pragma once

#include <algorithm>
#include <vector>

#include "math/rows.hpp"
#include "structure/coupled_modes.hpp"
#include "structure/loads.hpp"
#include "util/at.hpp"

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

class Structure {
    real dt_ = 0;
    Row gravity_{};
    // by mode
    std::vector<Mode> mode_;
    std::vector<ModeTransition> mode_transitions_;
    std::vector<real> transition_; // matrix of all modes together if damping couples them; else empty
    std::vector<ModeState> propagated_;
    // by load
    std::vector<real> shape_;    // force on each mode, by load and mode
    std::vector<char> is_base_;  // whether it is an acceleration of the base
    std::vector<Row> direction_; // of that
    std::vector<real> value_;    // at the next step

    int modes() const { return static_cast<int>(mode_.size()); }
    int loads() const { return static_cast<int>(signals.size()); }

public:
    std::vector<ModeState> state, output; // at the next step, and at the last one whose forces are known
    std::vector<real> force, viscous;     // by mode
    std::vector<Signal> signals;
    std::vector<real> load_work, base_work; // by load
    Row body_acceleration{};                // of all particles, by gravity and the base

    Structure(const std::vector<Mode>& modes, const std::vector<ModeState>& start,
              const std::vector<Load>& loads, const std::vector<Row>& directions)
        : mode_(modes), propagated_(modes.size()), direction_(directions), value_(loads.size()), state(start),
          output(start), force(modes.size()), viscous(modes.size()), load_work(loads.size()),
          base_work(loads.size()) {
        for (const Load& load : loads) {
            signals.push_back(load.signal);
            shape_.insert(shape_.end(), load.shape.begin(), load.shape.end());
            is_base_.push_back(load.base);
        }
    }

    void set_inputs(real dt, Row gravity, const std::vector<real>& coupling) {
        dt_ = dt, gravity_ = gravity;
        mode_transitions_.clear();
        for (const Mode& mode : mode_) mode_transitions_.push_back(mode_transition(mode, dt));
        if (!coupling.empty()) transition_ = transition(mode_, coupling, dt);
    }

    // Evaluates the loads at the next step.
    void load_values(real t) {
        body_acceleration = gravity_;
        for (int l = 0; l < loads(); ++l) {
            at(value_, l) = at(signals, l).step_value(t, dt_);
            if (at(is_base_, l)) body_acceleration -= at(direction_, l) * at(value_, l);
        }
    }

    CavityMotion cavity_motion(const Row* shape) const {
        CavityMotion c;
        for (int m = 0; m < modes(); ++m) {
            c.displacement += shape[m] * at(state, m).q;
            // The velocity is predicted for the end of the kick.
            c.velocity += shape[m] * (at(state, m).p + 0.5 * dt_ * at(force, m));
        }
        return c;
    }

    // Modal forces: first the cavities, one by one, then the loads.
    void clear_forces() { std::fill(force.begin(), force.end(), 0); }
    void add_force(const Row* shape, Row on_cavity) {
        for (int m = 0; m < modes(); ++m) at(force, m) += dot(shape[m], on_cavity);
    }
    void add_loads() {
        for (int l = 0; l < loads(); ++l)
            for (int m = 0; m < modes(); ++m) at(force, m) += at(shape_, l * modes() + m) * at(value_, l);
    }

    // Applies the forces for half a step.
    void kick() {
        const real h = 0.5 * dt_;
        for (int m = 0; m < modes(); ++m) {
            const real mean = at(state, m).p + 0.5 * h * at(force, m);
            for (int l = 0; l < loads(); ++l) {
                const real work = at(shape_, l * modes() + m) * at(value_, l) * h * mean;
                at(at(is_base_, l) ? base_work : load_work, l) += work;
            }
            at(state, m).p += h * at(force, m);
        }
    }

    void drift() {
        if (!transition_.empty()) return drift_coupled();
        // Compilers compute several modes at once if pointers are loaded before the loop.
        const int count = modes();
        const Mode* const mode = mode_.data();
        const ModeTransition* const transitions = mode_transitions_.data();
        ModeState* const moved = state.data();
        real* const lost = viscous.data();
        for (int m = 0; m < count; ++m) {
            const ModeState from = moved[m];
            const auto& [of_q, of_p] = transitions[m];
            moved[m] = {of_q.q * from.q + of_p.q * from.p, of_q.p * from.q + of_p.p * from.p};
            if (mode[m].decay > 0) lost[m] += from.energy(mode[m]) - moved[m].energy(mode[m]);
        }
    }

    // The loss is not separable by mode; it is added to that of the first mode.
    void drift_coupled() {
        real energy = 0;
        for (int m = 0; m < modes(); ++m) energy += at(state, m).energy(at(mode_, m));
        const int n = 2 * modes();
        for (int m = 0; m < modes(); ++m) {
            ModeState& next = at(propagated_, m) = {};
            const real *q = &at(transition_, 2 * m * n), *p = q + n;
            for (int j = 0; j < modes(); ++j) {
                next.q += q[2 * j] * at(state, j).q + q[2 * j + 1] * at(state, j).p;
                next.p += p[2 * j] * at(state, j).q + p[2 * j + 1] * at(state, j).p;
            }
        }
        for (int m = 0; m < modes(); ++m) {
            at(state, m) = at(propagated_, m);
            energy -= at(state, m).energy(at(mode_, m));
        }
        viscous[0] += energy;
    }

    // Adds half of the work of the base on the particles in this step.
    void work_on_particles(Row momentum) {
        for (int l = 0; l < loads(); ++l)
            if (at(is_base_, l))
                at(base_work, l) -= 0.5 * dt_ * at(value_, l) * dot(at(direction_, l), momentum);
    }

    void store_output() { std::copy(state.begin(), state.end(), output.begin()); }
};

} // namespace rattlebox::dem
