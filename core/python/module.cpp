// The door between Python and the core: problems in, results out, Ctrl-C heard while threads work.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/dem.hpp"
#include "python/laws.hpp"
#include "python/sweep.hpp"

namespace nb = nanobind;
using namespace rattlebox;

namespace {

struct Job {
    Problem problem;
    Result result;
    double seconds = 0;
    bool begun = false;
};

// Runs all problems on `threads` threads. Each result is computed by one thread alone: the same bits for any
// number. Ctrl-C ends the runs in progress with a status of their own.
nb::list simulate(const nb::list& problems, int threads) {
    std::vector<Job> jobs(problems.size());
    for (std::size_t i = 0; i < jobs.size(); ++i)
        door::Reader(jobs[i].problem, nullptr).problem(nb::cast<nb::dict>(problems[i]));
    const auto work = [&](std::size_t i, int, const std::atomic<bool>& stop) {
        const auto from = std::chrono::steady_clock::now();
        jobs[i].begun = true;
        jobs[i].result = run(jobs[i].problem, &stop);
        jobs[i].seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
    };
    try {
        door::work_off(jobs.size(), threads, 1, work, [](std::size_t) { return true; });
    } catch (nb::python_error& error) {
        if (!error.matches(PyExc_KeyboardInterrupt)) throw;
    }
    nb::list results;
    for (Job& job : jobs) {
        if (!job.begun) job.result.status = Status::interrupted;
        results.append(door::write(job.problem, std::move(job.result), job.seconds));
    }
    return results;
}

} // namespace

NB_MODULE(RATTLEBOX_MODULE, module) {
    module.doc() = "Rattlebox core";
    module.attr("worst_closure") = worst_closure;
    module.attr("speed_at_rest") = speed_at_rest;
    module.def("simulate", &simulate, nb::arg("problems"), nb::arg("threads") = 1,
               "Run packed problems (see rattlebox/engines/pack.py) and return their results.");
    module.def("sweep", &door::sweep, nb::arg("problem"), nb::arg("shape"), nb::arg("start"), nb::arg("stop"),
               nb::arg("measures"), nb::arg("window"), nb::arg("motion") = false, nb::arg("state") = false,
               nb::arg("last") = 0, nb::arg("threads") = 1, nb::arg("progress") = nb::none(),
               "Run members start to stop of a batch and keep measures of them, not their trajectories.");
    module.def(
        "measures",
        [] {
            nb::dict names;
            for (const Measure& m : measures) names[m.name] = m.samples;
            return names;
        },
        "Names of the measures, and whether each needs samples of the motion.");
    door::add_laws(module);
    door::add_dem(module);
}
