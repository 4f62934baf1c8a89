// The door between Python and the core: problems in, results out, Ctrl-C heard while threads work.

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "impact/run.hpp"
#include "python/read.hpp"
#include "python/write.hpp"

namespace nb = nanobind;
using namespace rattlebox;

namespace {

struct Job {
    Problem problem;
    Result result;
    double seconds = 0;
    bool begun = false;
    std::exception_ptr error;
};

void work(Job& job, const std::atomic<bool>& stop) {
    const auto from = std::chrono::steady_clock::now();
    job.begun = true;
    try {
        job.result = run(job.problem, &stop);
    } catch (...) {
        job.error = std::current_exception();
    }
    job.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
}

// Runs all problems on `threads` threads. Each result is computed by one thread alone: the same bits for any
// number.
nb::list simulate(const nb::list& problems, int threads) {
    std::vector<Job> jobs(problems.size());
    for (std::size_t i = 0; i < jobs.size(); ++i)
        door::read(jobs[i].problem, nb::cast<nb::dict>(problems[i]));

    std::atomic<bool> stop{false};
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::condition_variable done;
    int working = threads;
    bool interrupted = false;
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t)
        pool.emplace_back([&] {
            for (std::size_t i; !stop && (i = next++) < jobs.size();) work(jobs[i], stop);
            const std::lock_guard lock(mutex);
            --working;
            done.notify_all();
        });
    for (bool finished = false; !finished;) {
        {
            nb::gil_scoped_release unlocked;
            std::unique_lock lock(mutex);
            finished = done.wait_for(lock, std::chrono::milliseconds(50), [&] { return working == 0; });
        }
        if (!finished && !interrupted && PyErr_CheckSignals() != 0) {
            PyErr_Clear();
            interrupted = true;
            stop = true;
        }
    }
    for (std::thread& t : pool) t.join();

    nb::list results;
    for (Job& job : jobs) {
        if (job.error) std::rethrow_exception(job.error);
        if (!job.begun) job.result.status = Status::interrupted;
        results.append(door::write(job.problem, std::move(job.result), job.seconds));
    }
    return results;
}

// Restitution of a packed law at each speed; not a number beyond it.
nb::object restitution(const nb::dict& law, const door::Array& speeds) {
    Problem storage;
    storage.tables.reserve(2);
    RestitutionLaw choice;
    door::choose(choice, law, storage);
    std::vector<real> values;
    for (std::size_t i = 0; i < speeds.shape(0); ++i) {
        const Rebound r = rebound(choice, speeds.data()[i]);
        values.push_back(r.outside ? not_a_number : r.e);
    }
    return door::array(std::move(values));
}

} // namespace

NB_MODULE(RATTLEBOX_MODULE, module) {
    module.doc() = "Rattlebox core";
    module.def("simulate", &simulate, nb::arg("problems"), nb::arg("threads") = 1,
               "Run packed problems (see rattlebox/engines/pack.py) and return their results.");
    module.def("restitution", &restitution, nb::arg("law"), nb::arg("speeds"));
}
