// Samples of a run: the requested times, and those of contacts.
#pragma once

#include "impact/run_state.hpp"

namespace rattlebox {

class Output {
    RunState& run_;
    std::size_t next_ = 0;
    std::vector<real> force_; // of the contacts on each cavity

public:
    Ledger ledger;            // at a sample
    std::vector<real> stored; // energy of the contacts of each damper at a sample

    explicit Output(RunState& run)
        : run_(run), force_(run.problem.dampers.size()), ledger(run.problem),
          stored(run.problem.dampers.size()) {}

    bool is_due(real until) const {
        const std::vector<real>& times = run_.problem.sample_times;
        return next_ < times.size() && times[next_] <= until;
    }
    real next_time() { return run_.problem.sample_times[next_++]; }
    void rewind() { next_ = 0; }

    // Whether samples are taken at the start and the end of contacts.
    bool samples_contacts() const {
        return run_.result.counts.events <= run_.problem.settings.contact_samples;
    }

    void clear() {
        std::fill(stored.begin(), stored.end(), 0.0);
        std::fill(force_.begin(), force_.end(), 0.0);
    }

    void add_wall_force(int c, real force) {
        if (run_.contact(c).above == wall) force_[run_.damper_of(c)] += force;
        if (run_.contact(c).below == wall) force_[run_.damper_of(c)] -= force;
    }

    // Adds a sample with `ledger`, to which the losses of released contacts are added here.
    void record(real t, const State& state, bool given = true) {
        for (const Released& r : run_.released) {
            const real left = run_.recoverable_energy(r, state.y.data());
            stored[run_.damper_of(r.contact)] += left;
            ledger.normal[run_.damper_of(r.contact)] += r.energy - left;
        }
        run_.result.record(t, state, ledger, stored, force_, given);
    }

    // Adds a sample of the current state without closed contacts.
    void record_now() {
        clear();
        ledger = run_.ledger;
        record(run_.state.t, run_.state);
    }
};

} // namespace rattlebox
