// Spheres in cavities: many small simulations, one a block and many steps a launch, or one large by all
// blocks.
//
// Worlds (dem/wide/world.hpp) come laid out for the address at which they lie.
#include "dem/wide/near.hpp"
#include "gpu/teams.hpp"

using namespace rattlebox;
using dem::wide::World;

namespace {

constexpr int most_beds = 8;

using Beds = dem::wide::Bed[most_beds];

// What the host looks at between launches, of each world.
struct Told {
    long step;
    int status, pause;

    Told& operator=(const dem::wide::Control& c) {
        step = c.step, status = static_cast<int>(c.status), pause = static_cast<int>(c.pause);
        return *this;
    }
};

} // namespace

// Of all worlds, each of which begins so many bytes after the first; `size` bytes of shared memory are at
// hand.
extern "C" __global__ __launch_bounds__(RATTLEBOX_THREADS,
                                        RATTLEBOX_BLOCKS) void block(char* worlds, const std::size_t* begin,
                                                                     std::size_t until, std::size_t size,
                                                                     Told* told) {
    extern __shared__ __align__(64) char near[];
    __shared__ __align__(64) char own[sizeof(World)], beds[sizeof(Beds)];
    gpu::Block team;
    World& world = *reinterpret_cast<World*>(worlds + begin[blockIdx.x]);
    dem::wide::run_near(team, world, *reinterpret_cast<World*>(own), *reinterpret_cast<Beds*>(beds), near,
                        static_cast<int>(size), static_cast<long>(until));
    if (team.first()) told[blockIdx.x] = world.control;
}

extern "C" __global__ __launch_bounds__(RATTLEBOX_THREADS,
                                        RATTLEBOX_BLOCKS) void grid(World* world, unsigned* barrier,
                                                                    std::size_t until, Told* told) {
    gpu::Grid team(barrier);
    dem::wide::run(team, *world, static_cast<long>(until));
    if (team.first()) *told = world->control;
}
