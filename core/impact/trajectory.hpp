// The event-driven 1-D engine: flights and contacts in turn, with samples.
//
// Soft contacts are integrated (impact/closed_contacts.hpp). With Method::newton impacts are instantaneous,
// and a contact whose bounces become shorter than a given fraction of the shortest period of modes and loads,
// or slower than that fraction of the largest speed, sticks until its force would become attractive.
#pragma once

#include "impact/closed_contacts.hpp"

namespace rattlebox {

class Trajectory : protected ClosedContacts {
    std::vector<char> is_watched_, is_pressing_;
    std::vector<int> held_;    // hard contacts that stay closed in a flight: stuck ones, then others at rest
    std::vector<int> opening_; // touching contacts that open in a flight
    State flight_end_;         // state at the end of a flight
    bool goes_on_ = false;     // whether the last flight ended without any event while contacts were stuck

    void sample_flight_at(real t, bool given) {
        sampled_ = ledger_;
        flight_.add_to_ledger(t - state_.t, sampled_);
        flight_.at(t - state_.t, scratch_);
        clear_contact_samples();
        for (std::size_t i = 0; i < stuck_.size(); ++i)
            add_wall_force(stuck_[i], flight_.held_force(i, t - state_.t));
        record(t, scratch_, sampled_, given);
    }

    // Takes the samples up to `until`, and those at a contact that has just ended or begins at `until`. The
    // end is sampled at the next floating-point time, so that hard impacts have samples of the velocities
    // before and after.
    void sample_flight(real until, bool at_touch) {
        const real begin = state_.t;
        const auto sample_up_to = [&](real t) {
            while (sample_due(t)) sample_flight_at(problem_.sample_times[next_sample_++], true);
        };
        if (samples_contacts() && (contact_ended_ || at_touch)) {
            const real just_after = std::nextafter(begin, infinity), middle = 0.5 * (begin + until);
            if (contact_ended_ && just_after < until) {
                sample_up_to(begin);
                sample_flight_at(just_after, false);
            }
            sample_up_to(middle);
            if (middle > begin) sample_flight_at(middle, false);
            sample_up_to(until);
            if (at_touch) sample_flight_at(until, false);
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
        goes_on_ = false;
        flight_.begin(state_, loads_, stop - state_.t, any_touching, stuck_);
        bool pressing = false;
        is_pressing_.assign(phase_.size(), false);
        held_ = stuck_;
        opening_.clear();
        for (std::size_t c = 0; c < phase_.size(); ++c) {
            is_watched_[c] = phase_[c] == Phase::open || phase_[c] == Phase::released;
            if (phase_[c] != Phase::touching) continue;
            const int tendency = flight_.tendency(problem_.contacts[c]);
            if (tendency > 0 && !hard()) phase_[c] = Phase::open;
            if (tendency > 0) opening_.push_back(static_cast<int>(c));
            if (tendency < 0) is_pressing_[c] = pressing = true;
            if (tendency == 0) held_.push_back(static_cast<int>(c));
        }
        if (pressing && hard()) {
            std::vector<Closing> pressed;
            for (std::size_t c = 0; c < phase_.size(); ++c)
                if (is_pressing_[c]) pressed.emplace_back().contact = static_cast<int>(c);
            stick(pressed);
            return;
        }
        // Hard contacts at rest that no force presses together would drift by the rounding of their speeds.
        if (hard() && held_.size() > stuck_.size())
            flight_.begin(state_, loads_, flight_.horizon(), true, held_);
        const FirstTouch release = flight_.first_release(stuck_.size());
        if (release.contact >= 0 && release.time == 0) return release_stuck(release.contact);
        const FirstTouch touch = flight_.first_touch(is_watched_, release.time, flight_end_);
        real length = touch.time;
        if (pressing) {
            length = rest_flight_length(length);
            flight_.at(length, flight_end_);
        }
        const bool to_stop = touch.contact < 0 && length == stop - state_.t;
        const real begin = state_.t, end = to_stop ? stop : begin + length;
        const bool touches = touch.contact >= 0 && length == touch.time;
        sample_flight(end, touches || pressing);
        flight_.add_to_ledger(length, ledger_);
        std::swap(flight_end_.y, state_.y);
        state_.t = end;
        if (length > 0) // several may open at one time: until then all of them touch
            for (const int c : opening_) phase(c) = Phase::open;
        open_all_released(touch.contact, true);
        if (pressing) begin_contacts_from_rest(begin, is_pressing_);
        if (touches)
            begin_contact_at(touch.contact);
        else if (release.contact >= 0 && length == release.time)
            release_stuck(release.contact);
        else
            goes_on_ = !stuck_.empty();
        last_jump_ = pressing && !touches ? begin : state_.t;
    }

    // The force of a stuck contact became attractive: it touches, and the forces decide whether it opens.
    void release_stuck(int which) {
        phase(stuck_[static_cast<std::size_t>(which)]) = Phase::touching;
        stuck_.erase(stuck_.begin() + which);
    }

    // Whether every released contact will open because its rate is too large for the accelerations of the
    // flight.
    bool released_contacts_only_open() {
        if (released_.empty()) return true;
        flight_.begin(state_, loads_, next_stop() - state_.t, false);
        for (const Released& r : released_) {
            const Gap g = gap(problem_, contact(r.contact), state_.y.data());
            const real bound = std::fabs(flight_.curvature(static_cast<std::size_t>(r.contact)));
            if (!(g.rate > 0 && square(g.rate) > 8 * bound * std::fabs(g.value))) return false;
        }
        return true;
    }

protected:
    // Finds the contacts that touch at the start.
    void find_touching() {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            const Gap g = gap(problem_, contact(c), state_.y.data());
            if (g.value <= 0 && g.rate == 0) phase(c) = Phase::touching;
        }
    }

    // Continues until the time `until_`, or until the run stops early.
    void advance() {
        while (running() && state_.t < until_) {
            if (state_.t >= loads_.next_knot()) loads_.advance(state_.t);
            result_.counts.events += !goes_on_;
            if (result_.counts.events > problem_.settings.max_events ||
                result_.counts.flights > 200 * problem_.settings.max_events)
                fail(Status::too_many_events);
            else if (stop_ && stop_->load(std::memory_order_relaxed))
                fail(Status::interrupted);
            else if (system_.active.empty() && released_contacts_only_open())
                fly();
            else
                integrate_closed();
        }
        result_.stopped_at = state_.t;
    }

public:
    Trajectory(const Problem& problem, const std::atomic<bool>* stop = nullptr)
        : ClosedContacts(problem, stop), is_watched_(problem.contacts.size()), flight_end_(problem) {}

    Result run() {
        find_touching();
        if (sample_due(0)) {
            ++next_sample_;
            clear_contact_samples();
            sampled_ = ledger_;
            record(0, state_, sampled_);
        }
        advance();
        return std::move(result_);
    }
};

} // namespace rattlebox
