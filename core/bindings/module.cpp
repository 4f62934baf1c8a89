// The Python module of the core.

#include <chrono>

#include "bindings/dem.hpp"
#include "bindings/linearise.hpp"
#include "bindings/sweep.hpp"

namespace {

namespace nb = nanobind;
using namespace rattlebox;

struct Job {
    Problem problem;
    Result result;
    double seconds = 0;
    bool begun = false;
};

// Runs all problems on `threads` threads. Each result is computed by a single thread, so that the bits do not
// depend on their number. Ctrl-C, or a `progress` that returns False, ends the current runs with status
// `interrupted`.
std::vector<bindings::RunResult> simulate(const std::vector<bindings::ProblemNumbers>& problems, int threads,
                                          const bindings::Progress& progress) {
    std::vector<Job> jobs(problems.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) bindings::fill_problem(jobs[i].problem, problems[i]);
    const auto work = [&](std::size_t i, int, const std::atomic<bool>& stop) {
        const auto from = std::chrono::steady_clock::now();
        jobs[i].begun = true;
        jobs[i].result = run(jobs[i].problem, &stop);
        jobs[i].seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
    };
    try {
        bindings::run_jobs(jobs.size(), threads, 1, work, [&](std::size_t done) {
            return !progress || !(*progress)(done).is(nb::bool_(false));
        });
    } catch (nb::python_error& error) {
        if (!error.matches(PyExc_KeyboardInterrupt)) throw;
    }
    std::vector<bindings::RunResult> results;
    const std::atomic<bool> stopped{true};
    for (Job& job : jobs) {
        if (!job.begun) job.result = run(job.problem, &stopped); // the state at the start
        results.emplace_back(job.problem, std::move(job.result), job.seconds);
    }
    return results;
}

} // namespace

NB_MODULE(RATTLEBOX_MODULE, module) {
    nb::set_leak_warnings(false); // tracebacks and caches keep objects until the interpreter ends
    module.doc() = "The compiled core of Rattlebox.";
    bindings::add_node(module);
    bindings::add_laws(module);
    bindings::add_structure(module);
    bindings::add_problem(module);
    bindings::add_results(module);
    bindings::add_measures(module);
    bindings::add_sweep(module);
    bindings::add_linearise(module);
    bindings::add_dem(module);
    module.attr("worst_energy_residual") = worst_energy_residual;
    module.attr("energy_at_rest") = energy_at_rest;
    module.attr("speed_at_rest") = speed_at_rest;
    module.def(
        "simulate", &simulate, nb::arg("problems"), nb::arg("threads") = 1, nb::arg("progress") = nb::none(),
        "Run problems of the 1-D engine and return their results. `progress` is called with the number of "
        "finished runs; False stops.");
}
