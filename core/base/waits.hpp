// How long the members of a team wait for each other, and whether one alone would have been as fast.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <vector>

namespace rattlebox {

class Waits {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    explicit Waits(int members, Time now = Clock::now())
        : waited_(static_cast<std::size_t>(members)), since_(now) {}

    // A member has waited. What it waited before the count began anew counts no more: the core of one may be
    // taken away in a wait, and while another waits for that one the wait of the first ends.
    void add(int rank, Time begun, Time ended) {
        waited_[static_cast<std::size_t>(rank)].sum.fetch_add((ended - std::max(begun, since_)).count(),
                                                              std::memory_order_relaxed);
    }

    // For one that all others wait for.
    bool are_a_habit(Time now) {
        constexpr Clock::duration short_term = std::chrono::milliseconds(20); // single halts are no habit
        if (now - since_ < short_term) return false;
        const bool all_the_time = sum() >= static_cast<int>(waited_.size() - 1) * (now - since_);
        forget(now);
        return all_the_time;
    }

    // The count begins anew.
    void forget(Time now) {
        for (Sum& w : waited_) w.sum.store(0, std::memory_order_relaxed);
        since_ = now;
    }

private:
    struct alignas(64) Sum {
        std::atomic<Clock::rep> sum{0};
    };
    std::vector<Sum> waited_;
    Time since_; // written while all others wait

    Clock::duration sum() const {
        Clock::rep total = 0;
        for (const Sum& w : waited_) total += w.sum.load(std::memory_order_relaxed);
        return Clock::duration(total);
    }
};

} // namespace rattlebox
