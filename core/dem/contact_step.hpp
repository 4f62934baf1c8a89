// What two bodies that touch do to each other: of a number, or of as many as a register holds.
//
//     normal       the laws of core/contact, with x = d^(1/4)
//     tangential   spring and dashpot, |F_t| <= mu N:  dF = -k_t v_t dt, k_t = B sqrt(d)
//                  (Mindlin: B = 8 G* sqrt(R*))
//     rolling      the same with torques and relative spin, |M| <= mu_r R* N, k_r = (k_r / k_t) k_t
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
#include "dem/encounter.hpp"

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

// A sphere: where its centre is, and how it moves and turns.
template <class T> struct Ball {
    Vector<T> place, velocity, spin;
    T radius;
};

// Two spheres, seen from each other.
template <class T> struct Facing {
    Vector<T> way;            // from the first centre to the second
    Vector<T> velocity, spin; // of the first relative to the second
    Vector<T> swirl;          // sum of spin times radius
    T near, radius;           // sum of the radii, and the smaller of them
};

template <class T> RATTLEBOX_INLINE Facing<T> facing(const Ball<T>& a, const Ball<T>& b) {
    return {b.place - a.place,   a.velocity - b.velocity,
            a.spin - b.spin,     a.radius * a.spin + b.radius * b.spin,
            a.radius + b.radius, smaller(a.radius, b.radius)};
}

template <bool spins, class T> RATTLEBOX_INLINE Meeting<T> meet(const Facing<T>& f) {
    const T distance = root(dot(f.way, f.way));
    const T per_both = all(distance, 1) / (distance * f.near); // one division for two
    Meeting<T> m;
    m.normal = (f.near * per_both) * f.way;
    m.overlap = overlap(f.near, distance);
    m.radius = f.radius;
    m.velocity = f.velocity;
    if constexpr (spins) {
        m.lever = distance * distance * per_both;
        m.swirl = m.lever * f.swirl;
        m.spin = f.spin;
    }
    return m;
}

// A sphere and a wall in the direction `normal`.
template <bool spins, class T>
RATTLEBOX_INLINE Meeting<T> meet(const Ball<T>& a, const Vector<T>& normal, const T& distance,
                                 const Vector<T>& velocity) {
    Meeting<T> m;
    m.normal = normal;
    m.overlap = overlap(a.radius, distance);
    m.velocity = a.velocity - velocity;
    m.radius = a.radius;
    if constexpr (spins) {
        m.lever = distance / a.radius;
        m.spin = a.spin;
        m.swirl = distance * m.spin;
    }
    return m;
}

// A spring with a dashpot beside it in the plane of contact, together never above a limit.
template <class T> struct Holding {
    Vector<T> force, spring; // at this step
    Vector<T> ahead;         // the spring half a step later
    T gives;                 // 1 / stiffness
    T loss;                  // energy lost in this step
    T stored;                // in the spring at this step
    T beyond;                // what half a step before and after it holds on average more: what slips away
};

// `before` is the spring's force half a step ago, when it gave by `gave` times its force: half of the stretch
// of a step comes before its force is needed and half after it, which is the trapezoidal rule.
template <class T>
RATTLEBOX_INLINE Holding<T> hold(const Vector<T>& before, const T& gave, const Vector<T>& normal,
                                 const T& stiffness, const T& damping, const Vector<T>& velocity,
                                 const T& limit, const T& dt) {
    const T one = all(limit, 1), half = all(limit, 0.5), tiny = all(limit, 1e-290), zero = all(limit, 0);
    // Into the present plane, with its size, less what unloading takes.
    const Vector<T> flat = before - dot(before, normal) * normal;
    const T was = dot(before, before), eased = smaller(one, stiffness * gave);
    const T kept = eased * root(was / (dot(flat, flat) + tiny));
    const Vector<T> stretch = (half * stiffness * dt) * velocity;
    const Vector<T> trial = kept * flat - stretch;
    const T size = root(dot(trial, trial)), part = smaller(one, limit / (size + tiny));
    Holding<T> h;
    h.gives = one / stiffness;
    h.spring = part * trial;
    h.ahead = h.spring - stretch;
    const T slip = dot(velocity, velocity), drag = damping * root(slip);
    const T dashpot = damping * smaller(one, larger(limit - size, zero) / (drag + tiny));
    h.force = h.spring - dashpot * velocity;
    // What the spring took up in this step and does not hold: by slipping, and by its change of stiffness.
    const T held = half * was * gave, holds = half * dot(h.ahead, h.ahead) * h.gives;
    h.loss = dashpot * slip * dt + larger(held - holds - dot(h.spring, velocity) * dt, zero);
    // Where it slips, the spring half a step from here is stretched further than friction allows.
    const T mean = half * (held + holds), most = half * h.loss, pulls = smaller(size, limit);
    h.beyond = smaller(most, larger(zero - most, mean - half * pulls * pulls * h.gives));
    h.stored = mean - h.beyond;
    return h;
}

// ---- normal laws: the four numbers of `law` are A, c, B, c_t of each contact

template <class T> struct Four {
    T x, y, z, w;
    RATTLEBOX_INLINE Vector<T> vector() const { return {x, y, z}; }
};
inline Four<real> four(Row r) { return {r[0], r[1], r[2], r[3]}; }

template <class T> struct Push {
    T force, elastic; // total, and without the dashpot
    T root, fourth;   // d^(1/2), d^(1/4)
};

struct HertzStep {
    static constexpr bool plastic = false;
    template <class T, class Row>
    RATTLEBOX_INLINE static Push<T> push(const Row& law, const Row&, const T& overlap, const T& rate) {
        const T s = root(overlap), x = root(s), elastic = law.x * overlap * s;
        return {elastic + law.y * x * rate, elastic, s, x};
    }
    template <class T, class Row>
    RATTLEBOX_INLINE static T stored(const Row& law, const Row&, const T& overlap) {
        return 0.4 * law.x * overlap * overlap * root(overlap);
    }
};

struct LinearStep {
    static constexpr bool plastic = false;
    template <class T, class Row>
    RATTLEBOX_INLINE static Push<T> push(const Row& law, const Row&, const T& overlap, const T& rate) {
        const T elastic = law.x * overlap, s = root(overlap);
        return {elastic + law.y * rate, elastic, s, root(s)};
    }
    template <class T, class Row>
    RATTLEBOX_INLINE static T stored(const Row& law, const Row&, const T& overlap) {
        return 0.5 * law.x * overlap * overlap;
    }
};

// Thornton: law holds A, the slope of yielding, B and the overlap at which it begins; dent the deepest
// overlap so far, stiffness and origin of the curve that unloads from there.
struct PlasticStep {
    static constexpr bool plastic = true;
    template <class T> RATTLEBOX_INLINE static T curve(const T& stiffness, const T& overlap) {
        const T above = larger(overlap, all(overlap, 0));
        return stiffness * above * root(above);
    }
    template <class T, class Row>
    RATTLEBOX_INLINE static Push<T> push(const Row& law, const Row& dent, const T& overlap, const T&) {
        const T yielding = curve(law.x, law.w) + law.y * (overlap - law.w);
        const T first = choose(overlap - law.w, yielding, curve(law.x, overlap));
        const T again = curve(dent.y, overlap - dent.z);
        const T force = choose(dent.x - overlap, again, first);
        const T s = root(overlap);
        return {force, force, s, root(s)};
    }
    template <class T, class Row>
    RATTLEBOX_INLINE static T stored(const Row&, const Row& dent, const T& overlap) {
        const T above = larger(overlap - dent.z, all(overlap, 0));
        return 0.4 * dent.y * above * above * root(above);
    }
};

// ---- all of a contact

template <class T> struct Tangential {
    Vector<T> force, couple; // on the first; the couple over its radius
    Four<T> friction;        // what the spring remembers
    T stiffness;
    T lost, stored, beyond;
};

template <class T, class Row>
RATTLEBOX_INLINE Tangential<T> rub(const Meeting<T>& m, const Push<T>& push, const T& rate, const Row& law,
                                   const T& friction, const Row& history, bool dashpots, bool mindlin,
                                   const T& dt) {
    const T zero = all(rate, 0), one = all(rate, 1);
    const T firm = mindlin ? push.root : one, drag = mindlin ? push.fourth : one;
    const T pressed = larger(push.force, zero), stiffness = law.z * firm;
    const Vector<T> slip = m.velocity - rate * m.normal + cross(m.swirl, m.normal);
    const T dashpot = dashpots ? law.w * drag : zero;
    const auto h =
        hold(history.vector(), history.w, m.normal, stiffness, dashpot, slip, friction * pressed, dt);
    return {h.force,
            m.lever * cross(m.normal, h.force),
            {h.ahead.x, h.ahead.y, h.ahead.z, h.gives},
            stiffness,
            h.loss,
            h.stored,
            h.beyond};
}

template <class T> struct Rolling {
    Vector<T> torque; // on the first
    Four<T> rolling;  // what the spring remembers
    T lost, stored, beyond;
};

// `law` holds mu_r R*, k_r / k_t, c_r.
template <class T, class Row>
RATTLEBOX_INLINE Rolling<T> roll(const Meeting<T>& m, const Push<T>& push, const T& stiffness, const Row& law,
                                 const Row& past, bool mindlin, const T& dt) {
    const T zero = all(stiffness, 0), one = all(stiffness, 1);
    const T drag = mindlin ? push.fourth : one, pressed = larger(push.force, zero);
    const Vector<T> turning = m.spin - dot(m.spin, m.normal) * m.normal;
    const T spring = law.y * stiffness;
    const auto r = hold(past.vector(), past.w, m.normal, spring, law.z * drag, turning, law.x * pressed, dt);
    return {r.force, {r.ahead.x, r.ahead.y, r.ahead.z, r.gives}, r.loss, r.stored, r.beyond};
}

} // namespace rattlebox::dem
