// The earliest event within a step of closed contacts.
//
// The step is shortened to each event that is found, so that the next one is sought before it. Rates are
// looked at apart from values: a gap that opens and closes within the step has the same signs at both ends.
#pragma once

#include "impact/closed_motion.hpp"
#include "impact/contact_start.hpp"

namespace rattlebox {

struct ContactEvent {
    enum class Kind { none, phase_end, touch, rest_touch, opened, reengaged };
    Kind kind = Kind::none;
    int index = -1;  // of the closed contact, the released one, or the contact that touches
    real length = 0; // of the step to it, in transformed time
};

class EventLocator {
    using Kind = ContactEvent::Kind;
    using Phase = RunState::Phase;

    RunState& run_;
    const Problem& problem_;
    ClosedMotion& motion_;
    const ContactStarter& starter_;
    real length_ = 0;       // of the step, up to the earliest event so far
    ContactEvent event_;    // the earliest so far
    bool at_stop_ = false;  // whether the step ends at a knot of a load or at the end of the run
    bool too_deep_ = false; // whether a contact closed from rest too far for one step

    const real* before() const { return motion_.y.data(); }
    const real* after() const { return motion_.trial.data(); }
    const real* within() const { return motion_.partial.data(); }
    Gap gap_at(int c, const real* y) const { return gap(problem_, run_.contact(c), y); }

    // Shortens the step, which ends at no event then.
    void shorten(real length) {
        length_ = length;
        motion_.step(length_, motion_.trial);
    }

    // Returns the event at which a function changes from `value` >= 0 at the start to <= 0, if it does so.
    template <class F> ContactEvent zero(Kind kind, int index, real value, F&& f) {
        const real at_end = f(after());
        if (at_end > 0 || value < 0 || (value == 0 && at_end == 0)) return {};
        return {kind, index, motion_.locate(length_, value, at_end, f)};
    }

    void accept(const ContactEvent& found) {
        if (found.kind == Kind::none || (event_.kind != Kind::none && found.length >= length_)) return;
        event_ = found;
        shorten(found.length);
    }

    // Shortens the step to where a rate changes its sign, if is_over() holds there but not at the end.
    template <class Rate, class Over>
    void turn_back(real rate_before, real rate_after, Rate&& rate, Over&& is_over) {
        const real turn = motion_.locate(length_, rate_before, rate_after, rate);
        motion_.step(turn, motion_.partial);
        if (!is_over(within())) return;
        std::swap(motion_.trial, motion_.partial);
        length_ = turn;
        event_ = {};
        at_stop_ = false;
    }

    // ---- limits of the step that are no events

    void find_stop(real remaining) {
        const std::size_t clock = motion_.clock();
        at_stop_ = after()[clock] >= remaining;
        if (!at_stop_) return;
        run_.meet_stop();
        shorten(motion_.locate(length_, remaining, remaining - after()[clock],
                               [&](const real* y) { return remaining - y[clock]; }));
    }

    template <class F> void stop_at_zero(real rounding, F&& margin) {
        const real here = margin(before()), there = margin(after());
        if (!(here > 0.5 * rounding && there < 0)) return;
        shorten(motion_.locate(length_, here, there, margin));
        at_stop_ = false;
    }

    // No step passes a knot of a measured curve: the error estimate does not see a jump of the curvature
    // close to the start of a step, and the error would add up in a contact that vibrates for long.
    void find_knot(std::size_t j) {
        // A knot within rounding was reached by the last step; its far side counts.
        const real here = motion_.overlap_of(before(), j), rounding = knot_rounding * here;
        const bool closes = run_.system.approach(before(), run_.system.active[j].contact) > 0;
        const Span span = motion_.smooth_span_at(j, closes ? here + rounding : here - rounding);
        if (span.low > 0)
            stop_at_zero(rounding, [&](const real* y) { return motion_.overlap_of(y, j) - span.low; });
        if (span.high < infinity)
            stop_at_zero(rounding, [&](const real* y) { return span.high - motion_.overlap_of(y, j); });
    }

    // ---- events, one function for each kind

    ContactEvent phase_end(std::size_t j) {
        const auto margin = [&](const real* y) { return motion_.phase_margin(y, j); };
        const auto rate = [&](const real* y) {
            return run_.system.approach(y, run_.system.active[j].contact);
        };
        // A contact may reach the end of its phase at its largest overlap only, and return from it.
        const real closing = rate(before()), opening = rate(after());
        if (closing > 0 && opening < 0 && motion_.has_end(j) && margin(after()) > 0)
            turn_back(closing, opening, rate, [&](const real* y) { return margin(y) < 0; });
        return zero(Kind::phase_end, static_cast<int>(j), std::fmax(margin(before()), 0.0), margin);
    }

    // A released contact opens.
    ContactEvent opened(std::size_t r) {
        const int c = run_.released[r].contact;
        const Gap at_start = gap_at(c, before()), at_end = gap_at(c, after());
        // It may open and close again within the step.
        if (at_end.value < 0 && at_start.rate > 0 && at_end.rate < 0)
            turn_back(
                at_start.rate, at_end.rate, [&](const real* y) { return gap_at(c, y).rate; },
                [&](const real* y) { return gap_at(c, y).value >= 0; });
        return zero(Kind::opened, static_cast<int>(r), -at_start.value,
                    [&](const real* y) { return -gap_at(c, y).value; });
    }

    // The force of a released contact becomes repulsive again. Only if it grows: after a release it may still
    // be positive by rounding.
    ContactEvent reengaged(std::size_t r) {
        const Released& released = run_.released[r];
        const real margin = motion_.release_margin(before(), released);
        if (!(motion_.release_margin(after(), released) < margin)) return {};
        return zero(Kind::reengaged, static_cast<int>(r), std::fmax(margin, 0.0),
                    [&](const real* y) { return motion_.release_margin(y, released); });
    }

    // A contact that touches, or that rounding alone keeps open, closes from rest.
    ContactEvent rest_touch(int c, const Gap& at_end, real rounding) {
        if (at_end.value > rounding) run_.phase(c) = Phase::open;
        if (at_end.value >= -rounding) return {};
        const std::size_t clock = motion_.clock();
        const bool is_faint = at_end.value >= -4 * rounding ||
                              starter_.is_force_negligible(c, after(), after()[clock] - before()[clock],
                                                           motion_.contact_speed());
        if (is_faint && at_end.rate >= 0) return {}; // it opens again before a contact starts
        if (!is_faint) {
            too_deep_ = true;
            return {};
        }
        // A dashpot acts immediately, so the contact starts as soon as rounding errors permit.
        run_.phase(c) = Phase::touching;
        return {Kind::rest_touch, event_.index, length_};
    }

    // An open contact has closed at the end of the step.
    ContactEvent closed(int c, const Gap& at_start, const Gap& at_end, real rounding) {
        const auto value = [&](const real* y) { return gap_at(c, y).value; };
        const auto rate = [&](const real* y) { return gap_at(c, y).rate; };
        // It opens within the step. Rounding errors may have closed it, but it must not get deeper.
        if (at_end.rate >= 0 && (at_start.value <= rounding || at_start.rate >= 0)) {
            const real deepest = std::fmin(at_start.value, 0.0) - rounding;
            if (at_start.rate < 0)
                turn_back(
                    -at_start.rate, -at_end.rate, [&](const real* y) { return -rate(y); },
                    [&](const real* y) { return value(y) < deepest; });
            if (value(after()) >= deepest) return {};
            if (at_start.rate >= 0) { // it closes and opens again within the step
                too_deep_ = true;
                return {};
            }
        }
        // It opens and closes again within the step. Rounding errors may hide that it opens.
        if (at_start.value <= rounding && at_start.rate > 0 && at_end.rate < 0) {
            const real first = motion_.locate(length_, std::fmax(at_start.value, 0.0), at_end.value, value);
            motion_.step(first, motion_.partial);
            if (!(rate(within()) < 0)) return hidden_touch(c, at_start.rate, at_end.rate, rounding);
        }
        return zero(Kind::touch, c, std::fmax(at_start.value, 0.0), value);
    }

    // A contact that was open by less than rounding opens first: it is sought behind its largest gap.
    ContactEvent hidden_touch(int c, real rate_before, real rate_after, real rounding) {
        const auto rate = [&](const real* y) { return gap_at(c, y).rate; };
        motion_.step(motion_.locate(length_, rate_before, rate_after, rate), motion_.partial);
        const std::size_t clock = motion_.clock();
        const real since = within()[clock];
        if (gap_at(c, within()).value > rounding)
            return zero(Kind::touch, c, 1,
                        [&](const real* y) { return y[clock] <= since ? 1 : gap_at(c, y).value; });
        run_.phase(c) = Phase::touching;
        too_deep_ = true;
        return {};
    }

    // A contact that is open at both ends of the step may close within it.
    ContactEvent dipped(int c, const Gap& at_start, const Gap& at_end) {
        const auto value = [&](const real* y) { return gap_at(c, y).value; };
        turn_back(
            -at_start.rate, -at_end.rate, [&](const real* y) { return -gap_at(c, y).rate; },
            [&](const real* y) { return value(y) <= 0; });
        if (value(after()) > 0) return {};
        return zero(Kind::touch, c, std::fmax(at_start.value, 0.0), value);
    }

    // An open or touching contact starts.
    ContactEvent touch(int c) {
        const Gap at_start = gap_at(c, before()), at_end = gap_at(c, after());
        const real rounding = motion_.gap_rounding(c, before());
        if (run_.phase(c) == Phase::touching ||
            (std::fabs(at_start.value) <= rounding && std::fabs(at_start.rate) <= rounding))
            return rest_touch(c, at_end, rounding);
        if (at_end.value <= 0) return closed(c, at_start, at_end, rounding);
        const real largest_rate = std::fmax(-at_start.rate, at_end.rate);
        if (at_start.rate < 0 && at_end.rate > 0 &&
            std::fmin(at_start.value, at_end.value) < 2 * after()[motion_.clock()] * largest_rate)
            return dipped(c, at_start, at_end);
        return {};
    }

public:
    EventLocator(RunState& run, ClosedMotion& motion, const ContactStarter& starter)
        : run_(run), problem_(run.problem), motion_(motion), starter_(starter) {}

    // Shortens the step of this length from y to trial to its earliest event.
    void search(real length, real remaining) {
        length_ = length;
        event_ = {};
        too_deep_ = false;
        find_stop(remaining);
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) find_knot(j);
        for (std::size_t j = 0; j < run_.system.active.size(); ++j) accept(phase_end(j));
        for (std::size_t r = 0; r < run_.released.size(); ++r) {
            accept(opened(r));
            accept(reengaged(r));
        }
        for (int c = 0; c < problem_.contact_count() && !too_deep_; ++c) {
            if (run_.phase(c) != Phase::open && run_.phase(c) != Phase::touching) continue;
            const ContactEvent found = touch(c);
            // Contacts from rest start together at the end of the step, whatever else happens there.
            if (found.kind == Kind::rest_touch)
                event_ = found;
            else
                accept(found);
        }
    }

    real length() const { return length_; }
    const ContactEvent& event() const { return event_; }
    bool at_stop() const { return at_stop_; }
    bool too_deep() const { return too_deep_; }
};

} // namespace rattlebox
