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
    std::vector<Series> mode_series_, ball_series_, load_series_, force_series_;
    std::vector<real> curvature_, jerk_; // by contact: lower bound of g'', bound of |g'''|
    mutable std::vector<real> safe_;     // time before which a contact cannot touch

    // Calls add(weight, series) for the series whose sum is the gap.
    template <class Add> void each_part(const Contact& contact, Add&& add) const {
        if (contact.above != wall) add(1.0, ball_series_[static_cast<std::size_t>(contact.above)]);
        if (contact.below != wall) add(-1.0, ball_series_[static_cast<std::size_t>(contact.below)]);
        if (contact.below != wall && contact.above != wall) return;
        const Damper& damper = problem_.dampers[static_cast<std::size_t>(contact.damper)];
        const real side = contact.below == wall ? 1 : -1;
        for (std::size_t k = 0; k < damper.shape.size(); ++k) add(-side * damper.shape[k], mode_series_[k]);
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
            if (contact.below != wall && contact.above != wall) {
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
        : problem_(problem), load_series_(problem.loads.size()), curvature_(problem.contacts.size()),
          jerk_(problem.contacts.size()), safe_(problem.contacts.size()) {
        for (const Mode& mode : problem.modes) free_.emplace_back(mode);
        mode_series_.reserve(problem.modes.size());
        ball_series_.reserve(problem.ball_mass.size());
    }

    // Begins a flight of at most `length` from `start`; `series` forces Taylor series also without load.
    void begin(const State& start, const Loads& loads, real length, bool series) {
        start_ = &start;
        loads_ = &loads;
        series_ = series || loads.active() || !problem_.coupling.empty();
        horizon_ = length;
        if (series_) {
            const real rate = std::max(loads.frequency(), fastest_rate(problem_.modes, problem_.coupling));
            // Rounded to a representable time, or the time would drift from the motion with each flight.
            if (rate * horizon_ > 1) horizon_ = start.t + 1 / rate - start.t;
            Series base;
            for (std::size_t l = 0; l < loads.size(); ++l) {
                load_series_[l] = Series{};
                loads.piece(l).add_taylor(start.t, 1, Series::order, load_series_[l].c);
                if (loads.load(l).base) base.add(-1, load_series_[l]);
            }
            mode_series_.clear();
            force_series_.assign(problem_.modes.size(), Series{});
            for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
                Series& force = force_series_[k];
                for (std::size_t l = 0; l < loads.size(); ++l)
                    force.add(loads.load(l).shape[k], load_series_[l]);
                if (problem_.coupling.empty())
                    mode_series_.push_back(
                        forced_mode(problem_.modes[k], {start.y[2 * k], start.y[2 * k + 1]}, force));
            }
            if (!problem_.coupling.empty())
                coupled_series(problem_.modes, problem_.coupling, start.y.data(), force_series_,
                               mode_series_);
            ball_series_.clear();
            for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
                Series acceleration = base;
                acceleration.c[0] +=
                    problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
                ball_series_.push_back(forced_ball(positions(problem_, start.y.data())[i],
                                                   velocities(problem_, start.y.data())[i], acceleration));
            }
        } else {
            for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                free_[k].begin({start.y[2 * k], start.y[2 * k + 1]});
        }
        bound_curvatures();
    }

    real horizon() const { return horizon_; }
    real curvature(std::size_t contact) const { return curvature_[contact]; }

    // Computes the state after time s.
    void at(real s, State& out) const {
        out.t = start_->t + s;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            const ModeState mode =
                series_ ? ModeState{mode_series_[k].value(s), mode_series_[k].slope(s)} : free_[k].at(s);
            out.y[2 * k] = mode.q;
            out.y[2 * k + 1] = mode.p;
        }
        const real* s0 = positions(problem_, start_->y.data());
        const real* v0 = velocities(problem_, start_->y.data());
        real* position = positions(problem_, out.y.data());
        real* velocity = velocities(problem_, out.y.data());
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            if (series_) {
                position[i] = ball_series_[i].value(s);
                velocity[i] = ball_series_[i].slope(s);
            } else {
                const real g = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
                position[i] = s0[i] + s * (v0[i] + 0.5 * g * s);
                velocity[i] = v0[i] + g * s;
            }
        }
    }

    // Adds work and viscous loss over [0, s], by quadrature or in closed form rather than as a difference of
    // energies, so that the energy balance is an independent check.
    void add_to_ledger(real s, Ledger& ledger) const {
        if (!series_) {
            for (const FreeMode& mode : free_) ledger.viscous += mode.dissipated(s);
            return;
        }
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            if (problem_.modes[k].decay != 0)
                ledger.viscous += 2 * problem_.modes[k].decay *
                                  integrate(s, [&](real r) { return square(mode_series_[k].slope(r)); });
        if (!problem_.coupling.empty())
            ledger.viscous += integrate(s, [&](real r) {
                return coupled_power(problem_.coupling, problem_.modes.size(),
                                     [&](std::size_t k) { return mode_series_[k].slope(r); });
            });
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            if (loads_->piece(l).is_zero()) continue;
            const Load& load = loads_->load(l);
            const real work = integrate(s, [&](real r) {
                real speed = 0;
                for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                    speed += load.shape[k] * mode_series_[k].slope(r);
                if (load.base)
                    for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
                        speed -= problem_.ball_mass[i] * ball_series_[i].slope(r);
                return load_series_[l].value(r) * speed;
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
        real scale = 0, power = 1;
        for (int n = 1; n <= Series::order; ++n)
            scale = std::max(scale, std::fabs(g.c[n]) * (power *= horizon_));
        power = horizon_;
        for (int n = 2; n <= Series::order; ++n) {
            power *= horizon_;
            // Rounding errors of the forces, and of the time at which loads are evaluated.
            const real turned = n < Series::order ? (n + 1) * std::fabs(g.c[n + 1]) * start_->t : 0;
            const real limit = 8192 * scale + 64 * (sizes[n] + turned) * power;
            if (std::fabs(g.c[n]) * power <= epsilon * limit) continue;
            if (g.c[n] < 0) return -1;
            for (;;) {
                real rest = 0, later = 1;
                for (int j = n + 1; j <= Series::order; ++j)
                    rest += std::fmin(g.c[j], 0.0) * (later *= horizon_);
                if (g.c[n] + rest > 0) return 1;
                horizon_ *= 0.5;
            }
        }
        return 0;
    }

    // Returns the rounding error of a gap.
    real gap_rounding(const Contact& contact, const State& state) const {
        const real half = 0.5 * problem_.dampers[static_cast<std::size_t>(contact.damper)].clearance;
        const int ball = contact.below == wall ? contact.above : contact.below;
        return 4 * epsilon * (half + std::fabs(positions(problem_, state.y.data())[ball]));
    }

    // Returns the first touch of the watched contacts within the horizon, and the state there. A contact is
    // returned only if its own gap at that time is closed to rounding: contacts whose safe times differ by
    // less than the resolution of time are all evaluated there.
    FirstTouch first_touch(const std::vector<char>& is_watched, State& out) const {
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
                    if (g.value < -rounding &&
                        g.rate > 0) { // released and still recovering: latest time at which it opens
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
            if (!(next < horizon_)) return end({horizon_, -1});
            s = next;
            at(s, out);
        }
        return {s, -1};
    }
};

} // namespace rattlebox
