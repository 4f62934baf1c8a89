// First touch: an isolated contact solved as a whole, the begin of a soft contact, or a hard impact.
//
// A hard impact changes the approach rate v to -e v. Impacts at the same time, to rounding, are resolved
// together, and contacts that have come to rest are constraints: the impulses of all are the solution of one
// linear complementarity problem.
//
// J. J. Moreau, in Nonsmooth Mechanics and Applications, Springer 1988, p. 1,
// doi:10.1007/978-3-7091-2624-0_1; C. Glocker, F. Pfeiffer, Nonlinear Dynamics 7 (1995) 471,
// doi:10.1007/BF00121109; B. Brogliato, Nonsmooth Mechanics, 3rd ed., Springer 2016,
// doi:10.1007/978-3-319-28664-8.
#pragma once

#include <iterator>

#include "impact/isolated_contact.hpp"
#include "impact/run_state.hpp"
#include "math/complementarity.hpp"

namespace rattlebox {

class ContactBegin : protected RunState {
    IsolatedContact isolated_contact_, partial_contact_;
    State partial_state_;          // at a sample within an isolated contact
    Ledger contact_ledger_;        // of one contact
    std::vector<int> uncertain_;   // contacts that may begin during an isolated one
    TaylorMotion start_of_motion_; // accelerations after a hard impact
    real rest_speed_ =
        0; // of contacts that close from rest: speed at which contact force and inertia balance
    real largest_impact_speed_ =
        0; // largest speed of a ball relative to its cavity at any hard impact so far

protected:
    real last_jump_ =
        0; // time of the last jump of a force or its rate, except by contacts that began at rest

    real largest_overlap_ = 0; // so far, expected from the approach speeds

    template <class Archive> void serialize(Archive& a) {
        RunState::serialize(a);
        a(rest_speed_, largest_impact_speed_, last_jump_, largest_overlap_);
    }

    // ---- first touch

    // Returns the sum of the magnitudes of the terms of a gap.
    real gap_terms(int c) const {
        const Damper& damper = problem_.dampers[damper_of(c)];
        const real* y = state_.y.data();
        real sum = damper.clearance;
        for (const int side : {contact(c).below, contact(c).above}) {
            if (side != wall) {
                sum += std::fabs(positions(problem_, y)[side]);
                continue;
            }
            for (std::size_t m = 0; m < damper.shape.size(); ++m)
                sum += std::fabs(damper.shape[m] * y[2 * m]);
        }
        return sum;
    }

    // Whether the gap of contact c is zero, to the rounding errors of its terms and those that they
    // accumulate in time. This must hold wherever a contact begins: the energy balance holds for a contact at
    // any gap. Balls that rest on each other may drift as fast as velocities can be told from zero.
    bool is_touching(int c) const {
        const real value = gap(problem_, contact(c), state_.y.data()).value;
        const real length = gap_terms(c) + largest_overlap_; // without clearance there are no other lengths
        // The overlap of a soft contact is integrated apart from the positions, and ends with its errors.
        const real apart = hard() ? 0 : resolution() * largest_overlap_;
        return std::fabs(value) <= 64 * (epsilon * length + velocity_rounding() * state_.t + apart);
    }

    void begin_contact_at(int c) {
        if (!is_touching(c))
            return fail(Status::false_contact, c, gap(problem_, contact(c), state_.y.data()).value);
        const real speed = std::max(system_.approach(state_.y.data(), c), 0.0);
        const Rebound r = rebound(contact(c).restitution, speed);
        if (r.outside) return fail(Status::law_domain, c, speed);
        result_.counts.extrapolated += r.extrapolated;
        if (!hard() && !possible(contact(c).normal, r)) return fail(Status::no_rebound, c, speed);
        if (speed == 0) { // by rounding; the forces decide whether it closes
            phase(c) = Phase::touching;
            return;
        }
        if (hard()) return hard_impacts(c);
        if (problem_.settings.collocation && solve_isolated(c, speed, r.e)) return;
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

    // Returns a bound of the second derivative of a gap over a time without contacts.
    real acceleration_bound(int c, real length) const {
        const Contact& k = contact(c);
        if (k.below != wall && k.above != wall) return 0; // both balls have the same acceleration
        const Damper& damper = problem_.dampers[damper_of(c)];
        real bound = std::fabs(damper.gravity);
        std::vector<real> largest(loads_.active() ? loads_.size() : 0);
        for (std::size_t l = 0; l < largest.size(); ++l) {
            real taylor[Series::order + 1] = {}, power = 1;
            loads_.piece(l).add_taylor(state_.t, 1, Series::order, taylor);
            for (const real term : taylor) largest[l] += std::fabs(term) * power, power *= length;
            if (loads_.load(l).base) bound += largest[l];
        }
        for (std::size_t m = 0; m < damper.shape.size(); ++m) {
            const Mode& mode = problem_.modes[m];
            real force = 0;
            for (std::size_t l = 0; l < largest.size(); ++l)
                force += std::fabs(loads_.load(l).shape[m]) * largest[l];
            const real speed =
                std::sqrt(2 * ModeState{state_.y[2 * m], state_.y[2 * m + 1]}.energy(mode)) + force * length;
            bound +=
                std::fabs(damper.shape[m]) * ((std::sqrt(mode.stiffness) + 2 * mode.decay) * speed + force);
        }
        return bound;
    }

    // Whether no other contact can begin during this one, or can be excluded when it is solved: these are
    // stored in uncertain_.
    bool is_isolated(int c, real speed, real longest) {
        uncertain_.clear();
        if (!system_.active.empty() || !stuck_.empty() || !released_.empty()) return false;
        for (int other = 0; other < problem_.contact_count(); ++other) {
            if (other == c) continue;
            const Damper& damper = problem_.dampers[damper_of(other)];
            if (damper.balls == 1 && contact(other).damper == contact(c).damper) continue;
            const Gap g = gap(problem_, contact(other), state_.y.data());
            if (!(g.value > longest * (std::fabs(g.rate) + 4 * speed))) return false;
            // The impulse of the contact is at most about twice that of an elastic one.
            const real share =
                std::fabs(contact_coupling(problem_, contact(other), contact(c))) * contact(c).mass;
            const real change = 4 * share * speed + acceleration_bound(other, longest) * longest;
            if (!(g.value > longest * (std::fabs(g.rate) + change))) uncertain_.push_back(other);
        }
        return true;
    }

    // Takes a sample within an isolated contact. The contact is solved again up to the phase at that time,
    // because interpolation would be less accurate.
    void sample_isolated(int c, const HertzTsuji& law, real speed, real zeta) {
        const real t = problem_.sample_times[next_sample_++];
        sampled_ = ledger_;
        IsolatedContact::Instant now;
        real psi = isolated_contact_.psi_at(t - state_.t);
        for (int pass = 0; pass < 8; ++pass) {
            partial_contact_.prepare(contact(c), law, loads_, state_, speed, zeta, infinity, psi);
            partial_contact_.solve();
            now = partial_contact_.end();
            const real late = t - state_.t - now.time;
            if (std::fabs(late) <= 2 * epsilon * t) break;
            psi = std::clamp(psi + late * partial_contact_.phase_rate(now), 0.5 * psi,
                             isolated_contact_.last_psi());
        }
        partial_contact_.store_end(now, partial_state_, sampled_);
        clear_contact_samples();
        stored_[damper_of(c)] = law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        add_wall_force(c, now.force);
        record(t, partial_state_, sampled_);
    }

    // Takes a sample at the deepest overlap of an isolated contact.
    void sample_deepest(int c, const HertzTsuji& law, real speed, real zeta) {
        sampled_ = ledger_;
        partial_contact_.prepare(contact(c), law, loads_, state_, speed, zeta, infinity, std::acos(zeta));
        partial_contact_.solve();
        const IsolatedContact::Instant now = partial_contact_.end();
        partial_contact_.store_end(now, partial_state_, sampled_);
        clear_contact_samples();
        stored_[damper_of(c)] = law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        add_wall_force(c, now.force);
        record(state_.t + now.time, partial_state_, sampled_, false);
    }

    // Solves a contact as a whole if it is isolated and the energy balance of the solution holds.
    bool solve_isolated(int c, real speed, real e) {
        const HertzTsuji* law = contact(c).normal.get_if<HertzTsuji>();
        if (!law) return false;
        const real zeta = law->damping(e);
        if (!isolated_contact_.prepare(contact(c), *law, loads_, state_, speed, zeta, next_stop() - state_.t))
            return false;
        if (!is_isolated(c, speed, isolated_contact_.longest_time()) || !isolated_contact_.solve())
            return false;
        for (const int other : uncertain_)
            if (!(isolated_contact_.smallest_gap(contact(other)) > 0)) return false;
        contact_ledger_
            .clear(); // a separate ledger, because the sums of a long run have larger rounding errors
        const IsolatedContact::Instant end = isolated_contact_.end();
        isolated_contact_.store_end(end, scratch_, contact_ledger_);
        const ContactState contact_state = initial_state(*law, e, speed);
        const real stored = stored_energy(*law, contact_state, end.x);
        const std::size_t d = damper_of(c);
        const real residual = energy(scratch_) + stored - energy(state_) + contact_ledger_.normal[d] +
                              contact_ledger_.viscous - contact_ledger_.load_work - contact_ledger_.base_work;
        const real size = contact(c).mass * speed * speed + energy(state_) * 1e-2;
        if (!(std::fabs(residual) < resolution() * size)) return false;
        result_.permitted_error += resolution() * size;

        Impact impact;
        impact.contact = c;
        impact.time = state_.t;
        impact.approach_speed = speed;
        if (law->needs_restitution()) impact.restitution = e;
        impact.separation_speed = -end.rate;
        impact.duration = end.time;
        if (problem_.settings.peaks) {
            const IsolatedContact::Instant deepest =
                isolated_contact_.instant_at(isolated_contact_.deepest_position());
            impact.peak_overlap = square(square(deepest.x));
            impact.peak_force = zeta == 0 ? deepest.force : isolated_contact_.peak_force();
        }
        impact.energy_lost = end.lost + stored;
        impact.complete = true;
        const int number = result_.add_impact(impact);
        ++result_.counts.collocated;
        if (samples_contacts()) {
            const real deepest = state_.t + isolated_contact_.time_at(isolated_contact_.deepest_position());
            while (sample_due(deepest)) sample_isolated(c, *law, speed, zeta);
            sample_deepest(c, *law, speed, zeta);
        }
        while (sample_due(state_.t + end.time)) sample_isolated(c, *law, speed, zeta);
        contact_ended_ = true;
        std::swap(state_.y, scratch_.y);
        state_.t += end.time;
        ledger_.add(contact_ledger_);
        if (stored > 0) {
            released_.push_back({c, contact_state, number, stored});
            phase(c) = Phase::released;
        }
        return true;
    }

    // `since` is the time at which the force began, by default the current time.
    void begin_contact(int c, real speed, real e, real x, real since = not_a_number) {
        Active a;
        a.contact = c;
        bool has_restitution = false;
        contact(c).normal.visit([&](const auto& law) {
            a.state = initial_state(law, e, speed);
            has_restitution = law.needs_restitution();
        });
        Impact impact;
        impact.contact = c;
        impact.time = std::isnan(since) ? state_.t : since;
        impact.approach_speed = speed;
        if (has_restitution) impact.restitution = e;
        a.impact = result_.add_impact(impact);
        a.x = x;
        a.speed = speed;
        system_.active.push_back(a);
        phase(c) = Phase::closed;
    }

    // Returns the length of a flight in which the forces of contacts that close from rest are negligible. At
    // first their speed is below the rounding error of the other motion, so their errors are scaled with the
    // speed at which their force balances the closing force.
    real rest_flight_length(real length) {
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
                balanced = balanced && speed_loss(c, y, length) <= std::fabs(rate);
                negligible = negligible &&
                             rate * length <= 8 * epsilon * problem_.dampers[damper_of(c)].clearance &&
                             is_force_negligible(c, y, length, 0);
            }
            if (balanced) rest_speed_ = std::fmax(rest_speed_, speed);
            if (negligible) break;
        }
        return length;
    }

    // Returns the change of the approach rate by the force of a contact that closes from rest.
    real speed_loss(int c, const real* y, real length) const {
        const Gap g = gap(problem_, contact(c), y);
        if (g.value >= 0) return 0;
        const real e = rebound(contact(c).restitution, 0).e, x = std::sqrt(std::sqrt(-g.value));
        const real f = contact(c).normal.visit([&](const auto& law) {
            return contact_force(law, initial_state(law, e, -g.rate), x, -g.rate).total;
        });
        return std::fabs(f) * length / contact(c).mass;
    }

    // Whether the change is below 1e-8 of the approach rate, or within the tolerance of the speed of other
    // contacts.
    bool is_force_negligible(int c, const real* y, real length, real speed) const {
        const real rate = gap(problem_, contact(c), y).rate;
        return speed_loss(c, y, length) <=
               std::fmax(1e-8 * std::fabs(rate), problem_.settings.tolerance * speed);
    }

    // Begins the contacts that close from rest, at their current overlap. Their force began at `since`,
    // unless the overlap has grown faster than a power of the time since then. Contacts that are pressed
    // together also begin if the overlap is lost in the rounding error of the positions.
    void begin_contacts_from_rest(real since, const std::vector<char>& presses = {}) {
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

    // A contact that closes, or that is to stick.
    struct Closing {
        int contact = 0;
        real speed = 0, restitution = 0;
        real change = 0; // of the approach rate
        real impulse = 0;
        std::size_t number = 0; // in the log
    };
    std::vector<Closing> closing_;
    // Of the complementarity problem: contacts, whether impulses of both signs are allowed, and the arrays.
    std::vector<int> taking_part_;
    std::vector<char> both_signs_;
    std::vector<real> matrix_, need_, impulses_;

    // Applies the impulse j to both sides of contact c.
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

    // Returns the acceleration of the gap with the current stuck contacts.
    real gap_acceleration(int c) {
        start_of_motion_.expand(state_, loads_, stuck_, 0);
        return start_of_motion_.gap_acceleration(contact(c));
    }

    // Returns the shortest period of modes and loads, or 0 if there is none: bounces then become touching
    // contacts by their speed alone, and the result does not depend on the duration of the run.
    real shortest_period() const {
        real rate = loads_.frequency();
        for (const Mode& mode : problem_.modes) rate = std::max(rate, std::sqrt(mode.stiffness));
        return rate > 0 ? 2 * pi / rate : 0;
    }

    // Returns the largest speed of a ball relative to its cavity.
    real largest_speed() const {
        const real* v = velocities(problem_, state_.y.data());
        real largest = 0;
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            const Damper& damper = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])];
            largest = std::max(largest, std::fabs(v[i] - cavity(damper, state_.y.data()).p));
        }
        return largest;
    }

    // Returns the rounding error of the difference of two equal velocities.
    real velocity_rounding() const {
        const real* v = velocities(problem_, state_.y.data());
        real largest = largest_impact_speed_;
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
            largest = std::fmax(largest, std::fabs(v[i]));
        for (const Damper& damper : problem_.dampers)
            largest = std::fmax(largest, std::fabs(cavity(damper, state_.y.data()).p));
        return 16 * epsilon * largest;
    }

    // Opens contacts at rest whose sides move relative to each other after an impact elsewhere.
    void release_moving() {
        const real rounding = this->velocity_rounding();
        std::erase_if(stuck_, [&](int c) {
            if (std::fabs(system_.approach(state_.y.data(), c)) <= rounding) return false;
            phase(c) = Phase::open;
            return true;
        });
        for (int c = 0; c < problem_.contact_count(); ++c)
            if (phase(c) == Phase::touching && std::fabs(system_.approach(state_.y.data(), c)) > rounding)
                phase(c) = Phase::open;
    }

    // Reduces the approach rates of contacts by their `change`, and computes their impulses. Resting contacts
    // take part: stuck ones stay closed without rebound unless their impulse would be attractive, and
    // touching ones, too, if none of the contacts rebounds. The impulses of all follow from one
    // complementarity problem. In slow impacts those of stuck contacts may be attractive, because otherwise
    // balls in two cavities could detach each other without end; with `sticks` those of the contacts may be,
    // too.
    void reduce_approaches(std::vector<Closing>& contacts, bool rebounds, bool slow, bool sticks = false) {
        const auto is_resting = [&](int other) {
            return std::none_of(contacts.begin(), contacts.end(),
                                [&](const Closing& each) { return each.contact == other; });
        };
        taking_part_.clear();
        std::copy_if(stuck_.begin(), stuck_.end(), std::back_inserter(taking_part_), is_resting);
        both_signs_.assign(taking_part_.size(), slow);
        for (int other = 0; other < problem_.contact_count() && !rebounds; ++other)
            if (phase(other) == Phase::touching && is_resting(other)) taking_part_.push_back(other);
        const std::size_t resting = taking_part_.size();
        both_signs_.resize(resting, false);
        both_signs_.resize(resting + contacts.size(), sticks);
        need_.assign(resting, 0.0);
        for (const Closing& each : contacts) {
            taking_part_.push_back(each.contact);
            need_.push_back(each.change);
        }
        matrix_.clear();
        for (const int i : taking_part_)
            for (const int j : taking_part_)
                matrix_.push_back(-contact_coupling(problem_, contact(i), contact(j)));
        solve_complementary(matrix_, need_, both_signs_, impulses_);
        for (std::size_t i = 0; i < taking_part_.size(); ++i) impulse(taking_part_[i], impulses_[i]);
        for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].impulse = impulses_[resting + i];
    }

    // Whether an open contact closes now, to the rounding errors of its gap and of the time.
    bool closes_now(int c) const {
        const Gap g = gap(problem_, contact(c), state_.y.data());
        return phase_[static_cast<std::size_t>(c)] == Phase::open && g.rate < 0 &&
               g.value <= 16 * epsilon * (gap_terms(c) + state_.t * -g.rate);
    }

    // Resolves the impact of contact c together with those of all contacts that close at the same time.
    // Newton's law holds for each: with the approach rates v before and v' after the impact and the impulses
    // p, p >= 0, -v' >= e v, and one of both is an equality. Each contact loses p (1 - e) v / 2.
    void hard_impacts(int first) {
        // Impacts that become slow without a closing force (inelastic collapse) end in the same way.
        largest_impact_speed_ = std::fmax(largest_impact_speed_, largest_speed());
        const real slowest = std::fmax(problem_.settings.stick * largest_impact_speed_, velocity_rounding());
        bool rebounds = false, slow = true;
        closing_.clear();
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (c != first && !closes_now(c)) continue;
            Closing& each = closing_.emplace_back();
            each.contact = c;
            each.speed = system_.approach(state_.y.data(), c);
            const Rebound r = rebound(contact(c).restitution, each.speed);
            if (r.outside) return fail(Status::law_domain, c, each.speed);
            result_.counts.extrapolated += c != first && r.extrapolated;
            each.restitution = each.speed < slowest ? 0 : r.e;
            each.change = (1 + each.restitution) * each.speed;
            rebounds = rebounds || each.restitution > 0;
            slow = slow && each.speed < slowest;
        }
        reduce_approaches(closing_, rebounds, slow);
        contact_ended_ = true;
        std::erase_if(closing_, [](const Closing& each) { return !(each.impulse > 0); }); // opened by others
        for (Closing& each : closing_) {
            Impact impact;
            impact.contact = each.contact;
            impact.time = state_.t;
            impact.approach_speed = each.speed;
            impact.restitution = each.restitution;
            impact.separation_speed = each.restitution * each.speed;
            impact.duration = 0;
            impact.peak_force = infinity;
            impact.energy_lost = 0.5 * each.impulse * (1 - each.restitution) * each.speed;
            impact.complete = true;
            ledger_.normal[damper_of(each.contact)] += impact.energy_lost;
            each.number = static_cast<std::size_t>(result_.add_impact(impact));
        }
        result_.counts.simultaneous += closing_.size() > 1;
        release_moving();
        // All decisions before any contact sticks, so that their order does not matter.
        std::vector<Closing> sticking;
        for (const Closing& each : closing_) {
            const int c = each.contact;
            const real rebound_speed = std::fmax(-system_.approach(state_.y.data(), c), 0.0);
            const real acceleration = gap_acceleration(c);
            if (acceleration < 0 &&
                2 * rebound_speed < -acceleration * problem_.settings.stick * shortest_period())
                sticking.push_back(each);
            else if (each.restitution == 0)
                phase(c) = Phase::touching;
        }
        if (sticking.empty()) return;
        stick(sticking);
        for (const Closing& each : sticking)
            result_.impacts[each.number].energy_lost += 0.5 * each.impulse * each.change;
    }

    // Makes contacts stuck. Their remaining approach rates are lost, with the energy impulse x change / 2.
    void stick(std::vector<Closing>& contacts) {
        for (Closing& each : contacts) each.change = system_.approach(state_.y.data(), each.contact);
        reduce_approaches(contacts, false, true, true);
        for (const Closing& each : contacts) {
            ledger_.normal[damper_of(each.contact)] += 0.5 * each.impulse * each.change;
            ++result_.counts.sticks;
            stuck_.push_back(each.contact);
            phase(each.contact) = Phase::closed;
        }
        release_moving();
    }

public:
    ContactBegin(const Problem& problem, const std::atomic<bool>* stop)
        : RunState(problem, stop), isolated_contact_(problem), partial_contact_(problem),
          partial_state_(problem), contact_ledger_(problem), start_of_motion_(problem) {}
};

} // namespace rattlebox
