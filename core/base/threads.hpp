// Teams of threads of the processor for work in phases, which take their items in orders that are asked for:
// a phase whose items depend on each other is a mistake that some order shows.
#pragma once

#include <atomic>
#include <numeric>

#include "base/phases.hpp"
#include "base/team.hpp"

namespace rattlebox {

// Where the share of a member begins; that of the next one is its end.
inline int share(int items, int rank, int size) {
    return static_cast<int>(static_cast<long long>(items) * rank / size);
}

enum class Order : int { forward, reverse, interleaved, shuffled };

template <class Member> class Phased {
    const Member* member_;
    Order order_;
    unsigned phase_ = 0; // the same for all members

    // The k-th of n items.
    struct Path {
        long long n, from, step;
        int operator()(int k) const { return static_cast<int>((from + step * k) % n); }
    };

    Path path(int n, unsigned phase) const {
        if (order_ == Order::reverse) return {n, n - 1, n - 1};
        if (order_ != Order::shuffled) return {n, 0, 1};
        const unsigned mixed = (phase + 1) * 2654435761u;
        long long step = mixed % static_cast<unsigned>(n) | 1u;
        while (std::gcd(step, static_cast<long long>(n)) != 1) ++step;
        return {n, mixed / 7 % static_cast<unsigned>(n), step % n};
    }

public:
    Phased(const Member& member, Order order) : member_(&member), order_(order) {}

    template <class F> void each(int n, F&& f) {
        ++phase_;
        if (n <= 0) return;
        const Path item = path(n, phase_);
        if (order_ == Order::interleaved) {
            for (int k = member_->rank(); k < n; k += member_->size()) f(k);
            return;
        }
        const int to = share(n, member_->rank() + 1, member_->size());
        for (int k = share(n, member_->rank(), member_->size()); k < to; ++k) f(item(k));
    }

    template <class T, class F> void reduce(int n, T* part, F&& f) {
        each(trees(n), [&](int g) {
            T leaves[tree_width]{};
            const int begin = g * tree_width, count = n - begin < tree_width ? n - begin : tree_width;
            const Path leaf = path(count, phase_);
            for (int k = 0; k < count; ++k) leaves[leaf(k)] = f(begin + leaf(k));
            part[g] = tree(leaves);
        });
    }

    template <class T> T total(int n, T* part) const { return total_of(n, part); }

    void sync() const { member_->sync(); }
    bool leads() const { return member_->rank() == 0; }
    static constexpr bool first() { return true; }

    static int count(int& number) {
        return std::atomic_ref<int>(number).fetch_add(1, std::memory_order_relaxed);
    }
    static void least(int& number, int value) {
        std::atomic_ref<int> shared(number);
        int now = shared.load(std::memory_order_relaxed);
        while (value < now && !shared.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
        }
    }
};

} // namespace rattlebox
