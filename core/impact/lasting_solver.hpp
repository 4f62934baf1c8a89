// Long steps of contacts that stay closed (impact/lasting_contact.hpp), until something happens to one.
#pragma once

#include "impact/closed_output.hpp"
#include "impact/lasting_contact.hpp"

namespace rattlebox {

class LastingSolver {
    RunState& run_;
    const Problem& problem_;
    Output& output_;
    ClosedMotion& motion_;
    ClosedOutput& samples_;
    LastingContact step_;
    State state_; // at the nodes of a step
    std::vector<real> inside_;

    // Part of an overlap below which its changes count as rounding.
    real rest_part() const { return rest_tolerances * run_.resolution(); }

    // Returns whether nothing will move before the next knot: the loads are constant, and speeds and
    // accelerations of all bodies are below the tolerance of the overlaps, at the frequency of the contacts
    // or of the mode.
    bool is_at_rest(real frequency) {
        for (std::size_t l = 0; l < run_.loads.size(); ++l)
            if (run_.loads.piece(l).amplitude != 0 || run_.loads.piece(l).slope != 0) return false;
        real overlap = infinity;
        for (std::size_t j = 0; j < run_.system.active.size(); ++j)
            overlap = std::fmin(overlap, motion_.overlap_of(motion_.y.data(), j));
        run_.system(motion_.y.data(), motion_.trial.data());
        const real clock = motion_.trial[run_.system.time_index()], small = rest_part() * overlap;
        if (!(clock > 0)) return false;
        const auto rests = [&](real x, real speed, real acceleration, real rate, real shape) {
            const real length = std::fmax(small / shape, 4 * epsilon * std::fabs(x));
            return std::fabs(speed) <= length * rate &&
                   std::fabs(acceleration / clock) <= length * rate * rate;
        };
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real shape = 0;
            for (const Damper& damper : problem_.dampers)
                shape = std::fmax(shape, std::fabs(damper.shape[k]));
            const real rate = std::fmin(std::sqrt(problem_.modes[k].stiffness), frequency);
            if (shape > 0 &&
                !rests(motion_.y[2 * k], motion_.y[2 * k + 1], motion_.trial[2 * k + 1], rate, shape))
                return false;
            if (shape == 0 && (motion_.y[2 * k + 1] != 0 || motion_.trial[2 * k + 1] != 0)) return false;
        }
        const real *v = velocities(problem_, motion_.y.data()),
                   *dv = velocities(problem_, motion_.trial.data());
        for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
            if (!rests(0, v[b], dv[b], frequency, 1)) return false;
        return true;
    }

    // Returns the error of the long step over the tolerance, apart from the rounding errors of the forces,
    // which follow from overlaps and of the time.
    real error_of(real frequency) const {
        const real time = run_.state.t + motion_.y[run_.system.time_index()]; // at which loads are evaluated
        const real rounding = epsilon * (8 + square(frequency * step_.h) + run_.loads.frequency() * time);
        const auto tail = [&](const LastingContact::Row& f, real size) {
            return std::fmax(step_.tail(f) - rounding * size, 0.0);
        };
        real error = 0;
        for (const auto& force : step_.force) {
            const real largest = *std::max_element(std::begin(force.at), std::end(force.at));
            error = std::fmax(error, tail(force, largest) / (run_.resolution() * largest));
        }
        const std::size_t modes = problem_.modes.size(), balls = problem_.ball_mass.size();
        for (std::size_t b = 0; b < modes + balls; ++b)
            error = std::fmax(error, step_.h * tail(step_.acceleration[b], step_.free_acceleration(b)) /
                                         motion_.scale[b < modes ? 2 * b + 1 : modes + balls + b]);
        return error;
    }

    // The smallest and the largest value that a resolved function can have between the nodes.
    static Span range_of(const LastingContact::Row& f) {
        const auto [low, high] = std::minmax_element(std::begin(f.at), std::end(f.at));
        const real margin = between_nodes * (*high - *low);
        return {*low - margin, *high + margin};
    }

    // Returns the largest value of a function within the long step.
    static real largest_within(const LastingContact::Row& f) {
        const auto& node = LastingContact::rule().node;
        const auto top = std::max_element(std::begin(f.at), std::end(f.at)) - std::begin(f.at);
        real low = top == 0 ? 0 : node[top - 1], high = top == LastingContact::n - 1 ? 1 : node[top + 1];
        real most = f[static_cast<int>(top)];
        constexpr real golden = 0.6180339887498949;
        for (int i = 0; i < 40; ++i) {
            const real a = high - golden * (high - low), b = low + golden * (high - low);
            const real left = LastingContact::rule().interpolate(f, a),
                       right = LastingContact::rule().interpolate(f, b);
            most = std::fmax(most, std::fmax(left, right));
            (left < right ? low : high) = left < right ? a : b;
        }
        return most;
    }

    // Whether no contact begins, ends or changes its phase within the long step.
    bool stays_closed() {
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
            const Active& a = run_.system.active[j];
            const Span force = range_of(step_.force[j]), overlap = range_of(step_.overlap[j]);
            if (!(force.low > 0) || !(overlap.low > a.state.origin())) return false;
            const Span smooth = motion_.smooth_span_at(j, step_.overlap[j][0]);
            if (overlap.low < smooth.low || overlap.high > smooth.high) return false;
            // A vibration returns to its deepest overlap without yielding again.
            const real end = run_.contact(a.contact).normal.visit(
                [&](const auto& law) { return last_overlap(law, a.state); });
            if (overlap.high > end && largest_within(step_.overlap[j]) > end * (1 + run_.resolution()))
                return false;
        }
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (run_.phase(c) != RunState::Phase::open) continue;
            if (!(range_of(step_.gap_of(run_.contact(c), state_)).low >
                  motion_.gap_rounding(c, motion_.y.data())))
                return false;
        }
        return true;
    }

    // Takes the samples within a long step: requested times and deepest overlaps.
    void sample(real from, real to) {
        std::vector<std::pair<real, bool>> times; // and whether the time was requested
        while (output_.is_due(to)) times.emplace_back(output_.next_time(), true);
        if (output_.samples_contacts())
            for (std::size_t j = 0; j < run_.system.active.size(); ++j)
                for (int i = 0; i + 1 < LastingContact::n; ++i) {
                    const LastingContact::Row& rate = step_.rate[j];
                    const real moves = run_.resolution() * run_.system.active[j].speed;
                    if (!(rate[i] > moves && rate[i + 1] < 0) && !(rate[i] > 0 && rate[i + 1] < -moves))
                        continue;
                    real low = LastingContact::rule().node[i], high = LastingContact::rule().node[i + 1];
                    for (int half = 0; half < 30; ++half) {
                        const real middle = 0.5 * (low + high);
                        (LastingContact::rule().interpolate(rate, middle) > 0 ? low : high) = middle;
                    }
                    times.emplace_back(from + low * step_.h, false);
                }
        std::sort(times.begin(), times.end());
        for (const auto& [t, given] : times) {
            inside_.resize(run_.system.size());
            const real part = (t - from) / step_.h;
            if (part >= 1) {
                samples_.sample(motion_.trial, t, given);
            } else {
                step_.state_at(run_.system, motion_.y.data(), part, inside_);
                samples_.sample(inside_, t, given);
            }
        }
    }

    // Moves the integrated state at rest to a time since the start; only impulses on stops change.
    void rest_until(real since) {
        const std::size_t clock = run_.system.time_index();
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
            const Contact& c = run_.contact(run_.system.active[j].contact);
            if (c.above == ground)
                motion_.y[impulse_index(problem_, c)] +=
                    run_.system.force(motion_.y.data(), j) * (since - motion_.y[clock]);
        }
        motion_.y[clock] = since;
    }

    void sample_at_rest(real t) {
        if (problem_.stop_count > 0) rest_until(t - run_.state.t);
        samples_.sample(motion_.y, t, true);
    }

    void record_peaks() {
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
            Impact& impact = run_.result.impacts[static_cast<std::size_t>(run_.system.active[j].impact)];
            if (range_of(step_.force[j]).high > impact.peak_force)
                impact.peak_force = std::fmax(impact.peak_force, largest_within(step_.force[j]));
            if (range_of(step_.overlap[j]).high > impact.peak_overlap)
                impact.peak_overlap = std::fmax(impact.peak_overlap, largest_within(step_.overlap[j]));
        }
    }

public:
    LastingSolver(RunState& run, Output& output, ClosedMotion& motion, ClosedOutput& samples)
        : run_(run), problem_(run.problem), output_(output), motion_(motion), samples_(samples),
          step_(problem_), state_(problem_) {}

    // Whether all closed contacts have lasted so long that long steps may pay. The explicit steps before keep
    // ordinary impacts as they are.
    bool may_last() const {
        if (run_.system.active.empty() || !run_.released.empty() || !problem_.coupling.empty()) return false;
        for (const Active& a : run_.system.active)
            if (a.steps < a.wait || a.state.phase == ContactState::yielding) return false;
        for (RunState::Phase p : run_.phases)
            if (p == RunState::Phase::touching) return false;
        return true;
    }

    // Makes long steps until a contact begins, ends or changes its phase, or until the time `remaining`.
    // Returns whether there was a step.
    bool advance(real remaining) {
        const std::size_t clock = run_.system.time_index();
        const real frequency = std::sqrt(step_.square_of_frequency(run_.system, motion_.y.data()));
        if (!(frequency > 0 && frequency < infinity)) return false;
        // Beyond the longest step rounding errors of the forces matter; below the shortest one the equations
        // of all nodes and contacts cost more than explicit steps.
        const real longest = longest_lasting / frequency;
        const real shortest =
            shortest_lasting * cube(static_cast<real>(run_.system.active.size())) / frequency;
        bool advanced = false;
        for (real h = 1.5 * shortest;;) {
            if (run_.is_stopped()) return advanced;
            const real now = run_.state.t + motion_.y[clock], left = remaining - motion_.y[clock];
            if (is_at_rest(frequency)) {
                run_.meet_stop();
                while (output_.is_due(run_.state.t + remaining)) sample_at_rest(output_.next_time());
                if (run_.listener) run_.listener->rest(motion_.y.data(), now, left);
                rest_until(remaining);
                return true;
            }
            if (h < shortest || shortest > longest) return advanced;
            const bool last = h >= left, is_short = !advanced && left < shortest;
            if (last || is_short) run_.meet_stop();
            if (is_short) return advanced;
            // Rounded to a representable time, or the time would drift from the motion with each step.
            const real step = last ? left : now + h - now;
            const bool solved = step_.solve_step(run_.system, run_.loads, motion_.y.data(), now, step);
            const real error = solved ? error_of(frequency) : infinity;
            if (!(error <= 1)) {
                ++run_.result.counts.rejected_steps;
                h = step * (error < infinity ? std::fmax(0.3, 0.9 * std::pow(error, -1.0 / 15)) : 0.5);
                continue;
            }
            if (!stays_closed()) return advanced;
            ++run_.result.counts.contact_steps;
            run_.result.permitted_error += motion_.permitted_error;
            step_.state_at(run_.system, motion_.y.data(), 1, motion_.trial);
            if (run_.listener) run_.listener->long_step(motion_.y.data(), motion_.trial.data(), step_, now);
            sample(now, last ? run_.state.t + remaining : now + step);
            if (problem_.settings.peaks) record_peaks();
            std::swap(motion_.y, motion_.trial);
            bool faster = false;
            for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
                Active& a = run_.system.active[j];
                a.x = motion_.y[run_.system.x_index(j)];
                for (real rate : step_.rate[j].at)
                    if (std::fabs(rate) > 2 * a.speed) a.speed = std::fabs(rate), faster = true;
            }
            if (faster) motion_.set_scales();
            advanced = true;
            if (last) {
                motion_.y[clock] = remaining;
                return true;
            }
            h = std::fmin(longest, step * std::fmin(1.5, 0.9 * std::pow(std::fmax(error, 1e-12), -1.0 / 15)));
        }
    }
};

} // namespace rattlebox
