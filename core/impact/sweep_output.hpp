// Output of a batch: measures, and on request the motion, the final state and the last impacts of each
// variant.
#pragma once

#include <cstdint>

#include "impact/observer.hpp"

namespace rattlebox {

struct OutputRequest {
    std::vector<int> measures; // indices into the table of measures
    std::vector<int> batched;  // measures that are also evaluated in batches
    bool motion = false, state = false;
    std::size_t last = 0; // number of last impacts
};

// Layout of the output of all variants in one block of numbers. Arrays that were not requested are empty.
struct SweepOutput {
    std::size_t variants = 0;
    std::int8_t* status = nullptr;
    real* numbers = nullptr;
    std::size_t measures = 0;                                         // offsets in `numbers`
    std::size_t batches = 0, batch_length = 0;                        // batches one after the other
    std::size_t displacement = 0, velocity = 0, place = 0, speed = 0; // of the motion
    std::size_t state = 0, last_time = 0, last_speed = 0, last_contact = 0;

    // Sets the offsets and returns the total number of values.
    std::size_t set_layout(const Problem& problem, const Window& window, const OutputRequest& request) {
        std::size_t size = 0;
        const auto take = [&](bool needed, std::size_t each) {
            const std::size_t at = size;
            if (needed) size += variants * each;
            return at;
        };
        const std::size_t samples = static_cast<std::size_t>(window.samples),
                          balls = problem.ball_mass.size();
        measures = take(true, request.measures.size());
        batches = take(true, request.batched.size() * most_batches);
        batch_length = take(!request.batched.empty(), most_batches);
        displacement = take(request.motion, samples);
        velocity = take(request.motion, samples);
        place = take(request.motion, samples * balls);
        speed = take(request.motion, samples * balls);
        state = take(request.state, 2 * (problem.modes.size() + balls));
        last_time = take(true, request.last);
        last_speed = take(true, request.last);
        last_contact = take(true, request.last);
        return size;
    }

    void store(std::size_t i, const Problem& problem, const Window& window, const OutputRequest& request,
               const Result& result) const {
        status[i] = static_cast<std::int8_t>(result.status);
        if (result.status != Status::finished) return;
        const Observer observer(problem, result, window);
        const Status end = observer.end(problem.settings.energy_residual_limit());
        status[i] = static_cast<std::int8_t>(end);
        for (std::size_t m = 0; m < request.measures.size(); ++m) {
            const Measure<Observer>& measure = rattlebox::measures<Observer>[request.measures[m]];
            if (end == Status::finished || measure.despite_residual)
                numbers[measures + m * variants + i] = measure.value(observer);
        }
        if (end == Status::finished && !request.batched.empty()) store_batches(i, observer, request);
        const std::size_t samples = observer.count(), balls = problem.ball_mass.size();
        for (std::size_t s = 0; request.motion && s < samples; ++s) {
            const ModeState z = observer.point(s);
            numbers[displacement + i * samples + s] = z.q;
            numbers[velocity + i * samples + s] = z.p;
            for (std::size_t b = 0; b < balls; ++b) {
                const std::size_t at = (i * samples + s) * balls + b;
                const auto damper = static_cast<std::size_t>(problem.ball_damper[b]);
                const ModeState c = observer.along(problem.dampers[damper].shape, s);
                numbers[place + at] = positions(problem, observer.state(s))[b] - c.q;
                numbers[speed + at] = velocities(problem, observer.state(s))[b] - c.p;
            }
        }
        const std::size_t states = 2 * (problem.modes.size() + balls);
        if (request.state) std::copy_n(observer.state(observer.last()), states, numbers + state + i * states);
        const std::size_t known = std::min(request.last, result.impacts.size());
        for (std::size_t k = 0; k < known; ++k) {
            const Impact& impact = result.impacts[result.impacts.size() - known + k];
            const std::size_t at = (i + 1) * request.last - known + k;
            numbers[last_time + at] = impact.time;
            numbers[last_speed + at] = impact.approach_speed;
            numbers[last_contact + at] = impact.contact;
        }
    }

    void store_batches(std::size_t i, const Observer& observer, const OutputRequest& request) const {
        const std::size_t n = observer.batches();
        for (std::size_t k = 0; k < n; ++k) {
            const std::optional<Observer> batch = observer.batch(k, n);
            if (!batch) return;
            numbers[batch_length + i * most_batches + k] = batch->length();
            for (std::size_t m = 0; m < request.batched.size(); ++m)
                numbers[batches + (m * variants + i) * most_batches + k] =
                    rattlebox::measures<Observer>[request.batched[m]].value(*batch);
        }
    }
};

} // namespace rattlebox
