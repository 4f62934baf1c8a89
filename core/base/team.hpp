// Who does the work of a phase: one thread alone, or several that wait for each other between phases.
//
// A phase is a loop over items none of which reads what another writes; each member of a team takes a
// contiguous share.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "base/cores.hpp"
#include "base/waits.hpp"

namespace rattlebox {

struct Alone {
    static constexpr int rank() { return 0; }
    static constexpr int size() { return 1; }
    static void sync() {}
    template <class Last> static void sync(Last&& last) { last(); }
    static void report() {}
    template <class Other> static void await_lower(Other&&) {}
    static bool is_held_up() { return false; }
    static void forget_waits() {}
};

// Where the members of a team wait for each other.
class Meetingpoint {
    struct alignas(64) Reports {
        std::atomic<unsigned> number{0};
    };
    alignas(64) std::atomic<int> waiting_{0};
    alignas(64) std::atomic<unsigned> round_{0};
    alignas(64) std::vector<Reports> reports_;
    Waits waits_; // beyond the first moments

    // A phase lasts microseconds, worth spinning for. Who waits longer lets others have the core, since what
    // it waits for may be among them, and sleeps in the end, to be woken where a core is free.
    static constexpr int spins = 2000, yields = 1000;

    // Until is_over() or sleep() has brought what is waited for.
    template <class IsOver, class Sleep> void wait(int rank, IsOver&& is_over, Sleep&& sleep) {
        for (int looks = 0; looks < spins; ++looks)
            if (is_over()) return;
        const auto begun = Waits::Clock::now();
        for (int looks = 0; !is_over(); ++looks)
            if (looks < yields)
                std::this_thread::yield();
            else
                sleep();
        waits_.add(rank, begun, Waits::Clock::now());
    }

    std::atomic<unsigned>& reports(int rank) { return reports_[static_cast<std::size_t>(rank)].number; }

public:
    explicit Meetingpoint(int size) : reports_(static_cast<std::size_t>(size)), waits_(size) {}

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

    // All lower members have reported as often as this one; until then it works on something other, while
    // there is some.
    template <class Other> void await_lower(int rank, Other&& other) {
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

    // Whether members have waited so long of late that one alone would have been as fast: other programs have
    // their cores. For one that all others wait for.
    bool is_held_up() { return waits_.are_a_habit(Waits::Clock::now()); }
    void forget_waits() { waits_.forget(Waits::Clock::now()); }
};

class Member {
    Meetingpoint* point_;
    int rank_, size_;

public:
    Member(Meetingpoint& point, int rank, int size) : point_(&point), rank_(rank), size_(size) {}
    int rank() const { return rank_; }
    int size() const { return size_; }
    // All have come so far; the last to come does what is to be done before any goes on.
    void sync() const {
        sync([] {});
    }
    template <class Last> void sync(Last&& last) const { point_->sync(rank_, last); }
    // Tells those of higher rank, in each round, that they may use what this member has done.
    void report() const { point_->report(rank_); }
    template <class Other> void await_lower(Other&& other) const { point_->await_lower(rank_, other); }
    bool is_held_up() const { return point_->is_held_up(); }
    void forget_waits() const { point_->forget_waits(); }
};

// Calls work(member) on `threads` threads, this one among them.
template <class Work> void together(int threads, Work&& work) {
    if (threads <= 1) return work(Alone{});
    Meetingpoint point(threads);
    const Cores cores;
    std::vector<std::thread> others;
    for (int rank = 1; rank < threads; ++rank)
        others.emplace_back([&, rank] {
            cores.begin(rank);
            work(Member(point, rank, threads));
        });
    work(Member(point, 0, threads));
    for (std::thread& t : others) t.join();
}

} // namespace rattlebox
