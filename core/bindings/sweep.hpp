// Runs the variants of a batch and returns measures of each, not their trajectories.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <memory>

#include "bindings/impact.hpp"
#include "bindings/jobs.hpp"
#include "bindings/measures.hpp"
#include "bindings/results.hpp"
#include "impact/run.hpp"
#include "impact/sweep_output.hpp"

namespace rattlebox::bindings {

using Progress = std::optional<nb::typed<nb::callable, nb::object(std::size_t)>>;

struct WindowNumbers : Node {
    Number start, period, base, residual_mass;
    Vector shape, participation;
    int samples = 0;
};

// The problem of one thread; the columns of the batch point into it.
struct Worker {
    Problem problem;
    Batch batch;
    Window window;

    Worker(const ProblemNumbers& packed, const std::vector<std::size_t>& grid, const WindowNumbers& given,
           const OutputRequest& request) {
        batch.shape = grid;
        fill_problem(problem, packed, &batch);
        Filler fill(&batch);
        fill.number(window.from, given.start);
        fill.number(window.period, given.period);
        const std::size_t components = given.shape.ndim() > 0 ? given.shape.shape(0) : 0;
        if (components > problem.modes.size())
            throw std::invalid_argument("the window has more mode shapes than the problem has modes");
        fill.vector(window.shape, given.shape, components);
        if (given.participation.ndim() > 0 && given.participation.shape(0) > 0)
            fill.vector(window.participation, given.participation, problem.modes.size());
        fill.number(window.base, given.base);
        fill.number(window.residual_mass, given.residual_mass);
        window.samples = given.samples;
        problem.settings.peaks = std::any_of(request.measures.begin(), request.measures.end(), [](int m) {
            return measures<Observer>[m].need(peaks_of_impacts);
        });
    }
    Worker(const Worker&) = delete; // columns point into it
};

// Output of the variants, one row for each; NaN if a run did not finish.
struct Block : Node {
    nb::ndarray<nb::numpy, std::int8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu> status;
    std::vector<Doubles<1>> measures;
    std::vector<Doubles<2>> batches;
    std::optional<Doubles<2>> batch_length, displacement, velocity, state, last_time, last_approach_speed,
        last_contact;
    std::optional<Doubles<3>> relative_position, relative_velocity;
    std::vector<RunResult> runs;
};

// A run with samples at times of its own, beside those of a window.
struct KeptRun {
    Result result;
    double seconds = 0;
};

// Runs a problem once, with the samples of its window and further ones at `times`, which do not affect it;
// returns the result with those of the window, and keeps the others and those at contacts.
inline Result run_and_keep(Problem& problem, const std::vector<real>& times, const std::atomic<bool>& stopped,
                           KeptRun& kept) {
    const auto from = std::chrono::steady_clock::now();
    const std::vector<real> own = problem.sample_times;
    problem.sample_times.clear();
    std::set_union(own.begin(), own.end(), times.begin(), times.end(),
                   std::back_inserter(problem.sample_times));
    kept.result = run(problem, &stopped);
    const auto has = [](const std::vector<real>& set, real t) {
        return std::binary_search(set.begin(), set.end(), t);
    };
    const Samples all = std::move(kept.result.samples);
    kept.result.samples =
        all.selected([&](std::size_t i) { return !all.given[i] || has(times, all.time[i]); });
    Result result = kept.result;
    result.samples = all.selected([&](std::size_t i) { return all.given[i] && has(own, all.time[i]); });
    if (result.status == Status::finished && result.samples.time.size() != own.size())
        throw std::runtime_error("samples of the window are missing");
    kept.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
    return result;
}

// Runs the variants start to stop of a batch; returns nothing if `progress` returned False. With `times` the
// runs themselves are returned, too, with samples at these times.
inline std::optional<Block> sweep(const ProblemNumbers& packed, const std::vector<std::size_t>& grid,
                                  std::size_t start, std::size_t stop, const WindowNumbers& window,
                                  const std::vector<std::string>& names,
                                  const std::vector<std::string>& batched, bool motion, bool state,
                                  std::size_t last, int threads, const Progress& progress,
                                  const std::optional<std::vector<real>>& times) {
    const OutputRequest outputs{measure_indices(names), measure_indices(batched), motion, state, last};
    // Each thread has a problem of its own, whose varying numbers are overwritten for each variant.
    std::vector<std::unique_ptr<Worker>> workers;
    for (int t = 0; t < threads; ++t)
        workers.push_back(std::make_unique<Worker>(packed, grid, window, outputs));
    for (const auto& worker : workers) worker->problem.settings.peaks |= times.has_value();
    SweepOutput output;
    const std::size_t n = output.variants = stop - start;
    std::vector<KeptRun> kept(times ? n : 0);
    std::vector<real> numbers(output.set_layout(workers.at(0)->problem, workers[0]->window, outputs),
                              not_a_number);
    // A variant that was not reached keeps this status and NaN.
    std::vector<std::int8_t> status(n, static_cast<std::int8_t>(Status::interrupted));
    output.numbers = numbers.data();
    output.status = status.data();
    const bool finished = run_jobs(
        // Four variants at a time: threads seldom meet at the counter, and few wait at the end.
        n, threads, 4,
        [&](std::size_t i, int thread, const std::atomic<bool>& stopped) {
            Worker& worker = *workers[static_cast<std::size_t>(thread)];
            worker.batch.apply(start + i);
            worker.window.place(worker.problem);
            output.store(i, worker.problem, worker.window, outputs,
                         times ? run_and_keep(worker.problem, *times, stopped, kept[i])
                               : run(worker.problem, &stopped));
        },
        [&](std::size_t done) { return !progress || !(*progress)(done).is(nb::bool_(false)); });
    if (!finished) return {};
    const auto part = [&]<std::size_t axes>(const std::size_t (&shape)[axes], std::size_t first) {
        std::size_t size = 1;
        for (const std::size_t length : shape) size *= length;
        const auto* from = numbers.data() + first;
        return owned<Doubles<static_cast<int>(axes)>>(std::vector<real>(from, from + size),
                                                      {shape, shape + axes});
    };
    const std::size_t samples = static_cast<std::size_t>(workers[0]->window.samples),
                      balls = workers[0]->problem.ball_mass.size(), modes = workers[0]->problem.modes.size();
    Block block;
    block.status = owned<decltype(block.status)>(std::move(status));
    for (std::size_t m = 0; m < outputs.measures.size(); ++m)
        block.measures.push_back(part({n}, output.measures + m * n));
    for (std::size_t m = 0; m < outputs.batched.size(); ++m)
        block.batches.push_back(part({n, most_batches}, output.batches + m * n * most_batches));
    if (!outputs.batched.empty()) block.batch_length = part({n, most_batches}, output.batch_length);
    if (motion) {
        block.displacement = part({n, samples}, output.displacement);
        block.velocity = part({n, samples}, output.velocity);
        block.relative_position = part({n, samples, balls}, output.place);
        block.relative_velocity = part({n, samples, balls}, output.speed);
    }
    if (state) block.state = part({n, 2 * (modes + balls)}, output.state);
    if (last > 0) {
        block.last_time = part({n, last}, output.last_time);
        block.last_approach_speed = part({n, last}, output.last_speed);
        block.last_contact = part({n, last}, output.last_contact);
    }
    for (KeptRun& one : kept)
        block.runs.emplace_back(workers[0]->problem, std::move(one.result), one.seconds);
    return block;
}

inline void add_sweep(nb::module_& module) {
    using W = WindowNumbers;
    define<W>(
        module, "Window",
        "Equally spaced samples of each run from `start` to its end, in cycles of `period`, at a point with "
        "these mode shapes, which moves with the base if `base` is 1; the participation and the residual "
        "mass "
        "give the force on the base.",
        field("start", &W::start), field("period", &W::period), field("shape", &W::shape),
        field("base", &W::base), field("participation", &W::participation),
        field("residual_mass", &W::residual_mass), field("samples", &W::samples));
    using B = Block;
    define<B>(module, "Block", "Output of the variants of a batch, one row for each.",
              field("status", &B::status), field("measures", &B::measures), field("batches", &B::batches),
              field("batch_length", &B::batch_length), field("displacement", &B::displacement),
              field("velocity", &B::velocity), field("relative_position", &B::relative_position),
              field("relative_velocity", &B::relative_velocity), field("state", &B::state),
              field("last_time", &B::last_time), field("last_approach_speed", &B::last_approach_speed),
              field("last_contact", &B::last_contact), field("runs", &B::runs));
    module.def(
        "sweep", &sweep, nb::arg("problem"), nb::arg("grid"), nb::arg("start"), nb::arg("stop"),
        nb::arg("window"), nb::arg("measures"), nb::arg("batched") = std::vector<std::string>(),
        nb::arg("motion") = false, nb::arg("state") = false, nb::arg("last") = 0, nb::arg("threads") = 1,
        nb::arg("progress") = nb::none(), nb::arg("times") = nb::none(),
        "Run the variants start to stop of a batch over a grid and return their output; None if `progress` "
        "returned False. With `times` the output holds the runs, too, with samples at these times.");
}

} // namespace rattlebox::bindings
