// What is kept of one member of a batch, and where it is put.
#pragma once

#include <cstdint>

#include "impact/measures.hpp"

namespace rattlebox {

struct Wanted {
    std::vector<int> measures; // places in the table of measures
    std::vector<int> batched;  // of these, those that are evaluated in batches, too
    bool motion = false, state = false;
    std::size_t last = 0; // impacts at the end
};

// Where numbers of members are put: arrays over `members` in one block, those that are not wanted are empty.
struct Kept {
    std::size_t members = 0;
    std::int8_t* status = nullptr;
    real* numbers = nullptr;
    std::size_t measures = 0;                                         // one after the other
    std::size_t batches = 0, batch_length = 0;                        // batches one after the other
    std::size_t displacement = 0, velocity = 0, place = 0, speed = 0; // of the motion
    std::size_t state = 0, last_time = 0, last_speed = 0, last_contact = 0;

    // Says where each array begins, and how many numbers there are.
    std::size_t lay(const Problem& problem, const Window& window, const Wanted& wanted) {
        std::size_t size = 0;
        const auto take = [&](bool needed, std::size_t each) {
            const std::size_t at = size;
            if (needed) size += members * each;
            return at;
        };
        const std::size_t samples = static_cast<std::size_t>(window.samples),
                          balls = problem.ball_mass.size();
        measures = take(true, wanted.measures.size());
        batches = take(true, wanted.batched.size() * most_batches);
        batch_length = take(!wanted.batched.empty(), most_batches);
        displacement = take(wanted.motion, samples);
        velocity = take(wanted.motion, samples);
        place = take(wanted.motion, samples * balls);
        speed = take(wanted.motion, samples * balls);
        state = take(wanted.state, 2 * (problem.modes.size() + balls));
        last_time = take(true, wanted.last);
        last_speed = take(true, wanted.last);
        last_contact = take(true, wanted.last);
        return size;
    }

    void keep(std::size_t i, const Problem& problem, const Window& window, const Wanted& wanted,
              const Result& result) const {
        status[i] = static_cast<std::int8_t>(result.status);
        if (result.status != Status::finished) return;
        const Observer seen(problem, result, window);
        const Status end = seen.end(problem.settings.energy_residual_limit());
        status[i] = static_cast<std::int8_t>(end);
        for (std::size_t m = 0; m < wanted.measures.size(); ++m) {
            const Measure& measure = rattlebox::measures[wanted.measures[m]];
            if (end == Status::finished || measure.of_energy_residual)
                numbers[measures + m * members + i] = measure.value(seen);
        }
        if (end == Status::finished && !wanted.batched.empty()) keep_batches(i, seen, wanted);
        const std::size_t samples = seen.count(), balls = problem.ball_mass.size();
        for (std::size_t s = 0; wanted.motion && s < samples; ++s) {
            const ModeState z = seen.point(s);
            numbers[displacement + i * samples + s] = z.q;
            numbers[velocity + i * samples + s] = z.p;
            for (std::size_t b = 0; b < balls; ++b) {
                const std::size_t at = (i * samples + s) * balls + b;
                const auto damper = static_cast<std::size_t>(problem.ball_damper[b]);
                const ModeState c = seen.along(problem.dampers[damper].shape, s);
                numbers[place + at] = positions(problem, seen.state(s))[b] - c.q;
                numbers[speed + at] = velocities(problem, seen.state(s))[b] - c.p;
            }
        }
        const std::size_t states = 2 * (problem.modes.size() + balls);
        if (wanted.state) std::copy_n(seen.state(seen.last()), states, numbers + state + i * states);
        const std::size_t known = std::min(wanted.last, result.impacts.size());
        for (std::size_t k = 0; k < known; ++k) {
            const Impact& impact = result.impacts[result.impacts.size() - known + k];
            const std::size_t at = (i + 1) * wanted.last - known + k;
            numbers[last_time + at] = impact.time;
            numbers[last_speed + at] = impact.approach_speed;
            numbers[last_contact + at] = impact.contact;
        }
    }

    void keep_batches(std::size_t i, const Observer& seen, const Wanted& wanted) const {
        const std::size_t n = seen.batches();
        for (std::size_t k = 0; k < n; ++k) {
            const std::optional<Observer> batch = seen.batch(k, n);
            if (!batch) return;
            numbers[batch_length + i * most_batches + k] = batch->length();
            for (std::size_t m = 0; m < wanted.batched.size(); ++m)
                numbers[batches + (m * members + i) * most_batches + k] =
                    rattlebox::measures[wanted.batched[m]].value(*batch);
        }
    }
};

} // namespace rattlebox
