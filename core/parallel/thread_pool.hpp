// Runs one function on several threads with barriers, or on the calling thread alone.
//
// The argument of the function is its worker: rank, number of workers, and synchronisation. Between two
// barriers no worker may read what another one writes; each worker takes a contiguous range of the items.
//
// With RATTLEBOX_THREADS=0, the default for WebAssembly, the calling thread is the only worker.
//
// Barriers: J. M. Mellor-Crummey, M. L. Scott, ACM Trans. Comput. Syst. 9 (1991) 21,
// doi:10.1145/103727.103729.
#pragma once

#ifndef RATTLEBOX_THREADS
#ifdef __wasi__
#define RATTLEBOX_THREADS 0
#else
#define RATTLEBOX_THREADS 1
#endif
#endif

#if RATTLEBOX_THREADS
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "parallel/contention.hpp"
#include "parallel/core_placement.hpp"
#endif

namespace rattlebox {

struct SingleThread {
    static constexpr int rank() { return 0; }
    static constexpr int size() { return 1; }
    static void sync() {}
    template <class Last> static void sync(Last&& last) { last(); }
    static void report() {}
    template <class Other> static void wait_for_lower(Other&&) {}
    static bool is_contended() { return false; }
    static void reset_wait_times() {}
};

#if RATTLEBOX_THREADS

// A barrier, and counters with which a worker waits for the workers of lower rank only. A phase lasts
// microseconds, so a waiting thread spins for about two microseconds, then yields its core, because the
// thread that it waits for may need it, and finally sleeps.
class Barrier {
    struct alignas(64) Reports {
        std::atomic<unsigned> number{0};
    };
    alignas(64) std::atomic<int> waiting_{0};
    alignas(64) std::atomic<unsigned> round_{0};
    alignas(64) std::vector<Reports> reports_;
    WaitTimes wait_times_; // after the spinning

    static constexpr int spins = 2000, yields = 1000;

    // Returns once is_over() is true; sleep() blocks until that is possible.
    template <class IsOver, class Sleep> void wait(int rank, IsOver&& is_over, Sleep&& sleep) {
        for (int polls = 0; polls < spins; ++polls)
            if (is_over()) return;
        const auto begun = WaitTimes::Clock::now();
        for (int polls = 0; !is_over(); ++polls)
            if (polls < yields)
                std::this_thread::yield();
            else
                sleep();
        wait_times_.add(rank, begun, WaitTimes::Clock::now());
    }

    std::atomic<unsigned>& reports(int rank) { return reports_[static_cast<std::size_t>(rank)].number; }

public:
    explicit Barrier(int size) : reports_(static_cast<std::size_t>(size)), wait_times_(size) {}

    template <class Last> void sync(int rank, Last&& last) {
        const unsigned round = round_.load(std::memory_order_relaxed);
        if (waiting_.fetch_add(1, std::memory_order_acq_rel) + 1 == static_cast<int>(reports_.size())) {
            last();
            waiting_.store(0, std::memory_order_relaxed);
            round_.store(round + 1, std::memory_order_release);
            round_.notify_all();
            return;
        }
        const auto is_over = [&] { return round_.load(std::memory_order_acquire) != round; };
        wait(rank, is_over, [&] { round_.wait(round, std::memory_order_acquire); });
    }

    void report(int rank) {
        std::atomic<unsigned>& own = reports(rank);
        own.store(own.load(std::memory_order_relaxed) + 1, std::memory_order_release);
        own.notify_all();
    }

    // Returns once all workers of lower rank have reported as often as this one. In the meantime calls
    // other(), which does one piece of work and returns false if none is left.
    template <class Other> void wait_for_lower(int rank, Other&& other) {
        const unsigned own = reports(rank).load(std::memory_order_relaxed);
        for (int r = 0; r < rank; ++r) {
            const std::atomic<unsigned>& theirs = reports(r);
            unsigned now;
            const auto is_over = [&] {
                now = theirs.load(std::memory_order_acquire);
                return static_cast<int>(now - own) >= 0;
            };
            while (!is_over() && other()) {
            }
            wait(rank, is_over, [&] { theirs.wait(now, std::memory_order_acquire); });
        }
    }

    // Whether a single thread would have been as fast in the last 20 ms. All other workers must be waiting.
    bool is_contended() { return wait_times_.dominate(WaitTimes::Clock::now()); }
    void reset_wait_times() { wait_times_.reset(WaitTimes::Clock::now()); }
};

class Worker {
    Barrier* barrier_;
    int rank_, size_;

public:
    Worker(Barrier& barrier, int rank, int size) : barrier_(&barrier), rank_(rank), size_(size) {}
    int rank() const { return rank_; }
    int size() const { return size_; }
    // Barrier. The last worker to arrive runs `last` before any continues.
    void sync() const {
        sync([] {});
    }
    template <class Last> void sync(Last&& last) const { barrier_->sync(rank_, last); }
    // Signals to workers of higher rank, once per step, that the data they need are complete.
    void report() const { barrier_->report(rank_); }
    template <class Other> void wait_for_lower(Other&& other) const {
        barrier_->wait_for_lower(rank_, other);
    }
    bool is_contended() const { return barrier_->is_contended(); }
    void reset_wait_times() const { barrier_->reset_wait_times(); }
};

// Calls work(worker) on `threads` threads, including the calling one.
template <class Work> void run_parallel(int threads, Work&& work) {
    if (threads <= 1) return work(SingleThread{});
    Barrier barrier(threads);
    const CorePlacement placement;
    std::vector<std::thread> others;
    for (int rank = 1; rank < threads; ++rank)
        others.emplace_back([&, rank] {
            placement.place(rank);
            work(Worker(barrier, rank, threads));
        });
    work(Worker(barrier, 0, threads));
    for (std::thread& t : others) t.join();
}

#else

// Calls work(worker) on the calling thread.
template <class Work> void run_parallel(int, Work&& work) { work(SingleThread{}); }

#endif

} // namespace rattlebox
