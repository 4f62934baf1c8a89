// A spring with a dashpot beside it, in series with a slider: the force never exceeds a limit. Tangential
// laws and rolling resistance are both of this form.
//
//     dF = -k v dt,  |F - c v| <= limit
//
// The spring keeps its force, not its stretch. When the normal force falls, so does k, and the spring's force
// with it; when it rises, the force stays. Either way the energy F^2 / (2 k) never grows by itself, and what
// it loses counts as sliding (micro-slip). The dashpot takes only what room the spring leaves below the
// limit.
//
// R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20 (1953) 327, doi:10.1115/1.4010702; C. Thornton, S. J.
// Cummins, P. W. Cleary, Powder Technology 233 (2013) 30, section 3, doi:10.1016/j.powtec.2012.08.012.
#pragma once

#include "math/rows.hpp"

namespace rattlebox {

template <class T> struct SpringSlider {
    Vector<T> force, spring; // at this step
    Vector<T> next_spring;   // half a step later
    T compliance;            // 1 / stiffness
    T loss;                  // energy lost in this step
    T stored;                // in the spring at this step
    T excess;                // mean energy of the springs half a step before and after, less `stored`: slips
};

// One step. `before` is the spring's force half a step ago, `compliance_before` its compliance then. Half of
// a step's stretch comes before its force is needed and half after it, which is the trapezoidal rule.
template <class T>
RATTLEBOX_INLINE SpringSlider<T> advance_spring_slider(const Vector<T>& before, const T& compliance_before,
                                                       const Vector<T>& normal, const T& stiffness,
                                                       const T& damping, const Vector<T>& velocity,
                                                       const T& limit, const T& dt) {
    const T one = all(limit, 1), half = all(limit, 0.5), tiny = all(limit, 1e-290), zero = all(limit, 0);
    // Turned into the present plane without a change of size, less what unloading takes.
    const Vector<T> flat = before - dot(before, normal) * normal;
    const T was = dot(before, before), eased = smaller(one, stiffness * compliance_before);
    const T kept = eased * root(was / (dot(flat, flat) + tiny));
    const Vector<T> stretch = (half * stiffness * dt) * velocity;
    const Vector<T> trial = kept * flat - stretch;
    const T size = root(dot(trial, trial)), part = smaller(one, limit / (size + tiny));
    SpringSlider<T> s;
    s.compliance = one / stiffness;
    s.spring = part * trial;
    s.next_spring = s.spring - stretch;
    const T slip = dot(velocity, velocity), drag = damping * root(slip);
    const T dashpot = damping * smaller(one, larger(limit - size, zero) / (drag + tiny));
    s.force = s.spring - dashpot * velocity;
    // What the spring took up in this step and does not hold: by slipping, and by its change of stiffness.
    const T held = half * was * compliance_before,
            holds = half * dot(s.next_spring, s.next_spring) * s.compliance;
    s.loss = dashpot * slip * dt + larger(held - holds - dot(s.spring, velocity) * dt, zero);
    // Where it slips, the spring half a step from here is stretched further than friction allows.
    const T mean = half * (held + holds), most = half * s.loss, pulls = smaller(size, limit);
    s.excess = smaller(most, larger(zero - most, mean - half * pulls * pulls * s.compliance));
    s.stored = mean - s.excess;
    return s;
}

// Energy held by a spring whose force and compliance are in one row.
inline real spring_energy(Row spring) { return 0.5 * dot(spring, spring) * spring[3]; }

} // namespace rattlebox
