// Integration of closed soft contacts with DOP853 (math/dop853.hpp), events within its steps, and peaks of
// force and overlap.
//
// Events: M. Dowell, P. Jarratt, BIT 11 (1971) 168, doi:10.1007/BF01934364 (the Illinois algorithm).
#pragma once

#include "impact/contact_begin.hpp"
#include "impact/lasting_contact.hpp"
#include "math/dop853.hpp"

namespace rattlebox {

class ClosedContacts : protected ContactBegin {
    Dop853 integrator_;
    LastingContact lasting_;
    std::vector<real> partial_, inside_, scale_, slope_, forward_, backward_;
    real deepest_ = 0;                           // scale of the overlaps
    real step_error_ = 0;                        // energy error that counts as permitted in one step [J]
    static constexpr real peak_precision = 1e-8; // part of a step; the error of a peak is its square

protected:
    // ---- closed contacts

    // Copies the integrated state y; adds the losses in dashpots to the ledger and the log.
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
        record(t, scratch_, ledger, given);
    }

    // Returns the rounding error of a gap.
    real gap_rounding(int c, const real* y) const {
        const Contact& k = contact(c);
        const Damper& damper = problem_.dampers[damper_of(c)];
        const real* at = positions(problem_, y);
        real size = damper.clearance + std::fabs(gap(problem_, k, y).value);
        for (int ball : {k.below, k.above}) size += std::fabs(ball == wall ? cavity(damper, y).q : at[ball]);
        return 8 * epsilon * std::fmax(size, deepest_);
    }

    // Returns x at the largest overlap that follows from the approach speed.
    real expected_x(const Active& a) const {
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return std::sqrt(std::sqrt(law.overlap_scale(a.speed))); });
    }

    // Returns the first step in transformed time: a tenth of the shortest contact.
    real first_step(real remaining) const {
        if (system_.active.empty()) {
            const real rate = std::max(loads_.frequency(), fastest_rate(problem_.modes, problem_.coupling));
            real h = std::min(remaining, rate > 0 ? 0.1 / rate : remaining);
            for (const Released& r : released_) {
                const Gap g = gap(problem_, contact(r.contact), state_.y.data());
                // Distance to where it opens or its force begins again, at least the rounding error.
                const real margin = std::fabs(g.rate < 0 ? g.value + r.state.origin() : g.value);
                if (margin != 0 && g.rate != 0)
                    h = std::min(h, 0.1 * (margin + gap_rounding(r.contact, state_.y.data())) /
                                        std::fabs(g.rate));
            }
            return h;
        }
        real h = infinity;
        for (const Active& a : system_.active) {
            const real depth = expected_x(a);
            // For a contact from rest either one may underflow.
            h = std::min(h, 0.4 * (a.x > 0 && depth > 0 ? std::min(a.x, depth) : a.x + depth) / a.speed);
        }
        return h;
    }

    real contact_speed() const {
        real speed = 0;
        for (const Active& a : system_.active) speed = std::max(speed, a.speed);
        return speed;
    }

    // Returns the error of x that the rounding errors of the velocities cause during the contact.
    real x_rounding(const Active& a, real depth) const {
        if (a.speed == 0 || depth == 0) return 0;
        const Contact& k = contact(a.contact);
        real size = 0;
        for (int side : {k.below, k.above})
            size = std::fmax(size, std::fabs(side == wall
                                                 ? cavity(problem_.dampers[damper_of(a.contact)], y_.data()).p
                                                 : velocities(problem_, y_.data())[side]));
        const real x = expected_x(a);
        return 0.25 * epsilon * size / a.speed * x * cube(x / depth);
    }

    // Sets the scales of errors to the speeds and overlaps of the contacts, at least to rounding errors.
    void set_scales() {
        const real tolerance = problem_.settings.tolerance;
        scale_.assign(system_.size(), infinity);
        real speed = 0, deepest = 0;
        const auto depth = [&](const Active& a) { return std::max(expected_x(a), std::fabs(a.x)); };
        for (const Active& a : system_.active) {
            speed = std::max(speed, a.speed);
            deepest = std::max(deepest, depth(a));
        }
        deepest_ = square(square(deepest));
        largest_overlap_ = std::fmax(largest_overlap_, deepest_);
        step_error_ = 0;
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            const Active& a = system_.active[j];
            // A contact that starts from rest has no scale of its own.
            const real size = std::max(depth(a), 0.1 * deepest);
            scale_[system_.x_index(j)] = std::fmax(tolerance * size, x_rounding(a, depth(a)));
            step_error_ += step_error(a, depth(a));
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

    // Returns the energy error of a step whose speed and overlap are wrong by the tolerance: in m V^2 / 2,
    // and in the stored energy, which grows at most with the power 10 of x.
    real step_error(const Active& a, real depth) const {
        const Contact& k = contact(a.contact);
        const real stored = k.normal.visit([&](const auto& law) {
            const real deepest = std::sqrt(std::sqrt(last_overlap(law, a.state) - a.state.origin()));
            return stored_energy(law, a.state, std::fmin(depth, deepest));
        });
        return resolution() * (k.mass * square(a.speed) + 10 * stored);
    }

    // Returns where, in a step of length h from y_, a function changes from `before` (>= 0) to <= 0: the far
    // end of a bracket of size `part` x h, by default rounding, by regula falsi with the Illinois
    // modification. Each evaluation is a step of the integrator, so that nothing is interpolated.
    template <class F> real locate(real h, real before, real after, F&& f, real part = 4 * epsilon) {
        real low = 0, high = h, f_low = before, f_high = after;
        int side = 0;
        for (int iteration = 0; iteration < 80 && f_high != 0; ++iteration) {
            real next = (low * f_high - high * f_low) / (f_high - f_low);
            const real width = high - low,
                       edge = 1e-3 * width * std::fabs(f_high) / (std::fabs(f_high) + std::fabs(f_low));
            if (iteration % 3 == 2)
                next += edge; // beyond the root, so that the bracket shrinks from both ends
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

    real phase_margin(const real* y, std::size_t j) const {
        const Active& a = system_.active[j];
        const real rate = system_.approach(y, a.contact);
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return phase_end(law, a.state, y[system_.x_index(j)], rate); });
    }

    real overlap_of(const real* y, std::size_t j) const {
        return system_.active[j].state.origin() + square(square(y[system_.x_index(j)]));
    }

    Span smooth_span_at(std::size_t j, real overlap) const {
        const Active& a = system_.active[j];
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return smooth_span(law, a.state, overlap); });
    }

    // Whether the phase of the contact ends at some overlap.
    bool has_end(std::size_t j) const {
        const Active& a = system_.active[j];
        return contact(a.contact).normal.visit([&](const auto& law) {
            return std::decay_t<decltype(law)>::hysteretic && a.state.phase != ContactState::yielding;
        });
    }

    // Positive while the force of a released contact is not certain to be repulsive. Without the margin for
    // rounding, contacts could close and be released again at the same time.
    real release_margin(const real* y, const Released& r) const {
        const Gap g = gap(problem_, contact(r.contact), y);
        const real overlap = -g.value - r.state.origin() - gap_rounding(r.contact, y);
        if (overlap <= 0) return 1;
        const real x = std::sqrt(std::sqrt(overlap));
        return -contact(r.contact).normal.visit(
            [&](const auto& law) { return contact_force(law, r.state, x, -g.rate).total; });
    }

    enum class Event { none, phase_end, touch, rest_touch, opened, reengaged };

    void integrate_closed() {
        open_all_released(-1);
        for (int r = static_cast<int>(released_.size()) - 1; r >= 0; --r) {
            const Released& released = released_[static_cast<std::size_t>(r)];
            if (release_margin(state_.y.data(), released) < 0 &&
                gap(problem_, contact(released.contact), state_.y.data()).rate < 0)
                reengage(r);
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
        // Without soft contacts the error estimate can vanish; this limit ensures that no change of sign of a
        // force is missed.
        const real longest = system_.active.empty() ? 2.5 * h : infinity;
        for (;;) {
            if (stop_ && stop_->load(std::memory_order_relaxed)) fail(Status::interrupted);
            if (result_.counts.contact_steps + result_.counts.rejected_steps >
                200 * problem_.settings.max_events)
                fail(Status::too_many_events);
            if (!running()) return unload_system(y_);
            if (may_last()) {
                // Whether or not long steps were possible, the next attempt waits for some explicit steps.
                const bool advanced = advance_lasting(remaining);
                for (Active& a : system_.active)
                    a.wait = a.steps + (advanced ? 250 : std::max(1000L, a.steps));
                if (advanced) set_scales();
                if (y_[clock] >= remaining) {
                    const real start = state_.t;
                    unload_system(y_);
                    state_.t = start + remaining;
                    return;
                }
                if (advanced) h = first_step(remaining);
                continue;
            }
            integrator_.start(system_, y_.data());
            if (problem_.settings.peaks) record_forces();
            // One step whose error is within the tolerance.
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
            for (Active& a : system_.active) ++a.steps;
            result_.permitted_error += step_error_;
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
            // No step passes a knot of a measured curve: the error estimate does not see a jump of the
            // curvature close to the begin of a step, and the error would add up in a contact that vibrates
            // for long.
            for (std::size_t j = 0; j < system_.active.size(); ++j) {
                const auto overlap = [&](const real* y) { return overlap_of(y, j); };
                // A knot within rounding was reached by the last step; its far side counts.
                const real here = overlap(y_.data()), rounding = 32 * epsilon * here;
                const bool closes = system_.approach(y_.data(), system_.active[j].contact) > 0;
                const Span span = smooth_span_at(j, closes ? here + rounding : here - rounding);
                const auto stop_at = [&](auto&& margin) {
                    const real before = margin(y_.data()), after = margin(trial_.data());
                    if (!(before > 0.5 * rounding && after < 0)) return;
                    end = locate(end, before, after, margin);
                    integrator_.step(system_, y_.data(), end, trial_.data());
                    at_stop = false;
                };
                if (span.low > 0) stop_at([&](const real* y) { return overlap(y) - span.low; });
                if (span.high < infinity) stop_at([&](const real* y) { return span.high - overlap(y); });
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
            // Shortens the step to where a rate changes its sign, if is_over() holds there but not at the
            // end.
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
                const auto margin = [&](const real* y) { return phase_margin(y, j); };
                const auto rate = [&](const real* y) {
                    return system_.approach(y, system_.active[j].contact);
                };
                const real before = rate(y_.data()), after = rate(trial_.data());
                if (before > 0 && after < 0 && has_end(j) && margin(trial_.data()) > 0)
                    turn_back(before, after, rate, [&](const real* y) { return margin(y) < 0; });
                consider(Event::phase_end, static_cast<int>(j), std::fmax(margin(y_.data()), 0.0), margin);
            }
            for (std::size_t r = 0; r < released_.size(); ++r) {
                const Released& released = released_[r];
                const auto at = [&](const real* y) { return gap(problem_, contact(released.contact), y); };
                const Gap before = at(y_.data()), after = at(trial_.data());
                // The contact may open and close again within the step.
                if (after.value < 0 && before.rate > 0 && after.rate < 0)
                    turn_back(
                        before.rate, after.rate, [&](const real* y) { return at(y).rate; },
                        [&](const real* y) { return at(y).value >= 0; });
                consider(Event::opened, static_cast<int>(r), -before.value,
                         [&](const real* y) { return -at(y).value; });
                // Only if the force grows: after a release it may still be positive by rounding.
                const real was = release_margin(y_.data(), released);
                if (release_margin(trial_.data(), released) < was)
                    consider(Event::reengaged, static_cast<int>(r), std::fmax(was, 0.0),
                             [&](const real* y) { return release_margin(y, released); });
            }
            bool retry = false;
            for (int c = 0; c < problem_.contact_count() && !retry; ++c) {
                if (phase(c) != Phase::open && phase(c) != Phase::touching) continue;
                const auto value = [&](const real* y) { return gap(problem_, contact(c), y).value; };
                const Gap before = gap(problem_, contact(c), y_.data()),
                          after = gap(problem_, contact(c), trial_.data());
                const real rounding = gap_rounding(c, y_.data());
                if (phase(c) == Phase::touching ||
                    (std::fabs(before.value) <= rounding && std::fabs(before.rate) <= rounding)) {
                    if (after.value > rounding) phase(c) = Phase::open;
                    if (after.value >= -rounding) continue;
                    const bool faint =
                        after.value >= -4 * rounding ||
                        is_force_negligible(c, trial_.data(), trial_[clock] - y_[clock], contact_speed());
                    if (faint && after.rate >= 0) continue; // it opens again before a contact begins
                    // A dashpot acts immediately, so the contact begins as soon as rounding errors permit.
                    if (faint) {
                        phase(c) = Phase::touching;
                        event = Event::rest_touch;
                    } else {
                        retry = true;
                    }
                } else if (after.value <= 0) {
                    // It opens within the step. Rounding errors may have closed it, but it must not get
                    // deeper.
                    if (after.rate >= 0 && (before.value <= rounding || before.rate >= 0)) {
                        const real deepest = std::fmin(before.value, 0.0) - rounding;
                        if (before.rate < 0)
                            turn_back(
                                -before.rate, -after.rate,
                                [&](const real* y) { return -gap(problem_, contact(c), y).rate; },
                                [&](const real* y) { return value(y) < deepest; });
                        if (value(trial_.data()) >= deepest) continue;
                        if (before.rate >= 0) { // it closes and opens again within the step
                            retry = true;
                            continue;
                        }
                    }
                    // It opens and closes again within the step. Rounding errors may hide that it opens.
                    bool is_hidden = false;
                    const auto rate = [&](const real* y) { return gap(problem_, contact(c), y).rate; };
                    if (before.value <= rounding && before.rate > 0 && after.rate < 0) {
                        const real where = locate(end, std::fmax(before.value, 0.0), after.value, value);
                        integrator_.step(system_, y_.data(), where, partial_.data());
                        is_hidden = !(rate(partial_.data()) < 0);
                    }
                    if (is_hidden) {
                        const real turn = locate(end, before.rate, after.rate, rate);
                        integrator_.step(system_, y_.data(), turn, partial_.data());
                        const real since = partial_[clock];
                        if (value(partial_.data()) > rounding) {
                            consider(Event::touch, c, 1,
                                     [&](const real* y) { return y[clock] <= since ? 1 : value(y); });
                            continue;
                        }
                        phase(c) = Phase::touching;
                        retry = true;
                        continue;
                    }
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
            if (problem_.settings.peaks) record_peaks(end);
            sample_step(end, event == Event::touch || event == Event::phase_end);
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
                return handle_event(event, which);
            }
            h = std::min(h * grow, longest);
        }
    }

    // ---- contacts that stay closed

    // Whether all closed contacts have lasted so long that long steps may pay. The explicit steps before keep
    // ordinary impacts as they are.
    bool may_last() const {
        if (system_.active.empty() || !released_.empty() || !problem_.coupling.empty()) return false;
        for (const Active& a : system_.active)
            if (a.steps < a.wait || a.state.phase == ContactState::yielding) return false;
        for (Phase p : phase_)
            if (p == Phase::touching) return false;
        return true;
    }

    // Returns whether nothing will move before the next knot: the loads are constant, and speeds and
    // accelerations of all bodies are below the tolerance of the overlaps, at the frequency of the contacts
    // or of the mode.
    bool is_at_rest(real frequency) {
        for (std::size_t l = 0; l < loads_.size(); ++l)
            if (loads_.piece(l).amplitude != 0 || loads_.piece(l).slope != 0) return false;
        real overlap = infinity;
        for (std::size_t j = 0; j < system_.active.size(); ++j)
            overlap = std::fmin(overlap, overlap_of(y_.data(), j));
        system_(y_.data(), trial_.data());
        const real clock = trial_[system_.time_index()], small = rest_part() * overlap;
        if (!(clock > 0)) return false;
        const auto rests = [&](real x, real speed, real acceleration, real rate, real shape) {
            const real length = std::fmax(small / shape, 4 * epsilon * std::fabs(x));
            return std::fabs(speed) <= length * rate &&
                   std::fabs(acceleration / clock) <= length * rate * rate;
        };
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real shape = 0;
            for (const Damper& damper : problem_.dampers)
                shape = std::fmax(shape, std::fabs(damper.shape[k]));
            const real rate = std::fmin(std::sqrt(problem_.modes[k].stiffness), frequency);
            if (shape > 0 && !rests(y_[2 * k], y_[2 * k + 1], trial_[2 * k + 1], rate, shape)) return false;
            if (shape == 0 && (y_[2 * k + 1] != 0 || trial_[2 * k + 1] != 0)) return false;
        }
        const real *v = velocities(problem_, y_.data()), *dv = velocities(problem_, trial_.data());
        for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
            if (!rests(0, v[b], dv[b], frequency, 1)) return false;
        return true;
    }

    // Part of an overlap below which its changes count as rounding.
    real rest_part() const { return 4 * resolution(); }

    // Returns the error of the long step over the tolerance, apart from the rounding errors of the forces,
    // which follow from overlaps and of the time.
    real lasting_error(real frequency) const {
        const real time = state_.t + y_[system_.time_index()]; // at which loads are evaluated
        const real rounding = epsilon * (8 + square(frequency * lasting_.h) + loads_.frequency() * time);
        const auto tail = [&](const LastingContact::Row& f, real size) {
            return std::fmax(lasting_.tail(f) - rounding * size, 0.0);
        };
        real error = 0;
        for (const auto& force : lasting_.force) {
            const real largest = *std::max_element(std::begin(force.at), std::end(force.at));
            error = std::fmax(error, tail(force, largest) / (resolution() * largest));
        }
        const std::size_t modes = problem_.modes.size(), balls = problem_.ball_mass.size();
        for (std::size_t b = 0; b < modes + balls; ++b)
            error =
                std::fmax(error, lasting_.h * tail(lasting_.acceleration[b], lasting_.free_acceleration(b)) /
                                     scale_[b < modes ? 2 * b + 1 : modes + balls + b]);
        return error;
    }

    // The smallest and the largest value that a resolved function can have between the nodes.
    static Span range_of(const LastingContact::Row& f) {
        const auto [low, high] = std::minmax_element(std::begin(f.at), std::end(f.at));
        const real margin = 0.05 * (*high - *low);
        return {*low - margin, *high + margin};
    }

    // Returns the largest value of a function within the long step.
    static real largest_within(const LastingContact::Row& f) {
        const auto& node = LastingContact::rule().node;
        const auto top = std::max_element(std::begin(f.at), std::end(f.at)) - std::begin(f.at);
        real low = top == 0 ? 0 : node[top - 1], high = top == LastingContact::n - 1 ? 1 : node[top + 1];
        real most = f[static_cast<int>(top)];
        constexpr real golden = 0.6180339887498949;
        for (int i = 0; i < 40; ++i) {
            const real a = high - golden * (high - low), b = low + golden * (high - low);
            const real left = LastingContact::rule().interpolate(f, a),
                       right = LastingContact::rule().interpolate(f, b);
            most = std::fmax(most, std::fmax(left, right));
            (left < right ? low : high) = left < right ? a : b;
        }
        return most;
    }

    // Whether no contact begins, ends or changes its phase within the long step.
    bool stays_closed() {
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            const Active& a = system_.active[j];
            const Span force = range_of(lasting_.force[j]), overlap = range_of(lasting_.overlap[j]);
            if (!(force.low > 0) || !(overlap.low > a.state.origin())) return false;
            const Span smooth = smooth_span_at(j, lasting_.overlap[j][0]);
            if (overlap.low < smooth.low || overlap.high > smooth.high) return false;
            // A vibration returns to its deepest overlap without yielding again.
            const real end =
                contact(a.contact).normal.visit([&](const auto& law) { return last_overlap(law, a.state); });
            if (overlap.high > end && largest_within(lasting_.overlap[j]) > end * (1 + resolution()))
                return false;
        }
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (phase(c) != Phase::open) continue;
            if (!(range_of(lasting_.gap_of(contact(c), scratch_)).low > gap_rounding(c, y_.data())))
                return false;
        }
        return true;
    }

    // Makes long steps until a contact begins, ends or changes its phase, or until the time `remaining`.
    // Returns whether there was a step.
    bool advance_lasting(real remaining) {
        const std::size_t clock = system_.time_index();
        const real frequency = std::sqrt(lasting_.square_of_frequency(system_, y_.data()));
        if (!(frequency > 0 && frequency < infinity)) return false;
        // Beyond the longest step rounding errors of the forces matter; below the shortest one the equations
        // of all nodes and contacts cost more than explicit steps.
        const real longest = 40 / frequency;
        const real shortest = 4 * cube(static_cast<real>(system_.active.size())) / frequency;
        bool advanced = false;
        for (real h = 1.5 * shortest;;) {
            if (stop_ && stop_->load(std::memory_order_relaxed)) return advanced;
            if (is_at_rest(frequency)) {
                while (sample_due(state_.t + remaining))
                    sample_closed(y_, problem_.sample_times[next_sample_++], true);
                y_[clock] = remaining;
                return true;
            }
            const real now = state_.t + y_[clock], left = remaining - y_[clock];
            if (h < shortest || shortest > longest || (!advanced && left < shortest)) return advanced;
            const bool last = h >= left;
            // Rounded to a representable time, or the time would drift from the motion with each step.
            const real step = last ? left : now + h - now;
            const bool solved = lasting_.solve_step(system_, loads_, y_.data(), now, step);
            const real error = solved ? lasting_error(frequency) : infinity;
            if (!(error <= 1)) {
                ++result_.counts.rejected_steps;
                h = step * (error < infinity ? std::fmax(0.3, 0.9 * std::pow(error, -1.0 / 15)) : 0.5);
                continue;
            }
            if (!stays_closed()) return advanced;
            ++result_.counts.contact_steps;
            result_.permitted_error += step_error_;
            lasting_.state_at(system_, y_.data(), 1, trial_);
            sample_lasting(now, last ? state_.t + remaining : now + step);
            if (problem_.settings.peaks) record_lasting_peaks();
            std::swap(y_, trial_);
            bool faster = false;
            for (std::size_t j = 0; j < system_.active.size(); ++j) {
                Active& a = system_.active[j];
                a.x = y_[system_.x_index(j)];
                for (real rate : lasting_.rate[j].at)
                    if (std::fabs(rate) > 2 * a.speed) a.speed = std::fabs(rate), faster = true;
            }
            if (faster) set_scales();
            advanced = true;
            if (last) {
                y_[clock] = remaining;
                return true;
            }
            h = std::fmin(longest, step * std::fmin(1.5, 0.9 * std::pow(std::fmax(error, 1e-12), -1.0 / 15)));
        }
    }

    // Takes the samples within a long step: requested times and deepest overlaps.
    void sample_lasting(real from, real to) {
        std::vector<std::pair<real, bool>> times; // and whether the time was requested
        while (sample_due(to)) times.emplace_back(problem_.sample_times[next_sample_++], true);
        if (samples_contacts())
            for (std::size_t j = 0; j < system_.active.size(); ++j)
                for (int i = 0; i + 1 < LastingContact::n; ++i) {
                    const LastingContact::Row& rate = lasting_.rate[j];
                    const real moves = resolution() * system_.active[j].speed;
                    if (!(rate[i] > moves && rate[i + 1] < 0) && !(rate[i] > 0 && rate[i + 1] < -moves))
                        continue;
                    real low = LastingContact::rule().node[i], high = LastingContact::rule().node[i + 1];
                    for (int half = 0; half < 30; ++half) {
                        const real middle = 0.5 * (low + high);
                        (LastingContact::rule().interpolate(rate, middle) > 0 ? low : high) = middle;
                    }
                    times.emplace_back(from + low * lasting_.h, false);
                }
        std::sort(times.begin(), times.end());
        for (const auto& [t, given] : times) {
            inside_.resize(system_.size());
            const real part = (t - from) / lasting_.h;
            if (part >= 1) {
                sample_closed(trial_, t, given);
            } else {
                lasting_.state_at(system_, y_.data(), part, inside_);
                sample_closed(inside_, t, given);
            }
        }
    }

    void record_lasting_peaks() {
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            Impact& impact = result_.impacts[static_cast<std::size_t>(system_.active[j].impact)];
            if (range_of(lasting_.force[j]).high > impact.peak_force)
                impact.peak_force = std::fmax(impact.peak_force, largest_within(lasting_.force[j]));
            if (range_of(lasting_.overlap[j]).high > impact.peak_overlap)
                impact.peak_overlap = std::fmax(impact.peak_overlap, largest_within(lasting_.overlap[j]));
        }
    }

    // Takes the samples in the step of length h from y_ to trial_: requested times, deepest overlaps, and the
    // end of the step if a contact begins or ends there.
    void sample_step(real h, bool at_event) {
        const std::size_t clock = system_.time_index();
        std::vector<std::pair<real, real>> turns; // time, and length of the step to it
        if (samples_contacts())
            for (const Active& a : system_.active) {
                const auto rate = [&](const real* y) { return system_.approach(y, a.contact); };
                const real before = rate(y_.data()), after = rate(trial_.data());
                if (!(before > 0 && after < 0)) continue;
                const real where = locate(h, before, after, rate, peak_precision);
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

    void handle_event(Event event, int which) {
        if (event != Event::rest_touch) last_jump_ = state_.t;
        switch (event) {
        case Event::none:
            return;
        case Event::phase_end:
            return end_phase(static_cast<std::size_t>(which));
        case Event::touch:
            return begin_contact_at(which);
        case Event::rest_touch:
            return begin_contacts_from_rest(last_jump_);
        case Event::opened:
            return open_released(which);
        case Event::reengaged:
            return reengage(which);
        }
    }

    void end_phase(std::size_t j) {
        Active& a = system_.active[j];
        const Contact& k = contact(a.contact);
        const real rate = system_.approach(state_.y.data(), a.contact);
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
        contact_ended_ = true;
        Impact& impact = result_.impacts[static_cast<std::size_t>(a.impact)];
        const std::size_t d = damper_of(a.contact);
        ledger_.plastic[d] += plastic;
        impact.energy_lost += plastic;
        impact.duration = state_.t - impact.time;
        impact.separation_speed = -rate;
        impact.complete = true;
        if (next == PhaseEnd::release && overlap > 0) {
            impact.energy_lost += stored;
            released_.push_back({a.contact, a.state, a.impact, stored});
            phase(a.contact) = Phase::released;
        } else {
            phase(a.contact) = Phase::open;
        }
        system_.active.erase(system_.active.begin() + static_cast<std::ptrdiff_t>(j));
    }

    void open_released(int r) {
        const Released& released = released_[static_cast<std::size_t>(r)];
        ledger_.normal[damper_of(released.contact)] += released.energy;
        phase(released.contact) = Phase::open;
        released_.erase(released_.begin() + r);
    }

    // A released contact touches again: the same impact continues, without the energy lost during recovery.
    void reengage(int r) {
        const Released released = released_[static_cast<std::size_t>(r)];
        released_.erase(released_.begin() + r);
        const real left = recoverable_energy(released, state_.y.data());
        ledger_.normal[damper_of(released.contact)] += released.energy - left;
        const real plastic = contact(released.contact).normal.visit([&](const auto& law) {
            return plastic_loss(law, released.state, 0);
        });
        ledger_.plastic[damper_of(released.contact)] -= plastic;
        Impact& impact = result_.impacts[static_cast<std::size_t>(released.impact)];
        impact.energy_lost -= left + plastic;
        impact.complete = false;
        Active a;
        a.contact = released.contact;
        a.state = released.state;
        a.impact = released.impact;
        const Gap g = gap(problem_, contact(a.contact), state_.y.data());
        a.x = std::sqrt(std::sqrt(std::fmax(-g.value - a.state.origin(), 0.0)));
        a.speed = std::fmax(impact.approach_speed, std::fabs(g.rate));
        system_.active.push_back(a);
        phase(a.contact) = Phase::closed;
    }

    // ---- peaks of force and overlap

    void record_peak(std::size_t j, const real* y) {
        const Active& a = system_.active[j];
        Impact& impact = result_.impacts[static_cast<std::size_t>(a.impact)];
        impact.peak_force = std::fmax(impact.peak_force, system_.force(y, j));
        impact.peak_overlap =
            std::fmax(impact.peak_overlap, a.state.origin() + square(square(y[system_.x_index(j)])));
    }

    void record_forces() {
        for (std::size_t j = 0; j < system_.active.size(); ++j) record_peak(j, y_.data());
    }

    // Records the peaks within the step from y_ to trial_.
    void record_peaks(real h) {
        for (std::size_t j = 0; j < system_.active.size(); ++j) {
            record_peak(j, trial_.data());
            const int c = system_.active[j].contact;
            const real before = system_.approach(y_.data(), c), after = system_.approach(trial_.data(), c);
            if (before > 0 && after < 0) {
                const real turn = locate(
                    h, before, after, [&](const real* y) { return system_.approach(y, c); }, peak_precision);
                integrator_.step(system_, y_.data(), turn, partial_.data());
                record_peak(j, partial_.data());
            }
            const real rises = force_slope(y_.data(), h, j), falls = force_slope(trial_.data(), h, j);
            if (!(rises > 0 && falls < 0)) continue;
            const real top =
                locate(h, rises, falls, [&](const real* y) { return force_slope(y, h, j); }, peak_precision);
            integrator_.step(system_, y_.data(), top, partial_.data());
            record_peak(j, partial_.data());
        }
    }

    // Returns the slope of the force of contact j along the motion through y, up to a positive factor.
    real force_slope(const real* y, real h, std::size_t j) {
        const std::size_t n = system_.size();
        slope_.resize(n);
        forward_.resize(n);
        backward_.resize(n);
        system_(y, slope_.data());
        for (std::size_t i = 0; i < n; ++i) {
            forward_[i] = y[i] + 1e-4 * h * slope_[i];
            backward_[i] = y[i] - 1e-4 * h * slope_[i];
        }
        return system_.force(forward_.data(), j) - system_.force(backward_.data(), j);
    }

public:
    ClosedContacts(const Problem& problem, const std::atomic<bool>* stop)
        : ContactBegin(problem, stop), lasting_(problem) {}
};

} // namespace rattlebox
