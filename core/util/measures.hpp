// Measures: numbers that characterise a run in a window. The table is their only description, for both
// engines and for Python: name, unit, meaning, what a measure needs, and its formula.
//
// A formula takes a run of the following form (Observer of the 1-D engine, RecordedRun of the 3-D engine),
// whose energies count from the start of the window:
//
//     count(), last(), time(i), length(), cycles()           samples; a cycle is that of the harmonic load
//     point(i)                                               displacement q and velocity p of the point
//     accelerations(i, frame)                                at both ends of the step before sample i
//     mean_damper_force(i)                                   mean over the step before sample i
//     interface_force(i)
//     motion(i), gravity(i), load_work(i), base_work(i), viscous(i), impact(i),
//     handled(i, motion, gravity)
//     loss_per_cycle(), mass(), cavity_speed(), apparent_mass(), has_dampers()
//     impacts()                                              of the 1-D engine alone
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include "math/real.hpp"

namespace rattlebox {

// Part of the largest energy of a run up to which the energy supplied and the residual count as none.
inline constexpr real energy_at_rest = 1e-10;

// ---- impacts

// Sums and extremes over impacts. The sum of the approach speeds is compensated (two-sum: D. E. Knuth, The
// Art of Computer Programming, vol. 2, section 4.2.2).
struct ImpactSums {
    real impacts = 0, approach_speeds = 0, rounded_off = 0;
    real largest_approach_speed = 0, peak_force = 0, peak_overlap = 0, longest_contact = 0;

    void add(const auto& i) {
        impacts += 1;
        const real sum = approach_speeds + i.approach_speed, part = sum - approach_speeds;
        rounded_off += (approach_speeds - (sum - part)) + (i.approach_speed - part);
        approach_speeds = sum;
        largest_approach_speed = std::fmax(largest_approach_speed, i.approach_speed);
        peak_force = std::fmax(peak_force, i.peak_force);
        peak_overlap = std::fmax(peak_overlap, i.peak_overlap);
        longest_contact = std::fmax(longest_contact, i.duration);
    }

    real mean_approach_speed() const {
        return impacts > 0 ? (approach_speeds + rounded_off) / impacts : not_a_number;
    }
};

template <class R> ImpactSums impacts_of(const R& run) {
    if constexpr (requires { run.impacts(); }) return run.impacts();
    return {}; // not requested: see Measure::of_impacts
}

// ---- samples

// Largest magnitude of f at samples `first` to the last one; 1 for means over the intervals before them.
template <class R, class F> real peak(const R& run, F&& f, std::size_t first = 0) {
    real most = 0;
    for (std::size_t i = first; i < run.count(); ++i) most = std::fmax(most, std::fabs(f(i)));
    return most;
}

template <class R, class F> real rms_of_means(const R& run, F&& f) {
    real total = 0;
    for (std::size_t i = 1; i < run.count(); ++i) total += square(f(i));
    return std::sqrt(total / static_cast<real>(run.last()));
}

template <class R, class F> real rms(const R& run, F&& f) { // trapezoids
    if constexpr (R::is_even) {
        real total = 0.5 * (square(f(0)) + square(f(run.last())));
        for (std::size_t i = 1; i < run.last(); ++i) total += square(f(i));
        return std::sqrt(total / static_cast<real>(run.last()));
    } else {
        real total = 0;
        for (std::size_t i = 1; i < run.count(); ++i)
            total += 0.5 * (run.time(i) - run.time(i - 1)) * (square(f(i)) + square(f(i - 1)));
        return std::sqrt(total / run.length());
    }
}

// Frame of an acceleration: relative to the base, or absolute.
enum class Frame { base, absolute };

template <class R> real peak_acceleration(const R& run, Frame frame) {
    real most = 0;
    for (std::size_t i = 1; i < run.count(); ++i)
        for (const real each : run.accelerations(i, frame)) most = std::fmax(most, std::fabs(each));
    return most;
}

template <class R> real rms_acceleration(const R& run, Frame frame) { // trapezoids
    real total = 0;
    for (std::size_t i = 1; i < run.count(); ++i)
        for (const real each : run.accelerations(i, frame))
            total += (R::is_even ? 0.5 : 0.5 * (run.time(i) - run.time(i - 1))) * square(each);
    return std::sqrt(total / (R::is_even ? static_cast<real>(run.last()) : run.length()));
}

// Time after which the magnitude of a signal z stays within a limit. NaN unless it has stayed there at least
// for the duration of its last swing, because the motion may just pass through the band.
template <class Time, class F> real settled_after(const Time& time, F&& z, std::size_t last, real limit) {
    const auto side = [&](std::size_t i) { return (z(i) > limit) - (z(i) < -limit); };
    const auto start_of = [&](std::size_t i) { // of consecutive samples on one side, or within the band
        const int here = side(i);
        while (i > 0 && side(i - 1) == here) --i;
        return i;
    };
    if (side(last) != 0) return not_a_number;
    const std::size_t within = start_of(last);
    if (within == 0) return time(0);
    // A fast oscillation may cross zero between two samples; signed values give the time at the edge of the
    // band.
    const std::size_t i = within - 1, start = start_of(i);
    const real out = std::copysign(limit, z(i));
    const real passed = time(i) + (time(i + 1) - time(i)) * (out - z(i)) / (z(i + 1) - z(i));
    if (start == 0) return passed;
    const std::size_t before = side(start - 1) == 0 ? start_of(start - 1) : start;
    if (before == 0 || side(before - 1) == side(i)) return passed;
    const real swing = time(start) - time(start_of(before - 1));
    return time(last) - passed < swing ? not_a_number : passed;
}

// ---- energy

template <class R> real share(const R& run, real part) {
    const std::size_t last = run.last();
    const real supplied =
        run.motion(0) + run.load_work(last) + run.base_work(last) + run.gravity(0) - run.gravity(last);
    return supplied > 0 ? part / supplied : not_a_number;
}

struct Balance {
    real residual = 0, supplied = 0, turnover = 0; // largest residual; energy supplied; sum of all terms
};

template <class R> Balance balance(const R& run) {
    Balance sums;
    real load = 0, base = 0, height = 0;
    const real before = run.motion(0) + run.gravity(0);
    for (std::size_t i = 0; i < run.count(); ++i) {
        const real moving = run.motion(i), potential = run.gravity(i);
        const real residual = moving + potential - before - run.load_work(i) - run.base_work(i) +
                              run.viscous(i) + run.impact(i);
        if (!(std::fabs(residual) <= sums.residual)) sums.residual = std::fabs(residual); // or NaN
        if (!std::isfinite(residual)) break;
        sums.turnover = std::fmax(sums.turnover, run.handled(i, moving, potential));
        load = std::fmax(load, std::fabs(run.load_work(i)));
        base = std::fmax(base, std::fabs(run.base_work(i)));
        height = std::fmax(height, std::fabs(potential - run.gravity(0)));
    }
    sums.supplied = load + base + run.motion(0) + height;
    return sums;
}

// Zero if nothing moves, so that only rounding errors of the largest energy are left.
template <class R> real energy_residual(const R& run) {
    const Balance b = balance(run);
    const bool rests = b.supplied <= energy_at_rest * b.turnover && b.residual <= energy_at_rest * b.turnover;
    return b.residual == 0 || rests ? 0 : b.residual / b.supplied;
}

// ---- table

// What a measure needs, beyond the energies of a run.
enum Needs : unsigned {
    energies = 0,
    single_impacts = 1,       // the impact log
    peaks_of_impacts = 2 | 1, // force and overlap of each impact
    samples = 4,              // samples of the motion, whose spacing limits the accuracy
    force_in_dampers = 8 | 4, //
    force_on_base = 16 | 4,   // participation of the modes
    loss_in_cycle = 32,       // energy that dampers take in a cycle
    first_harmonic = 64 | 4,  // force and motion of the cavity in whole cycles
    acceleration = 128 | 4,   // at both ends of each step
};

template <class R> struct Measure {
    const char *name, *unit, *meaning;
    unsigned needs;
    bool cyclic;         // is defined per cycle
    const char* average; // relation of a steady value to those of parts: see rattlebox.MEASURES
    real (*value)(const R&);
    bool despite_residual = false; // is computed also if the energy residual exceeds its limit

    bool need(unsigned part) const { return (needs & part) == part; }
};

template <class R>
inline constexpr Measure<R> measures[] = {
    {"impacts", "1", "impacts", single_impacts, false, "total",
     [](const R& r) { return impacts_of(r).impacts; }},
    {"impacts_per_cycle", "1", "impacts per cycle", single_impacts, true, "mean",
     [](const R& r) { return impacts_of(r).impacts / r.cycles(); }},
    {"peak_contact_force", "N", "peak contact force", peaks_of_impacts, false, "",
     [](const R& r) { return impacts_of(r).peak_force; }},
    {"peak_overlap", "m", "largest overlap", peaks_of_impacts, false, "",
     [](const R& r) { return impacts_of(r).peak_overlap; }},
    {"largest_approach_speed", "m/s", "largest approach speed", single_impacts, false, "",
     [](const R& r) { return impacts_of(r).largest_approach_speed; }},
    {"mean_approach_speed", "m/s", "mean approach speed", single_impacts, false, "mean",
     [](const R& r) { return impacts_of(r).mean_approach_speed(); }},
    {"longest_contact", "s", "longest contact", single_impacts, false, "",
     [](const R& r) { return impacts_of(r).longest_contact; }},
    {"work", "J", "work of load and base", energies, false, "total",
     [](const R& r) { return r.load_work(r.last()) + r.base_work(r.last()); }},
    {"viscous_loss", "J", "loss in the structure", energies, false, "total",
     [](const R& r) { return r.viscous(r.last()); }},
    {"impact_loss", "J", "loss in the damper", energies, false, "total",
     [](const R& r) { return r.impact(r.last()); }},
    {"viscous_share", "1", "share lost in the structure", energies, false, "",
     [](const R& r) { return share(r, r.viscous(r.last())); }},
    {"impact_share", "1", "share lost in the damper", energies, false, "",
     [](const R& r) { return share(r, r.impact(r.last())); }},
    {"motion_share", "1", "share left in the motion", energies, false, "",
     [](const R& r) { return share(r, r.motion(r.last())); }},
    {"energy_residual", "1", "energy residual over the energy put in", energies, false, "",
     [](const R& r) { return energy_residual(r); }, true},
    {"peak", "m", "peak displacement", samples, false, "",
     [](const R& r) { return peak(r, [&](std::size_t i) { return r.point(i).q; }); }},
    {"rms", "m", "RMS displacement", samples, false, "root mean square",
     [](const R& r) { return rms(r, [&](std::size_t i) { return r.point(i).q; }); }},
    {"peak_velocity", "m/s", "peak velocity", samples, false, "",
     [](const R& r) { return peak(r, [&](std::size_t i) { return r.point(i).p; }); }},
    {"rms_velocity", "m/s", "RMS velocity", samples, false, "root mean square",
     [](const R& r) { return rms(r, [&](std::size_t i) { return r.point(i).p; }); }},
    {"peak_acceleration", "m/s^2", "peak absolute acceleration, without peaks of contacts", acceleration,
     false, "", [](const R& r) { return peak_acceleration(r, Frame::absolute); }},
    {"rms_acceleration", "m/s^2", "RMS absolute acceleration, without peaks of contacts", acceleration, false,
     "root mean square", [](const R& r) { return rms_acceleration(r, Frame::absolute); }},
    {"peak_relative_acceleration", "m/s^2",
     "peak acceleration relative to the base, without peaks of contacts", acceleration, false, "",
     [](const R& r) { return peak_acceleration(r, Frame::base); }},
    {"rms_relative_acceleration", "m/s^2", "RMS acceleration relative to the base, without peaks of contacts",
     acceleration, false, "root mean square", [](const R& r) { return rms_acceleration(r, Frame::base); }},
    {"peak_damper_force", "N", "peak force of all dampers, mean over a sample step", force_in_dampers, false,
     "", [](const R& r) { return peak(r, [&](std::size_t i) { return r.mean_damper_force(i); }, 1); }},
    {"rms_damper_force", "N", "RMS force of all dampers, mean over a sample step", force_in_dampers, false,
     "root mean square",
     [](const R& r) { return rms_of_means(r, [&](std::size_t i) { return r.mean_damper_force(i); }); }},
    {"peak_interface_force", "N", "peak force on the base", force_on_base, false, "",
     [](const R& r) { return peak(r, [&](std::size_t i) { return r.interface_force(i); }); }},
    {"rms_interface_force", "N", "RMS force on the base", force_on_base, false, "root mean square",
     [](const R& r) { return rms(r, [&](std::size_t i) { return r.interface_force(i); }); }},
    {"settling_time", "s", "settling time to 5 % of the peak", samples, false, "",
     [](const R& r) {
         const auto z = [&](std::size_t i) { return r.point(i).q; };
         return settled_after([&](std::size_t i) { return r.time(i); }, z, r.last(), 0.05 * peak(r, z));
     }},
    {"loss_per_cycle", "J", "loss in the damper per cycle", loss_in_cycle, true, "mean",
     [](const R& r) { return r.loss_per_cycle(); }},
    // The loss per cycle over m V^2, where V is the velocity amplitude of the cavity.
    {"reduced_loss", "1", "loss a cycle over m V^2", loss_in_cycle | first_harmonic, true, "mean",
     [](const R& r) {
         return r.has_dampers() ? r.loss_per_cycle() / (r.mass() * square(r.cavity_speed())) : 0;
     }},
    {"effective_mass", "kg", "effective mass", first_harmonic, true, "mean",
     [](const R& r) { return r.apparent_mass().real(); }},
    {"damping_mass", "kg", "imaginary part of the apparent mass", first_harmonic, true, "mean",
     [](const R& r) { return -r.apparent_mass().imag(); }},
    {"loss_factor", "1", "loss factor", first_harmonic, true, "mean",
     [](const R& r) {
         const std::complex<real> mass = r.apparent_mass();
         return -mass.imag() / std::fabs(mass.real());
     }},
};

} // namespace rattlebox
