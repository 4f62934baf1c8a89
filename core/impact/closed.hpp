// Closed contacts integrated step by step, their events, and the peaks of force and overlap.
#pragma once

#include "impact/touch.hpp"
#include "math/dop853.hpp"

namespace rattlebox {

class ClosedContacts : protected Touching {
    Dop853 integrator_;
    std::vector<real> partial_, scale_, slope_, ahead_, behind_;
    real deepest_ = 0;                    // overlap that closed contacts come to, about
    static constexpr real roughly = 1e-8; // of a step: for peaks, whose error is its square

protected:
    // ---- closed contacts

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

    void sample_closed(const std::vector<real>& y, real t, bool given) {
        std::copy_n(y.begin(), state_.y.size(), scratch_.y.begin());
        Ledger& ledger = sampled_ = ledger_;
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
                ledger.plastic[d] += plastic_loss(law, a.state, x);
                stored_[d] += stored_energy(law, a.state, x);
            });
            add_wall_force(a.contact, system_.force(y.data(), j));
        }
        if (!system_.stuck.empty()) {
            partial_.resize(system_.size());
            system_(y.data(), partial_.data());
            for (std::size_t i = 0; i < system_.stuck.size(); ++i)
                add_wall_force(system_.stuck[i], system_.stuck_forces()[i]);
        }
        record(t, scratch_, ledger, given);
    }

    // What rounding leaves of a gap that is zero.
    real gap_blur(int c, const real* y) const {
        const Contact& k = contact(c);
        const Damper& damper = problem_.dampers[damper_of(c)];
        const real* at = positions(problem_, y);
        real size = damper.clearance + std::fabs(gap(problem_, k, y).value);
        for (int ball : {k.below, k.above}) size += std::fabs(ball == wall ? cavity(damper, y).q : at[ball]);
        return 8 * epsilon * std::fmax(size, deepest_);
    }

    // x where the overlap of a contact comes to what its speed lets expect.
    real expected(const Active& a) const {
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return std::sqrt(std::sqrt(law.overlap_scale(a.speed))); });
    }

    // First step in transformed time: a tenth of the way through the contact that is soonest over.
    real first_step(real remaining) const {
        if (system_.active.empty()) {
            const real rate = std::max(loads_.frequency(), fastest_rate(problem_.modes, problem_.coupling));
            real h = std::min(remaining, rate > 0 ? 0.1 / rate : remaining);
            for (const Released& r : released_) {
                const Gap g = gap(problem_, contact(r.contact), state_.y.data());
                // To where it opens, or back to where its force begins; no less than rounding can tell.
                const real room = std::fabs(g.rate < 0 ? g.value + r.state.origin() : g.value);
                if (room != 0 && g.rate != 0)
                    h = std::min(h, 0.1 * (room + gap_blur(r.contact, state_.y.data())) / std::fabs(g.rate));
            }
            return h;
        }
        real h = infinity;
        for (const Active& a : system_.active) {
            const real depth = expected(a);
            // Of a contact that starts from rest either may be too small for a number.
            h = std::min(h, 0.4 * (a.x > 0 && depth > 0 ? std::min(a.x, depth) : a.x + depth) / a.speed);
        }
        return h;
    }

    real contact_speed() const {
        real speed = 0;
        for (const Active& a : system_.active) speed = std::max(speed, a.speed);
        return speed;
    }

    // What rounding of the velocities of both sides makes of x, in the time that the contact takes.
    real x_blur(const Active& a, real depth) const {
        if (a.speed == 0 || depth == 0) return 0;
        const Contact& k = contact(a.contact);
        real size = 0;
        for (int side : {k.below, k.above})
            size = std::fmax(size, std::fabs(side == wall
                                                 ? cavity(problem_.dampers[damper_of(a.contact)], y_.data()).p
                                                 : velocities(problem_, y_.data())[side]));
        const real x = expected(a);
        return 0.25 * epsilon * size / a.speed * x * cube(x / depth);
    }

    // Errors are measured against the speeds and overlaps of the contacts themselves, but not below rounding.
    void set_scales() {
        const real tolerance = problem_.settings.tolerance;
        scale_.assign(system_.size(), infinity);
        real speed = 0, deepest = 0;
        const auto depth = [&](const Active& a) { return std::max(expected(a), std::fabs(a.x)); };
        for (const Active& a : system_.active) {
            speed = std::max(speed, a.speed);
            deepest = std::max(deepest, depth(a));
        }
        deepest_ = square(square(deepest));
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            const Active& a = system_.active[j];
            // A contact that starts from rest has no depth of its own to measure by.
            const real size = std::max(depth(a), 0.1 * deepest);
            scale_[system_.x_index(j)] = std::fmax(tolerance * size, x_blur(a, depth(a)));
        }
        if (system_.active.empty())
            for (real y : state_.y) speed = std::max(speed, std::fabs(y));
        if (speed == 0) speed = 1;
        const auto bound = [&](real size, real v) {
            return std::fmax(tolerance * size, epsilon * std::fabs(v));
        };
        const real* v = velocities(problem_, y_.data());
        real* ball = scale_.data() + 2 * problem_.modes.size() + problem_.ball_mass.size();
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) ball[i] = bound(speed, v[i]);
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real shape = 0;
            for (const Damper& damper : problem_.dampers) shape = std::max(shape, std::fabs(damper.shape[k]));
            scale_[2 * k + 1] = bound(shape > 0 ? speed / shape : speed, y_[2 * k + 1]);
        }
    }

    // Where in a step of length h from y_ the function turns from `before` (>= 0) to <= 0: the far end of a
    // bracket that has shrunk to `part` of it, by default to rounding. Every probe is a step of the
    // integrator itself.
    template <class F> real locate(real h, real before, real after, F&& f, real part = 4 * epsilon) {
        real low = 0, high = h, f_low = before, f_high = after;
        int side = 0;
        for (int iteration = 0; iteration < 80 && f_high != 0; ++iteration) {
            real next = (low * f_high - high * f_low) / (f_high - f_low);
            const real width = high - low,
                       edge = 1e-3 * width * std::fabs(f_high) / (std::fabs(f_high) + std::fabs(f_low));
            if (iteration % 3 == 2)
                next += edge; // step over the root, so that the bracket shrinks from both ends
            if (!(next > low && next < high) || iteration > 20) next = low + 0.5 * width;
            if (width <= part * h) break;
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
            [&](const auto& law) { return phase_end(law, a.state, y[system_.x_index(j)], rate); });
    }

    // Whether the curve of force that it is on ends at some overlap.
    bool has_end(std::size_t j) const {
        const Active& a = system_.active[j];
        return contact(a.contact).normal.visit([&](const auto& law) {
            return std::decay_t<decltype(law)>::hysteretic && a.state.phase != ContactState::yielding;
        });
    }

    // Positive while a released contact's law would not surely push: a force that grows by less than rounding
    // of its gap would make contacts close and be released again at one instant.
    real apart(const real* y, const Released& r) const {
        const Gap g = gap(problem_, contact(r.contact), y);
        const real overlap = -g.value - r.state.origin() - gap_blur(r.contact, y);
        if (overlap <= 0) return 1;
        const real x = std::sqrt(std::sqrt(overlap));
        return -contact(r.contact).normal.visit(
            [&](const auto& law) { return contact_force(law, r.state, x, -g.rate).total; });
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
        if (contact_ended_ && samples_contacts()) {
            while (sample_due(state_.t)) sample_closed(y_, problem_.sample_times[next_sample_++], true);
            sample_closed(y_, std::nextafter(state_.t, infinity), false);
        }
        contact_ended_ = false;
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
            if (problem_.settings.peaks) note_forces();
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
                if (after > 0 || before < 0 || (before == 0 && after == 0)) return;
                const real where = locate(end, before, after, f);
                if (where < end || event == Event::none) {
                    end = where;
                    event = kind;
                    which = index;
                    integrator_.step(system_, y_.data(), end, trial_.data());
                }
            };
            // Turns to where a rate changes its sign, if something is over there that is not so at the end.
            const auto turn_back = [&](real before, real after, auto&& rate, auto&& is_over) {
                const real turn = locate(end, before, after, rate);
                integrator_.step(system_, y_.data(), turn, partial_.data());
                if (!is_over(partial_.data())) return;
                std::swap(trial_, partial_);
                end = turn;
                event = Event::none;
                at_stop = false;
            };
            for (std::size_t j = 0; j < system_.active.size(); ++j) {
                const auto room = [&](const real* y) { return boundary(y, j); };
                const auto rate = [&](const real* y) {
                    return system_.approach(y, system_.active[j].contact);
                };
                const real before = rate(y_.data()), after = rate(trial_.data());
                if (before > 0 && after < 0 && has_end(j) && room(trial_.data()) > 0)
                    turn_back(before, after, rate, [&](const real* y) { return room(y) < 0; });
                consider(Event::boundary, static_cast<int>(j), std::fmax(room(y_.data()), 0.0), room);
            }
            for (std::size_t r = 0; r < released_.size(); ++r) {
                const Released& released = released_[r];
                const auto at = [&](const real* y) { return gap(problem_, contact(released.contact), y); };
                const Gap before = at(y_.data()), after = at(trial_.data());
                // It may open and close again within the step.
                if (after.value < 0 && before.rate > 0 && after.rate < 0)
                    turn_back(
                        before.rate, after.rate, [&](const real* y) { return at(y).rate; },
                        [&](const real* y) { return at(y).value >= 0; });
                consider(Event::opened, static_cast<int>(r), -before.value,
                         [&](const real* y) { return -at(y).value; });
                // Only a force that grows: one that was just released may still push by rounding.
                const real was = apart(y_.data(), released);
                if (apart(trial_.data(), released) < was)
                    consider(Event::engaged, static_cast<int>(r), std::fmax(was, 0.0),
                             [&](const real* y) { return apart(y, released); });
            }
            if (!system_.stuck.empty()) {
                std::vector<real> work(n);
                real blur = 0; // a row afloat has forces of nothing but rounding
                for (const real* y : {y_.data(), trial_.data()}) {
                    system_(y, work.data());
                    for (real force : system_.stuck_forces())
                        blur = std::fmax(blur, 512 * epsilon * std::fabs(force));
                }
                for (std::size_t i = 0; i < system_.stuck.size(); ++i) {
                    const auto holding = [&](const real* y) {
                        system_(y, work.data());
                        return system_.stuck_forces()[i] + blur;
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
                const real blur = gap_blur(c, y_.data());
                if (phase(c) == Phase::touching ||
                    (std::fabs(before.value) <= blur && std::fabs(before.rate) <= blur)) {
                    if (after.value > blur) phase(c) = Phase::open;
                    if (hard()) {
                        const real drift = this->blur() * trial_[clock];
                        if (after.value < std::fmin(before.value, 0.0) - blur - drift) return press(c);
                        continue;
                    }
                    if (after.value >= -blur) continue;
                    const bool faint = after.value >= -4 * blur ||
                                       weak(c, trial_.data(), trial_[clock] - y_[clock], contact_speed());
                    if (faint && after.rate >= 0) continue; // it parts again: nothing begins
                    // A dashpot acts at once: as soon as rounding can tell that it closes must do.
                    if (faint) {
                        phase(c) = Phase::touching;
                        event = Event::rest_touch;
                    } else {
                        retry = true;
                    }
                } else if (after.value <= 0) {
                    if (after.rate >= 0 && (before.value <= blur || before.rate >= 0))
                        continue; // parting, by less than rounding can tell
                    consider(Event::touch, c, std::fmax(before.value, 0.0), value);
                } else if (before.rate < 0 && after.rate > 0 &&
                           std::fmin(before.value, after.value) <
                               2 * trial_[clock] * std::fmax(-before.rate, after.rate)) {
                    turn_back(
                        -before.rate, -after.rate,
                        [&](const real* y) { return -gap(problem_, contact(c), y).rate; },
                        [&](const real* y) { return value(y) <= 0; });
                    if (value(trial_.data()) <= 0)
                        consider(Event::touch, c, std::fmax(before.value, 0.0), value);
                }
            }
            if (retry) {
                h *= 0.25;
                continue;
            }
            if (problem_.settings.peaks) note_peaks(end);
            sample_step(end, event == Event::touch || event == Event::boundary);
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

    // Samples in the step of length h from y_ to trial_: those that are due, those at deepest overlaps, and
    // one at the end of the step if a contact begins or ends there.
    void sample_step(real h, bool at_event) {
        const std::size_t clock = system_.time_index();
        std::vector<std::pair<real, real>> turns; // time since the start, length of the step to there
        if (samples_contacts())
            for (const Active& a : system_.active) {
                const auto rate = [&](const real* y) { return system_.approach(y, a.contact); };
                const real before = rate(y_.data()), after = rate(trial_.data());
                if (!(before > 0 && after < 0)) continue;
                const real where = locate(h, before, after, rate, roughly);
                integrator_.step(system_, y_.data(), where, partial_.data());
                turns.emplace_back(partial_[clock], where);
            }
        std::sort(turns.begin(), turns.end());
        std::vector<real> at(system_.size());
        const auto sample_up_to = [&](real until) {
            while (sample_due(state_.t + until)) {
                const real t = problem_.sample_times[next_sample_++], due = t - state_.t;
                if (due >= trial_[clock]) {
                    sample_closed(trial_, t, true);
                    continue;
                }
                const real where = locate(h, due - y_[clock], due - trial_[clock],
                                          [&](const real* y) { return due - y[clock]; });
                integrator_.step(system_, y_.data(), where, at.data());
                sample_closed(at, t, true);
            }
        };
        for (const auto& [since, where] : turns) {
            sample_up_to(since);
            integrator_.step(system_, y_.data(), where, at.data());
            sample_closed(at, state_.t + since, false);
        }
        sample_up_to(trial_[clock]);
        if (at_event && samples_contacts()) sample_closed(trial_, state_.t + trial_[clock], false);
    }

    // What touches closes by itself: it sticks from the beginning of this step.
    void press(int c) {
        unload_system(y_);
        stick(c);
    }

    void handle(Event event, int which) {
        if (event != Event::rest_touch) smooth_since_ = state_.t;
        switch (event) {
        case Event::none:
            return;
        case Event::boundary:
            return cross(static_cast<std::size_t>(which));
        case Event::touch:
            return meet(which);
        case Event::rest_touch:
            return begin_at_rest(smooth_since_);
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
        const real overlap = a.state.origin() + square(a.x * a.x);
        real plastic = 0, stored = 0;
        Next next{};
        k.normal.visit([&](const auto& law) {
            next = next_phase(law, a.state, a.x);
            a.x = std::sqrt(std::sqrt(std::fmax(overlap - a.state.origin(), 0.0)));
            plastic = plastic_loss(law, a.state, a.x);
            stored = stored_energy(law, a.state, a.x);
        });
        if (next == Next::stay) return;
        contact_ended_ = true;
        Impact& line = result_.impacts[static_cast<std::size_t>(a.impact)];
        const std::size_t d = damper_of(a.contact);
        ledger_.plastic[d] += plastic;
        line.energy_lost += plastic;
        line.duration = state_.t - line.time;
        line.separation_speed = -rate;
        line.complete = true;
        if (next == Next::release && overlap > 0) {
            line.energy_lost += stored;
            released_.push_back({a.contact, a.state, a.impact, stored});
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
            return plastic_loss(law, released.state, 0);
        });
        ledger_.plastic[damper_of(released.contact)] -= plastic;
        Impact& line = result_.impacts[static_cast<std::size_t>(released.impact)];
        line.energy_lost -= left + plastic;
        line.complete = false;
        Active a;
        a.contact = released.contact;
        a.state = released.state;
        a.impact = released.impact;
        const Gap g = gap(problem_, contact(a.contact), state_.y.data());
        a.x = std::sqrt(std::sqrt(std::fmax(-g.value - a.state.origin(), 0.0)));
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
            std::fmax(line.peak_overlap, a.state.origin() + square(square(y[system_.x_index(j)])));
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
                    locate(h, before, after, [&](const real* y) { return system_.approach(y, c); }, roughly);
                integrator_.step(system_, y_.data(), turn, partial_.data());
                note(j, partial_.data());
            }
            const real rises = force_slope(y_.data(), h, j), falls = force_slope(trial_.data(), h, j);
            if (!(rises > 0 && falls < 0)) continue;
            const real top =
                locate(h, rises, falls, [&](const real* y) { return force_slope(y, h, j); }, roughly);
            integrator_.step(system_, y_.data(), top, partial_.data());
            note(j, partial_.data());
        }
    }

    // Slope of the force of j along the motion through y, up to a positive factor.
    real force_slope(const real* y, real h, std::size_t j) {
        const std::size_t n = system_.size();
        slope_.resize(n);
        ahead_.resize(n);
        behind_.resize(n);
        system_(y, slope_.data());
        for (std::size_t i = 0; i < n; ++i) {
            ahead_[i] = y[i] + 1e-4 * h * slope_[i];
            behind_[i] = y[i] - 1e-4 * h * slope_[i];
        }
        return system_.force(ahead_.data(), j) - system_.force(behind_.data(), j);
    }

public:
    using Touching::Touching;
};

} // namespace rattlebox
