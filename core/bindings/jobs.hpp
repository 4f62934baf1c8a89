// Runs jobs on several threads without the GIL, while the calling thread checks for Ctrl-C.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace rattlebox::bindings {

namespace nb = nanobind;

// Calls job(i, thread, stop) for i in 0..count, `chunk` at a time on one thread. Every 20 ms
// should_continue(finished jobs) is called with the GIL held; if it returns false, or after Ctrl-C, `stop` is
// set and the remaining jobs are skipped. Returns whether all jobs ran.
template <class Job, class ShouldContinue>
bool run_jobs(std::size_t count, int threads, std::size_t chunk, Job&& job,
              ShouldContinue&& should_continue) {
    std::atomic<bool> stop{false};
    std::atomic<std::size_t> next{0}, done{0};
    std::mutex mutex;
    std::condition_variable over;
    std::exception_ptr error;
    // The calling thread runs no job: it holds the interpreter, and only it may check for Ctrl-C and call
    // Python.
    int working = threads;
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t)
        pool.emplace_back([&, t] {
            try {
                // Jobs differ in cost by orders of magnitude, so that they are fetched, not divided in
                // advance.
                for (std::size_t i; !stop && (i = next.fetch_add(chunk)) < count;)
                    for (std::size_t k = i; k < std::min(i + chunk, count) && !stop; ++k, ++done)
                        job(k, t, stop);
            } catch (...) {
                const std::lock_guard lock(mutex);
                error = std::current_exception();
                stop = true;
            }
            const std::lock_guard lock(mutex);
            --working;
            over.notify_all();
        });
    bool stopped = false;
    for (bool finished = false; !finished;) {
        {
            nb::gil_scoped_release unlocked;
            // Without the GIL while waiting: other threads of the program run, and end the wait at once when
            // the work is done.
            std::unique_lock lock(mutex);
            finished = over.wait_for(lock, std::chrono::milliseconds(20), [&] { return working == 0; });
        }
        // After a stop, workers need a moment to see it; they are waited for without asking again.
        if (finished || stopped) continue;
        try {
            if (PyErr_CheckSignals() != 0) throw nb::python_error();
            stopped = !should_continue(done.load());
        } catch (...) {
            const std::lock_guard lock(mutex);
            error = std::current_exception();
            stopped = true;
        }
        if (stopped) stop = true;
    }
    for (std::thread& t : pool) t.join();
    if (error) std::rethrow_exception(error);
    return !stopped;
}

} // namespace rattlebox::bindings
