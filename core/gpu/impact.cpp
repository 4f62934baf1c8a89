// Trajectories of a batch, one a thread at a time.
#include "impact/image.hpp"

using namespace rattlebox;

namespace {

inline constexpr std::size_t near_bytes = 16384; // what a ball or two, a mode or two and their contacts take

// What threads and host tell each other: how many members have been begun, and whether to stop.
struct Desk {
    unsigned long long begun;
    alignas(64) std::atomic<bool> stop;
};

// Works off members, `next()` being the first that nobody has.
template <class Next>
void work_off(const char* image, const Kept& kept, std::size_t members, char* far, std::size_t far_bytes,
              const Desk& desk, Next&& next, gpu::Arena& arena) {
    alignas(gpu::Arena::grain) char near[near_bytes];
    gpu::use(arena);
    const auto stopped = [&] { return desk.stop.load(std::memory_order_relaxed); };
    for (std::size_t i = next(); i < members && !stopped(); i = next()) {
        arena.near = {near, near, near + near_bytes};
        arena.far = {far, far, far + far_bytes};
        work(image, i, kept, &desk.stop);
    }
}

} // namespace

extern "C" __global__ void prepare() {
    new (&room<GaussRule>) GaussRule;
    new (&room<PhaseGrid::Rule>) PhaseGrid::Rule;
}

extern "C" __global__ __launch_bounds__(RATTLEBOX_THREADS) void impact(const char* image, std::int8_t* status,
                                                                       real* numbers, std::size_t members,
                                                                       char* far, std::size_t far_bytes,
                                                                       Desk* desk) {
    gpu::Arena arena;
    Kept kept;
    kept.status = status;
    kept.numbers = numbers;
    const std::size_t thread = blockIdx.x * static_cast<std::size_t>(blockDim.x) + threadIdx.x;
    work_off(
        image, kept, members, far + thread * far_bytes, far_bytes, *desk,
        [&] { return static_cast<std::size_t>(atomicAdd(&desk->begun, 1ull)); }, arena);
}
