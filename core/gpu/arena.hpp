// Memory of one thread, which its vectors share: taken from one end, given back from there too.
//
// A kernel puts a block of its own local memory here, which the hardware lays out so that neighbouring
// threads read neighbouring addresses, and a share of the card's memory for what does not fit into it.
#pragma once

#include <cstddef>

#include "base/real.hpp"

namespace rattlebox::gpu {

struct Stretch {
    char *first = nullptr, *next = nullptr, *end = nullptr;

    void* take(std::size_t bytes) {
        if (static_cast<std::size_t>(end - next) < bytes) return nullptr;
        char* taken = next;
        next += bytes;
        return taken;
    }
    bool give_back(char* p, std::size_t bytes) {
        if (p < first || p >= end) return false;
        if (p + bytes == next) next = p; // what lies below others stays until these are given back
        return true;
    }
};

struct Arena {
    static constexpr std::size_t grain = 64; // all begin at a multiple of it
    Stretch near, far;

    static std::size_t rounded(std::size_t bytes) { return (bytes + grain - 1) / grain * grain; }

    RATTLEBOX_CALL void* take(std::size_t bytes) {
        bytes = rounded(bytes);
        // The near part is for what is often looked at, not for samples.
        const bool large = bytes > static_cast<std::size_t>(near.end - near.first) / 4;
        void* p = large ? far.take(bytes) : near.take(bytes);
        if (!p) p = large ? near.take(bytes) : far.take(bytes);
        if (!p) exhausted();
        return p;
    }
    RATTLEBOX_CALL void give_back(void* p, std::size_t bytes) {
        char* from = static_cast<char*>(p);
        if (!near.give_back(from, rounded(bytes))) far.give_back(from, rounded(bytes));
    }

private:
    // The need was reckoned before: an error of ours, and no trajectory may go on with it.
    static void exhausted() { __trap(); }
};

inline __shared__ Arena* arenas[RATTLEBOX_THREADS]; // of the threads of a block
inline Arena& arena() { return *arenas[threadIdx.x]; }
inline void use(Arena& mine) { arenas[threadIdx.x] = &mine; }

} // namespace rattlebox::gpu
