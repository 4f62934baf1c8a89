// A spring and a dashpot in parallel, in series with a slider that limits the force. Tangential laws and
// rolling resistance have this form.
//
//     dF = -k v dt,  |F - c v| <= limit
//
// The history variable is the force of the spring, not its displacement. During unloading of the normal
// contact k decreases, and the spring force decreases in proportion; during loading the force does not
// change. The energy F^2 / (2 k) of the spring therefore never grows without work, and its decrease counts as
// sliding loss (micro-slip). The force of the dashpot is limited to the difference between the limit and the
// spring force.
//
// R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20 (1953) 327, doi:10.1115/1.4010702; C. Thornton, S. J.
// Cummins, P. W. Cleary, An investigation of the comparative behaviour of alternative contact force models
// during inelastic collisions, Powder Technology 233 (2013) 30-46, section 3,
// doi:10.1016/j.powtec.2012.08.012.
#pragma once

#include "math/rows.hpp"

namespace rattlebox {

template <class T> struct SpringSlider {
    Vector<T> force, spring; // at this step
    Vector<T> next_spring;   // half a step later
    T compliance;            // 1 / stiffness
    T loss;                  // energy lost in this step
    T stored;                // energy of the spring at this step
    T excess;                // mean energy half a step before and after, less `stored`; caused by slip
};

// One step. `before` is the spring force half a step before, `compliance_before` the compliance then. Half of
// the displacement of the step is applied before the force is evaluated and half after it (trapezoidal rule).
template <class T>
RATTLEBOX_INLINE SpringSlider<T> advance_spring_slider(const Vector<T>& before, const T& compliance_before,
                                                       const Vector<T>& normal, const T& stiffness,
                                                       const T& damping, const Vector<T>& velocity,
                                                       const T& limit, const T& dt) {
    const T one = all(limit, 1), half = all(limit, 0.5), tiny = all(limit, 1e-290), zero = all(limit, 0);
    // Rotated into the current contact plane at constant magnitude, and reduced by unloading.
    const Vector<T> in_plane = before - dot(before, normal) * normal;
    const T before_squared = dot(before, before), unloading = smaller(one, stiffness * compliance_before);
    const T scale = unloading * root(before_squared / (dot(in_plane, in_plane) + tiny));
    const Vector<T> stretch = (half * stiffness * dt) * velocity;
    const Vector<T> trial = scale * in_plane - stretch;
    const T size = root(dot(trial, trial)), part = smaller(one, limit / (size + tiny));
    SpringSlider<T> s;
    s.compliance = one / stiffness;
    s.spring = part * trial;
    s.next_spring = s.spring - stretch;
    const T speed_squared = dot(velocity, velocity), drag = damping * root(speed_squared);
    const T dashpot = damping * smaller(one, larger(limit - size, zero) / (drag + tiny));
    s.force = s.spring - dashpot * velocity;
    // Work on the spring that it does not store: slip, and decrease of stiffness.
    const T energy_before = half * before_squared * compliance_before,
            energy_after = half * dot(s.next_spring, s.next_spring) * s.compliance;
    s.loss = dashpot * speed_squared * dt +
             larger(energy_before - energy_after - dot(s.spring, velocity) * dt, zero);
    // During slip the spring force half a step later exceeds the friction limit.
    const T mean = half * (energy_before + energy_after), bound = half * s.loss, pull = smaller(size, limit);
    s.excess = smaller(bound, larger(zero - bound, mean - half * pull * pull * s.compliance));
    s.stored = mean - s.excess;
    return s;
}

// The second half of a step after its length has changed.
template <class T> struct ChangedHalfStep {
    Vector<T> next_spring; // half a step later
    T loss;                // change of the energy lost in this step
};

// The length of the step after this one has changed from `dt_before`: moves the spring from half of the
// former step ahead to half of the new one. The loss is the energy that leaves the motion and is not stored.
// It is not limited to positive values: while the spring exceeds the friction limit, parts of it come and go.
template <class T>
RATTLEBOX_INLINE ChangedHalfStep<T> change_half_step(const Vector<T>& next, const T& compliance,
                                                     const T& damping, const Vector<T>& velocity,
                                                     const T& limit, const T& dt_before, const T& dt) {
    const T one = all(limit, 1), half = all(limit, 0.5), tiny = all(limit, 1e-290), zero = all(limit, 0);
    const T stiffness = one / compliance, more = half * (dt - dt_before);
    const Vector<T> force = next + (half * dt_before * stiffness) * velocity;
    const T speed_squared = dot(velocity, velocity), drag = damping * root(speed_squared);
    const T dashpot = damping * smaller(one, larger(limit - root(dot(force, force)), zero) / (drag + tiny));
    ChangedHalfStep<T> s;
    s.next_spring = next - (more * stiffness) * velocity;
    s.loss = half * compliance * (dot(next, next) - dot(s.next_spring, s.next_spring)) +
             more * (dashpot * speed_squared - dot(force, velocity));
    return s;
}

// Energy of a spring whose force and compliance are in one row.
inline real spring_energy(Row spring) { return 0.5 * dot(spring, spring) * spring[3]; }

} // namespace rattlebox
