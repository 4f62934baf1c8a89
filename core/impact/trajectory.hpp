// The event-driven 1-D engine: flights and contacts in turn, with samples.
//
// Soft contacts are integrated (impact/contact_solver.hpp). With Method::newton impacts are instantaneous
// (impact/hard_contacts.hpp), and a contact whose bounces become shorter than a given fraction of the
// shortest period of modes and loads, or slower than that fraction of the largest speed, sticks until its
// force would become attractive.
#pragma once

#include <utility>

#include "impact/contact_solver.hpp"
#include "util/archive.hpp"

namespace rattlebox {

class Trajectory {
    using Phase = RunState::Phase;

    RunState run_;
    const Problem& problem_;
    Output output_;
    Flight flight_;
    HardContacts hard_;
    ContactStarter starter_;
    ContactSolver solver_;
    State sample_, flight_end_; // within a flight, and at its end
    // Contacts of a flight: whether their touches are sought, and whether forces press them together.
    std::vector<char> is_watched_, is_pressing_;
    std::vector<int> opening_; // touching contacts that open
    std::vector<int> held_;    // hard contacts that stay closed: stuck ones, then others at rest
    bool goes_on_ = false;     // whether the last flight ended without any event while contacts were stuck

    void sample_flight_at(real t, bool given) {
        output_.ledger = run_.ledger;
        flight_.add_to_ledger(t - run_.state.t, output_.ledger);
        flight_.at(t - run_.state.t, sample_);
        output_.clear();
        // A stop that only touches shares the force of a stuck one.
        const std::vector<int>& held = flight_.held();
        for (std::size_t i = 0; i < held.size(); ++i)
            if (i < run_.stuck.size() || run_.contact(held[i]).above == ground)
                output_.add_wall_force(held[i], flight_.held_force(i, t - run_.state.t));
        output_.record(t, sample_, given);
    }

    // Takes the samples up to `until`, and those at a contact that has just ended or begins at `until`. The
    // end is sampled at the next floating-point time, so that hard impacts have samples of the velocities
    // before and after.
    void sample_flight(real until, bool at_touch) {
        const real start = run_.state.t;
        const auto sample_up_to = [&](real t) {
            while (output_.is_due(t)) sample_flight_at(output_.next_time(), true);
        };
        if (output_.samples_contacts() && (run_.contact_ended || at_touch)) {
            const real just_after = std::nextafter(start, infinity), middle = 0.5 * (start + until);
            if (run_.contact_ended && just_after < until) {
                sample_up_to(start);
                sample_flight_at(just_after, false);
            }
            sample_up_to(middle);
            if (middle > start) sample_flight_at(middle, false);
            sample_up_to(until);
            if (at_touch) sample_flight_at(until, false);
        }
        sample_up_to(until);
        run_.contact_ended = false;
    }

    // Asks the forces how the touching contacts go on; returns whether some are pressed together.
    bool sort_touching() {
        bool is_any_pressing = false;
        is_pressing_.assign(run_.phases.size(), false);
        held_ = run_.stuck;
        opening_.clear();
        for (int c = 0; c < problem_.contact_count(); ++c) {
            const auto at = static_cast<std::size_t>(c);
            is_watched_[at] = run_.phase(c) == Phase::open || run_.phase(c) == Phase::released;
            if (run_.phase(c) != Phase::touching) continue;
            const int tendency = flight_.tendency(run_.contact(c));
            if (tendency > 0 && !run_.hard()) run_.phase(c) = Phase::open;
            if (tendency > 0) opening_.push_back(c);
            if (tendency < 0) is_pressing_[at] = is_any_pressing = true;
            if (tendency == 0) held_.push_back(c);
        }
        return is_any_pressing;
    }

    void stick_pressing() {
        std::vector<Closing> pressed;
        for (std::size_t c = 0; c < is_pressing_.size(); ++c)
            if (is_pressing_[c]) pressed.emplace_back().contact = static_cast<int>(c);
        if (run_.listener) run_.listener->begin_impact(-1);
        hard_.stick(pressed);
        if (run_.listener) run_.listener->end_impact();
    }

    // Moves to the end of the flight, with samples and the energies of the way there.
    void land(real length, real end, bool at_touch) {
        sample_flight(end, at_touch);
        if (run_.listener) run_.listener->flight(flight_, length);
        flight_.add_to_ledger(length, run_.ledger);
        // The work of the force of a held stop, whose point moves by rounding.
        for (std::size_t i = 0; i < flight_.held().size(); ++i)
            if (run_.contact(flight_.held()[i]).above == ground)
                run_.result.permitted_error +=
                    std::fabs(flight_.held_force(i, 0.5 * length)) * hard_.velocity_rounding() * length;
        std::swap(flight_end_.y, run_.state.y);
        run_.state.t = end;
    }

    void fly() {
        ++run_.result.counts.flights;
        goes_on_ = false;
        const real stop = run_.next_stop(), take_off = run_.state.t;
        const bool any_touching =
            std::find(run_.phases.begin(), run_.phases.end(), Phase::touching) != run_.phases.end();
        flight_.start(run_.state, run_.loads, stop - take_off, any_touching, run_.stuck);
        if (flight_.is_bounded_by(stop - take_off)) run_.meet_stop();

        // Contacts that touch: hard ones stick if a force presses them, soft ones close from rest.
        const bool pressing = sort_touching();
        if (pressing && run_.hard()) return stick_pressing();
        // Hard contacts at rest that no force presses together would drift by the rounding of their speeds.
        if (run_.hard() && held_.size() > run_.stuck.size())
            flight_.start(run_.state, run_.loads, flight_.horizon(), true, held_);

        // The earliest event: a stuck contact is released, a contact touches, or the flight ends.
        const FirstTouch release = flight_.first_release(run_.stuck.size());
        if (release.contact >= 0 && release.time == 0) return hard_.release(release.contact);
        const FirstTouch touch = flight_.first_touch(is_watched_, release.time, flight_end_);
        real length = touch.time;
        if (pressing) {
            length = starter_.rest_flight_length(flight_, length);
            flight_.at(length, flight_end_);
        }
        const bool to_stop = touch.contact < 0 && length == stop - take_off;
        if (to_stop) run_.meet_stop();
        const bool touches = touch.contact >= 0 && length == touch.time;
        land(length, to_stop ? stop : take_off + length, touches || pressing);

        // What happens there. Several contacts may open at one time: until then all of them touch.
        if (length > 0)
            for (const int c : opening_) run_.phase(c) = Phase::open;
        run_.open_all_released(touch.contact, true);
        if (pressing) starter_.start_from_rest(take_off, is_pressing_);
        if (touches)
            starter_.start_at(touch.contact);
        else if (release.contact >= 0 && length == release.time)
            hard_.release(release.contact);
        else if (run_.hard() && length < release.time) // the search gave up: gaps and rates of rounding
            hard_.gather_touching();
        else
            goes_on_ = !run_.stuck.empty();
        run_.last_jump = pressing && !touches ? take_off : run_.state.t;
    }

    // Whether every released contact will open because its rate is too large for the accelerations of the
    // flight.
    bool released_contacts_only_open() {
        if (run_.released.empty()) return true;
        const real length = run_.next_stop() - run_.state.t;
        flight_.start(run_.state, run_.loads, length, false);
        if (flight_.is_bounded_by(length)) run_.meet_stop();
        for (const Released& r : run_.released) {
            const Gap g = gap(problem_, run_.contact(r.contact), run_.state.y.data());
            const real bound = std::fabs(flight_.curvature(static_cast<std::size_t>(r.contact)));
            if (!(g.rate > 0 && square(g.rate) > 8 * bound * std::fabs(g.value))) return false;
        }
        return true;
    }

    bool may_go_on() {
        const Counts& counts = run_.result.counts;
        const long most = problem_.settings.max_events;
        if (counts.events > most || counts.flights > steps_per_event * most)
            run_.fail(Status::too_many_events);
        else if (run_.is_stopped())
            run_.fail(Status::interrupted);
        return run_.running();
    }

    // Writes the state with those impacts of the log that are not over.
    void save(std::vector<std::uint8_t>& bytes) {
        const std::vector<Active> active = run_.system.active;
        const std::vector<Released> released = run_.released;
        const Status status = std::exchange(run_.result.status, Status::finished);
        std::vector<Impact> log = run_.take_open_impacts();
        run_.result.impacts.swap(log);
        Writer writer(std::move(bytes));
        serialize(writer);
        bytes = std::move(writer.bytes);
        run_.result.impacts.swap(log);
        run_.result.status = status;
        run_.system.active = active;
        run_.released = released;
    }

    void keep_end() {
        EndStates& states = run_.result.states;
        save(states.end);
        if (states.whole.empty()) states.whole = states.end;
        states.motion = run_.state.y;
        for (const Phase phase : run_.phases) states.phases.push_back(static_cast<std::int8_t>(phase));
    }

    // Starts from the state of another run.
    void restore() {
        Reader reader(reinterpret_cast<const char*>(problem_.start_state.data()),
                      problem_.start_state.size());
        serialize(reader);
        run_.check();
        if (!reader.at_end()) throw std::invalid_argument("the state is of another case");
        run_.loads.advance(run_.state.t);
        if (!problem_.changed) return;
        // Closed contacts have the coefficients of their laws; those with a history keep them.
        const auto renew = [&](int c, int impact, ContactState& state) {
            const real speed = run_.result.impacts.at(static_cast<std::size_t>(impact)).approach_speed;
            run_.contact(c).normal.visit([&]<class Law>(const Law& law) {
                if constexpr (!Law::hysteretic)
                    state = initial_state(law, rebound(run_.contact(c).restitution, speed).e, speed);
            });
        };
        for (Active& a : run_.system.active) renew(a.contact, a.impact, a.state);
        for (Released& r : run_.released) renew(r.contact, r.impact, r.state);
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            run_.state.y[2 * k] = problem_.start[k].q;
            run_.state.y[2 * k + 1] = problem_.start[k].p;
        }
        run_.last_jump = run_.state.t;
    }

public:
    explicit Trajectory(const Problem& problem, const std::atomic<bool>* stop = nullptr)
        : run_(problem, stop), problem_(problem), output_(run_), flight_(problem), hard_(run_),
          starter_(run_, output_, hard_), solver_(run_, output_, starter_), sample_(problem),
          flight_end_(problem), is_watched_(problem.contacts.size()) {}
    Trajectory(const Trajectory&) = delete; // its parts refer to each other
    Trajectory& operator=(const Trajectory&) = delete;

    RunState& run_state() { return run_; }
    const RunState& run_state() const { return run_; }
    Output& output() { return output_; }
    ContactStarter& contact_starter() { return starter_; }

    // Finds the contacts that touch at the start. Hard ones at rest to rounding, as at the end of a period in
    // which a ball rode on a wall, touch: an impact at a speed of rounding has no derivatives.
    void find_touching() {
        run_.find_touching();
        if (run_.hard()) hard_.gather_touching();
    }

    // Continues until the time `until`, or until the run stops early.
    void advance() {
        // Saving takes a tenth of the time of a hard impact.
        constexpr long turns_per_state = 16;
        for (long turn = 0; run_.running() && run_.state.t < run_.until; ++turn) {
            if (problem_.settings.keep_end && !run_.met_end && turn % turns_per_state == 0)
                save(run_.result.states.whole);
            if (run_.state.t >= run_.loads.next_knot()) {
                if (run_.listener) run_.listener->pass_knot();
                run_.loads.advance(run_.state.t);
            }
            run_.result.counts.events += !goes_on_;
            if (!may_go_on()) break;
            if (run_.system.active.empty() && released_contacts_only_open())
                fly();
            else
                solver_.advance();
        }
        run_.result.stopped_at = run_.state.t;
    }

    Result run() {
        if (problem_.start_state.empty()) {
            find_touching();
            if (output_.is_due(0)) {
                output_.next_time();
                output_.record_now();
            }
        } else {
            restore();
        }
        advance();
        if (problem_.settings.keep_end && (run_.running() || run_.result.status == Status::interrupted))
            keep_end();
        return std::move(run_.result);
    }

    template <class Archive> void serialize(Archive& a) {
        run_.serialize(a);
        starter_.serialize(a);
        hard_.serialize(a);
        a(run_.last_jump, run_.largest_overlap);
    }
};

} // namespace rattlebox
