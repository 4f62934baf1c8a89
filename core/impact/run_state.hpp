// The state of a run: bodies, contacts, energies, and the result so far. The parts of the engine share it.
#pragma once

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "impact/result.hpp"
#include "impact/run_listener.hpp"
#include "impact/system.hpp"

namespace rattlebox {

struct RunState {
    enum class Phase : char { open, touching, closed, released };

    const Problem& problem;
    const std::atomic<bool>* stop;
    Loads loads;
    State state;
    Ledger ledger;
    System system; // with the closed soft contacts
    std::vector<Phase> phases;
    std::vector<Released> released;
    std::vector<int> stuck;     // hard contacts that have come to rest
    real until;                 // time at which the run pauses or ends
    bool met_end = false;       // whether the motion of a longer run may differ in its last bits from now on
    bool contact_ended = false; // at the current time
    real last_jump = 0; // time of the last jump of a force or its rate, except by contacts that began at rest
    real largest_overlap = 0; // so far, expected from the approach speeds
    Result result;
    RunListener* listener = nullptr; // an object beside the run, or null

    RunState(const Problem& problem_to_run, const std::atomic<bool>* stop_flag)
        : problem(problem_to_run), stop(stop_flag), loads(problem.loads), state(problem), ledger(problem),
          system(problem), phases(problem.contacts.size(), Phase::open), until(problem.settings.duration),
          result(problem) {}

    const Contact& contact(int c) const { return problem.contacts[static_cast<std::size_t>(c)]; }
    std::size_t damper_of(int c) const { return static_cast<std::size_t>(contact(c).damper); }
    Phase& phase(int c) { return phases[static_cast<std::size_t>(c)]; }
    Phase phase(int c) const { return phases[static_cast<std::size_t>(c)]; }
    bool hard() const { return problem.settings.method == Method::newton; }
    bool running() const { return result.status == Status::finished; }
    bool is_stopped() const { return stop && stop->load(std::memory_order_relaxed); }
    // The tolerance, at least the rounding error of a step.
    real resolution() const { return std::fmax(problem.settings.tolerance, step_rounding); }
    real next_stop() const { return std::min(loads.next_knot(), until); }
    // Called where the next stop has shortened a step or a search.
    void meet_stop() { met_end = met_end || until < loads.next_knot(); }

    void fail(Status status, int c = -1, real value = 0) {
        result.status = status;
        result.stopped_contact = c;
        result.stopped_value = value;
    }

    // Returns the sum of the magnitudes of the terms of a gap.
    real gap_terms(int c) const {
        const Damper& damper = problem.dampers[damper_of(c)];
        const real* y = state.y.data();
        real sum = damper.clearance;
        for (const int side : {contact(c).below, contact(c).above}) {
            if (side == ground) continue;
            if (side != wall) {
                sum += std::fabs(positions(problem, y)[side]);
                continue;
            }
            for (std::size_t m = 0; m < damper.shape.size(); ++m)
                sum += std::fabs(damper.shape[m] * y[2 * m]);
        }
        return sum;
    }

    // Returns the length whose rounding error is that of a gap: that of a stop may be zero.
    real gap_length(int c, const real* y) const {
        return contact(c).above == ground ? stop_terms(problem, contact(c), y, state.t)
                                          : problem.dampers[damper_of(c)].clearance;
    }

    // Stored energy of a released contact that still overlaps in state y.
    real recoverable_energy(const Released& r, const real* y) const {
        const real overlap = -gap(problem, contact(r.contact), y).value - r.state.origin();
        if (overlap <= 0) return 0;
        const real x = std::sqrt(std::sqrt(overlap));
        return contact(r.contact).normal.visit(
            [&](const auto& law) { return stored_energy(law, r.state, x); });
    }

    // Ends the recovery of released contacts that have opened. Their stored energy is lost. In a flight they
    // only open, so that one that approaches after it has been open, even if it has just closed again.
    void open_all_released(int touched, bool after_flight = false) {
        for (std::size_t i = released.size(); i-- > 0;) {
            const int c = released[i].contact;
            const real rounding = contact_gap_rounding * gap_length(c, state.y.data());
            const Gap g = gap(problem, contact(c), state.y.data());
            const bool is_recovering = g.value < -rounding && !(after_flight && g.rate < 0);
            if (c != touched && is_recovering) continue;
            ledger.normal[damper_of(released[i].contact)] += released[i].energy;
            phase(released[i].contact) = Phase::open;
            released.erase(released.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }

    // Finds the contacts that touch at the start.
    void find_touching() {
        for (int c = 0; c < problem.contact_count(); ++c) {
            const Gap g = gap(problem, contact(c), state.y.data());
            const real rounding = contact(c).above == ground ? contact_gap_rounding * gap_terms(c) : 0;
            if (g.value <= rounding && g.rate == 0) phase(c) = Phase::touching;
        }
    }

    // Throws unless every index and size of a state that was read can be one of this problem.
    void check() const {
        const auto require = [](bool holds) {
            if (!holds) throw std::invalid_argument("the state is damaged");
        };
        const std::size_t contacts = problem.contacts.size(), dampers = problem.dampers.size();
        const auto check_impact = [&](int impact) {
            require(impact >= -1 && impact < static_cast<int>(result.impacts.size()));
        };
        // A contact is in one of the lists at most.
        std::vector<char> is_listed(contacts, false);
        const auto check_contact = [&](int contact) {
            require(contact >= 0 && contact < static_cast<int>(contacts));
            char& listed = is_listed[static_cast<std::size_t>(contact)];
            require(!listed);
            listed = true;
        };
        require(state.t >= 0 && state.t < infinity);
        require(std::all_of(state.y.begin(), state.y.end(),
                            [](real value) { return std::fabs(value) < infinity; }));
        require(state.y.size() == problem.state_size());
        require(ledger.normal.size() == dampers && ledger.plastic.size() == dampers);
        require(phases.size() == contacts);
        for (const Phase each : phases) require(each >= Phase::open && each <= Phase::released);
        for (const auto& one : system.active) check_contact(one.contact), check_impact(one.impact);
        for (const auto& one : released) check_contact(one.contact), check_impact(one.impact);
        for (const int one : stuck) check_contact(one);
        for (const Impact& impact : result.impacts)
            require(impact.contact >= 0 && impact.contact < static_cast<int>(contacts));
        require(result.status == Status::finished);
    }

    // Returns the impacts in the log that are not over, and numbers closed and released contacts by them.
    std::vector<Impact> take_open_impacts() {
        std::vector<Impact> kept;
        const auto keep = [&](int& index) {
            if (index < 0) return;
            kept.push_back(result.impacts[static_cast<std::size_t>(index)]);
            index = static_cast<int>(kept.size()) - 1;
        };
        for (Active& a : system.active) keep(a.impact);
        for (Released& r : released) keep(r.impact);
        return kept;
    }

    // Writes or reads all that the next event needs, in a fixed order.
    template <class Archive> void serialize(Archive& a) {
        a(state.t, state.y, ledger.load_work, ledger.base_work, ledger.viscous, ledger.normal, ledger.plastic,
          phases, released, system.active, stuck, contact_ended, result.status, result.impacts);
    }
};

} // namespace rattlebox
