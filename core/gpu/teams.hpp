// Teams of the threads of a card, for work in phases (base/phases.hpp): those of one block, or of all blocks.
#pragma once

#include "base/phases.hpp"

namespace rattlebox::gpu {

inline constexpr unsigned all_lanes = 0xffffffffu;

// Of 32 lanes the first has the sum, in the order of tree(); number by number, which takes few registers.
template <class T> __device__ T tree_of_lanes(const T& value) {
    static_assert(sizeof(T) % sizeof(real) == 0);
    union Numbers {
        T sum;
        real at[numbers_of<T>];
        __device__ Numbers(const T& value) : sum(value) {}
    } own(value);
    for (int k = 0; k < numbers_of<T>; ++k)
        for (int half = tree_width / 2; half > 0; half /= 2)
            own.at[k] = T::join(k, own.at[k], __shfl_down_sync(all_lanes, own.at[k], half));
    return own.sum;
}

// What both kinds share: `rank` of `size` threads, blocks being whole multiples of 32.
class Threads {
protected:
    int rank_, size_;

    // Trees begin to end, for 32 lanes together.
    template <class T, class F>
    __device__ static void trees_of(int count, T* part, int warp, int warps, F&& f) {
        const int lane = threadIdx.x % tree_width;
        for (int g = warp; g < trees(count); g += warps) {
            const int i = g * tree_width + lane;
            const T sum = tree_of_lanes(i < count ? f(i) : T{});
            if (lane == 0) part[g] = sum;
        }
    }

public:
    __device__ Threads(int rank, int size) : rank_(rank), size_(size) {}

    template <class F> __device__ void each(int n, F&& f) {
        for (int i = rank_; i < n; i += size_) f(i);
    }
    template <class T, class F> __device__ void reduce(int n, T* part, F&& f) {
        trees_of(n, part, rank_ / tree_width, size_ / tree_width, f);
    }
    __device__ static int count(int& number) { return atomicAdd(&number, 1); }
    __device__ static void least(int& number, int value) { atomicMin(&number, value); }
};

// The threads of a block, of which the first 32 lead.
struct Block : Threads {
    __device__ Block() : Threads(threadIdx.x, blockDim.x) {}
    __device__ void sync() const { __syncthreads(); }
    __device__ bool leads() const { return threadIdx.x < tree_width; }
    __device__ bool first() const { return threadIdx.x == 0; }

    template <class T> __device__ T total(int n, T* part) const {
        for (int count = trees(n); count > 1; count = trees(count)) {
            T* above = part + count;
            __syncwarp();
            trees_of(count, above, 0, 1, [&](int k) { return part[k]; });
            part = above;
        }
        __syncwarp();
        return part[0];
    }
};

// All threads of a launch, which must all be there at once. The first block leads.
class Grid : public Threads {
    unsigned* arrived_; // and the number of the round behind it

public:
    __device__ explicit Grid(unsigned* barrier)
        : Threads(blockIdx.x * blockDim.x + threadIdx.x, gridDim.x * blockDim.x), arrived_(barrier) {}

    __device__ void sync() const {
        __syncthreads();
        if (threadIdx.x == 0) {
            volatile unsigned* round = arrived_ + 1;
            __threadfence();
            const unsigned now = *round;
            if (atomicAdd(arrived_, 1u) == gridDim.x - 1) {
                *arrived_ = 0;
                __threadfence();
                *round = now + 1;
            } else {
                while (*round == now) __nanosleep(20);
            }
            __threadfence();
        }
        __syncthreads();
    }
    __device__ bool leads() const { return blockIdx.x == 0; }
    __device__ bool first() const { return rank_ == 0; }

    template <class T> __device__ T total(int n, T* part) const {
        for (int count = trees(n); count > 1; count = trees(count)) {
            T* above = part + count;
            __syncthreads();
            trees_of(count, above, threadIdx.x / tree_width, blockDim.x / tree_width,
                     [&](int k) { return part[k]; });
            part = above;
        }
        __syncthreads();
        return part[0];
    }
};

} // namespace rattlebox::gpu
