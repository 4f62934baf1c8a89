// The forces of contacts that touch, eight at a time.
//
//     normal       the laws of core/contact, with x = d^(1/4)
//     tangential   spring and dashpot, |F_t| <= mu N:  dF = -k_t v_t dt, k_t = B sqrt(d) (Mindlin: B = 8 G*
//     sqrt(R*)) rolling      the same with torques and relative spin, |M| <= mu_r R* N, k_r = (k_r / k_t) k_t
//
// The springs keep their force, not their stretch: when the normal force falls, so does k_t, and the spring's
// force with it; when it rises, the force stays. Either way the energy F^2 / (2 k_t) never grows by itself,
// and what it loses counts as sliding (micro-slip). R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20 (1953)
// 327; C. Thornton, S. J. Cummins, P. W. Cleary, Powder Technology 233 (2013) 30, section 3. A dashpot takes
// only what room the spring leaves below the limit. Rolling: J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi,
// Powder Technology 206 (2011) 269, type C.
#pragma once

#include "base/rows.hpp"
#include "contact/hertz_tsuji.hpp"
#include "contact/linear.hpp"
#include "contact/thornton.hpp"
#include "dem/contacts.hpp"

namespace rattlebox::dem {

// How two partners meet. `normal` points from the first to the second.
template <class T> struct Meeting {
    Vector<T> normal;
    T overlap;
    Vector<T> velocity; // of the first relative to the second, centres
    Vector<T> swirl;    // sum of spin times lever
    Vector<T> spin;     // of the first relative to the second
    T lever;            // of the first over its radius, and of the second over its own
    T radius;           // of the first
};

// A spring with a dashpot beside it in the plane of contact, together never above a limit.
template <class T> struct Holding {
    Vector<T> force, spring; // at this step
    Vector<T> ahead;         // the spring half a step later
    T loss;                  // energy lost in this step
    T stored;                // in the spring, mean of half a step before and after
};

// `before` is the spring's force half a step ago: half of the stretch of a step comes before its force is
// needed and half after it, which is the trapezoidal rule.
template <class T>
RATTLEBOX_INLINE Holding<T> hold(const Vector<T>& before, const T& stiffness_before, const Vector<T>& normal,
                                 const T& stiffness, const T& damping, const Vector<T>& velocity,
                                 const T& limit, const T& dt) {
    const T one = all(limit, 1), half = all(limit, 0.5), tiny = all(limit, 1e-290), zero = all(limit, 0);
    // Into the present plane, with its size, less what unloading takes.
    const Vector<T> flat = before - dot(before, normal) * normal;
    const T was = dot(before, before), eased = smaller(one, stiffness / stiffness_before);
    const T kept = eased * root(was / (dot(flat, flat) + tiny));
    const Vector<T> stretch = (half * stiffness * dt) * velocity;
    const Vector<T> trial = kept * flat - stretch;
    const T size = root(dot(trial, trial)), part = smaller(one, limit / (size + tiny));
    Holding<T> h;
    h.spring = part * trial;
    h.ahead = h.spring - stretch;
    const T slip = dot(velocity, velocity), drag = damping * root(slip);
    const T dashpot = damping * smaller(one, larger(limit - size, zero) / (drag + tiny));
    h.force = h.spring - dashpot * velocity;
    // What the spring took up in this step and does not hold: by slipping, and by its change of stiffness.
    const T held = half * was / stiffness_before, holds = half * dot(h.ahead, h.ahead) / stiffness;
    h.loss = dashpot * slip * dt + larger(held - holds - dot(h.spring, velocity) * dt, zero);
    h.stored = half * (held + holds);
    return h;
}

// ---- normal laws in lanes: the rows `law` hold A, c, B, c_t of each contact

struct Push {
    Lanes force, elastic; // total, and without the dashpot
    Lanes root;           // sqrt(d)
};

struct HertzStep {
    static constexpr bool plastic = false;
    RATTLEBOX_INLINE static Push push(const Columns<8>& law, const Columns<8>&, const Lanes& overlap,
                                      const Lanes& rate) {
        const Lanes s = root(overlap), elastic = law.x * overlap * s;
        return {elastic + law.y * root(s) * rate, elastic, s};
    }
    RATTLEBOX_INLINE static Lanes stored(const Columns<8>& law, const Columns<8>&, const Lanes& overlap) {
        return 0.4 * law.x * overlap * overlap * root(overlap);
    }
};

struct LinearStep {
    static constexpr bool plastic = false;
    RATTLEBOX_INLINE static Push push(const Columns<8>& law, const Columns<8>&, const Lanes& overlap,
                                      const Lanes& rate) {
        const Lanes elastic = law.x * overlap;
        return {elastic + law.y * rate, elastic, root(overlap)};
    }
    RATTLEBOX_INLINE static Lanes stored(const Columns<8>& law, const Columns<8>&, const Lanes& overlap) {
        return 0.5 * law.x * overlap * overlap;
    }
};

// Thornton: law holds A, the slope of yielding, B and the overlap at which it begins; dent the deepest
// overlap so far, stiffness and origin of the curve that unloads from there.
struct PlasticStep {
    static constexpr bool plastic = true;
    RATTLEBOX_INLINE static Lanes curve(const Lanes& stiffness, const Lanes& overlap) {
        const Lanes above = larger(overlap, Lanes::all(0));
        return stiffness * above * root(above);
    }
    RATTLEBOX_INLINE static Push push(const Columns<8>& law, const Columns<8>& dent, const Lanes& overlap,
                                      const Lanes&) {
        const Lanes yielding = curve(law.x, law.w) + law.y * (overlap - law.w);
        const Lanes first = choose(overlap - law.w, yielding, curve(law.x, overlap));
        const Lanes again = curve(dent.y, overlap - dent.z);
        const Lanes force = choose(dent.x - overlap, again, first);
        return {force, force, root(overlap)};
    }
    RATTLEBOX_INLINE static Lanes stored(const Columns<8>&, const Columns<8>& dent, const Lanes& overlap) {
        const Lanes above = larger(overlap - dent.z, Lanes::all(0));
        return 0.4 * dent.y * above * above * root(above);
    }
};

} // namespace rattlebox::dem
