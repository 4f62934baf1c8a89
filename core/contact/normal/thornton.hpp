// Thornton's elastic, perfectly plastic contact: dissipation by yielding, not by a dashpot.
//
//     loading    F = A d^(3/2)                           to d_y = R (pi p_y / (2 E))^2
//     yielding   F = F_y + S (d - d_y)                   S = pi p_y R
//     unloading  F = (4/3) E sqrt(R_p) (d - d_p)^(3/2)
//                R_p = 4 E / (3 F_max) ((2 F_max + F_y) / (2 pi p_y))^(3/2)
//
// E = E* [Pa], R = R* [m], p_y = limiting contact pressure [Pa], d_p = d_max - (3 F_max / (4 E
// sqrt(R_p)))^(2/3) the residual overlap. Reloading follows the unloading curve up to d_max, then the
// yielding curve. Yielding begins where the Hertz curve has the slope S, so that d_y = (2 S / (3 A))^2. Rate
// independent.
//
// C. Thornton, Coefficient of restitution for collinear collisions of elastic-perfectly plastic spheres,
// J. Appl. Mech. 64 (1997) 383-386, eqs 8 to 18, doi:10.1115/1.2787319; C. Thornton, Z. Ning, Powder
// Technology 99 (1998) 154, doi:10.1016/S0032-5910(98)00099-0.
#pragma once

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct Thornton {
    real stiffness = 0;      // A = (4/3) E sqrt(R), N/m^1.5
    real mass = 0;           // effective mass, kg
    real radius = 0;         // R, m
    real modulus = 0;        // E, Pa
    real yield_pressure = 0; // p_y, Pa

    static constexpr const char* name = "thornton";
    static constexpr Field<Thornton> fields[] = {{"stiffness", &Thornton::stiffness},
                                                 {"mass", &Thornton::mass},
                                                 {"radius", &Thornton::radius},
                                                 {"modulus", &Thornton::modulus},
                                                 {"yield_pressure", &Thornton::yield_pressure}};
    static constexpr bool hysteretic = true;

    // ---- the formula; k.stiffness = A, k.second holds S

    template <class T> RATTLEBOX_INLINE T yield_overlap(const Coefficients<T>& k) const {
        const T slope = k.second / k.stiffness;
        return (4.0 / 9.0) * slope * slope;
    }
    template <class T> RATTLEBOX_INLINE T elastic_force(const Coefficients<T>& k, const Depth<T>& d) const {
        return k.stiffness * d.overlap * d.root;
    }
    template <class T> RATTLEBOX_INLINE T yielding_force(const Coefficients<T>& k, const Depth<T>& d) const {
        // F_y + S (d - d_y) with F_y = (2/3) S d_y.
        return k.second * (d.overlap - (1.0 / 3.0) * yield_overlap(k));
    }
    // `above` is measured from the origin of the unloading curve.
    template <class T> RATTLEBOX_INLINE T unloading_force(const History<T>& h, const Depth<T>& above) const {
        return h.stiffness * above.overlap * above.root;
    }
    // Energy that unloading along that curve recovers.
    template <class T> RATTLEBOX_INLINE T recovered(const History<T>& h, const Depth<T>& above) const {
        return 0.4 * h.stiffness * above.overlap * above.overlap * above.root;
    }

    // ---- one impact

    bool needs_restitution() const { return false; }
    Coefficients<real> coefficients(real, real) const { return {stiffness, pi * yield_pressure * radius}; }
    // Before yielding the unloading curve is the Hertz curve.
    History<real> untouched() const { return {0, stiffness, 0}; }

    // Returns the history for unloading from the overlap `deepest`.
    History<real> unloaded_from(real deepest) const {
        const Coefficients<real> k = coefficients(0, 0);
        const real yield = yield_overlap(k);
        if (deepest <= yield) return {deepest, stiffness, 0};
        const real yield_force = 2.0 / 3.0 * k.second * yield;
        const real top = yielding_force(k, depth_from_overlap(deepest));
        const real contact_radius_squared = (2 * top + yield_force) / (2 * pi * yield_pressure);
        const real plastic_radius = 4 * modulus / (3 * top) * std::pow(contact_radius_squared, 1.5);
        const real curve = 4.0 / 3.0 * modulus * std::sqrt(plastic_radius);
        return {deepest, curve, deepest - std::pow(top / curve, 2.0 / 3.0)};
    }

    // Work of loading to the overlap `deepest` less the energy that unloading recovers.
    real plastic_loss(real deepest) const {
        const Coefficients<real> k = coefficients(0, 0);
        const real yield = yield_overlap(k), past = deepest - yield;
        if (past <= 0) return 0;
        const History<real> h = unloaded_from(deepest);
        const real work = 0.4 * stiffness * square(yield) * std::sqrt(yield) +
                          past * k.second * (2.0 / 3.0 * yield + 0.5 * past);
        return work - recovered(h, depth_from_overlap(deepest - h.origin));
    }

    // ---- scales

    Thornton resized(PairSize from, PairSize to) const {
        Thornton law = *this;
        law.mass = to.mass;
        law.radius = to.radius;
        law.stiffness *= std::sqrt(to.radius / from.radius);
        return law;
    }
    real overlap_scale(real speed) const { return std::pow(1.25 * mass * speed * speed / stiffness, 0.4); }
    // Upper bound: all energy is absorbed by yielding beyond the yield overlap.
    real largest_overlap(real speed) const {
        const Coefficients<real> k = coefficients(0, 0);
        return yield_overlap(k) + speed * std::sqrt(mass / k.second);
    }
    // Duration for a Hertz contact with the largest slope of the force in the impact, at the yield overlap or
    // at the start of unloading.
    real contact_time(real speed) const {
        const Coefficients<real> k = coefficients(0, 0);
        const real yield = yield_overlap(k), yield_force = 2.0 / 3.0 * k.second * yield;
        const real left = 0.5 * mass * speed * speed - 0.4 * yield_force * yield;
        if (left <= 0) return hertz_time * std::pow(1.25 * mass / stiffness, 0.4) * std::pow(speed, -0.2);
        const real top = std::sqrt(square(yield_force) + 2 * k.second * left);
        const History<real> h = unloaded_from(yield + (top - yield_force) / k.second);
        const real steepest = std::fmax(1.5 * top / (h.deepest - h.origin), 1.5 * yield_force / yield);
        // The square of the frequency of a Hertz contact is at most 1.5 * 1.25 (V / d_max)^2.
        return hertz_time * std::sqrt(1.5 * 1.25 * mass / steepest);
    }
    bool same_shape(const Thornton&) const { return true; }
};

} // namespace rattlebox
