// Linear spring and dashpot.
//
//     N = k d + c d'        c = 2 zeta sqrt(m k)
//
// k [N/m], m = effective mass [kg], d = overlap [m], d' = approach rate [m/s]. Restitution depends on zeta
// only (contact/damping.hpp). The contact ends at zero overlap (the dashpot may cause attraction before) or
// at zero force.
//
// P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.
#pragma once

#include "contact/damping.hpp"
#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct LinearDashpot {
    real stiffness = 0;          // k, N/m
    real mass = 0;               // m, kg
    real dashpot = not_a_number; // c, N s/m; NaN: follows from the restitution
    real zero_overlap = 0;       // 1: ends at zero overlap; 0: ends at zero force
    real fixed_contact_time = 0; // 1: the stiffness is proportional to m*

    static constexpr const char* name = "linear";
    static constexpr Field<LinearDashpot> fields[] = {
        {"stiffness", &LinearDashpot::stiffness},
        {"mass", &LinearDashpot::mass},
        {"damping", &LinearDashpot::dashpot},
        {"zero_overlap", &LinearDashpot::zero_overlap},
        {"fixed_contact_time", &LinearDashpot::fixed_contact_time}};
    static constexpr bool hysteretic = false;

    // ---- the formula; k.stiffness = k, k.second = c

    template <class T>
    RATTLEBOX_INLINE NormalForce<T> force(const Coefficients<T>& k, const Depth<T>& d, const T& rate) const {
        const T elastic = k.stiffness * d.overlap;
        return {elastic + k.second * rate, elastic};
    }
    template <class T> RATTLEBOX_INLINE T stored(const Coefficients<T>& k, const Depth<T>& d) const {
        return 0.5 * k.stiffness * d.overlap * d.overlap;
    }

    // ---- one impact

    bool needs_restitution() const { return std::isnan(dashpot); }
    // Returns the damping ratio of an impact with restitution e.
    real damping(real e) const {
        return needs_restitution() ? rattlebox::damping_ratio(e, zero_overlap != 0)
                                   : 0.5 * dashpot / std::sqrt(mass * stiffness);
    }
    real damping_ratio(real damping, real) const { return damping; }
    Coefficients<real> coefficients(real damping, real) const {
        return {stiffness, 2 * damping * std::sqrt(mass * stiffness)};
    }
    real dashpot_exponent() const { return 0; }
    static constexpr real tangential_share = 1;

    // ---- scales

    LinearDashpot resized(PairSize from, PairSize to) const {
        LinearDashpot law = *this;
        law.mass = to.mass;
        if (fixed_contact_time != 0) law.stiffness *= to.mass / from.mass;
        return law;
    }
    real overlap_scale(real speed) const { return speed * std::sqrt(mass / stiffness); }
    real largest_overlap(real speed) const { return overlap_scale(speed); }
    real contact_time(real) const { return pi * std::sqrt(mass / stiffness); }
    bool same_shape(const LinearDashpot& other) const { return zero_overlap == other.zero_overlap; }
};

} // namespace rattlebox
