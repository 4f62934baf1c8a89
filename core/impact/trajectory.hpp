// One run from its start to its end: flights and contacts in turn, samples on the way.
//
// Soft contacts are integrated (impact/closed.hpp); with Method::newton an impact takes no time and a contact
// whose bounces have become shorter than a stated part of the shortest period sticks until its force would
// have to pull.
#pragma once

#include <algorithm>
#include <atomic>

#include "base/dop853.hpp"
#include "impact/flight.hpp"
#include "impact/log.hpp"
#include "impact/lone_contact.hpp"
#include "impact/system.hpp"

namespace rattlebox {

class Trajectory {
    enum class Phase : char { open, touching, closed, released };

    const Problem& problem_;
    const std::atomic<bool>* stop_;
    Loads loads_;
    State state_, scratch_;
    Ledger ledger_;
    Flight flight_;
    System system_;
    Dop853 integrator_;
    LoneContact lone_, sampler_;
    std::vector<Phase> phase_;
    std::vector<char> watched_;
    std::vector<Released> released_;
    std::size_t next_sample_ = 0;
    Result result_;
    std::vector<real> y_, trial_, partial_, scale_, stored_, force_;

    const Contact& contact(int c) const { return problem_.contacts[static_cast<std::size_t>(c)]; }
    std::size_t damper_of(int c) const { return static_cast<std::size_t>(contact(c).damper); }
    Phase& phase(int c) { return phase_[static_cast<std::size_t>(c)]; }
    bool hard() const { return problem_.settings.method == Method::newton; }
    bool running() const { return result_.status == Status::finished; }
    real next_stop() const { return std::min(loads_.next_knot(), problem_.settings.duration); }

    void fail(Status status, int c = -1, real value = 0) {
        result_.status = status;
        result_.stopped_contact = c;
        result_.stopped_value = value;
    }

    // ---- recording

    // Stored energy of a released contact that still overlaps in state y.
    real recovering(const Released& r, const real* y) const {
        const real overlap = -gap(problem_, contact(r.contact), y).value - r.memory.offset;
        if (overlap <= 0) return 0;
        const real x = std::sqrt(std::sqrt(overlap));
        return contact(r.contact).normal.visit([&](const auto& law) { return law.stored(r.memory, x); });
    }

    void record(real t, const State& state, Ledger ledger) {
        for (const Released& r : released_) {
            const real left = recovering(r, state.y.data());
            stored_[damper_of(r.contact)] += left;
            ledger.normal[damper_of(r.contact)] += r.energy - left;
        }
        result_.record(t, state, ledger, stored_, force_);
    }

    void clear_contact_samples() {
        std::fill(stored_.begin(), stored_.end(), 0.0);
        std::fill(force_.begin(), force_.end(), 0.0);
    }

    bool sample_due(real until) const {
        return next_sample_ < problem_.sample_times.size() && problem_.sample_times[next_sample_] <= until;
    }

    void sample_flight(real until) {
        while (sample_due(until)) {
            const real t = problem_.sample_times[next_sample_++];
            Ledger ledger = ledger_;
            flight_.account(t - state_.t, ledger);
            flight_.at(t - state_.t, scratch_);
            clear_contact_samples();
            record(t, scratch_, std::move(ledger));
        }
    }

    // ---- flights

    void fly() {
        ++result_.counts.flights;
        const real stop = next_stop();
        bool any_touching = false;
        for (Phase p : phase_) any_touching = any_touching || p == Phase::touching;
        flight_.begin(state_, loads_, stop - state_.t, any_touching);
        bool pressing = false;
        for (std::size_t c = 0; c < phase_.size(); ++c) {
            watched_[c] = phase_[c] != Phase::touching;
            if (phase_[c] != Phase::touching) continue;
            const int tendency = flight_.tendency(problem_.contacts[c]);
            if (tendency > 0) phase_[c] = Phase::open;
            if (tendency < 0) pressing = true;
            if (tendency < 0 && hard()) stick(static_cast<int>(c));
        }
        if (pressing && hard()) return;
        const Touch touch = flight_.first_touch(watched_);
        real length = touch.after;
        if (pressing) length = rest_start_length(length);
        const bool to_stop = touch.contact < 0 && length == stop - state_.t;
        const real end = to_stop ? stop : state_.t + length;
        sample_flight(end);
        flight_.account(length, ledger_);
        flight_.at(length, scratch_);
        std::swap(scratch_.y, state_.y);
        state_.t = end;
        settle_released(touch.contact);
        if (pressing)
            begin_at_rest();
        else if (touch.contact >= 0)
            meet(touch.contact);
    }

    // Released contacts that have opened: their stored energy is gone for good.
    void settle_released(int touched) {
        for (std::size_t i = released_.size(); i-- > 0;) {
            const int c = released_[i].contact;
            const real blur = 8 * epsilon * problem_.dampers[damper_of(c)].clearance;
            if (c != touched && gap(problem_, contact(c), state_.y.data()).value < -blur) continue;
            ledger_.normal[damper_of(released_[i].contact)] += released_[i].energy;
            phase(released_[i].contact) = Phase::open;
            released_.erase(released_.begin() + static_cast<std::ptrdiff_t>(i));
        }
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

    // ---- first touch

    void meet(int c) {
        const real speed = std::fmax(system_.approach(state_.y.data(), c), 0.0);
        const Rebound r = rebound(contact(c).restitution, speed);
        if (r.outside) return fail(Status::law_domain, c, speed);
        result_.counts.extrapolated += r.extrapolated;
        if (hard()) return strike(c, speed, r.e);
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
        State at(problem_);
        Ledger ledger = ledger_;
        LoneContact::Instant now;
        real psi = lone_.psi_at(t - state_.t);
        for (int pass = 0; pass < 8; ++pass) {
            sampler_.prepare(contact(c), law, loads_, state_, speed, zeta, infinity, psi);
            sampler_.solve();
            now = sampler_.at(1, nullptr, nullptr);
            const real late = t - state_.t - now.time;
            if (std::fabs(late) <= 2 * epsilon * t) break;
            psi = std::fmax(psi + late * sampler_.turning(now), 0.5 * psi);
        }
        now = sampler_.at(1, &at, &ledger);
        clear_contact_samples();
        stored_[damper_of(c)] = law.stored({}, now.x);
        add_wall_force(c, now.force);
        record(t, at, std::move(ledger));
    }

    // The whole contact at once, where that is possible and its energy balance agrees.
    bool collocate(int c, real speed, real e) {
        const HertzTsuji* law = contact(c).normal.get_if<HertzTsuji>();
        if (!law) return false;
        const real zeta = law->zeta(e);
        if (!lone_.prepare(contact(c), *law, loads_, state_, speed, zeta, next_stop() - state_.t))
            return false;
        if (!alone(c, speed, lone_.longest_time()) || !lone_.solve()) return false;
        Ledger after = ledger_;
        const LoneContact::Instant end = lone_.at(1, &scratch_, &after);
        const real stored = law->stored({}, end.x);
        const std::size_t d = damper_of(c);
        const real residual = energy(scratch_) + stored - energy(state_) +
                              (after.normal[d] - ledger_.normal[d]) + (after.viscous - ledger_.viscous) -
                              (after.load_work - ledger_.load_work) - (after.base_work - ledger_.base_work);
        const real size = contact(c).mass * speed * speed + energy(state_) * 1e-2;
        if (!(std::fabs(residual) < std::fmax(problem_.settings.tolerance, 64 * epsilon) * size))
            return false;

        const LoneContact::Instant deepest = lone_.at(lone_.deepest_position(), nullptr, nullptr);
        Impact line;
        line.contact = c;
        line.time = state_.t;
        line.approach_speed = speed;
        if (law->needs_restitution()) line.restitution = e;
        line.separation_speed = -end.rate;
        line.duration = end.time;
        line.peak_overlap = square(square(deepest.x));
        line.peak_force = lone_.peak_force();
        line.energy_lost = end.lost + stored;
        line.complete = true;
        result_.impacts.push_back(line);
        ++result_.counts.collocated;
        while (sample_due(state_.t + end.time)) sample_lone(c, *law, speed, zeta);
        std::swap(state_.y, scratch_.y);
        state_.t += end.time;
        ledger_ = after;
        if (stored > 0) {
            Memory memory = law->begin(e);
            released_.push_back({c, memory, static_cast<int>(result_.impacts.size()) - 1, stored});
            phase(c) = Phase::released;
        }
        return true;
    }

    void begin_contact(int c, real speed, real e, real x) {
        Active a;
        a.contact = c;
        bool asked = false;
        contact(c).normal.visit([&](const auto& law) {
            a.memory = law.begin(e);
            asked = law.needs_restitution();
        });
        a.impact = static_cast<int>(result_.impacts.size());
        a.x = x;
        a.speed = speed;
        system_.active.push_back(a);
        phase(c) = Phase::closed;
        Impact line;
        line.contact = c;
        line.time = state_.t;
        line.approach_speed = speed;
        if (asked) line.restitution = e;
        result_.impacts.push_back(line);
    }

    // Length of a flight after which the contacts that close from rest still exert a negligible force.
    real rest_start_length(real length) {
        for (int halving = 0; halving < 400; ++halving, length *= 0.5) {
            flight_.at(length, scratch_);
            bool negligible = true;
            for (std::size_t c = 0; c < phase_.size(); ++c)
                if (phase_[c] == Phase::touching)
                    negligible = negligible && weak(static_cast<int>(c), scratch_.y.data(), length, 0);
            if (negligible) break;
        }
        return length;
    }

    // Is what the force of a contact that closes from rest does in `length` negligible: below 1e-8 of the
    // closing rate itself, or within the tolerance of the speeds around it?
    bool weak(int c, const real* y, real length, real speed) const {
        const Gap g = gap(problem_, contact(c), y);
        if (g.value >= 0) return true;
        const real e = rebound(contact(c).restitution, 0).e, x = std::sqrt(std::sqrt(-g.value));
        const real f =
            contact(c).normal.visit([&](const auto& law) { return law.force(law.begin(e), x, -g.rate); });
        return std::fabs(f) * length <=
               contact(c).mass * std::fmax(1e-8 * std::fabs(g.rate), problem_.settings.tolerance * speed);
    }

    void begin_at_rest() {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (phase(c) != Phase::touching) continue;
            const Gap g = gap(problem_, contact(c), state_.y.data());
            if (g.value >= 0 || g.rate >= 0) continue;
            begin_contact(c, 0, rebound(contact(c).restitution, 0).e, std::sqrt(std::sqrt(-g.value)));
            system_.active.back().speed = -g.rate;
        }
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

    // An impact elsewhere has moved what was at rest on something: it is struck in its turn, or it parts.
    void wake_stuck() {
        const real blur = 16 * epsilon * largest_speed();
        std::erase_if(system_.stuck, [&](int c) {
            if (std::fabs(system_.approach(state_.y.data(), c)) <= blur) return false;
            phase(c) = Phase::open;
            return true;
        });
        for (int c = 0; c < problem_.contact_count(); ++c)
            if (phase(c) == Phase::touching && std::fabs(system_.approach(state_.y.data(), c)) > blur)
                phase(c) = Phase::open;
    }

    // An impact of c. What rests on each other meanwhile holds without rebound, where it need not pull: the
    // impulses of c and of the stuck contacts solve one linear system.
    void strike(int c, real speed, real e) {
        // Impacts that shrink without a force that presses (a row that collapses) end like those that do.
        if (speed < problem_.settings.stick * largest_speed()) e = 0;
        std::vector<int> held = system_.stuck;
        held.push_back(c);
        std::vector<real> matrix, impulses;
        for (;;) {
            const std::size_t n = held.size();
            matrix.resize(n * n);
            impulses.assign(n, 0.0);
            impulses[n - 1] = -(1 + e) * speed;
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t j = 0; j < n; ++j)
                    matrix[i * n + j] = system_.coupling(contact(held[i]), contact(held[j]));
            solve_definite(matrix, impulses);
            const auto weakest = std::min_element(impulses.begin(), impulses.end() - 1);
            if (n == 1 || !(*weakest < 0)) break;
            held.erase(held.begin() + (weakest - impulses.begin()));
        }
        for (std::size_t i = 0; i < held.size(); ++i) impulse(held[i], impulses[i]);
        Impact line;
        line.contact = c;
        line.time = state_.t;
        line.approach_speed = speed;
        line.restitution = e;
        line.separation_speed = e * speed;
        line.duration = 0;
        line.peak_force = infinity;
        line.energy_lost = 0.5 * impulses.back() * (1 - e) * speed;
        line.complete = true;
        ledger_.normal[damper_of(c)] += line.energy_lost;
        result_.impacts.push_back(line);
        wake_stuck();
        const real rebound_speed = std::fmax(-system_.approach(state_.y.data(), c), 0.0);
        const real acceleration = gap_acceleration(c);
        if (acceleration < 0 &&
            2 * rebound_speed < -acceleration * problem_.settings.stick * shortest_period()) {
            result_.impacts.back().energy_lost += stick(c);
        } else if (e == 0) {
            phase(c) = Phase::touching;
        }
    }

    // Holds c at rest from now on; returns the energy that was left in its rebound.
    real stick(int c) {
        const Contact& k = contact(c);
        const real rest = system_.approach(state_.y.data(), c), mass = 1 / -system_.coupling(k, k);
        impulse(c, mass * rest);
        ledger_.normal[damper_of(c)] += 0.5 * mass * rest * rest;
        ++result_.counts.sticks;
        system_.stuck.push_back(c);
        phase(c) = Phase::closed;
        return 0.5 * mass * rest * rest;
    }

    // ---- closed contacts

    void load_system() {
        y_.assign(system_.size(), 0.0);
        std::copy(state_.y.begin(), state_.y.end(), y_.begin());
        for (std::size_t j = 0; j < system_.active.size(); ++j) y_[system_.x_index(j)] = system_.active[j].x;
    }

    // Takes over the integrated state y; what the dashpots have taken goes to the ledger and to the log.
    void unload_system(const std::vector<real>& y) {
        std::copy_n(y.begin(), state_.y.size(), state_.y.begin());
        const std::size_t at = system_.time_index();
        state_.t += y[at];
        ledger_.load_work += y[at + 1];
        ledger_.base_work += y[at + 2];
        ledger_.viscous += y[at + 3];
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            Active& a = system_.active[j];
            a.x = y[system_.x_index(j)];
            const real lost = y[system_.x_index(j) + 1];
            ledger_.normal[damper_of(a.contact)] += lost;
            result_.impacts[static_cast<std::size_t>(a.impact)].energy_lost += lost;
        }
    }

    void sample_closed(const std::vector<real>& y) {
        std::copy_n(y.begin(), state_.y.size(), scratch_.y.begin());
        Ledger ledger = ledger_;
        const std::size_t at = system_.time_index();
        ledger.load_work += y[at + 1];
        ledger.base_work += y[at + 2];
        ledger.viscous += y[at + 3];
        clear_contact_samples();
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            const Active& a = system_.active[j];
            const std::size_t d = damper_of(a.contact);
            const real x = y[system_.x_index(j)];
            ledger.normal[d] += y[system_.x_index(j) + 1];
            contact(a.contact).normal.visit([&](const auto& law) {
                ledger.plastic[d] += law.plastic(a.memory, x);
                stored_[d] += law.stored(a.memory, x);
            });
            add_wall_force(a.contact, system_.force(y.data(), j));
        }
        if (!system_.stuck.empty()) {
            partial_.resize(system_.size());
            system_(y.data(), partial_.data());
            for (std::size_t i = 0; i < system_.stuck.size(); ++i)
                add_wall_force(system_.stuck[i], system_.stuck_forces()[i]);
        }
        record(problem_.sample_times[next_sample_++], scratch_, std::move(ledger));
    }

    void add_wall_force(int c, real force) {
        if (contact(c).above == wall) force_[damper_of(c)] += force;
        if (contact(c).below == wall) force_[damper_of(c)] -= force;
    }

    // First step in transformed time: a tenth of the way through the contact that is soonest over.
    real first_step(real remaining) const {
        if (system_.active.empty()) {
            real rate = loads_.frequency();
            for (const Mode& mode : problem_.modes) rate = std::max(rate, mode.rate());
            real h = std::min(remaining, rate > 0 ? 0.1 / rate : remaining);
            for (const Released& r : released_) {
                const Gap g = gap(problem_, contact(r.contact), state_.y.data());
                if (g.value != 0 && g.rate != 0) h = std::min(h, 0.1 * std::fabs(g.value / g.rate));
            }
            return h;
        }
        real h = infinity;
        for (const Active& a : system_.active) {
            const real depth = contact(a.contact).normal.visit(
                [&](const auto& law) { return std::sqrt(std::sqrt(law.overlap_scale(a.speed))); });
            h = std::min(h, 0.4 * (a.x > 0 ? std::min(a.x, depth) : depth) / a.speed);
        }
        return h;
    }

    real contact_speed() const {
        real speed = 0;
        for (const Active& a : system_.active) speed = std::max(speed, a.speed);
        return speed;
    }

    // Errors are measured against the speeds and overlaps of the contacts themselves.
    void set_scales() {
        const real tolerance = problem_.settings.tolerance;
        scale_.assign(system_.size(), infinity);
        real speed = 0;
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            const Active& a = system_.active[j];
            speed = std::max(speed, a.speed);
            const real depth = contact(a.contact).normal.visit(
                [&](const auto& law) { return std::sqrt(std::sqrt(law.overlap_scale(a.speed))); });
            scale_[system_.x_index(j)] = tolerance * std::max(depth, std::fabs(a.x));
        }
        if (system_.active.empty())
            for (real y : state_.y) speed = std::max(speed, std::fabs(y));
        if (speed == 0) speed = 1;
        real* ball = scale_.data() + 2 * problem_.modes.size() + problem_.ball_mass.size();
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) ball[i] = tolerance * speed;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real shape = 0;
            for (const Damper& damper : problem_.dampers) shape = std::max(shape, std::fabs(damper.shape[k]));
            scale_[2 * k + 1] = shape > 0 ? tolerance * speed / shape : tolerance * speed;
        }
    }

    // Where in a step of length h from y_ the function turns from `before` (>= 0) to <= 0: the far end of a
    // bracket that has shrunk to rounding. Every probe is a step of the integrator itself.
    template <class F> real locate(real h, real before, real after, F&& f) {
        real low = 0, high = h, f_low = before, f_high = after;
        int side = 0;
        for (int iteration = 0; iteration < 80 && f_high != 0; ++iteration) {
            real next = (low * f_high - high * f_low) / (f_high - f_low);
            const real width = high - low,
                       edge = 1e-3 * width * std::fabs(f_high) / (std::fabs(f_high) + std::fabs(f_low));
            if (iteration % 3 == 2)
                next += edge; // step over the root, so that the bracket shrinks from both ends
            if (!(next > low && next < high) || iteration > 20) next = low + 0.5 * width;
            if (width <= 4 * epsilon * h) break;
            integrator_.step(system_, y_.data(), next, partial_.data());
            const real value = f(partial_.data());
            if (value > 0) {
                low = next;
                f_low = value;
                if (side == 1) f_high *= 0.5;
                side = 1;
            } else {
                high = next;
                f_high = value;
                if (side == -1) f_low *= 0.5;
                side = -1;
            }
        }
        return high;
    }

    real boundary(const real* y, std::size_t j) const {
        const Active& a = system_.active[j];
        const real rate = system_.approach(y, a.contact);
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return law.boundary(a.memory, y[system_.x_index(j)], rate); });
    }

    // Positive while a released contact's law would not push.
    real apart(const real* y, const Released& r) const {
        const Gap g = gap(problem_, contact(r.contact), y);
        const real overlap = -g.value - r.memory.offset;
        if (overlap <= 0) return 1;
        const real x = std::sqrt(std::sqrt(overlap));
        return -contact(r.contact).normal.visit(
            [&](const auto& law) { return law.force(r.memory, x, -g.rate); });
    }

    enum class Event { none, boundary, touch, rest_touch, opened, engaged, unstuck };

    void integrate_closed() {
        settle_released(-1);
        for (int r = static_cast<int>(released_.size()) - 1; r >= 0; --r) {
            const Released& released = released_[static_cast<std::size_t>(r)];
            if (apart(state_.y.data(), released) < 0 &&
                gap(problem_, contact(released.contact), state_.y.data()).rate < 0)
                engage(r);
        }
        system_.begin(loads_, state_.t);
        load_system();
        const std::size_t n = system_.size(), clock = system_.time_index();
        trial_.resize(n);
        partial_.resize(n);
        integrator_.resize(static_cast<int>(n));
        set_scales();
        const real remaining = next_stop() - state_.t;
        real h = first_step(remaining);
        // Without a soft contact errors can vanish, so that only this keeps a change of sign in a force from
        // being jumped.
        const real longest = system_.active.empty() ? 2.5 * h : infinity;
        for (;;) {
            if (stop_ && stop_->load(std::memory_order_relaxed)) fail(Status::interrupted);
            if (result_.counts.contact_steps + result_.counts.rejected_steps >
                200 * problem_.settings.max_events)
                fail(Status::too_many_events);
            if (!running()) return unload_system(y_);
            integrator_.start(system_, y_.data());
            note_forces();
            // One step whose error is within the bound, not beyond the next stop.
            for (int tries = 0;; ++tries) {
                integrator_.step(system_, y_.data(), h, trial_.data());
                const real error = integrator_.error(h, scale_);
                if (!(error <= 1)) {
                    ++result_.counts.rejected_steps;
                    const real shrink =
                        error < infinity ? std::fmax(0.2, 0.9 * std::pow(error, -0.125)) : 0.1;
                    h *= shrink;
                    if (tries > 200) return fail(Status::step_too_small), unload_system(y_);
                    continue;
                }
                break;
            }
            ++result_.counts.contact_steps;
            const real error = integrator_.error(h, scale_);
            const real grow = error > 0 ? std::fmin(4.0, 0.9 * std::pow(error, -0.125)) : 4.0;

            real end = h;
            bool at_stop = false;
            if (trial_[clock] >= remaining) {
                at_stop = true;
                end = locate(h, remaining, remaining - trial_[clock],
                             [&](const real* y) { return remaining - y[clock]; });
                integrator_.step(system_, y_.data(), end, trial_.data());
            }
            // The earliest event of the step.
            Event event = Event::none;
            int which = -1;
            const auto consider = [&](Event kind, int index, real before, auto&& f) {
                const real after = f(trial_.data());
                if (after > 0 || before < 0) return;
                const real where = locate(end, before, after, f);
                if (where < end || event == Event::none) {
                    end = where;
                    event = kind;
                    which = index;
                    integrator_.step(system_, y_.data(), end, trial_.data());
                }
            };
            for (std::size_t j = 0; j < system_.active.size(); ++j)
                consider(Event::boundary, static_cast<int>(j), boundary(y_.data(), j),
                         [&](const real* y) { return boundary(y, j); });
            for (std::size_t r = 0; r < released_.size(); ++r) {
                const Released& released = released_[r];
                consider(Event::opened, static_cast<int>(r),
                         -gap(problem_, contact(released.contact), y_.data()).value,
                         [&](const real* y) { return -gap(problem_, contact(released.contact), y).value; });
                consider(Event::engaged, static_cast<int>(r), std::fmax(apart(y_.data(), released), 0.0),
                         [&](const real* y) { return apart(y, released); });
            }
            if (!system_.stuck.empty()) {
                std::vector<real> work(n);
                for (std::size_t i = 0; i < system_.stuck.size(); ++i) {
                    const auto holding = [&](const real* y) {
                        system_(y, work.data());
                        return system_.stuck_forces()[i];
                    };
                    consider(Event::unstuck, static_cast<int>(i), std::fmax(holding(y_.data()), 0.0),
                             holding);
                }
            }
            bool retry = false;
            for (int c = 0; c < problem_.contact_count() && !retry; ++c) {
                if (phase(c) != Phase::open && phase(c) != Phase::touching) continue;
                const auto value = [&](const real* y) { return gap(problem_, contact(c), y).value; };
                const Gap before = gap(problem_, contact(c), y_.data()),
                          after = gap(problem_, contact(c), trial_.data());
                const real blur =
                    8 * epsilon * (problem_.dampers[damper_of(c)].clearance + std::fabs(before.value));
                if (phase(c) == Phase::touching ||
                    (std::fabs(before.value) <= blur && std::fabs(before.rate) <= blur)) {
                    if (after.value > blur) phase(c) = Phase::open;
                    if (after.value >= -blur || hard()) continue;
                    if (weak(c, trial_.data(), trial_[clock], contact_speed())) {
                        phase(c) = Phase::touching;
                        event = Event::rest_touch;
                    } else {
                        retry = true;
                    }
                } else if (after.value <= 0) {
                    if (after.rate >= 0) continue; // parting, by less than rounding can tell
                    consider(Event::touch, c, std::fmax(before.value, 0.0), value);
                } else if (before.rate < 0 && after.rate > 0 &&
                           std::fmin(before.value, after.value) <
                               2 * trial_[clock] * std::fmax(-before.rate, after.rate)) {
                    const real lowest = locate(end, -before.rate, -after.rate, [&](const real* y) {
                        return -gap(problem_, contact(c), y).rate;
                    });
                    integrator_.step(system_, y_.data(), lowest, partial_.data());
                    if (value(partial_.data()) <= 0) {
                        std::swap(trial_, partial_);
                        end = lowest;
                        event = Event::none;
                        consider(Event::touch, c, std::fmax(before.value, 0.0), value);
                    }
                }
            }
            if (retry) {
                h *= 0.25;
                continue;
            }
            note_peaks(end);
            while (sample_due(state_.t + trial_[clock])) {
                const real due = problem_.sample_times[next_sample_] - state_.t;
                if (due < trial_[clock]) {
                    const real where = locate(end, due - y_[clock], due - trial_[clock],
                                              [&](const real* y) { return due - y[clock]; });
                    std::vector<real> at(n);
                    integrator_.step(system_, y_.data(), where, at.data());
                    sample_closed(at);
                } else {
                    sample_closed(trial_);
                }
            }
            std::swap(y_, trial_);
            for (std::size_t j = 0; j < system_.active.size(); ++j) {
                Active& a = system_.active[j];
                const real speed = std::fabs(system_.approach(y_.data(), a.contact));
                if (speed > 2 * a.speed) {
                    a.speed = speed;
                    set_scales();
                }
            }
            if (event != Event::none || at_stop) {
                const real start = state_.t;
                unload_system(y_);
                if (at_stop && event == Event::none) state_.t = start + remaining;
                return handle(event, which);
            }
            h = std::min(h * grow, longest);
        }
    }

    void handle(Event event, int which) {
        switch (event) {
        case Event::none:
            return;
        case Event::boundary:
            return cross(static_cast<std::size_t>(which));
        case Event::touch:
            return meet(which);
        case Event::rest_touch:
            return begin_at_rest();
        case Event::opened:
            return settle(which);
        case Event::engaged:
            return engage(which);
        case Event::unstuck: {
            const int c = system_.stuck[static_cast<std::size_t>(which)];
            system_.stuck.erase(system_.stuck.begin() + which);
            phase(c) = Phase::touching;
            return;
        }
        }
    }

    void cross(std::size_t j) {
        Active& a = system_.active[j];
        const Contact& k = contact(a.contact);
        const real rate = system_.approach(state_.y.data(), a.contact);
        const real overlap = a.memory.offset + square(a.x * a.x);
        real plastic = 0, stored = 0;
        Next next{};
        k.normal.visit([&](const auto& law) {
            next = law.cross(a.memory, a.x, rate);
            a.x = std::sqrt(std::sqrt(std::fmax(overlap - a.memory.offset, 0.0)));
            plastic = law.plastic(a.memory, a.x);
            stored = law.stored(a.memory, a.x);
        });
        if (next == Next::stay) return;
        Impact& line = result_.impacts[static_cast<std::size_t>(a.impact)];
        const std::size_t d = damper_of(a.contact);
        ledger_.plastic[d] += plastic;
        line.energy_lost += plastic;
        line.duration = state_.t - line.time;
        line.separation_speed = -rate;
        line.complete = true;
        if (next == Next::release && overlap > 0) {
            line.energy_lost += stored;
            released_.push_back({a.contact, a.memory, a.impact, stored});
            phase(a.contact) = Phase::released;
        } else {
            phase(a.contact) = Phase::open;
        }
        system_.active.erase(system_.active.begin() + static_cast<std::ptrdiff_t>(j));
    }

    void settle(int r) {
        const Released& released = released_[static_cast<std::size_t>(r)];
        ledger_.normal[damper_of(released.contact)] += released.energy;
        phase(released.contact) = Phase::open;
        released_.erase(released_.begin() + r);
    }

    // A released contact takes hold again: the same impact goes on, what it had lost meanwhile stays lost.
    void engage(int r) {
        const Released released = released_[static_cast<std::size_t>(r)];
        released_.erase(released_.begin() + r);
        const real left = recovering(released, state_.y.data());
        ledger_.normal[damper_of(released.contact)] += released.energy - left;
        const real plastic = contact(released.contact).normal.visit([&](const auto& law) {
            return law.plastic(released.memory, 0);
        });
        ledger_.plastic[damper_of(released.contact)] -= plastic;
        Impact& line = result_.impacts[static_cast<std::size_t>(released.impact)];
        line.energy_lost -= left + plastic;
        line.complete = false;
        Active a;
        a.contact = released.contact;
        a.memory = released.memory;
        a.impact = released.impact;
        const Gap g = gap(problem_, contact(a.contact), state_.y.data());
        a.x = std::sqrt(std::sqrt(std::fmax(-g.value - a.memory.offset, 0.0)));
        a.speed = std::fmax(line.approach_speed, std::fabs(g.rate));
        system_.active.push_back(a);
        phase(a.contact) = Phase::closed;
    }

    // ---- peaks of force and overlap

    void note(std::size_t j, const real* y) {
        const Active& a = system_.active[j];
        Impact& line = result_.impacts[static_cast<std::size_t>(a.impact)];
        line.peak_force = std::fmax(line.peak_force, system_.force(y, j));
        line.peak_overlap =
            std::fmax(line.peak_overlap, a.memory.offset + square(square(y[system_.x_index(j)])));
    }

    void note_forces() {
        for (std::size_t j = 0; j < system_.active.size(); ++j) note(j, y_.data());
    }

    // Peaks inside the step from y_ to trial_.
    void note_peaks(real h) {
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            note(j, trial_.data());
            const int c = system_.active[j].contact;
            const real before = system_.approach(y_.data(), c), after = system_.approach(trial_.data(), c);
            if (before > 0 && after < 0) {
                const real turn =
                    locate(h, before, after, [&](const real* y) { return system_.approach(y, c); });
                integrator_.step(system_, y_.data(), turn, partial_.data());
                note(j, partial_.data());
            }
            // A maximum inside: the force rises at the step's start and falls at its end.
            const auto force_at = [&](real where) {
                integrator_.step(system_, y_.data(), where, partial_.data());
                return system_.force(partial_.data(), j);
            };
            const real probe = 1e-3 * h;
            const auto rise = [&](real where) { return force_at(where + probe) - force_at(where - probe); };
            real low = probe, high = h - probe, f_low = rise(low), f_high = rise(high);
            if (!(f_low > 0 && f_high < 0)) continue;
            for (int pass = 0; pass < 8; ++pass) {
                real next = (low * f_high - high * f_low) / (f_high - f_low);
                if (pass % 3 == 2) next = 0.5 * (low + high);
                const real value = rise(next);
                (value > 0 ? low : high) = next;
                (value > 0 ? f_low : f_high) = value;
            }
            force_at((low * f_high - high * f_low) / (f_high - f_low));
            note(j, partial_.data());
        }
    }

public:
    Trajectory(const Problem& problem, const std::atomic<bool>* stop = nullptr)
        : problem_(problem), stop_(stop), loads_(problem.loads), state_(problem), scratch_(problem),
          ledger_(problem), flight_(problem), system_(problem), lone_(problem), sampler_(problem),
          phase_(problem.contacts.size(), Phase::open), watched_(problem.contacts.size()),
          stored_(problem.dampers.size()), force_(problem.dampers.size()) {}

    Result run() {
        for (int c = 0; c < problem_.contact_count(); ++c) {
            const Gap g = gap(problem_, contact(c), state_.y.data());
            if (g.value <= 0 && g.rate == 0) phase(c) = Phase::touching;
        }
        if (sample_due(0)) {
            ++next_sample_;
            clear_contact_samples();
            record(0, state_, ledger_);
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
