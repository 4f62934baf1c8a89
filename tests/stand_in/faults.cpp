// Kernels with a fault each, that the stand-in has to find.
#include "base/real.hpp"

// Each thread takes what its mirror image has put down; the others look before it is there.
template <bool waits> void mirror(int* out) {
    __shared__ int shared[RATTLEBOX_THREADS];
    shared[threadIdx.x] = static_cast<int>(threadIdx.x);
    if (waits) __syncthreads();
    out[threadIdx.x] = shared[blockDim.x - 1 - threadIdx.x];
}
extern "C" __global__ void mirrored(int* out) { mirror<true>(out); }
extern "C" __global__ void too_early(int* out) { mirror<false>(out); }

extern "C" __global__ void elsewhere(int** there) { **there = 1; }

extern "C" __global__ void beyond_memory(char* out) { out[100] = 1; }

extern "C" __global__ void beyond_shared(int* out) {
    extern __shared__ char near[];
    near[64] = 1;
    *out = near[0];
}

extern "C" __global__ void one_is_missing(int* out) {
    if (threadIdx.x > 0) __syncthreads();
    *out = 0;
}

extern "C" __global__ void fresh(int* out) {
    __shared__ int shared[RATTLEBOX_THREADS];
    if (threadIdx.x > 0) out[0] = shared[0];
}
