// The data of a run that its parts share: state, ledger, phases of the contacts, and the result so far.
#pragma once

#include <algorithm>
#include <atomic>

#include "impact/flight.hpp"
#include "impact/result.hpp"
#include "impact/system.hpp"

namespace rattlebox {

class RunState {
protected:
    enum class Phase : char { open, touching, closed, released };

    const Problem& problem_;
    const std::atomic<bool>* stop_;
    Loads loads_;
    State state_, scratch_;
    Ledger ledger_, sampled_; // at the current time, and at a sample
    Flight flight_;
    System system_;
    std::vector<Phase> phase_;
    std::vector<Released> released_;
    std::vector<int> stuck_; // hard contacts that have come to rest
    real until_;             // time at which the run pauses or ends
    std::size_t next_sample_ = 0;
    bool contact_ended_ = false; // at the current time
    Result result_;
    std::vector<real> y_, trial_, stored_, force_;

    const Contact& contact(int c) const { return problem_.contacts[static_cast<std::size_t>(c)]; }
    std::size_t damper_of(int c) const { return static_cast<std::size_t>(contact(c).damper); }
    Phase& phase(int c) { return phase_[static_cast<std::size_t>(c)]; }
    bool hard() const { return problem_.settings.method == Method::newton; }
    bool running() const { return result_.status == Status::finished; }
    // The tolerance, at least the rounding error of a step.
    real resolution() const { return std::fmax(problem_.settings.tolerance, 64 * epsilon); }
    real next_stop() const { return std::min(loads_.next_knot(), until_); }

    void fail(Status status, int c = -1, real value = 0) {
        result_.status = status;
        result_.stopped_contact = c;
        result_.stopped_value = value;
    }

    // ---- recording

    // Stored energy of a released contact that still overlaps in state y.
    real recoverable_energy(const Released& r, const real* y) const {
        const real overlap = -gap(problem_, contact(r.contact), y).value - r.state.origin();
        if (overlap <= 0) return 0;
        const real x = std::sqrt(std::sqrt(overlap));
        return contact(r.contact).normal.visit(
            [&](const auto& law) { return stored_energy(law, r.state, x); });
    }

    // Whether samples are taken at begin and end of contacts.
    bool samples_contacts() const { return result_.counts.events <= problem_.settings.contact_samples; }

    // Adds a sample. `ledger` is that of the sample without the losses of released contacts, which are added
    // here.
    void record(real t, const State& state, Ledger& ledger, bool given = true) {
        for (const Released& r : released_) {
            const real left = recoverable_energy(r, state.y.data());
            stored_[damper_of(r.contact)] += left;
            ledger.normal[damper_of(r.contact)] += r.energy - left;
        }
        result_.record(t, state, ledger, stored_, force_, given);
    }

    void clear_contact_samples() {
        std::fill(stored_.begin(), stored_.end(), 0.0);
        std::fill(force_.begin(), force_.end(), 0.0);
    }

    bool sample_due(real until) const {
        return next_sample_ < problem_.sample_times.size() && problem_.sample_times[next_sample_] <= until;
    }

    // Ends the recovery of released contacts that have opened. Their stored energy is lost. In a flight they
    // only open, so that one that approaches after it has been open, even if it has just closed again.
    void open_all_released(int touched, bool after_flight = false) {
        for (std::size_t i = released_.size(); i-- > 0;) {
            const int c = released_[i].contact;
            const real rounding = 8 * epsilon * problem_.dampers[damper_of(c)].clearance;
            const Gap g = gap(problem_, contact(c), state_.y.data());
            const bool is_recovering = g.value < -rounding && !(after_flight && g.rate < 0);
            if (c != touched && is_recovering) continue;
            ledger_.normal[damper_of(released_[i].contact)] += released_[i].energy;
            phase(released_[i].contact) = Phase::open;
            released_.erase(released_.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }

    void load_system() {
        y_.assign(system_.size(), 0.0);
        std::copy(state_.y.begin(), state_.y.end(), y_.begin());
        for (std::size_t j = 0; j < system_.active.size(); ++j) y_[system_.x_index(j)] = system_.active[j].x;
    }

    void add_wall_force(int c, real force) {
        if (contact(c).above == wall) force_[damper_of(c)] += force;
        if (contact(c).below == wall) force_[damper_of(c)] -= force;
    }

    // Writes or reads all that the next event needs, in a fixed order.
    template <class Archive> void serialize(Archive& a) {
        a(state_.t, state_.y, ledger_.load_work, ledger_.base_work, ledger_.viscous, ledger_.normal,
          ledger_.plastic, phase_, released_, system_.active, stuck_, contact_ended_, result_.status,
          result_.impacts);
    }

public:
    RunState(const Problem& problem, const std::atomic<bool>* stop)
        : problem_(problem), stop_(stop), loads_(problem.loads), state_(problem), scratch_(problem),
          ledger_(problem), sampled_(problem), flight_(problem), system_(problem),
          phase_(problem.contacts.size(), Phase::open), until_(problem.settings.duration), result_(problem),
          stored_(problem.dampers.size()), force_(problem.dampers.size()) {}
};

} // namespace rattlebox
