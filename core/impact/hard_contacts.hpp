// Hard impacts, and contacts that have come to rest on each other.
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

#include "impact/run_state.hpp"
#include "impact/taylor_motion.hpp"
#include "math/complementarity.hpp"

namespace rattlebox {

// A contact that closes, or that is to stick.
struct Closing {
    int contact = 0;
    real speed = 0, restitution = 0;
    real change = 0; // of the approach rate
    real impulse = 0;
    std::size_t number = 0; // in the log
};

class HardContacts {
    using Phase = RunState::Phase;

    RunState& run_;
    const Problem& problem_;
    TaylorMotion motion_;           // accelerations after an impact
    real largest_impact_speed_ = 0; // largest of largest_speed() at any impact so far
    // Speed of a stop by the largest loads, and whether these are inputs that vary from step to step.
    real held_speed_;
    bool varies_;
    std::vector<Closing> closing_;
    // Of the complementarity problem: contacts, whether impulses of both signs are allowed, and the arrays.
    std::vector<int> taking_part_;
    std::vector<char> both_signs_;
    std::vector<real> matrix_, need_, impulses_;

    // Applies the impulse j to both sides of contact c.
    void impulse(int c, real j) {
        const Contact& k = run_.contact(c);
        real* v = velocities(problem_, run_.state.y.data());
        real on_cavity = 0;
        if (k.below == wall)
            on_cavity -= j;
        else
            v[k.below] -= j / problem_.ball_mass[static_cast<std::size_t>(k.below)];
        if (k.above == wall)
            on_cavity += j;
        else if (k.above == ground)
            run_.state.y[impulse_index(problem_, k)] += j;
        else
            v[k.above] += j / problem_.ball_mass[static_cast<std::size_t>(k.above)];
        const Damper& damper = problem_.dampers[run_.damper_of(c)];
        for (std::size_t m = 0; m < damper.shape.size(); ++m)
            run_.state.y[2 * m + 1] += damper.shape[m] * on_cavity;
    }

    // Returns the acceleration of the gap with the current stuck contacts.
    real gap_acceleration(int c) {
        motion_.expand(run_.state, run_.loads, run_.stuck, 0);
        return motion_.gap_acceleration(run_.contact(c));
    }

    // Returns the shortest period of modes and loads, or 0 if there is none: bounces then become touching
    // contacts by their speed alone, and the result does not depend on the duration of the run.
    real shortest_period() const {
        real rate = run_.loads.frequency();
        for (const Mode& mode : problem_.modes) rate = std::max(rate, std::sqrt(mode.stiffness));
        return rate > 0 ? 2 * pi / rate : 0;
    }

    // Returns the largest speed of a ball relative to its cavity, and of a point relative to its stop.
    real largest_speed() const {
        const real* v = velocities(problem_, run_.state.y.data());
        real largest = 0;
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            const Damper& damper = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])];
            largest = std::max(largest, std::fabs(v[i] - cavity(damper, run_.state.y.data()).p));
        }
        for (std::size_t d = problem_.first_stop(); d < problem_.dampers.size(); ++d)
            largest = std::max(largest, std::fabs(cavity(problem_.dampers[d], run_.state.y.data()).p));
        return largest;
    }

    // Returns the largest speed of a stop that the largest values of the loads would cause without it. While
    // they press its point against it, speeds are rounding errors of forces, and no other speed may exist.
    static real speed_by_loads(const Problem& problem) {
        real largest = 0;
        for (std::size_t d = problem.first_stop(); d < problem.dampers.size(); ++d) {
            real speed = 0;
            for (const Load& load : problem.loads)
                for (std::size_t k = 0; k < problem.modes.size(); ++k) {
                    const real rate = std::fmax(load.signal.frequency, std::sqrt(problem.modes[k].stiffness));
                    if (rate > 0)
                        speed += std::fabs(problem.dampers[d].shape[k] * load.shape[k]) *
                                 load.signal.largest() / rate;
                }
            largest = std::fmax(largest, speed);
        }
        return largest;
    }

    // Opens contacts at rest whose sides move relative to each other after an impact elsewhere.
    void release_moving() {
        const real rounding = velocity_rounding();
        std::erase_if(run_.stuck, [&](int c) {
            if (std::fabs(run_.system.approach(run_.state.y.data(), c)) <= rounding) return false;
            run_.phase(c) = Phase::open;
            return true;
        });
        for (int c = 0; c < problem_.contact_count(); ++c)
            if (run_.phase(c) == Phase::touching &&
                std::fabs(run_.system.approach(run_.state.y.data(), c)) > rounding)
                run_.phase(c) = Phase::open;
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
        std::copy_if(run_.stuck.begin(), run_.stuck.end(), std::back_inserter(taking_part_), is_resting);
        both_signs_.assign(taking_part_.size(), slow);
        for (int other = 0; other < problem_.contact_count() && !rebounds; ++other)
            if (run_.phase(other) == Phase::touching && is_resting(other)) taking_part_.push_back(other);
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
                matrix_.push_back(-contact_coupling(problem_, run_.contact(i), run_.contact(j)));
        solve_complementary(matrix_, need_, both_signs_, impulses_);
        if (run_.listener) {
            std::vector<real> restitution;
            for (const Closing& each : contacts) restitution.push_back(sticks ? 0 : each.restitution);
            run_.listener->impulses(
                {taking_part_, resting, restitution, need_, both_signs_, matrix_, impulses_});
        }
        for (std::size_t i = 0; i < taking_part_.size(); ++i) impulse(taking_part_[i], impulses_[i]);
        for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].impulse = impulses_[resting + i];
    }

    // Whether an open contact closes now, to the rounding errors of its gap and of the time.
    bool closes_now(int c) const {
        const Gap g = gap(problem_, run_.contact(c), run_.state.y.data());
        return run_.phase(c) == Phase::open && g.rate < 0 &&
               g.value <= instant_rounding * (run_.gap_terms(c) + run_.state.t * -g.rate);
    }

public:
    explicit HardContacts(RunState& run)
        : run_(run), problem_(run.problem), motion_(run.problem), held_speed_(speed_by_loads(run.problem)),
          varies_(std::any_of(problem_.loads.begin(), problem_.loads.end(),
                              [](const Load& load) { return load.signal.kind == Signal::Kind::constant; })) {}

    // Returns the rounding error of the difference of two equal velocities.
    real velocity_rounding() const {
        const real* v = velocities(problem_, run_.state.y.data());
        real largest = std::fmax(largest_impact_speed_, varies_ ? speed_by_loads(problem_) : held_speed_);
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i)
            largest = std::fmax(largest, std::fabs(v[i]));
        for (const Damper& damper : problem_.dampers) {
            real terms = 0; // which cancel where a point is held
            for (std::size_t m = 0; m < damper.shape.size(); ++m)
                terms += std::fabs(damper.shape[m] * run_.state.y[2 * m + 1]);
            largest = std::fmax(largest, terms);
        }
        return speed_rounding * largest;
    }

    // Resolves the impact of contact c together with those of all contacts that close at the same time.
    // Newton's law holds for each: with the approach rates v before and v' after the impact and the impulses
    // p, p >= 0, -v' >= e v, and one of both is an equality. Each contact loses p (1 - e) v / 2.
    void impact(int first) {
        // What closes now. Slow impacts do not rebound: those without a closing force (inelastic collapse)
        // would never end otherwise.
        largest_impact_speed_ = std::fmax(largest_impact_speed_, largest_speed());
        const real slowest = std::fmax(problem_.settings.stick * largest_impact_speed_, velocity_rounding());
        bool rebounds = false, slow = true;
        closing_.clear();
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (c != first && !closes_now(c)) continue;
            Closing& each = closing_.emplace_back();
            each.contact = c;
            each.speed = run_.system.approach(run_.state.y.data(), c);
            const Rebound r = rebound(run_.contact(c).restitution, each.speed);
            if (r.outside) return run_.fail(Status::law_domain, c, each.speed);
            run_.result.counts.extrapolated += c != first && r.extrapolated;
            each.restitution = each.speed < slowest ? 0 : r.e;
            each.change = (1 + each.restitution) * each.speed;
            rebounds = rebounds || each.restitution > 0;
            slow = slow && each.speed < slowest;
        }
        if (run_.listener) run_.listener->begin_impact(first);
        // All impulses at once, so that the order of the contacts does not matter.
        reduce_approaches(closing_, rebounds, slow);
        run_.contact_ended = true;
        std::erase_if(closing_, [](const Closing& each) { return !(each.impulse > 0); }); // opened by others
        for (Closing& each : closing_) {
            Impact impact;
            impact.contact = each.contact;
            impact.time = run_.state.t;
            impact.approach_speed = each.speed;
            impact.restitution = each.restitution;
            impact.separation_speed = each.restitution * each.speed;
            impact.duration = 0;
            impact.peak_force = infinity;
            impact.energy_lost = 0.5 * each.impulse * (1 - each.restitution) * each.speed;
            impact.complete = true;
            run_.ledger.normal[run_.damper_of(each.contact)] += impact.energy_lost;
            each.number = static_cast<std::size_t>(run_.result.add_impact(impact));
        }
        run_.result.counts.simultaneous += closing_.size() > 1;
        // Contacts at rest that the impact has set in motion are open before the accelerations are asked.
        release_moving();
        // All decisions before any contact sticks, so that their order does not matter.
        std::vector<Closing> sticking;
        for (const Closing& each : closing_) {
            const int c = each.contact;
            const real rebound_speed = std::fmax(-run_.system.approach(run_.state.y.data(), c), 0.0);
            const real acceleration = gap_acceleration(c);
            if (acceleration < 0 &&
                2 * rebound_speed < -acceleration * problem_.settings.stick * shortest_period())
                sticking.push_back(each);
            else if (each.restitution == 0)
                run_.phase(c) = Phase::touching;
        }
        // What is left of the approach rates is lost, too, and belongs to the same impacts.
        if (!sticking.empty()) stick(sticking);
        if (run_.listener) run_.listener->end_impact();
        for (const Closing& each : sticking)
            run_.result.impacts[each.number].energy_lost += 0.5 * each.impulse * each.change;
    }

    // Makes contacts stuck. Their remaining approach rates are lost, with the energy impulse x change / 2.
    void stick(std::vector<Closing>& contacts) {
        for (Closing& each : contacts) each.change = run_.system.approach(run_.state.y.data(), each.contact);
        reduce_approaches(contacts, false, true, true);
        for (const Closing& each : contacts) {
            run_.ledger.normal[run_.damper_of(each.contact)] += 0.5 * each.impulse * each.change;
            ++run_.result.counts.sticks;
            run_.stuck.push_back(each.contact);
            run_.phase(each.contact) = Phase::closed;
        }
        release_moving();
        gather_touching();
    }

    // The force of a stuck contact became attractive: it touches, and the forces decide whether it opens.
    void release(int which) {
        run_.phase(run_.stuck[static_cast<std::size_t>(which)]) = Phase::touching;
        run_.stuck.erase(run_.stuck.begin() + which);
        gather_touching();
    }

    // Open contacts that are closed and at rest to rounding touch, so that the forces decide about all
    // contacts at one place together: one that opens before the others would have a gap and a rate of
    // rounding, far below the resolution of the time.
    void gather_touching() {
        const real speed = velocity_rounding();
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (run_.phase(c) != Phase::open) continue;
            const Gap g = gap(problem_, run_.contact(c), run_.state.y.data());
            const real length = instant_rounding * run_.gap_terms(c) + speed * shortest_period();
            if (std::fabs(g.rate) <= speed && std::fabs(g.value) <= length) run_.phase(c) = Phase::touching;
        }
    }

    template <class Archive> void serialize(Archive& a) { a(largest_impact_speed_); }
};

} // namespace rattlebox
