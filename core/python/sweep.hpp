// Runs the members of a batch and keeps of each only what was asked for.
#pragma once

#include <algorithm>
#include <atomic>
#include <memory>

#include "impact/batch.hpp"
#include "impact/member.hpp"
#include "impact/run.hpp"
#include "python/crew.hpp"
#include "python/read.hpp"
#include "python/write.hpp"

namespace rattlebox::door {

// One thread's own problem, which its columns write into.
struct Worker {
    Problem problem;
    Batch batch;
    Window window;

    Worker(const nb::dict& packed, const std::vector<std::size_t>& shape, const nb::dict& look,
           const Wanted& wanted) {
        batch.shape = shape;
        Reader reader(problem, &batch);
        reader.problem(packed);
        reader.number(window.from, look, "from");
        reader.number(window.period, look, "period");
        reader.vector(window.shape, look["shape"]);
        window.samples = nb::cast<int>(look["samples"]);
        problem.settings.peaks = std::any_of(wanted.measures.begin(), wanted.measures.end(),
                                             [](int m) { return measures[m].peaks; });
    }
    Worker(const Worker&) = delete; // columns point into it
};

// One array of the block of numbers that is kept.
struct Named {
    const char* name;
    std::size_t at;
    std::vector<std::size_t> shape;
};

inline std::vector<Named> arrays(const Kept& kept, const Worker& worker, const Wanted& wanted) {
    const std::size_t n = kept.members, samples = static_cast<std::size_t>(worker.window.samples),
                      balls = worker.problem.ball_mass.size();
    std::vector<Named> found;
    for (std::size_t m = 0; m < wanted.measures.size(); ++m)
        found.push_back({measures[wanted.measures[m]].name, kept.measures + m * n, {n}});
    if (wanted.motion) {
        found.push_back({"displacement", kept.displacement, {n, samples}});
        found.push_back({"velocity", kept.velocity, {n, samples}});
        found.push_back({"ball_place", kept.place, {n, samples, balls}});
        found.push_back({"ball_speed", kept.speed, {n, samples, balls}});
    }
    if (wanted.state) found.push_back({"state", kept.state, {n, 2 * (worker.problem.modes.size() + balls)}});
    if (wanted.last > 0) {
        found.push_back({"last_time", kept.last_time, {n, wanted.last}});
        found.push_back({"last_approach_speed", kept.last_speed, {n, wanted.last}});
        found.push_back({"last_contact", kept.last_contact, {n, wanted.last}});
    }
    return found;
}

inline Wanted wanted(const std::vector<std::string>& names, bool motion, bool state, std::size_t last) {
    Wanted found{{}, motion, state, last};
    for (const std::string& name : names) {
        int number = -1;
        for (int m = 0; m < static_cast<int>(std::size(measures)); ++m)
            if (name == measures[m].name) number = m;
        if (number < 0) throw std::invalid_argument("the core has no measure named '" + name + "'");
        found.measures.push_back(number);
    }
    return found;
}

// Members start to stop of a batch; None when `progress` has answered False.
inline nb::object sweep(const nb::dict& packed, const std::vector<std::size_t>& shape, std::size_t start,
                        std::size_t stop, const std::vector<std::string>& names, const nb::dict& window,
                        bool motion, bool state, std::size_t last, int threads, const nb::object& progress) {
    const Wanted keep = wanted(names, motion, state, last);
    std::vector<std::unique_ptr<Worker>> workers;
    for (int t = 0; t < threads; ++t)
        workers.push_back(std::make_unique<Worker>(packed, shape, window, keep));
    Kept kept;
    kept.members = stop - start;
    std::vector<real> numbers(kept.lay(workers.at(0)->problem, workers[0]->window, keep), not_a_number);
    std::vector<std::int8_t> status(kept.members, static_cast<std::int8_t>(Status::interrupted));
    kept.numbers = numbers.data();
    kept.status = status.data();
    const bool whole = work_off(
        stop - start, threads, 4,
        [&](std::size_t i, int thread, const std::atomic<bool>& stopped) {
            Worker& worker = *workers[static_cast<std::size_t>(thread)];
            worker.batch.apply(start + i);
            worker.window.place(worker.problem);
            kept.keep(i, worker.problem, worker.window, keep, run(worker.problem, &stopped));
        },
        [&](std::size_t done) { return progress.is_none() || !progress(done).is(nb::bool_(false)); });
    if (!whole) return nb::none();
    nb::dict d;
    d["status"] = array(std::move(status));
    for (const Named& a : arrays(kept, *workers[0], keep)) {
        const auto* from = numbers.data() + a.at;
        std::size_t size = 1;
        for (std::size_t length : a.shape) size *= length;
        d[a.name] = array(std::vector<real>(from, from + size), a.shape);
    }
    return d;
}

} // namespace rattlebox::door
