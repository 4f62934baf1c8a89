// Measured curves of force against overlap for loading and unloading.
//
//     loading     F = f(d)
//     unloading   F = f(d_max) g(d / d_max)     from the largest overlap d_max so far, g(1) = 1
//
// f and g are monotone piecewise cubics through the measured points, extrapolated with their last slope. The
// unloading curve is measured from one largest overlap and scaled for others. It ends at the residual overlap
// r d_max, g(r) = 0; reloading follows it up to d_max. Without an unloading curve the contact is elastic:
// unloading follows f. Rate independent.
//
// F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, doi:10.1137/0905021.
#pragma once

#include <algorithm>

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

// Piecewise cubic function: coefficients of each piece about its left knot, highest power first.
struct PiecewiseCubic {
    Table knots, coefficients, integral; // integral from the first knot up to each knot

    bool empty() const { return knots.size == 0; }
    // Whether the sizes fit, and the function increases from knot to knot.
    bool is_possible() const {
        if (knots.size < 2 || integral.size != knots.size || coefficients.size != 4 * (knots.size - 1))
            return false;
        for (int i = 0; i < coefficients.size; ++i)
            if (!(std::fabs(coefficients[i]) < infinity)) return false;
        for (int i = 1; i < knots.size; ++i)
            if (!(knots[i - 1] < knots[i] && knots[i] < infinity && value(knots[i - 1]) <= value(knots[i]) &&
                  integral[i - 1] <= integral[i] && integral[i] < infinity))
                return false;
        return value(first()) >= 0 && value(last()) > 0 && slope(last()) >= 0;
    }
    real first() const { return knots[0]; }
    real last() const { return knots[knots.size - 1]; }
    int piece(real x) const {
        const auto after = std::upper_bound(knots.data, knots.data + knots.size, x) - knots.data;
        return std::clamp(static_cast<int>(after) - 1, 0, knots.size - 2);
    }
    // Of a number, or of one with derivatives.
    template <class T> T value(const T& x) const {
        if (x > T(last())) return value(last()) + slope(last()) * (x - last());
        const int i = piece(static_cast<real>(x));
        const real* c = coefficients.data + 4 * i;
        const T t = x - knots[i];
        return ((c[0] * t + c[1]) * t + c[2]) * t + c[3];
    }
    real slope(real x) const {
        const int i = piece(std::min(x, last()));
        const real *c = coefficients.data + 4 * i, t = std::min(x, last()) - knots[i];
        return (3 * c[0] * t + 2 * c[1]) * t + c[2];
    }
    real integral_to(real x) const {
        if (x > last()) {
            const real past = x - last();
            return integral[knots.size - 1] + past * (value(last()) + 0.5 * past * slope(last()));
        }
        const int i = piece(x);
        const real *c = coefficients.data + 4 * i, t = x - knots[i];
        return integral[i] + t * (c[3] + t * (c[2] / 2 + t * (c[1] / 3 + t * c[0] / 4)));
    }
    bool operator==(const PiecewiseCubic& other) const {
        return std::equal(knots.data, knots.data + knots.size, other.knots.data,
                          other.knots.data + other.knots.size) &&
               std::equal(coefficients.data, coefficients.data + coefficients.size, other.coefficients.data,
                          other.coefficients.data + other.coefficients.size);
    }
};

struct TabulatedNormal {
    real stiffness = 1;                                                // factor on the forces of the table
    real mass = 0;                                                     // effective mass, kg
    Table loading_knots, loading_coefficients, loading_integral;       // f: m, N
    Table unloading_knots, unloading_coefficients, unloading_integral; // g, from r to 1; empty: elastic

    static constexpr const char* name = "tabulated";
    static constexpr Field<TabulatedNormal> fields[] = {{"stiffness", &TabulatedNormal::stiffness},
                                                        {"mass", &TabulatedNormal::mass}};
    static constexpr TableField<TabulatedNormal> tables[] = {
        {"loading_knots", &TabulatedNormal::loading_knots},
        {"loading_coefficients", &TabulatedNormal::loading_coefficients},
        {"loading_integral", &TabulatedNormal::loading_integral},
        {"unloading_knots", &TabulatedNormal::unloading_knots},
        {"unloading_coefficients", &TabulatedNormal::unloading_coefficients},
        {"unloading_integral", &TabulatedNormal::unloading_integral}};
    static constexpr bool hysteretic = true;

    bool is_possible() const {
        return loading().is_possible() && (unloading().empty() || unloading().is_possible());
    }
    PiecewiseCubic loading() const { return {loading_knots, loading_coefficients, loading_integral}; }
    PiecewiseCubic unloading() const { return {unloading_knots, unloading_coefficients, unloading_integral}; }

    // ---- the formula; k.stiffness is the factor on the forces, h.stiffness the force at the deepest overlap

    template <class T> RATTLEBOX_INLINE T yield_overlap(const Coefficients<T>& k) const {
        return all(k.stiffness, 0); // yields from first touch on
    }
    template <class T> RATTLEBOX_INLINE T yielding_force(const Coefficients<T>& k, const Depth<T>& d) const {
        const PiecewiseCubic f = loading();
        return k.stiffness * each(d.overlap, [&](const auto& overlap) { return f.value(overlap); });
    }
    template <class T> RATTLEBOX_INLINE T elastic_force(const Coefficients<T>& k, const Depth<T>& d) const {
        return yielding_force(k, d);
    }
    // `above` is measured from the origin of the unloading curve.
    template <class T> RATTLEBOX_INLINE T unloading_force(const History<T>& h, const Depth<T>& above) const {
        if (unloading().empty()) return yielding_force({all(above.overlap, stiffness), h.origin}, above);
        const PiecewiseCubic g = unloading();
        return h.stiffness * each(part(h, above.overlap),
                                  [&](const auto& x) { return g.value(larger(x, all(x, g.first()))); });
    }
    // Energy that unloading along that curve recovers.
    template <class T> RATTLEBOX_INLINE T recovered(const History<T>& h, const Depth<T>& above) const {
        if (unloading().empty()) {
            const PiecewiseCubic f = loading();
            return stiffness * each(above.overlap, [&](real d) { return f.integral_to(d); });
        }
        const PiecewiseCubic g = unloading();
        return h.stiffness * h.deepest *
               each(part(h, above.overlap), [&](real x) { return g.integral_to(std::max(x, g.first())); });
    }

private:
    template <class T> RATTLEBOX_INLINE static T part(const History<T>& h, const T& above) {
        return (above + h.origin) / larger(h.deepest, all(above, 1e-300));
    }

public:
    // ---- one impact

    bool needs_restitution() const { return false; }
    Coefficients<real> coefficients(real, real) const { return {stiffness, 0}; }
    History<real> untouched() const { return {}; }
    History<real> unloaded_from(real deepest) const {
        if (unloading().empty()) return {deepest, stiffness * loading().value(deepest), 0};
        return {deepest, stiffness * loading().value(deepest), unloading().first() * deepest};
    }
    // Work of loading to the overlap `deepest` less the energy that unloading recovers.
    real plastic_loss(real deepest) const {
        if (unloading().empty() || deepest <= 0) return 0;
        const History<real> h = unloaded_from(deepest);
        return stiffness * loading().integral_to(deepest) -
               recovered(h, depth_from_overlap(deepest - h.origin));
    }

    // ---- scales

    TabulatedNormal resized(PairSize, PairSize to) const { // the measured curve does not scale with size
        TabulatedNormal law = *this;
        law.mass = to.mass;
        return law;
    }
    // Overlap at which the work of loading equals the kinetic energy.
    real largest_overlap(real speed) const {
        const real energy = 0.5 * mass * speed * speed / stiffness;
        const PiecewiseCubic f = loading();
        real low = 0, high = f.last();
        while (f.integral_to(high) < energy) high *= 2;
        for (int i = 0; i < 200 && high - low > 4 * epsilon * high; ++i) {
            const real middle = 0.5 * (low + high);
            (f.integral_to(middle) < energy ? low : high) = middle;
        }
        return high;
    }
    real overlap_scale(real speed) const { return largest_overlap(speed); }
    // Duration for a linear spring with the largest slope of the force in the impact.
    real contact_time(real speed) const {
        const real deepest = largest_overlap(speed);
        const PiecewiseCubic f = loading(), g = unloading();
        real steepest = 0;
        for (int i = 0; i <= 1000; ++i) steepest = std::fmax(steepest, f.slope(deepest * i / 1000));
        if (!g.empty() && deepest > 0)
            for (int i = 0; i <= 1000; ++i) {
                const real x = g.first() + (1 - g.first()) * i / 1000;
                steepest = std::fmax(steepest, f.value(deepest) / deepest * g.slope(x));
            }
        return pi * std::sqrt(mass / (stiffness * steepest));
    }
    bool same_shape(const TabulatedNormal& other) const {
        return loading() == other.loading() && unloading() == other.unloading();
    }
};

} // namespace rattlebox
