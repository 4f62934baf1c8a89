// Decides whether a contact is isolated, solves it as a whole, and samples it.
#pragma once

#include "impact/isolated_contact.hpp"
#include "impact/output.hpp"
#include "impact/taylor_motion.hpp"

namespace rattlebox {

class IsolatedStart {
    RunState& run_;
    Output& output_;
    const Problem& problem_;
    IsolatedContact contact_, part_; // part_: up to a sample
    State end_, partial_state_;      // at the end, and at a sample
    Ledger ledger_;                  // of one contact
    std::vector<int> uncertain_;     // contacts that may start during this one

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
        const Contact& k = run_.contact(c);
        if (k.below != wall && k.above != wall) return 0; // both balls have the same acceleration
        const Damper& damper = problem_.dampers[run_.damper_of(c)];
        real bound = std::fabs(damper.gravity);
        std::vector<real> largest(run_.loads.active() ? run_.loads.size() : 0);
        for (std::size_t l = 0; l < largest.size(); ++l) {
            real taylor[Series::order + 1] = {}, power = 1;
            run_.loads.piece(l).add_taylor(run_.state.t, 1, Series::order, taylor);
            for (const real term : taylor) largest[l] += std::fabs(term) * power, power *= length;
            if (run_.loads.load(l).base) bound += largest[l];
        }
        for (std::size_t m = 0; m < damper.shape.size(); ++m) {
            const Mode& mode = problem_.modes[m];
            real force = 0;
            for (std::size_t l = 0; l < largest.size(); ++l)
                force += std::fabs(run_.loads.load(l).shape[m]) * largest[l];
            const real speed =
                std::sqrt(2 * ModeState{run_.state.y[2 * m], run_.state.y[2 * m + 1]}.energy(mode)) +
                force * length;
            bound +=
                std::fabs(damper.shape[m]) * ((std::sqrt(mode.stiffness) + 2 * mode.decay) * speed + force);
        }
        return bound;
    }

    // Whether no other contact can start during this one, or can be excluded when it is solved: these are
    // stored in uncertain_.
    bool is_isolated(int c, real speed, real longest) {
        uncertain_.clear();
        if (!run_.system.active.empty() || !run_.stuck.empty() || !run_.released.empty()) return false;
        for (int other = 0; other < problem_.contact_count(); ++other) {
            if (other == c) continue;
            const Damper& damper = problem_.dampers[run_.damper_of(other)];
            if (damper.balls == 1 && run_.contact(other).damper == run_.contact(c).damper) continue;
            const Gap g = gap(problem_, run_.contact(other), run_.state.y.data());
            if (!(g.value > longest * (std::fabs(g.rate) + 4 * speed))) return false;
            // The impulse of the contact is at most about twice that of an elastic one.
            const real share = std::fabs(contact_coupling(problem_, run_.contact(other), run_.contact(c))) *
                               run_.contact(c).mass;
            const real change = 4 * share * speed + acceleration_bound(other, longest) * longest;
            if (!(g.value > longest * (std::fabs(g.rate) + change))) uncertain_.push_back(other);
        }
        return true;
    }

    // Takes a sample within an isolated contact. The contact is solved again up to the phase at that time,
    // because interpolation would be less accurate.
    void sample_isolated(int c, const HertzTsuji& law, real speed, real zeta) {
        const real t = output_.next_time();
        output_.ledger = run_.ledger;
        IsolatedContact::Instant now;
        real psi = contact_.psi_at(t - run_.state.t);
        for (int pass = 0; pass < 8; ++pass) {
            part_.prepare(run_.contact(c), law, run_.loads, run_.state, speed, zeta, infinity, psi);
            part_.solve();
            now = part_.end();
            const real late = t - run_.state.t - now.time;
            if (std::fabs(late) <= 2 * epsilon * t) break;
            psi = std::clamp(psi + late * part_.phase_rate(now), 0.5 * psi, contact_.last_psi());
        }
        part_.store_end(now, partial_state_, output_.ledger);
        output_.clear();
        output_.stored[run_.damper_of(c)] =
            law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        output_.add_wall_force(c, now.force);
        output_.record(t, partial_state_);
    }

    // Takes a sample at the deepest overlap of an isolated contact.
    void sample_deepest(int c, const HertzTsuji& law, real speed, real zeta) {
        output_.ledger = run_.ledger;
        part_.prepare(run_.contact(c), law, run_.loads, run_.state, speed, zeta, infinity, std::acos(zeta));
        part_.solve();
        const IsolatedContact::Instant now = part_.end();
        part_.store_end(now, partial_state_, output_.ledger);
        output_.clear();
        output_.stored[run_.damper_of(c)] =
            law.stored(law.coefficients(zeta, speed), depth_from_fourth_root(now.x));
        output_.add_wall_force(c, now.force);
        output_.record(run_.state.t + now.time, partial_state_, false);
    }

public:
    IsolatedStart(RunState& run, Output& output)
        : run_(run), output_(output), problem_(run.problem), contact_(problem_), part_(problem_),
          end_(problem_), partial_state_(problem_), ledger_(problem_) {}

    // Solves a contact as a whole if it is isolated and the energy balance of the solution holds.
    bool solve(int c, real speed, real e) {
        const HertzTsuji* law = run_.contact(c).normal.get_if<HertzTsuji>();
        if (!law) return false;
        const real zeta = law->damping(e);
        const real available = run_.next_stop() - run_.state.t;
        if (!contact_.prepare(run_.contact(c), *law, run_.loads, run_.state, speed, zeta, available)) {
            if (!(contact_.longest_time() <= available)) run_.meet_stop();
            return false;
        }
        if (!is_isolated(c, speed, contact_.longest_time()) || !contact_.solve()) return false;
        // Contacts that a bound of the motion could not exclude are excluded by the motion itself.
        for (const int other : uncertain_)
            if (!(contact_.smallest_gap(run_.contact(other)) > 0)) return false;
        // The sweeps do not use the energy balance, so that it tells whether they have converged. It has a
        // ledger of its own, because the sums of a long run have larger rounding errors.
        ledger_.clear();
        const IsolatedContact::Instant end = contact_.end();
        contact_.store_end(end, end_, ledger_);
        const ContactState contact_state = initial_state(*law, e, speed);
        const real stored = stored_energy(*law, contact_state, end.x);
        const std::size_t d = run_.damper_of(c);
        const real residual = energy(end_) + stored - energy(run_.state) + ledger_.normal[d] +
                              ledger_.viscous - ledger_.load_work - ledger_.base_work;
        const real size = run_.contact(c).mass * speed * speed + energy(run_.state) * energy_beside_contact;
        if (!(std::fabs(residual) < run_.resolution() * size)) return false;
        if (run_.listener && !run_.listener->isolated(c, speed, e, contact_, end_)) return false;
        run_.result.permitted_error += run_.resolution() * size;

        Impact impact;
        impact.contact = c;
        impact.time = run_.state.t;
        impact.approach_speed = speed;
        if (law->needs_restitution()) impact.restitution = e;
        impact.separation_speed = -end.rate;
        impact.duration = end.time;
        if (problem_.settings.peaks) {
            const IsolatedContact::Instant deepest = contact_.instant_at(contact_.deepest_position());
            impact.peak_overlap = square(square(deepest.x));
            impact.peak_force = zeta == 0 ? deepest.force : contact_.peak_force();
        }
        impact.energy_lost = end.lost + stored;
        impact.complete = true;
        const int number = run_.result.add_impact(impact);
        ++run_.result.counts.collocated;
        // Samples within need the state at the start, which the end replaces.
        if (output_.samples_contacts()) {
            const real deepest = run_.state.t + contact_.time_at(contact_.deepest_position());
            while (output_.is_due(deepest)) sample_isolated(c, *law, speed, zeta);
            sample_deepest(c, *law, speed, zeta);
        }
        while (output_.is_due(run_.state.t + end.time)) sample_isolated(c, *law, speed, zeta);
        run_.contact_ended = true;
        std::swap(run_.state.y, end_.y);
        run_.state.t += end.time;
        run_.ledger.add(ledger_);
        // A force that ends before the overlap leaves the bodies to recover in flight.
        if (stored > 0) {
            run_.released.push_back({c, contact_state, number, stored});
            run_.phase(c) = RunState::Phase::released;
        }
        return true;
    }
};

} // namespace rattlebox
