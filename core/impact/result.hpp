// The result of a run of the 1-D engine: samples of the state and the energy ledger, and the impact log.
#pragma once

#include <cstdint>
#include <vector>

#include "impact/state.hpp"
#include "util/status.hpp"

namespace rattlebox {

struct Impact {
    int contact = 0;
    real time = 0;
    real approach_speed = 0;
    real restitution = not_a_number; // NaN if the contact law does not use it
    real separation_speed = not_a_number;
    real duration = not_a_number;
    real peak_overlap = 0, peak_force = 0;
    real energy_lost = 0;
    bool complete = false;
};

struct Counts {
    long events = 0, flights = 0, contact_steps = 0, rejected_steps = 0, collocated = 0, extrapolated = 0,
         sticks = 0,
         simultaneous = 0; // instants at which several hard impacts were resolved together
};

struct Samples {
    std::vector<real> time, state; // state vectors y of impact/state.hpp, one after the other
    std::vector<real> load_work, base_work, viscous;
    std::vector<real> normal, plastic, stored, force; // by damper
    std::vector<std::int8_t> given; // whether the time was requested, or is that of a contact

    // Returns the samples i for which keep(i) is true.
    template <class Keep> Samples selected(Keep&& keep) const {
        Samples some;
        const auto copy = [&]<class T>(const std::vector<T>& from, std::vector<T>& to) {
            const std::size_t width = time.empty() ? 0 : from.size() / time.size();
            for (std::size_t i = 0; i < time.size(); ++i)
                if (keep(i)) to.insert(to.end(), from.begin() + i * width, from.begin() + (i + 1) * width);
        };
        copy(state, some.state);
        for (const auto column : {&Samples::load_work, &Samples::base_work, &Samples::viscous,
                                  &Samples::normal, &Samples::plastic, &Samples::stored, &Samples::force})
            copy(this->*column, some.*column);
        copy(given, some.given);
        copy(time, some.time);
        return some;
    }
};

// States from which another run continues.
struct EndStates {
    std::vector<std::uint8_t> end; // where the run ended
    std::vector<std::uint8_t>
        whole;                // the last one that a longer run has, too: its bits are those of the longer run
    std::vector<real> motion; // state vector y where the run ended
    std::vector<std::int8_t> phases; // of the contacts there; 0 is open
};

struct Result {
    Samples samples;
    EndStates states; // empty unless the settings ask for them
    std::vector<Impact> impacts;
    Counts counts;
    Status status = Status::finished;
    real stopped_at = 0;
    int stopped_contact = -1; // contact whose law left its range of validity
    real stopped_value = 0;   // its approach speed
    // Error of the energy [J] by the tolerance of all steps of contacts; of hard ones, rounding of held
    // stops.
    real permitted_error = 0;

    // Reserves memory for the requested samples, and as many for those at contacts.
    explicit Result(const Problem& problem) {
        const std::size_t given = problem.sample_times.size();
        const std::size_t n = problem.settings.contact_samples > 0 ? 2 * given : given;
        const std::size_t d = n * problem.dampers.size();
        samples.state.reserve(2 * n * (problem.modes.size() + problem.ball_mass.size()));
        for (auto* column : {&samples.time, &samples.load_work, &samples.base_work, &samples.viscous})
            column->reserve(n);
        for (auto* column : {&samples.normal, &samples.plastic, &samples.stored, &samples.force})
            column->reserve(d);
    }
    Result() = default;

    // Returns the part of the largest energy of a run that rounding errors may reach. In soft contacts those
    // of positions add up like a random walk.
    real rounding(const Settings& settings) const {
        if (settings.method != Method::event_driven) return 1e-10;
        return energy_rounding +
               4 * epsilon * std::sqrt(static_cast<real>(counts.events + counts.contact_steps));
    }

    // Adds an impact to the log and returns its index.
    int add_impact(const Impact& impact) {
        impacts.push_back(impact);
        return static_cast<int>(impacts.size()) - 1;
    }

    // Adds a sample. There is one sample for each time, in ascending order.
    void record(real t, const State& state, const Ledger& ledger, const std::vector<real>& stored,
                const std::vector<real>& force, bool given = true) {
        Samples& s = samples;
        if (!s.time.empty() && t <= s.time.back()) {
            if (!given) return;
            // A requested time that equals that of the last sample to rounding.
            if (s.time.back() - t <= 16 * epsilon * t) s.time.back() = t;
            s.given.back() = true;
            return;
        }
        s.time.push_back(t);
        s.given.push_back(given);
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
