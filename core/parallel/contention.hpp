// Detection of contention: the time that workers wait at barriers, and whether a single thread would be as
// fast.
//
// When other programs use the cores, each barrier waits for the scheduler. The waiting times of all workers
// are summed over 20 ms. If the sum reaches the time of all workers but one, the run continues on one thread
// for a while (core/dem/simulation.hpp, SerialFallback). Measured with 1000 particles on two cores shared
// with eight busy processes: 1.09 times as long without it (quartiles 0.94 to 1.30); with 100 000, or on idle
// cores, no difference.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <vector>

namespace rattlebox {

class WaitTimes {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    explicit WaitTimes(int workers, Time now = Clock::now())
        : waited_(static_cast<std::size_t>(workers)), since_(now) {}

    // Adds one wait of a worker. Time before the last reset does not count, because a wait of a preempted
    // worker ends after the waits that it caused have been counted.
    void add(int rank, Time begun, Time ended) {
        waited_[static_cast<std::size_t>(rank)].sum.fetch_add((ended - std::max(begun, since_)).count(),
                                                              std::memory_order_relaxed);
    }

    // Returns whether waiting dominated since the last reset, and resets after 20 ms. All other workers must
    // be waiting.
    bool dominate(Time now) {
        constexpr Clock::duration short_term =
            std::chrono::milliseconds(20); // one preemption is not contention
        if (now - since_ < short_term) return false;
        const bool all_the_time = sum() >= static_cast<int>(waited_.size() - 1) * (now - since_);
        reset(now);
        return all_the_time;
    }

    void reset(Time now) {
        for (Sum& w : waited_) w.sum.store(0, std::memory_order_relaxed);
        since_ = now;
    }

private:
    struct alignas(64) Sum {
        std::atomic<Clock::rep> sum{0};
    };
    std::vector<Sum> waited_;
    Time since_; // written while all other workers wait

    Clock::duration sum() const {
        Clock::rep total = 0;
        for (const Sum& w : waited_) total += w.sum.load(std::memory_order_relaxed);
        return Clock::duration(total);
    }
};

} // namespace rattlebox
