// One run from its start to its end: flights and contacts in turn, samples on the way.
//
// Soft contacts are integrated (impact/closed.hpp); with Method::newton an impact takes no time and a contact
// whose bounces have become shorter than a stated part of the shortest period sticks until its force would
// have to pull.
#pragma once

#include "impact/closed.hpp"

namespace rattlebox {

class Trajectory : ClosedContacts {
    std::vector<char> watched_, presses_;
    State ahead_; // at the end of a flight

    void sample_flight_at(real t, bool given) {
        sampled_ = ledger_;
        flight_.account(t - state_.t, sampled_);
        flight_.at(t - state_.t, scratch_);
        clear_contact_samples();
        record(t, scratch_, sampled_, given);
    }

    // The samples up to `until`, and those beside a contact that has just ended or begins there. One that
    // ended is sampled an instant later, so that hard impacts, which end where they begin, have velocities
    // before and after.
    void sample_flight(real until, bool touches) {
        const real begin = state_.t;
        const auto sample_up_to = [&](real t) {
            while (sample_due(t)) sample_flight_at(problem_.sample_times[next_sample_++], true);
        };
        if (samples_contacts() && (contact_ended_ || touches)) {
            const real just_after = std::nextafter(begin, infinity), middle = 0.5 * (begin + until);
            if (contact_ended_ && just_after < until) {
                sample_up_to(begin);
                sample_flight_at(just_after, false);
            }
            sample_up_to(middle);
            if (middle > begin) sample_flight_at(middle, false);
            sample_up_to(until);
            if (touches) sample_flight_at(until, false);
        }
        sample_up_to(until);
        contact_ended_ = false;
    }

    // ---- flights

    void fly() {
        ++result_.counts.flights;
        const real stop = next_stop();
        bool any_touching = false;
        for (Phase p : phase_) any_touching = any_touching || p == Phase::touching;
        flight_.begin(state_, loads_, stop - state_.t, any_touching);
        bool pressing = false;
        presses_.assign(phase_.size(), false);
        for (std::size_t c = 0; c < phase_.size(); ++c) {
            watched_[c] = phase_[c] != Phase::touching;
            if (phase_[c] != Phase::touching) continue;
            const int tendency = flight_.tendency(problem_.contacts[c]);
            if (tendency > 0) phase_[c] = Phase::open;
            if (tendency < 0) pressing = presses_[c] = true;
            if (tendency < 0 && hard()) stick(static_cast<int>(c));
        }
        if (pressing && hard()) return;
        const Touch touch = flight_.first_touch(watched_, ahead_);
        real length = touch.after;
        if (pressing) {
            length = rest_start_length(length);
            flight_.at(length, ahead_);
        }
        const bool to_stop = touch.contact < 0 && length == stop - state_.t;
        const real begin = state_.t, end = to_stop ? stop : begin + length;
        const bool met = touch.contact >= 0 && length == touch.after;
        sample_flight(end, met || pressing);
        flight_.account(length, ledger_);
        std::swap(ahead_.y, state_.y);
        state_.t = end;
        settle_released(touch.contact);
        if (pressing) begin_at_rest(begin, presses_);
        if (met) meet(touch.contact);
        smooth_since_ = pressing && !met ? begin : state_.t;
    }

    // Can every released contact only open? Its rate is too large for any acceleration of the flight to turn.
    bool released_only_open() {
        if (released_.empty()) return true;
        flight_.begin(state_, loads_, next_stop() - state_.t, false);
        for (const Released& r : released_) {
            const Gap g = gap(problem_, contact(r.contact), state_.y.data());
            const real bound = std::fabs(flight_.curvature(static_cast<std::size_t>(r.contact)));
            if (!(g.rate > 0 && square(g.rate) > 8 * bound * std::fabs(g.value))) return false;
        }
        return true;
    }

public:
    Trajectory(const Problem& problem, const std::atomic<bool>* stop = nullptr)
        : ClosedContacts(problem, stop), watched_(problem.contacts.size()), ahead_(problem) {}

    Result run() {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            const Gap g = gap(problem_, contact(c), state_.y.data());
            if (g.value <= 0 && g.rate == 0) phase(c) = Phase::touching;
        }
        if (sample_due(0)) {
            ++next_sample_;
            clear_contact_samples();
            sampled_ = ledger_;
            record(0, state_, sampled_);
        }
        while (running() && state_.t < problem_.settings.duration) {
            if (state_.t >= loads_.next_knot()) loads_.advance(state_.t);
            if (++result_.counts.events > problem_.settings.max_events)
                fail(Status::too_many_events);
            else if (stop_ && stop_->load(std::memory_order_relaxed))
                fail(Status::interrupted);
            else if (system_.active.empty() && system_.stuck.empty() && released_only_open())
                fly();
            else
                integrate_closed();
        }
        result_.stopped_at = state_.t;
        return std::move(result_);
    }
};

} // namespace rattlebox
