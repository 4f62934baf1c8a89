// Power law with a dashpot whose coefficient is also a power of the overlap.
//
//     N = k d^n + c d^p d'
//
// k [N/m^n], c [N s/m^(p+1)], d = overlap [m], d' = approach rate [m/s], n > 0, p >= 0. The contact ends at
// zero force (never attractive) or at zero overlap (the dashpot may cause attraction before). Well-known laws
// of this form:
//
//     Hunt, Crossley           n = 3/2, p = n     J. Appl. Mech. 42 (1975) 440, doi:10.1115/1.3423596
//     Kuwabara, Kono           n = 3/2, p = 1/2   Jpn. J. Appl. Phys. 26 (1987) 1230,
//                                                 doi:10.1143/JJAP.26.1230
//     Lankarani, Nikravesh     n = 3/2, p = n     J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617
//
// With p = (n - 1)/2 the restitution does not depend on the speed.
#pragma once

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct PowerLaw {
    real stiffness = 0;         // k, N/m^n
    real mass = 0;              // effective mass, kg
    real exponent = 1.5;        // n
    real dashpot = 0;           // c, N s/m^(p+1)
    real power_of_dashpot = 0;  // p
    real zero_overlap = 0;      // 1: ends at zero overlap; 0: ends at zero force
    real hertz = 0;             // 1: the stiffness is proportional to sqrt(R*)
    real fixed_restitution = 0; // 1: the dashpot of a pair keeps the restitution at a given speed

    static constexpr const char* name = "power";
    static constexpr Field<PowerLaw> fields[] = {{"stiffness", &PowerLaw::stiffness},
                                                 {"mass", &PowerLaw::mass},
                                                 {"exponent", &PowerLaw::exponent},
                                                 {"damping", &PowerLaw::dashpot},
                                                 {"damping_exponent", &PowerLaw::power_of_dashpot},
                                                 {"zero_overlap", &PowerLaw::zero_overlap},
                                                 {"hertz", &PowerLaw::hertz},
                                                 {"fixed_restitution", &PowerLaw::fixed_restitution}};
    static constexpr bool hysteretic = false;

    bool is_possible() const { return exponent > 0; }

    // ---- the formula; k.stiffness = k, k.second = c

    template <class T>
    RATTLEBOX_INLINE NormalForce<T> force(const Coefficients<T>& k, const Depth<T>& d, const T& rate) const {
        const T elastic = k.stiffness * power(d.overlap, exponent);
        return {elastic + k.second * power(d.overlap, power_of_dashpot) * rate, elastic};
    }
    template <class T> RATTLEBOX_INLINE T stored(const Coefficients<T>& k, const Depth<T>& d) const {
        return 1 / (exponent + 1) * k.stiffness * power(d.overlap, exponent + 1);
    }

    // ---- one impact

    bool needs_restitution() const { return false; }
    real damping(real) const { return dashpot; }
    // Returns the damping ratio of small vibrations about the largest overlap of an impact at this speed.
    real damping_ratio(real, real speed) const {
        const real d = overlap_scale(speed);
        if (d <= 0 || dashpot == 0) return 0;
        const real slope = exponent * stiffness * std::pow(d, exponent - 1);
        return dashpot * std::pow(d, power_of_dashpot) / (2 * std::sqrt(mass * slope));
    }
    Coefficients<real> coefficients(real damping, real) const { return {stiffness, damping}; }
    real dashpot_exponent() const { return power_of_dashpot; }
    static constexpr real tangential_share = 1;

    // ---- scales

    PowerLaw resized(PairSize from, PairSize to) const {
        PowerLaw law = *this;
        law.mass = to.mass;
        const real firmer = hertz != 0 ? std::sqrt(to.radius / from.radius) : 1;
        law.stiffness *= firmer;
        if (fixed_restitution != 0) { // c is proportional to k^q m^(1-q) at a given speed
            const real q = (power_of_dashpot + 1) / (exponent + 1);
            law.dashpot *= std::pow(firmer, q) * std::pow(to.mass / from.mass, 1 - q);
        }
        return law;
    }
    real overlap_scale(real speed) const {
        return std::pow(0.5 * (exponent + 1) * mass * speed * speed / stiffness, 1 / (exponent + 1));
    }
    real largest_overlap(real speed) const { return overlap_scale(speed); }
    real contact_time(real speed) const {
        const real q = 1 / (exponent + 1);
        if (speed <= 0) return exponent == 1 ? pi * std::sqrt(mass / stiffness) : exponent > 1 ? infinity : 0;
        return 2 * std::sqrt(pi) * std::tgamma(1 + q) / std::tgamma(0.5 + q) * overlap_scale(speed) / speed;
    }
    bool same_shape(const PowerLaw& other) const {
        return zero_overlap == other.zero_overlap && exponent == other.exponent &&
               power_of_dashpot == other.power_of_dashpot;
    }
};

} // namespace rattlebox
