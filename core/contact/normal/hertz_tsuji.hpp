// Hertz contact with Tsuji's dashpot.
//
//     N = A d^(3/2) + alpha sqrt(m A) d^(1/4) d'      alpha = sqrt(5) zeta
//
// A = (4/3) E* sqrt(R*) [N/m^1.5], m = effective mass [kg], d = overlap [m], d' = approach rate [m/s].
// Restitution depends on alpha only (contact/damping.hpp). Valid for d << R*. The contact ends at zero
// overlap (the dashpot may cause attraction before) or at zero force (never attractive).
//
// Y. Tsuji, T. Tanaka, T. Ishida, Powder Technology 71 (1992) 239, eqs 8 and 17, with the effective mass of
// the pair, doi:10.1016/0032-5910(92)88030-L.
#pragma once

#include "contact/damping.hpp"
#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct HertzTsuji {
    real stiffness = 0;        // A, N/m^1.5
    real mass = 0;             // m, kg
    real alpha = not_a_number; // damping; NaN: follows from the restitution
    real zero_overlap = 0;     // 1: ends at zero overlap; 0: ends at zero force

    static constexpr const char* name = "hertz_tsuji";
    static constexpr Field<HertzTsuji> fields[] = {{"stiffness", &HertzTsuji::stiffness},
                                                   {"mass", &HertzTsuji::mass},
                                                   {"alpha", &HertzTsuji::alpha},
                                                   {"zero_overlap", &HertzTsuji::zero_overlap}};
    static constexpr bool hysteretic = false;

    // ---- the formula; k.stiffness = A, k.second = alpha sqrt(m A)

    template <class T>
    RATTLEBOX_INLINE NormalForce<T> force(const Coefficients<T>& k, const Depth<T>& d, const T& rate) const {
        const T elastic = k.stiffness * d.overlap * d.root;
        return {elastic + k.second * d.fourth_root * rate, elastic};
    }
    template <class T> RATTLEBOX_INLINE T stored(const Coefficients<T>& k, const Depth<T>& d) const {
        return 0.4 * k.stiffness * d.overlap * d.overlap * d.root;
    }

    // ---- one impact

    bool needs_restitution() const { return std::isnan(alpha); }
    // Returns the damping ratio of an impact with restitution e.
    real damping(real e) const {
        return needs_restitution() ? rattlebox::damping_ratio(e, zero_overlap != 0) : alpha / std::sqrt(5.0);
    }
    real damping_ratio(real damping, real) const { return damping; }
    // Takes that damping ratio and the approach speed, on which this law does not depend.
    Coefficients<real> coefficients(real damping, real) const {
        return {stiffness, std::sqrt(5.0) * damping * std::sqrt(mass * stiffness)};
    }
    // Exponent of the overlap in the force of the dashpot.
    real dashpot_exponent() const { return 0.25; }
    // Damping ratio of a tangential dashpot with Mindlin's stiffness over that of this law.
    static constexpr real tangential_share = 0.91287092917527686; // sqrt(5/6)

    // ---- scales

    HertzTsuji resized(PairSize from, PairSize to) const {
        HertzTsuji law = *this;
        law.mass = to.mass;
        law.stiffness *= std::sqrt(to.radius / from.radius);
        return law;
    }
    // Returns the largest overlap of an undamped impact at this speed.
    real overlap_scale(real speed) const { return std::pow(1.25 * mass * speed * speed / stiffness, 0.4); }
    real largest_overlap(real speed) const { return overlap_scale(speed); }
    // Returns the duration of an undamped impact.
    real contact_time(real speed) const {
        return hertz_time * std::pow(1.25 * mass / stiffness, 0.4) * std::pow(speed, -0.2);
    }
    bool same_shape(const HertzTsuji& other) const { return zero_overlap == other.zero_overlap; }
};

} // namespace rattlebox
