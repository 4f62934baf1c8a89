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

// Impacts summed up, each once, in any order: the last bit of a sum must not depend on which line was
// dropped when.
struct ImpactSums {
    real impacts = 0, approach_speeds = 0, rounded_off = 0;
    real largest_approach_speed = 0, peak_force = 0, peak_overlap = 0, longest_contact = 0;

    void add(const Impact& i) {
        impacts += 1;
        const real sum = approach_speeds + i.approach_speed, part = sum - approach_speeds;
        rounded_off += (approach_speeds - (sum - part)) + (i.approach_speed - part);
        approach_speeds = sum;
        largest_approach_speed = std::fmax(largest_approach_speed, i.approach_speed);
        peak_force = std::fmax(peak_force, i.peak_force);
        peak_overlap = std::fmax(peak_overlap, i.peak_overlap);
        longest_contact = std::fmax(longest_contact, i.duration);
    }
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
    ImpactSums dropped; // of lines that are no longer in the log
    Counts counts;
    Status status = Status::finished;
    real stopped_at = 0;
    int stopped_contact = -1; // where a law left its domain
    real stopped_value = 0;   // and at which speed

    // Room for all samples, so that none is taken twice.
    explicit Result(const Problem& problem) {
        const std::size_t n = problem.sample_times.size(), d = n * problem.dampers.size();
        samples.state.reserve(2 * n * (problem.modes.size() + problem.ball_mass.size()));
        for (auto* column : {&samples.time, &samples.load_work, &samples.base_work, &samples.viscous})
            column->reserve(n);
        for (auto* column : {&samples.normal, &samples.plastic, &samples.stored, &samples.force})
            column->reserve(d);
    }
    Result() = default;

    // Adds a line to the log and returns its number. `each(f)` calls f for every number of a line that is in
    // use: where the log is limited, the older half goes but for those.
    template <class Each> int enter(const Impact& line, const Settings& settings, Each&& each) {
        if (settings.log_lines > 0 && impacts.size() >= settings.log_lines) {
            std::size_t kept = 0;
            for (std::size_t i = 0; i < impacts.size(); ++i) {
                bool needed = 2 * i >= impacts.size();
                each([&](int& number) {
                    if (number != static_cast<int>(i)) return;
                    number = static_cast<int>(kept);
                    needed = true;
                });
                if (needed)
                    impacts[kept++] = impacts[i];
                else if (impacts[i].time >= settings.log_from)
                    dropped.add(impacts[i]);
            }
            impacts.resize(kept);
        }
        impacts.push_back(line);
        return static_cast<int>(impacts.size()) - 1;
    }

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
