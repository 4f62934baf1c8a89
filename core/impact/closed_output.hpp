// Samples and peaks of force and overlap within steps of closed contacts.
#pragma once

#include "impact/closed_motion.hpp"
#include "impact/output.hpp"

namespace rattlebox {

class ClosedOutput {
    RunState& run_;
    const Problem& problem_;
    Output& output_;
    ClosedMotion& motion_;
    State state_; // at a sample
    std::vector<real> slope_, forward_, backward_;

    // Returns the slope of the force of contact j along the motion through y, up to a positive factor.
    real force_slope(const real* y, real h, std::size_t j) {
        const std::size_t n = run_.system.size();
        slope_.resize(n);
        forward_.resize(n);
        backward_.resize(n);
        run_.system(y, slope_.data());
        for (std::size_t i = 0; i < n; ++i) {
            forward_[i] = y[i] + 1e-4 * h * slope_[i];
            backward_[i] = y[i] - 1e-4 * h * slope_[i];
        }
        return run_.system.force(forward_.data(), j) - run_.system.force(backward_.data(), j);
    }

    void record_peak(std::size_t j, const real* y) {
        const Active& a = run_.system.active[j];
        Impact& impact = run_.result.impacts[static_cast<std::size_t>(a.impact)];
        impact.peak_force = std::fmax(impact.peak_force, run_.system.force(y, j));
        impact.peak_overlap =
            std::fmax(impact.peak_overlap, a.state.origin() + square(square(y[run_.system.x_index(j)])));
    }

public:
    ClosedOutput(RunState& run, Output& output, ClosedMotion& motion)
        : run_(run), problem_(run.problem), output_(output), motion_(motion), state_(problem_) {}

    void sample(const std::vector<real>& y, real t, bool given) {
        std::copy_n(y.begin(), run_.state.y.size(), state_.y.begin());
        Ledger& ledger = output_.ledger = run_.ledger;
        const std::size_t at = run_.system.time_index();
        ledger.load_work += y[at + 1];
        ledger.base_work += y[at + 2];
        ledger.viscous += y[at + 3];
        output_.clear();
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
            const Active& a = run_.system.active[j];
            const std::size_t d = run_.damper_of(a.contact);
            const real x = y[run_.system.x_index(j)];
            ledger.normal[d] += y[run_.system.x_index(j) + 1];
            run_.contact(a.contact).normal.visit([&](const auto& law) {
                ledger.plastic[d] += plastic_loss(law, a.state, x);
                output_.stored[d] += stored_energy(law, a.state, x);
            });
            output_.add_wall_force(a.contact, run_.system.force(y.data(), j));
        }
        output_.record(t, state_, given);
    }

    // Takes the samples in the step of length h from motion_.y to motion_.trial: requested times, deepest
    // overlaps, and the end of the step if a contact begins or ends there.
    void sample_step(real h, bool at_event) {
        const std::size_t clock = run_.system.time_index();
        std::vector<std::pair<real, real>> turns; // time, and length of the step to it
        if (output_.samples_contacts())
            for (const Active& a : run_.system.active) {
                const auto rate = [&](const real* y) { return run_.system.approach(y, a.contact); };
                const real before = rate(motion_.y.data()), after = rate(motion_.trial.data());
                if (!(before > 0 && after < 0)) continue;
                const real where = motion_.locate(h, before, after, rate, peak_part);
                motion_.step(where, motion_.partial);
                turns.emplace_back(motion_.partial[clock], where);
            }
        std::sort(turns.begin(), turns.end());
        std::vector<real> at(run_.system.size());
        const auto sample_up_to = [&](real until) {
            while (output_.is_due(run_.state.t + until)) {
                const real t = output_.next_time(), due = t - run_.state.t;
                if (due >= motion_.trial[clock]) {
                    sample(motion_.trial, t, true);
                    continue;
                }
                const real where = motion_.locate(h, due - motion_.y[clock], due - motion_.trial[clock],
                                                  [&](const real* y) { return due - y[clock]; });
                motion_.step(where, at);
                sample(at, t, true);
            }
        };
        for (const auto& [since, where] : turns) {
            sample_up_to(since);
            motion_.step(where, at);
            sample(at, run_.state.t + since, false);
        }
        sample_up_to(motion_.trial[clock]);
        if (at_event && output_.samples_contacts())
            sample(motion_.trial, run_.state.t + motion_.trial[clock], false);
    }

    void record_forces() {
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) record_peak(j, motion_.y.data());
    }

    // Records the peaks within the step from motion_.y to motion_.trial.
    void record_peaks(real h) {
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) {
            record_peak(j, motion_.trial.data());
            const int c = run_.system.active[j].contact;
            const real before = run_.system.approach(motion_.y.data(), c),
                       after = run_.system.approach(motion_.trial.data(), c);
            if (before > 0 && after < 0) {
                const real turn = motion_.locate(
                    h, before, after, [&](const real* y) { return run_.system.approach(y, c); }, peak_part);
                motion_.step(turn, motion_.partial);
                record_peak(j, motion_.partial.data());
            }
            const real rises = force_slope(motion_.y.data(), h, j),
                       falls = force_slope(motion_.trial.data(), h, j);
            if (!(rises > 0 && falls < 0)) continue;
            const real top = motion_.locate(
                h, rises, falls, [&](const real* y) { return force_slope(y, h, j); }, peak_part);
            motion_.step(top, motion_.partial);
            record_peak(j, motion_.partial.data());
        }
    }
};

} // namespace rattlebox
