// First touch: an isolated contact solved as a whole, the start of a soft contact, or a hard impact.
#pragma once

#include "impact/flight.hpp"
#include "impact/hard_contacts.hpp"
#include "impact/isolated_start.hpp"

namespace rattlebox {

class ContactStarter {
    RunState& run_;
    const Problem& problem_;
    HardContacts& hard_;
    IsolatedStart isolated_;
    State trial_; // at the end of a flight in which contacts close from rest
    real rest_speed_ =
        0; // of contacts that close from rest: speed at which contact force and inertia balance

    // Whether the gap of contact c is zero, to the rounding errors of its terms and those that they
    // accumulate in time. This must hold wherever a contact starts: the energy balance holds for a contact at
    // any gap and would not notice.
    bool is_touching(int c) const {
        const real value = gap(problem_, run_.contact(c), run_.state.y.data()).value;
        const real length =
            run_.gap_terms(c) + run_.largest_overlap; // without clearance there are no other lengths
        // The overlap of a soft contact is integrated apart from the positions, and ends with its errors.
        const real apart = run_.hard() ? 0 : run_.resolution() * run_.largest_overlap;
        return std::fabs(value) <=
               touching_margin * (epsilon * length + hard_.velocity_rounding() * run_.state.t + apart);
    }

    // `since` is the time at which the force began, by default the current time.
    void start(int c, real speed, real e, real x, real since = not_a_number) {
        Active a;
        a.contact = c;
        bool has_restitution = false;
        run_.contact(c).normal.visit([&](const auto& law) {
            a.state = initial_state(law, e, speed);
            has_restitution = law.needs_restitution();
        });
        if (run_.listener) run_.listener->touch(c, speed, e);
        Impact impact;
        impact.contact = c;
        impact.time = std::isnan(since) ? run_.state.t : since;
        impact.approach_speed = speed;
        if (has_restitution) impact.restitution = e;
        a.impact = run_.result.add_impact(impact);
        a.x = x;
        a.speed = speed;
        run_.system.active.push_back(a);
        run_.phase(c) = RunState::Phase::closed;
    }

    // Returns the change of the approach rate by the force of a contact that closes from rest.
    real speed_loss(int c, const real* y, real length) const {
        const Gap g = gap(problem_, run_.contact(c), y);
        if (g.value >= 0) return 0;
        const real e = rebound(run_.contact(c).restitution, 0).e, x = std::sqrt(std::sqrt(-g.value));
        const real f = run_.contact(c).normal.visit([&](const auto& law) {
            return contact_force(law, initial_state(law, e, -g.rate), x, -g.rate).total;
        });
        return std::fabs(f) * length / run_.contact(c).mass;
    }

public:
    ContactStarter(RunState& run, Output& output, HardContacts& hard)
        : run_(run), problem_(run.problem), hard_(hard), isolated_(run, output), trial_(problem_) {}

    void start_at(int c) {
        if (!is_touching(c))
            return run_.fail(Status::false_contact, c,
                             gap(problem_, run_.contact(c), run_.state.y.data()).value);
        const real speed = std::max(run_.system.approach(run_.state.y.data(), c), 0.0);
        const Rebound r = rebound(run_.contact(c).restitution, speed);
        if (r.outside) return run_.fail(Status::law_domain, c, speed);
        run_.result.counts.extrapolated += r.extrapolated;
        if (!run_.hard() && !possible(run_.contact(c).normal, r))
            return run_.fail(Status::no_rebound, c, speed);
        if (speed == 0) { // by rounding; the forces decide whether it closes
            run_.phase(c) = RunState::Phase::touching;
            if (run_.listener && run_.hard()) run_.listener->graze(c);
            return;
        }
        if (run_.hard()) return hard_.impact(c);
        if (problem_.settings.collocation && isolated_.solve(c, speed, r.e)) return;
        start(c, speed, r.e, 0);
    }

    // Returns the length of a flight in which the forces of contacts that close from rest are negligible. At
    // first their speed is below the rounding error of the other motion, so their errors are scaled with the
    // speed at which their force balances the closing force.
    real rest_flight_length(const Flight& flight, real length) {
        rest_speed_ = 0;
        for (int halving = 0; halving < 400; ++halving, length *= 0.5) {
            flight.at(length, trial_);
            const real* y = trial_.y.data();
            bool balanced = true, negligible = true;
            real speed = 0;
            for (int c = 0; c < problem_.contact_count(); ++c) {
                if (run_.phase(c) != RunState::Phase::touching) continue;
                const real rate = gap(problem_, run_.contact(c), y).rate;
                speed = std::fmax(speed, -rate);
                balanced = balanced && speed_loss(c, y, length) <= std::fabs(rate);
                negligible = negligible && rate * length <= contact_gap_rounding * run_.gap_length(c, y) &&
                             is_force_negligible(c, y, length, 0);
            }
            if (balanced) rest_speed_ = std::fmax(rest_speed_, speed);
            if (negligible) break;
        }
        return length;
    }

    // Whether the change is below negligible_force of the approach rate, or within the tolerance of the speed
    // of other contacts.
    bool is_force_negligible(int c, const real* y, real length, real speed) const {
        const real rate = gap(problem_, run_.contact(c), y).rate;
        return speed_loss(c, y, length) <=
               std::fmax(negligible_force * std::fabs(rate), problem_.settings.tolerance * speed);
    }

    // Begins the contacts that close from rest, at their current overlap. Their force began at `since`,
    // unless the overlap has grown faster than a power of the time since then. Contacts that are pressed
    // together also start if the overlap is lost in the rounding error of the positions.
    void start_from_rest(real since, const std::vector<char>& presses = {}) {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (run_.phase(c) != RunState::Phase::touching) continue;
            const Gap g = gap(problem_, run_.contact(c), run_.state.y.data());
            const bool pressing = !presses.empty() && presses[static_cast<std::size_t>(c)];
            if (g.rate >= 0 || (g.value >= 0 && !pressing)) continue;
            const Rebound r = rebound(run_.contact(c).restitution, 0);
            if (!possible(run_.contact(c).normal, r)) return run_.fail(Status::no_rebound, c, 0);
            start(c, 0, r.e, std::sqrt(std::sqrt(std::fmax(-g.value, 0.0))),
                  pressing || run_.state.t - since <= growth_from_rest * std::fabs(g.value / g.rate)
                      ? since
                      : run_.state.t);
            run_.system.active.back().speed = std::fmax(-g.rate, rest_speed_);
        }
        rest_speed_ = 0;
    }

    template <class Archive> void serialize(Archive& a) { a(rest_speed_); }
};

} // namespace rattlebox
