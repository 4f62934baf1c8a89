// Motion without contacts: modes and balls propagated exactly, and guaranteed detection of the first touch.
//
// Without load each mode has a closed form and each ball moves on a parabola, to any horizon. Under a load,
// or with modes coupled by damping, the flight has a bounded length and uses Taylor series
// (structure/taylor_series.hpp). In both cases g'' of each gap g has a lower bound L, so that no touch can
// occur before the first root of g + g' s + L s^2 / 2. Stepping from one such root to the next converges to
// the first touch and cannot miss one. A bound of g''' makes L close to g'' near the touch. (Conservative
// advancement: B. V. Mirtich, Impulse-based dynamic simulation of rigid body systems, PhD thesis, University
// of California, Berkeley 1996.)
#pragma once

#include <vector>

#include "impact/state.hpp"
#include "impact/taylor_motion.hpp"

namespace rattlebox {

struct FirstTouch {
    real time = 0;    // from the start of the flight
    int contact = -1; // -1: the horizon was reached
};

// Returns the first positive root of g + rate s + curvature s^2 / 2 for g >= 0.
inline real safe_step(real g, real rate, real curvature) {
    if (g <= 0 && rate > 0) return curvature < 0 ? -2 * rate / curvature : infinity;
    const real discriminant = rate * rate - 2 * curvature * g;
    if (rate < 0) return discriminant < 0 ? infinity : 2 * g / (-rate + std::sqrt(discriminant));
    return curvature < 0 ? (rate + std::sqrt(discriminant)) / -curvature : infinity;
}

class Flight {
    const Problem& problem_;
    const State* start_ = nullptr;
    const Loads* loads_ = nullptr;
    bool series_ = false;
    real horizon_ = 0;
    std::vector<FreeMode> free_;
    TaylorMotion series_motion_;
    std::vector<real> curvature_, jerk_; // by contact: lower bound of g'', bound of |g'''|
    mutable std::vector<real> safe_;     // time before which a contact cannot touch

    // Calls add(weight, series) for the series whose sum is the gap.
    template <class Add> void each_part(const Contact& contact, Add&& add) const {
        const std::vector<Series>&balls = series_motion_.balls(), &modes = series_motion_.modes();
        if (contact.above >= 0) add(1.0, balls[static_cast<std::size_t>(contact.above)]);
        if (contact.below != wall) add(-1.0, balls[static_cast<std::size_t>(contact.below)]);
        if (contact.below != wall && contact.above != wall) return;
        const Damper& damper = problem_.dampers[static_cast<std::size_t>(contact.damper)];
        const real side = contact.below == wall ? 1 : -1;
        for (std::size_t k = 0; k < damper.shape.size(); ++k) add(-side * damper.shape[k], modes[k]);
    }

    Series gap_series(const Contact& contact) const {
        Series g;
        each_part(contact, [&](real weight, const Series& part) { g.add(weight, part); });
        if (contact.below == wall || contact.above == wall)
            g.c[0] += 0.5 * problem_.dampers[static_cast<std::size_t>(contact.damper)].clearance;
        return g;
    }

    // Returns g'' of a gap at a wall in free flight.
    real acceleration(const Contact& contact, const real* y) const {
        const Damper& damper = problem_.dampers[static_cast<std::size_t>(contact.damper)];
        real wall_acceleration = 0;
        for (std::size_t k = 0; k < damper.shape.size(); ++k) {
            const Mode& mode = problem_.modes[k];
            wall_acceleration -=
                damper.shape[k] * (2 * mode.decay * y[2 * k + 1] + mode.stiffness * y[2 * k]);
        }
        const real apart = damper.gravity - wall_acceleration;
        return contact.below == wall ? apart : -apart;
    }

    // Returns a time for which contact c stays open.
    real safe_time(std::size_t c, const Gap& g, const real* y) const {
        const Contact& contact = problem_.contacts[c];
        const real value = std::max(g.value, 0.0);
        real bound = curvature_[c];
        if (!series_ && (contact.below == wall || contact.above == wall)) {
            const real now = acceleration(contact, y);
            bound = std::max(bound, now - jerk_[c] * safe_step(value, g.rate, now));
        }
        return safe_step(value, g.rate, bound);
    }

    void bound_curvatures() {
        for (std::size_t c = 0; c < problem_.contacts.size(); ++c) {
            const Contact& contact = problem_.contacts[c];
            if (contact.below != wall && contact.above != wall && series_motion_.held().empty()) {
                curvature_[c] = 0; // both balls have the same acceleration
            } else if (series_) {
                curvature_[c] = gap_series(contact).min_curvature(horizon_);
            } else {
                const Damper& damper = problem_.dampers[static_cast<std::size_t>(contact.damper)];
                real bound = 0;
                jerk_[c] = 0;
                for (std::size_t k = 0; k < free_.size(); ++k) {
                    real acceleration, jerk;
                    free_[k].bounds(acceleration, jerk);
                    bound += std::fabs(damper.shape[k]) * acceleration;
                    jerk_[c] += std::fabs(damper.shape[k]) * jerk;
                }
                curvature_[c] = (contact.below == wall ? damper.gravity : -damper.gravity) - bound;
            }
        }
    }

public:
    explicit Flight(const Problem& problem)
        : problem_(problem), series_motion_(problem), curvature_(problem.contacts.size()),
          jerk_(problem.contacts.size()), safe_(problem.contacts.size()) {
        for (const Mode& mode : problem.modes) free_.emplace_back(mode);
    }

    // Starts a flight of at most `length` from `state`; `series` forces Taylor series also without load.
    // Hard contacts in `held` stay closed.
    void start(const State& state, const Loads& loads, real length, bool series,
               const std::vector<int>& held = {}) {
        start_ = &state;
        loads_ = &loads;
        series_ = series || loads.active() || !problem_.coupling.empty() || !held.empty();
        horizon_ = length;
        series_motion_.hold(held);
        if (series_) {
            const real rate = std::max(loads.frequency(), fastest_rate(problem_.modes, problem_.coupling));
            // Rounded to a representable time, or the time would drift from the motion with each flight.
            if (rate * horizon_ > 1) horizon_ = state.t + 1 / rate - state.t;
            series_motion_.expand(state, loads, held);
        } else {
            for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                free_[k].start({state.y[2 * k], state.y[2 * k + 1]});
        }
        bound_curvatures();
    }

    real horizon() const { return horizon_; }
    // The series of the motion, or null if it is in closed form.
    const TaylorMotion* series() const { return series_ ? &series_motion_ : nullptr; }
    // Whether bounds of the motion depend on the length that the flight was given.
    bool is_bounded_by(real length) const { return series_ && horizon_ == length; }
    real curvature(std::size_t contact) const { return curvature_[contact]; }

    // Computes the state after time s.
    void at(real s, State& out) const {
        out.t = start_->t + s;
        if (series_) return series_motion_.at(s, out);
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            const ModeState mode = free_[k].at(s);
            out.y[2 * k] = mode.q;
            out.y[2 * k + 1] = mode.p;
        }
        const real* s0 = positions(problem_, start_->y.data());
        const real* v0 = velocities(problem_, start_->y.data());
        real* position = positions(problem_, out.y.data());
        real* velocity = velocities(problem_, out.y.data());
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            const real g = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
            position[i] = s0[i] + s * (v0[i] + 0.5 * g * s);
            velocity[i] = v0[i] + g * s;
        }
        for (std::size_t i = problem_.motion_size(); i < out.y.size(); ++i) out.y[i] = start_->y[i];
    }

    // Adds work and viscous loss over [0, s], by quadrature or in closed form rather than as a difference of
    // energies, so that the energy balance is an independent check.
    void add_to_ledger(real s, Ledger& ledger) const {
        if (!series_) {
            for (const FreeMode& mode : free_) ledger.viscous += mode.dissipated(s);
            return;
        }
        const std::vector<Series>&modes = series_motion_.modes(), &balls = series_motion_.balls();
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            if (problem_.modes[k].decay != 0)
                ledger.viscous += 2 * problem_.modes[k].decay *
                                  integrate(s, [&](real r) { return square(modes[k].slope(r)); });
        if (!problem_.coupling.empty())
            ledger.viscous += integrate(s, [&](real r) {
                return coupled_power(problem_.coupling, problem_.modes.size(),
                                     [&](std::size_t k) { return modes[k].slope(r); });
            });
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            if (loads_->piece(l).is_zero()) continue;
            const Load& load = loads_->load(l);
            const real work = integrate(s, [&](real r) {
                real speed = 0;
                for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                    speed += load.shape[k] * modes[k].slope(r);
                if (load.base)
                    for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
                        speed -= problem_.ball_mass[i] * balls[i].slope(r);
                return series_motion_.loads()[l].value(r) * speed;
            });
            (load.base ? ledger.base_work : ledger.load_work) += work;
        }
    }

    // Returns how a contact that touches at rest continues: -1 closing, +1 opening (the horizon is shortened
    // so that it cannot close again), 0 at rest. Needs series.
    int tendency(const Contact& contact) {
        const Series g = gap_series(contact);
        real sizes[Series::order + 1] = {}; // of the terms that may cancel
        each_part(contact, [&](real weight, const Series& part) {
            for (int n = 0; n <= Series::order; ++n) sizes[n] += std::fabs(weight * part.c[n]);
        });
        // A stop may touch at a point that another one holds: the forces there are the terms that cancel.
        for (std::size_t i = 0; contact.above == ground && i < series_motion_.held().size(); ++i) {
            const Contact& held = problem_.contacts[static_cast<std::size_t>(series_motion_.held()[i])];
            const real response = std::fabs(contact_coupling(problem_, contact, held));
            for (int n = 2; n <= Series::order; ++n)
                sizes[n] += response * std::fabs(series_motion_.forces()[i].c[n - 2]) / (n * (n - 1));
        }
        real scale = 0, power = 1;
        for (int n = 1; n <= Series::order; ++n)
            scale = std::max(scale, std::fabs(g.c[n]) * (power *= horizon_));
        power = horizon_;
        real terms = 0;
        for (int n = 2; n <= Series::order; ++n) {
            power *= horizon_;
            // What rounds in one order rounds in all that follow from it, which a held point leaves alone.
            terms = contact.above == ground ? std::fmax(terms, sizes[n] * power) : sizes[n] * power;
            // Rounding errors of the forces, and of the time at which loads are evaluated.
            const real turned = n < Series::order ? (n + 1) * std::fabs(g.c[n + 1]) * start_->t : 0;
            const real limit = tendency_of_gap * scale + tendency_of_terms * (terms + turned * power);
            if (std::fabs(g.c[n]) * power <= epsilon * limit) continue;
            if (g.c[n] < 0) return -1;
            // The sum from each term on has a lower bound over the horizon. A small first term with a
            // positive one after it must not shorten the horizon: a ball that a shaken floor lets go has
            // g'' = 0 there.
            for (;;) {
                real bound = 0;
                for (int j = Series::order; j >= n; --j) bound = g.c[j] + std::fmin(bound, 0.0) * horizon_;
                if (bound > 0) return 1;
                horizon_ *= 0.5;
            }
        }
        return 0;
    }

    const std::vector<int>& held() const { return series_motion_.held(); }

    // Returns the force of the i-th held contact after time s.
    real held_force(std::size_t i, real s) const { return series_motion_.forces()[i].value(s); }

    // The first of `count` held contacts whose force becomes attractive, and the time of that.
    FirstTouch first_release(std::size_t count) const {
        FirstTouch first{horizon_, -1};
        if (count == 0) return first;
        const std::vector<Series>& forces = series_motion_.forces();
        real largest = 0; // size of the forces, whose rounding errors those of all others share
        for (std::size_t i = 0; i < count; ++i) {
            real size = 0, power = 1;
            for (int n = 0; n <= Series::order; ++n, power *= horizon_)
                size += std::fabs(forces[i].c[n]) * power;
            largest = std::fmax(largest, size);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Contact& contact = problem_.contacts[static_cast<std::size_t>(series_motion_.held()[i])];
            const Series& force = forces[i];
            // Rounding errors of the accelerations and of the time at which loads are evaluated.
            real size = std::fabs(force.c[1]) * start_->t;
            each_part(contact, [&](real weight, const Series& part) {
                size += 2 * std::fabs(weight * part.c[2]) * contact.mass;
            });
            const real rounding = epsilon * (force_of_all * largest + force_of_terms * size);
            const real bound = force.min_curvature(horizon_);
            for (real s = 0; s < first.time;) {
                const real value = force.value(s) + rounding, rate = force.slope(s);
                const real step = safe_step(std::fmax(value, 0.0), rate, bound);
                // A force that is attractive at first and grows may be one that starts at zero.
                const bool is_attractive =
                    value < 0 ? rate <= 0 || value < -force_that_grows * rounding : value == 0 && rate < 0;
                if (is_attractive || step <= epsilon * s) {
                    first = {s, static_cast<int>(i)};
                    break;
                }
                s += step;
            }
        }
        return first;
    }

    // Returns the rounding error of a gap.
    real gap_rounding(const Contact& contact, const State& state) const {
        const real half = 0.5 * problem_.dampers[static_cast<std::size_t>(contact.damper)].clearance;
        const int ball = contact.below == wall ? contact.above : contact.below;
        if (ball == ground)
            return flight_gap_rounding * stop_terms(problem_, contact, state.y.data(), state.t);
        return flight_gap_rounding * (half + std::fabs(positions(problem_, state.y.data())[ball]));
    }

    // Returns the first touch of the watched contacts before `horizon`, and the state there. A contact is
    // returned only if its own gap at that time is closed to rounding: contacts whose safe times differ by
    // less than the resolution of time are all evaluated there.
    FirstTouch first_touch(const std::vector<char>& is_watched, real horizon, State& out) const {
        const auto end = [&](FirstTouch touch) {
            at(touch.time, out);
            return touch;
        };
        constexpr int max_iterations = 1000; // then a new flight begins at the time reached
        for (std::size_t c = 0; c < safe_.size(); ++c) safe_[c] = is_watched[c] ? 0 : infinity;
        real s = 0;
        out = *start_;
        for (int iteration = 0; iteration < max_iterations; ++iteration) {
            const real resolution = epsilon * s;
            real next = infinity;
            for (std::size_t c = 0; c < safe_.size(); ++c) {
                if (safe_[c] - s <= resolution) {
                    const Contact& contact = problem_.contacts[c];
                    const Gap g = gap(problem_, contact, out.y.data());
                    const real rounding = gap_rounding(contact, out);
                    // A hard stop never recovers: what it overlaps by is rounding.
                    const bool recovers =
                        contact.above != ground || problem_.settings.method != Method::newton;
                    if (g.value < -rounding && g.rate > 0 &&
                        recovers) { // released and still recovering: latest time at which it opens
                        const real room = g.rate * g.rate + 2 * curvature_[c] * -g.value;
                        safe_[c] = s - 2 * g.value / (g.rate + std::sqrt(std::max(room, 0.0)));
                    } else {
                        const FirstTouch touch{s, static_cast<int>(c)};
                        if (g.value <= rounding && g.rate < 0) return touch;
                        safe_[c] = s + safe_time(c, g, out.y.data());
                        if (safe_[c] - s <= resolution) {
                            if (g.value <= rounding + 4 * resolution * std::fabs(g.rate)) return touch;
                            return {s, -1}; // open; a new flight has a finer resolution
                        }
                    }
                }
                next = std::min(next, safe_[c]);
            }
            if (!(next < horizon)) return end({horizon, -1});
            s = next;
            at(s, out);
        }
        return {s, -1};
    }
};

} // namespace rattlebox
