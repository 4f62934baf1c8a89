// What happens at a first touch: a lone contact solved whole, a soft contact that begins, or a hard impact.
#pragma once

#include <iterator>

#include "impact/lone_contact.hpp"
#include "impact/progress.hpp"
#include "math/linear_system.hpp"

namespace rattlebox {

class Touching : protected Progress {
    LoneContact lone_, sampler_;
    State between_;       // of a sample within a lone contact
    Ledger spent_;        // in one contact
    real rest_speed_ = 0; // of contacts about to close from rest: when force and inertia balance
    real fastest_ = 0;    // of the balls relative to their cavities, at any hard impact so far

protected:
    real smooth_since_ =
        0; // when a force or its rate last jumped, other than by a contact that began at rest

    // ---- first touch

    void meet(int c) {
        const real speed = std::max(system_.approach(state_.y.data(), c), 0.0);
        const Rebound r = rebound(contact(c).restitution, speed);
        if (r.outside) return fail(Status::law_domain, c, speed);
        result_.counts.extrapolated += r.extrapolated;
        if (!hard() && !possible(contact(c).normal, r)) return fail(Status::no_rebound, c, speed);
        if (hard()) return strike(c, speed, r.e);
        if (speed == 0) { // by rounding: what presses it, if anything, will tell
            phase(c) = Phase::touching;
            return;
        }
        if (problem_.settings.collocation && collocate(c, speed, r.e)) return;
        begin_contact(c, speed, r.e, 0);
    }

    real energy(const State& state) const {
        real sum = 0;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            sum += ModeState{state.y[2 * k], state.y[2 * k + 1]}.energy(problem_.modes[k]);
        const real *s = positions(problem_, state.y.data()), *v = velocities(problem_, state.y.data());
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
            sum += problem_.ball_mass[i] *
                   (0.5 * v[i] * v[i] -
                    problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity * s[i]);
        return sum;
    }

    // Can nothing else touch while this contact lasts?
    bool alone(int c, real speed, real longest) const {
        if (!system_.active.empty() || !system_.stuck.empty() || !released_.empty()) return false;
        for (int other = 0; other < problem_.contact_count(); ++other) {
            if (other == c) continue;
            const Damper& damper = problem_.dampers[damper_of(other)];
            if (damper.balls == 1 && contact(other).damper == contact(c).damper) continue;
            const Gap g = gap(problem_, contact(other), state_.y.data());
            if (!(g.value > longest * (std::fabs(g.rate) + 4 * speed))) return false;
        }
        return true;
    }

    // A sample inside a lone contact: the contact solved again up to the phase at that time, so that nothing
    // is interpolated.
    void sample_lone(int c, const HertzTsuji& law, real speed, real zeta) {
        const real t = problem_.sample_times[next_sample_++];
        sampled_ = ledger_;
        LoneContact::Instant now;
        real psi = lone_.psi_at(t - state_.t);
        for (int pass = 0; pass < 8; ++pass) {
            sampler_.prepare(contact(c), law, loads_, state_, speed, zeta, infinity, psi);
            sampler_.solve();
            now = sampler_.end();
            const real late = t - state_.t - now.time;
            if (std::fabs(late) <= 2 * epsilon * t) break;
            psi = std::clamp(psi + late * sampler_.turning(now), 0.5 * psi, lone_.last_psi());
        }
        sampler_.finish(now, between_, sampled_);
        clear_contact_samples();
        stored_[damper_of(c)] = law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        add_wall_force(c, now.force);
        record(t, between_, sampled_);
    }

    // A sample at the deepest overlap of a lone contact.
    void sample_deepest(int c, const HertzTsuji& law, real speed, real zeta) {
        sampled_ = ledger_;
        sampler_.prepare(contact(c), law, loads_, state_, speed, zeta, infinity, std::acos(zeta));
        sampler_.solve();
        const LoneContact::Instant now = sampler_.end();
        sampler_.finish(now, between_, sampled_);
        clear_contact_samples();
        stored_[damper_of(c)] = law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        add_wall_force(c, now.force);
        record(state_.t + now.time, between_, sampled_, false);
    }

    // The whole contact at once, where that is possible and its energy balance agrees.
    bool collocate(int c, real speed, real e) {
        const HertzTsuji* law = contact(c).normal.get_if<HertzTsuji>();
        if (!law) return false;
        const real zeta = law->damping(e);
        if (!lone_.prepare(contact(c), *law, loads_, state_, speed, zeta, next_stop() - state_.t))
            return false;
        if (!alone(c, speed, lone_.longest_time()) || !lone_.solve()) return false;
        spent_.clear(); // by itself: in the sums of a long run its rounding would drown
        const LoneContact::Instant end = lone_.end();
        lone_.finish(end, scratch_, spent_);
        const ContactState contact_state = first_touch(*law, e, speed);
        const real stored = stored_energy(*law, contact_state, end.x);
        const std::size_t d = damper_of(c);
        const real residual = energy(scratch_) + stored - energy(state_) + spent_.normal[d] + spent_.viscous -
                              spent_.load_work - spent_.base_work;
        const real size = contact(c).mass * speed * speed + energy(state_) * 1e-2;
        if (!(std::fabs(residual) < std::fmax(problem_.settings.tolerance, 64 * epsilon) * size))
            return false;

        Impact line;
        line.contact = c;
        line.time = state_.t;
        line.approach_speed = speed;
        if (law->needs_restitution()) line.restitution = e;
        line.separation_speed = -end.rate;
        line.duration = end.time;
        if (problem_.settings.peaks) {
            const LoneContact::Instant deepest = lone_.look(lone_.deepest_position());
            line.peak_overlap = square(square(deepest.x));
            line.peak_force = zeta == 0 ? deepest.force : lone_.peak_force();
        }
        line.energy_lost = end.lost + stored;
        line.complete = true;
        const int number = result_.enter(line);
        ++result_.counts.collocated;
        if (samples_contacts()) {
            const real deepest = state_.t + lone_.time_at(lone_.deepest_position());
            while (sample_due(deepest)) sample_lone(c, *law, speed, zeta);
            sample_deepest(c, *law, speed, zeta);
        }
        while (sample_due(state_.t + end.time)) sample_lone(c, *law, speed, zeta);
        contact_ended_ = true;
        std::swap(state_.y, scratch_.y);
        state_.t += end.time;
        ledger_.add(spent_);
        if (stored > 0) {
            released_.push_back({c, contact_state, number, stored});
            phase(c) = Phase::released;
        }
        return true;
    }

    // `since`: when its force began, by default now.
    void begin_contact(int c, real speed, real e, real x, real since = not_a_number) {
        Active a;
        a.contact = c;
        bool asked = false;
        contact(c).normal.visit([&](const auto& law) {
            a.state = first_touch(law, e, speed);
            asked = law.needs_restitution();
        });
        Impact line;
        line.contact = c;
        line.time = std::isnan(since) ? state_.t : since;
        line.approach_speed = speed;
        if (asked) line.restitution = e;
        a.impact = result_.enter(line);
        a.x = x;
        a.speed = speed;
        system_.active.push_back(a);
        phase(c) = Phase::closed;
    }

    // Length of a flight in which the contacts that close from rest go on to close, with a negligible force.
    // They start slower than rounding can tell from the motion around them, so that their errors are measured
    // by the speed they have when their force balances what closes them.
    real rest_start_length(real length) {
        rest_speed_ = 0;
        for (int halving = 0; halving < 400; ++halving, length *= 0.5) {
            flight_.at(length, scratch_);
            const real* y = scratch_.y.data();
            bool balanced = true, negligible = true;
            real speed = 0;
            for (int c = 0; c < problem_.contact_count(); ++c) {
                if (phase(c) != Phase::touching) continue;
                const real rate = gap(problem_, contact(c), y).rate;
                speed = std::fmax(speed, -rate);
                balanced = balanced && braking(c, y, length) <= std::fabs(rate);
                negligible = negligible &&
                             rate * length <= 8 * epsilon * problem_.dampers[damper_of(c)].clearance &&
                             weak(c, y, length, 0);
            }
            if (balanced) rest_speed_ = std::fmax(rest_speed_, speed);
            if (negligible) break;
        }
        return length;
    }

    // What the force of a contact that closes from rest would take from its closing rate in `length`.
    real braking(int c, const real* y, real length) const {
        const Gap g = gap(problem_, contact(c), y);
        if (g.value >= 0) return 0;
        const real e = rebound(contact(c).restitution, 0).e, x = std::sqrt(std::sqrt(-g.value));
        const real f = contact(c).normal.visit([&](const auto& law) {
            return contact_force(law, first_touch(law, e, -g.rate), x, -g.rate).total;
        });
        return std::fabs(f) * length / contact(c).mass;
    }

    // Is that negligible: below 1e-8 of the closing rate itself, or within the tolerance of the speeds around
    // it?
    bool weak(int c, const real* y, real length, real speed) const {
        const real rate = gap(problem_, contact(c), y).rate;
        return braking(c, y, length) <=
               std::fmax(1e-8 * std::fabs(rate), problem_.settings.tolerance * speed);
    }

    // Begins the contacts that close from rest, at the overlap that they have now. Their force began at
    // `since`, unless the overlap has grown too fast for a power of the time since then. Those that press
    // begin also where rounding of the places has lost the way they came.
    void begin_at_rest(real since, const std::vector<char>& presses = {}) {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (phase(c) != Phase::touching) continue;
            const Gap g = gap(problem_, contact(c), state_.y.data());
            const bool pressing = !presses.empty() && presses[static_cast<std::size_t>(c)];
            if (g.rate >= 0 || (g.value >= 0 && !pressing)) continue;
            const Rebound r = rebound(contact(c).restitution, 0);
            if (!possible(contact(c).normal, r)) return fail(Status::no_rebound, c, 0);
            begin_contact(c, 0, r.e, std::sqrt(std::sqrt(std::fmax(-g.value, 0.0))),
                          pressing || state_.t - since <= 50 * std::fabs(g.value / g.rate) ? since
                                                                                           : state_.t);
            system_.active.back().speed = std::fmax(-g.rate, rest_speed_);
        }
        rest_speed_ = 0;
    }

    // ---- hard impacts

    // Pushes the two sides of c apart with the impulse j.
    void impulse(int c, real j) {
        const Contact& k = contact(c);
        real* v = velocities(problem_, state_.y.data());
        real on_cavity = 0;
        if (k.below == wall)
            on_cavity -= j;
        else
            v[k.below] -= j / problem_.ball_mass[static_cast<std::size_t>(k.below)];
        if (k.above == wall)
            on_cavity += j;
        else
            v[k.above] += j / problem_.ball_mass[static_cast<std::size_t>(k.above)];
        const Damper& damper = problem_.dampers[damper_of(c)];
        for (std::size_t m = 0; m < damper.shape.size(); ++m)
            state_.y[2 * m + 1] += damper.shape[m] * on_cavity;
    }

    // Acceleration of the gap with the contacts that are stuck now.
    real gap_acceleration(int c) {
        system_.begin(loads_, state_.t);
        load_system();
        trial_.resize(system_.size());
        system_(y_.data(), trial_.data());
        const Contact& k = contact(c);
        const real* dv = velocities(problem_, trial_.data());
        const real z = cavity(problem_.dampers[damper_of(c)], trial_.data()).p;
        return (k.above == wall ? z : dv[k.above]) - (k.below == wall ? z : dv[k.below]);
    }

    real shortest_period() const {
        real rate = 2 * pi / problem_.settings.duration;
        for (const Mode& mode : problem_.modes) rate = std::max(rate, std::sqrt(mode.stiffness));
        rate = std::max(rate, loads_.frequency());
        return 2 * pi / rate;
    }

    // The largest speed of a ball relative to its cavity.
    real largest_speed() const {
        const real* v = velocities(problem_, state_.y.data());
        real largest = 0;
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            const Damper& damper = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])];
            largest = std::max(largest, std::fabs(v[i] - cavity(damper, state_.y.data()).p));
        }
        return largest;
    }

    // What rounding leaves of the difference of two equal velocities.
    real blur() const {
        const real* v = velocities(problem_, state_.y.data());
        real largest = fastest_;
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
            largest = std::fmax(largest, std::fabs(v[i]));
        for (const Damper& damper : problem_.dampers)
            largest = std::fmax(largest, std::fabs(cavity(damper, state_.y.data()).p));
        return 16 * epsilon * largest;
    }

    // An impact elsewhere has moved what was at rest on something: it is struck in its turn, or it parts.
    void wake_stuck() {
        const real blur = this->blur();
        std::erase_if(system_.stuck, [&](int c) {
            if (std::fabs(system_.approach(state_.y.data(), c)) <= blur) return false;
            phase(c) = Phase::open;
            return true;
        });
        for (int c = 0; c < problem_.contact_count(); ++c)
            if (phase(c) == Phase::touching && std::fabs(system_.approach(state_.y.data(), c)) > blur)
                phase(c) = Phase::open;
    }

    // Takes `change` from the closing rate of c; returns the impulse. What is stuck meanwhile holds without
    // rebound, where it need not pull, and so does what only touches, if c does not rebound either: the
    // impulses of all solve one linear system. In a slow impact what is stuck may pull, by no more than that
    // impact's impulse: or balls in two cavities would knock each other off for ever.
    real push_apart(int c, real change, bool rebounds, bool slow) {
        std::vector<int> held;
        std::copy_if(system_.stuck.begin(), system_.stuck.end(), std::back_inserter(held),
                     [&](int other) { return other != c; });
        std::ptrdiff_t kept = slow ? static_cast<std::ptrdiff_t>(held.size()) : 0;
        for (int other = 0; other < problem_.contact_count() && !rebounds; ++other)
            if (other != c && phase(other) == Phase::touching) held.push_back(other);
        held.push_back(c);
        std::vector<real> matrix, impulses;
        for (;;) {
            const std::size_t n = held.size();
            matrix.resize(n * n);
            impulses.assign(n, 0.0);
            impulses[n - 1] = -change;
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t j = 0; j < n; ++j)
                    matrix[i * n + j] = system_.coupling(contact(held[i]), contact(held[j]));
            solve_definite(matrix, impulses);
            const auto weakest = std::min_element(impulses.begin() + kept, impulses.end() - 1);
            if (weakest == impulses.end() - 1 || !(*weakest < 0)) break;
            held.erase(held.begin() + (weakest - impulses.begin()));
        }
        for (std::size_t i = 0; i < held.size(); ++i) impulse(held[i], impulses[i]);
        return impulses.back();
    }

    void strike(int c, real speed, real e) {
        // Impacts that shrink without a force that presses (a row that collapses) end like those that do.
        fastest_ = std::fmax(fastest_, largest_speed());
        const bool slow = speed < problem_.settings.stick * fastest_ || speed < blur();
        if (slow) e = 0;
        const real push = push_apart(c, (1 + e) * speed, e > 0, slow);
        Impact line;
        line.contact = c;
        line.time = state_.t;
        line.approach_speed = speed;
        line.restitution = e;
        line.separation_speed = e * speed;
        line.duration = 0;
        line.peak_force = infinity;
        line.energy_lost = 0.5 * push * (1 - e) * speed;
        line.complete = true;
        contact_ended_ = true;
        ledger_.normal[damper_of(c)] += line.energy_lost;
        const auto number = static_cast<std::size_t>(result_.enter(line));
        wake_stuck();
        const real rebound_speed = std::fmax(-system_.approach(state_.y.data(), c), 0.0);
        const real acceleration = gap_acceleration(c);
        if (acceleration < 0 &&
            2 * rebound_speed < -acceleration * problem_.settings.stick * shortest_period()) {
            result_.impacts[number].energy_lost += stick(c);
        } else if (e == 0) {
            phase(c) = Phase::touching;
        }
    }

    // Holds c at rest from now on; returns the energy that was left in its rebound.
    real stick(int c) {
        const real rest = system_.approach(state_.y.data(), c);
        const real lost = 0.5 * push_apart(c, rest, false, true) * rest;
        ledger_.normal[damper_of(c)] += lost;
        ++result_.counts.sticks;
        system_.stuck.push_back(c);
        phase(c) = Phase::closed;
        wake_stuck();
        return lost;
    }

public:
    Touching(const Problem& problem, const std::atomic<bool>* stop)
        : Progress(problem, stop), lone_(problem), sampler_(problem), between_(problem), spent_(problem) {}
};

} // namespace rattlebox
