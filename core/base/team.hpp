// Who does the work of a phase: one thread alone, or several that wait for each other between phases.
//
// A phase is a loop over items none of which reads what another writes; each member of a team takes a
// contiguous share.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace rattlebox {

// Where the share of a member begins; that of the next one is its end.
inline int share(int items, int rank, int size) {
    return static_cast<int>(static_cast<long long>(items) * rank / size);
}

struct Alone {
    static constexpr int rank() { return 0; }
    static constexpr int size() { return 1; }
    static constexpr bool leads() { return true; }
    static void sync() {}
};

class Meetingpoint {
    std::atomic<int> waiting_{0};
    std::atomic<unsigned> round_{0};
    const int size_;

public:
    explicit Meetingpoint(int size) : size_(size) {}

    void wait() {
        const unsigned round = round_.load(std::memory_order_relaxed);
        if (waiting_.fetch_add(1, std::memory_order_acq_rel) + 1 == size_) {
            waiting_.store(0, std::memory_order_relaxed);
            round_.store(round + 1, std::memory_order_release);
            return;
        }
        // A phase lasts microseconds: worth spinning for, but not where others want the core.
        for (int spins = 0; round_.load(std::memory_order_acquire) == round; ++spins)
            if (spins > 4000) std::this_thread::yield();
    }
};

class Member {
    Meetingpoint* point_;
    int rank_, size_;

public:
    Member(Meetingpoint& point, int rank, int size) : point_(&point), rank_(rank), size_(size) {}
    int rank() const { return rank_; }
    int size() const { return size_; }
    bool leads() const { return rank_ == 0; }
    void sync() const { point_->wait(); }
};

// Calls work(member) on `threads` threads, this one among them.
template <class Work> void together(int threads, Work&& work) {
    if (threads <= 1) return work(Alone{});
    Meetingpoint point(threads);
    std::vector<std::thread> others;
    for (int rank = 1; rank < threads; ++rank)
        others.emplace_back([&, rank] { work(Member(point, rank, threads)); });
    work(Member(point, 0, threads));
    for (std::thread& t : others) t.join();
}

} // namespace rattlebox
