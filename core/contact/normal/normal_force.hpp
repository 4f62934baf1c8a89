// Types of the normal laws. The laws are written for a number type T: one number in the 1-D engine, one SIMD
// register of contacts in the 3-D engine.
#pragma once

#include "math/rows.hpp"

namespace rattlebox {

// An overlap d and its roots. The 1-D engine computes them from x = d^(1/4), the 3-D engine from d.
template <class T> struct Depth {
    T overlap;     // d, m
    T root;        // d^(1/2)
    T fourth_root; // d^(1/4)
};

template <class T> RATTLEBOX_INLINE Depth<T> depth_from_overlap(const T& overlap) {
    const T s = root(overlap);
    return {overlap, s, root(s)};
}

// x may be negative within a step of the integrator; d and its root are then those of |x|.
inline Depth<real> depth_from_fourth_root(real x) {
    const real s = x * x;
    return {s * s, s, x};
}

// The coefficients of one contact, constant from first touch to its end. Each law states their units.
template <class T> struct Coefficients {
    T stiffness{};
    T second{}; // coefficient of the dashpot, or as stated by the law
};

// History variables of a law with hysteresis: the deepest overlap so far, and the unloading curve from there.
template <class T> struct History {
    T deepest{};   // m
    T stiffness{}; // of the unloading curve, in the law's unit
    T origin{};    // overlap at which the unloading curve ends, m
};

template <class T> struct NormalForce {
    T total;   // N, positive if repulsive
    T elastic; // without the dashpot
};

// Duration of an undamped Hertz impact times its speed over its largest overlap: 2 sqrt(pi) Gamma(7/5) /
// Gamma(9/10).
inline constexpr real hertz_time = 2.9432752;

// Effective radius R* [m] and effective mass m* [kg] of a pair.
struct PairSize {
    real radius, mass;
};

} // namespace rattlebox
