// Work in phases over single items, for teams as wide as there are items.
//
// Within a phase no item reads what another one writes, so that any order of items and any number of members
// give the same bits. Sums are trees of 32, of 32 such trees, and so on, whoever adds them up; what members
// count together are whole numbers, whose sum and smallest do not depend on the order either.
//
// A team has
//     each(n, f)            calls f(i) for all i below n, each once
//     reduce(n, part, f)    likewise, and part[g] becomes the tree of f(32 g) ... f(32 g + 31)
//     total(n, part)        of a reduce, after a sync; the leaders call it, all of them
//     sync()                all that was written is there to be read
//     leads(), first()      one of the leaders; that one of them which does what is done once
//     count(x), least(x, v) adds 1 to x and returns what it was; makes x at most v
#pragma once

#include "base/real.hpp"

namespace rattlebox {

// Of what happens now and then: it keeps its registers to itself.
#ifdef __CUDACC__
#define RATTLEBOX_COLD __noinline__
#else
#define RATTLEBOX_COLD
#endif

inline constexpr int tree_width = 32;

inline int trees(int items) { return (items + tree_width - 1) / tree_width; }

// Room for the trees of so many items, of these trees, and so on.
inline int tree_room(int items) {
    int room = 0;
    do room += items = trees(items);
    while (items > 1);
    return room;
}

// A sum is a structure of numbers only; T::join(k, a, b) says what the k-th of one and of another come to.
template <class T> inline constexpr int numbers_of = sizeof(T) / sizeof(real);

template <class T> const T& tree(T* leaves) {
    for (int half = tree_width / 2; half > 0; half /= 2)
        for (int l = 0; l < half; ++l) {
            real* own = reinterpret_cast<real*>(leaves + l);
            const real* other = reinterpret_cast<const real*>(leaves + l + half);
            for (int k = 0; k < numbers_of<T>; ++k) own[k] = T::join(k, own[k], other[k]);
        }
    return leaves[0];
}

// The trees above those of a reduce, by one member.
template <class T> T total_of(int n, T* part) {
    for (int count = trees(n); count > 1; count = trees(count)) {
        T* above = part + count;
        for (int g = 0; g < trees(count); ++g) {
            T leaves[tree_width]{};
            for (int l = 0; l < tree_width && g * tree_width + l < count; ++l)
                leaves[l] = part[g * tree_width + l];
            above[g] = tree(leaves);
        }
        part = above;
    }
    return part[0];
}

// Of more trees than these, all of a team make the next ones.
inline constexpr int few_trees = 1024;

// What a reduce has left for the leaders to sum up: trees of trees, until they are few. All of the team call
// it.
template <class T> struct Summed {
    int items;
    T* part;
};
template <class T, class Team> Summed<T> sum_up(Team& team, int n, T* part) {
    while (trees(n) > few_trees) {
        const T* below = part;
        n = trees(n), part += n;
        team.reduce(n, part, [&](int g) { return below[g]; });
        team.sync();
    }
    return {n, part};
}

// A team of one.
struct One {
    template <class F> void each(int n, F&& f) const {
        for (int i = 0; i < n; ++i) f(i);
    }
    template <class T, class F> void reduce(int n, T* part, F&& f) const {
        for (int g = 0; g < trees(n); ++g) {
            T leaves[tree_width]{};
            for (int l = 0; l < tree_width && g * tree_width + l < n; ++l) leaves[l] = f(g * tree_width + l);
            part[g] = tree(leaves);
        }
    }
    template <class T> T total(int n, T* part) const { return total_of(n, part); }
    static void sync() {}
    static constexpr bool leads() { return true; }
    static constexpr bool first() { return true; }
    static int count(int& number) { return number++; }
    static void least(int& number, int value) { number = value < number ? value : number; }
};

inline int lowest_bit(unsigned bits) {
#ifdef __CUDACC__
    return __ffs(static_cast<int>(bits)) - 1;
#else
    return __builtin_ctz(bits);
#endif
}

// The number of integers that one member adds up in a scan, and of members that do.
inline int scan_length(int items) {
    int length = 16;
    while (length < items / length) length *= 2;
    return length;
}
inline int scan_parts(int items) { return (items + scan_length(items) - 1) / scan_length(items); }

// numbers[i] becomes the sum of those before it, and numbers[n] that of all. `part` has room for scan_parts.
template <class Team> void scan(Team& team, int n, int* numbers, int* part) {
    const int length = scan_length(n), parts = scan_parts(n);
    const auto end = [&](int p) { return (p + 1) * length < n ? (p + 1) * length : n; };
    team.each(parts, [&](int p) {
        int sum = 0;
        for (int i = p * length; i < end(p); ++i) sum += numbers[i];
        part[p] = sum;
    });
    team.sync();
    if (team.leads() && team.first()) {
        int sum = 0;
        for (int p = 0; p < parts; ++p) {
            const int own = part[p];
            part[p] = sum;
            sum += own;
        }
        numbers[n] = sum;
    }
    team.sync();
    team.each(parts, [&](int p) {
        int sum = part[p];
        for (int i = p * length; i < end(p); ++i) {
            const int own = numbers[i];
            numbers[i] = sum;
            sum += own;
        }
    });
    team.sync();
}

} // namespace rattlebox
