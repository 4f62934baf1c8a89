// What a trajectory leaves behind: samples of the state, the ledger, and one line for each impact.
#pragma once

#include <vector>

#include "base/status.hpp"
#include "impact/state.hpp"

namespace rattlebox {

struct Impact {
    int contact = 0;
    real time = 0;
    real approach_speed = 0;
    real restitution = not_a_number; // asked for; not a number where the law asks for none
    real separation_speed = not_a_number;
    real duration = not_a_number;
    real peak_overlap = 0, peak_force = 0;
    real energy_lost = 0;
    bool complete = false;
};

struct Counts {
    long events = 0, flights = 0, contact_steps = 0, rejected_steps = 0, collocated = 0, extrapolated = 0,
         sticks = 0;
};

struct Samples {
    std::vector<real> time, state; // y as in impact/state.hpp, one after the other
    std::vector<real> load_work, base_work, viscous;
    std::vector<real> normal, plastic, stored, force; // by damper
};

struct Result {
    Samples samples;
    std::vector<Impact> impacts;
    Counts counts;
    Status status = Status::finished;
    real stopped_at = 0;
    int stopped_contact = -1; // where a law left its domain
    real stopped_value = 0;   // and at which speed

    void record(real t, const State& state, const Ledger& ledger, const std::vector<real>& stored,
                const std::vector<real>& force) {
        Samples& s = samples;
        s.time.push_back(t);
        s.state.insert(s.state.end(), state.y.begin(), state.y.end());
        s.load_work.push_back(ledger.load_work);
        s.base_work.push_back(ledger.base_work);
        s.viscous.push_back(ledger.viscous);
        s.normal.insert(s.normal.end(), ledger.normal.begin(), ledger.normal.end());
        s.plastic.insert(s.plastic.end(), ledger.plastic.begin(), ledger.plastic.end());
        s.stored.insert(s.stored.end(), stored.begin(), stored.end());
        s.force.insert(s.force.end(), force.begin(), force.end());
    }
};

} // namespace rattlebox
