// Integration of closed soft contacts with DOP853 (math/dop853.hpp): steps, events, and what they change.
#pragma once

#include "impact/contact_events.hpp"
#include "impact/lasting_solver.hpp"

namespace rattlebox {

class ContactSolver {
    RunState& run_;
    const Problem& problem_;
    Output& output_;
    ContactStarter& starter_;
    ClosedMotion motion_;
    ClosedOutput samples_;
    EventLocator locator_;
    LastingSolver lasting_;
    // A series of steps: the number at its end, and the time of its start.
    long series_end_ = steps_of_series;
    real series_start_ = -infinity;

    // Returns the first step in transformed time: a tenth of the shortest contact.
    real first_step(real remaining) const {
        if (run_.system.active.empty()) {
            const real rate =
                std::max(run_.loads.frequency(), fastest_rate(problem_.modes, problem_.coupling));
            real h = std::min(remaining, rate > 0 ? first_part / rate : remaining);
            for (const Released& r : run_.released) {
                const Gap g = gap(problem_, run_.contact(r.contact), run_.state.y.data());
                // Distance to where it opens or its force begins again, at least the rounding error.
                const real margin = std::fabs(g.rate < 0 ? g.value + r.state.origin() : g.value);
                if (margin != 0 && g.rate != 0)
                    h = std::min(h, first_part *
                                        (margin + motion_.gap_rounding(r.contact, run_.state.y.data())) /
                                        std::fabs(g.rate));
            }
            return h;
        }
        real h = infinity;
        for (const Active& a : run_.system.active) {
            const real depth = motion_.expected_x(a);
            // For a contact from rest either one may underflow.
            h = std::min(h, first_part_of_x * (a.x > 0 && depth > 0 ? std::min(a.x, depth) : a.x + depth) /
                                a.speed);
        }
        return h;
    }

    // Contacts whose recovery has ended open, and those that are pressed together again close.
    void sort_released() {
        run_.open_all_released(-1);
        for (int r = static_cast<int>(run_.released.size()) - 1; r >= 0; --r) {
            const Released& released = run_.released[static_cast<std::size_t>(r)];
            if (motion_.release_margin(run_.state.y.data(), released) < 0 &&
                gap(problem_, run_.contact(released.contact), run_.state.y.data()).rate < 0)
                reengage(r);
        }
    }

    void sample_after_contact() {
        if (run_.contact_ended && output_.samples_contacts()) {
            while (output_.is_due(run_.state.t)) samples_.sample(motion_.y, output_.next_time(), true);
            samples_.sample(motion_.y, std::nextafter(run_.state.t, infinity), false);
        }
        run_.contact_ended = false;
    }

    // Stops the run if the user asks for it, or if the steps do not end.
    bool may_go_on() {
        const Counts& counts = run_.result.counts;
        if (run_.is_stopped()) run_.fail(Status::interrupted);
        const long steps = counts.contact_steps + counts.rejected_steps;
        if (steps > steps_per_event * problem_.settings.max_events || is_stuck(steps))
            run_.fail(Status::too_many_events);
        return run_.running();
    }

    // Whether the last series of steps has hardly moved the time.
    bool is_stuck(long steps) {
        if (steps < series_end_) return false;
        const real now = run_.state.t + motion_.y[run_.system.time_index()];
        const bool stuck = now - series_start_ < part_of_series * problem_.settings.duration;
        series_end_ = steps + steps_of_series;
        series_start_ = now;
        return stuck;
    }

    // A step whose error is within the tolerance, at most of length h, and the factor for the next one; the
    // length is 0 if there is none.
    struct Proposal {
        real length = 0, growth = 0;
    };

    Proposal propose(real h) {
        motion_.integrator.start(run_.system, motion_.y.data());
        for (int tries = 0; tries <= most_rejections; ++tries) {
            motion_.step(h, motion_.trial);
            const real error = motion_.integrator.error(h, motion_.scale);
            if (error <= 1)
                return {h, error > 0 ? std::fmin(largest_growth, safety * std::pow(error, error_exponent))
                                     : largest_growth};
            ++run_.result.counts.rejected_steps;
            h *= error < infinity ? std::fmax(smallest_shrink, safety * std::pow(error, error_exponent))
                                  : unknown_shrink;
        }
        return {};
    }

    void count_step() {
        ++run_.result.counts.contact_steps;
        for (Active& a : run_.system.active) ++a.steps;
        run_.result.permitted_error += motion_.permitted_error;
    }

    // The step that the locator has shortened becomes part of the motion.
    void accept_step() {
        const ContactEvent::Kind kind = locator_.event().kind;
        const bool at_event = kind == ContactEvent::Kind::touch || kind == ContactEvent::Kind::phase_end;
        if (problem_.settings.peaks) samples_.record_peaks(locator_.length());
        samples_.sample_step(locator_.length(), at_event);
        if (run_.listener) run_.listener->step(motion_.y.data(), locator_.length());
        std::swap(motion_.y, motion_.trial);
        // Errors are measured by the speeds, which other bodies may raise within a contact.
        for (Active& a : run_.system.active) {
            const real speed = std::fabs(run_.system.approach(motion_.y.data(), a.contact));
            if (speed > 2 * a.speed) {
                a.speed = speed;
                motion_.set_scales();
            }
        }
    }

    // Returns to the state of the bodies, at the exact time of a stop rather than at the sum of steps.
    void leave(real remaining, bool at_stop) {
        const real start = run_.state.t;
        motion_.unload();
        if (at_stop) run_.state.t = start + remaining;
    }

    // Makes long steps; returns whether the time `remaining` was reached.
    bool advance_lasting(real remaining, real& h) {
        const bool advanced = lasting_.advance(remaining);
        // Whether or not long steps were possible, the next attempt waits for some explicit steps.
        for (Active& a : run_.system.active)
            a.wait = a.steps + (advanced ? wait_after_long_step : std::max(wait_after_failure, a.steps));
        if (advanced) motion_.set_scales();
        if (motion_.y[motion_.clock()] >= remaining) return true;
        if (advanced) h = first_step(remaining);
        if (h == remaining) run_.meet_stop();
        return false;
    }

    void handle(const ContactEvent& event) {
        using Kind = ContactEvent::Kind;
        if (event.kind != Kind::rest_touch) run_.last_jump = run_.state.t;
        switch (event.kind) {
        case Kind::none:
            return;
        case Kind::phase_end:
            return end_phase(static_cast<std::size_t>(event.index));
        case Kind::touch:
            return starter_.start_at(event.index);
        case Kind::rest_touch:
            return starter_.start_from_rest(run_.last_jump);
        case Kind::opened:
            return open_released(event.index);
        case Kind::reengaged:
            return reengage(event.index);
        }
    }

    void end_phase(std::size_t j) {
        if (run_.listener) run_.listener->end_phase(j);
        Active& a = run_.system.active[j];
        const Contact& k = run_.contact(a.contact);
        const real rate = run_.system.approach(run_.state.y.data(), a.contact);
        const real overlap = a.state.origin() + square(a.x * a.x);
        real plastic = 0, stored = 0;
        PhaseEnd next{};
        k.normal.visit([&](const auto& law) {
            next = next_phase(law, a.state, a.x);
            a.x = std::sqrt(std::sqrt(std::fmax(overlap - a.state.origin(), 0.0)));
            plastic = plastic_loss(law, a.state, a.x);
            stored = stored_energy(law, a.state, a.x);
        });
        if (next == PhaseEnd::stay) return;
        run_.contact_ended = true;
        Impact& impact = run_.result.impacts[static_cast<std::size_t>(a.impact)];
        const std::size_t d = run_.damper_of(a.contact);
        run_.ledger.plastic[d] += plastic;
        impact.energy_lost += plastic;
        impact.duration = run_.state.t - impact.time;
        impact.separation_speed = -rate;
        impact.complete = true;
        if (next == PhaseEnd::release && overlap > 0) {
            impact.energy_lost += stored;
            run_.released.push_back({a.contact, a.state, a.impact, stored});
            run_.phase(a.contact) = RunState::Phase::released;
        } else {
            run_.phase(a.contact) = RunState::Phase::open;
        }
        run_.system.active.erase(run_.system.active.begin() + static_cast<std::ptrdiff_t>(j));
    }

    void open_released(int r) {
        const Released& released = run_.released[static_cast<std::size_t>(r)];
        run_.ledger.normal[run_.damper_of(released.contact)] += released.energy;
        run_.phase(released.contact) = RunState::Phase::open;
        run_.released.erase(run_.released.begin() + r);
    }

    // A released contact touches again: the same impact continues, without the energy lost during recovery.
    void reengage(int r) {
        const Released released = run_.released[static_cast<std::size_t>(r)];
        run_.released.erase(run_.released.begin() + r);
        const real left = run_.recoverable_energy(released, run_.state.y.data());
        run_.ledger.normal[run_.damper_of(released.contact)] += released.energy - left;
        const real plastic = run_.contact(released.contact).normal.visit([&](const auto& law) {
            return plastic_loss(law, released.state, 0);
        });
        run_.ledger.plastic[run_.damper_of(released.contact)] -= plastic;
        Impact& impact = run_.result.impacts[static_cast<std::size_t>(released.impact)];
        impact.energy_lost -= left + plastic;
        impact.complete = false;
        Active a;
        a.contact = released.contact;
        a.state = released.state;
        a.impact = released.impact;
        const Gap g = gap(problem_, run_.contact(a.contact), run_.state.y.data());
        a.x = std::sqrt(std::sqrt(std::fmax(-g.value - a.state.origin(), 0.0)));
        a.speed = std::fmax(impact.approach_speed, std::fabs(g.rate));
        run_.system.active.push_back(a);
        run_.phase(a.contact) = RunState::Phase::closed;
    }

public:
    ContactSolver(RunState& run, Output& output, ContactStarter& starter)
        : run_(run), problem_(run.problem), output_(output), starter_(starter), motion_(run),
          samples_(run, output, motion_), locator_(run, motion_, starter),
          lasting_(run, output, motion_, samples_) {}

    // Continues until a contact starts, ends or changes its phase, or until the next knot of a load.
    void advance() {
        sort_released();
        motion_.load();
        sample_after_contact();
        motion_.set_scales();
        const real remaining = run_.next_stop() - run_.state.t;
        real h = first_step(remaining);
        if (h == remaining) run_.meet_stop();
        // Without soft contacts the error estimate can vanish; this limit ensures that no change of sign of a
        // force is missed.
        const real longest = run_.system.active.empty() ? longest_free_step * h : infinity;
        for (;;) {
            if (!may_go_on()) return motion_.unload();
            if (lasting_.may_last()) {
                if (advance_lasting(remaining, h)) return leave(remaining, true);
                continue;
            }
            if (problem_.settings.peaks) samples_.record_forces();
            const Proposal step = propose(h);
            if (step.length == 0) return run_.fail(Status::step_too_small), motion_.unload();
            count_step();
            locator_.search(step.length, remaining);
            if (locator_.too_deep()) { // a contact from rest: its force must be negligible at first
                h = step.length * retry_part;
                continue;
            }
            accept_step();
            const bool at_event = locator_.event().kind != ContactEvent::Kind::none;
            if (at_event || locator_.at_stop()) {
                leave(remaining, !at_event);
                return handle(locator_.event());
            }
            h = std::min(step.length * step.growth, longest);
        }
    }
};

} // namespace rattlebox
