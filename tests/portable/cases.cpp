// The core without Python: one case of each engine, whose results are printed with all digits. It is compiled
// for every system that the core supports.
#include <cstdio>

#include "dem/simulation.hpp"
#include "impact/run.hpp"
#include "util/archive.hpp"

namespace {

using namespace rattlebox;

// A steel ball in a cavity on a sprung mass that a half-sine pulse hits.
void run_impact_case() {
    constexpr real structure = 20, stiffness = 80e3, damping = 25.3, ball = 1.2;
    Problem p;
    p.modes.push_back({damping / structure / 2, stiffness / structure});
    p.start.push_back({0, 0});
    Load& load = p.loads.emplace_back();
    load.signal.kind = Signal::Kind::half_sine;
    load.signal.amplitude = 5000;
    load.signal.frequency = pi / 1e-3;
    load.signal.stop = 1e-3;
    load.shape = {1 / std::sqrt(structure)};
    Damper& damper = p.dampers.emplace_back();
    damper.balls = 1;
    damper.clearance = 0.8e-3;
    damper.shape = load.shape;
    HertzTsuji law;
    law.stiffness = 5.337e10;
    law.mass = ball * structure / (ball + structure);
    for (int side = 0; side < 2; ++side) {
        Contact& contact = p.contacts.emplace_back();
        contact.mass = law.mass;
        (side == 0 ? contact.above : contact.below) = 0;
        contact.normal.set(law);
        contact.restitution.set(ConstantRestitution{0.99, 1});
    }
    p.ball_mass = {ball};
    p.ball_position = p.ball_velocity = {0};
    p.ball_damper = {0};
    for (int i = 0; i <= 100; ++i) p.sample_times.push_back(0.01 * i);
    p.settings.duration = 1;

    const Result result = run(p);
    std::printf("impact: status %d, %zu impacts", static_cast<int>(result.status), result.impacts.size());
    for (const Impact& impact : result.impacts)
        std::printf("\n%.17g %.17g %.17g", impact.time, impact.peak_force, impact.energy_lost);
    for (const real y : result.samples.state) std::printf("\n%.17g", y);
    std::printf("\n");
}

// Steel balls in a box on a mass on a spring that swings freely.
void run_particle_case() {
    dem::Problem p;
    p.dt = 2e-6;
    p.steps = 5000;
    p.sample_interval = 500;
    p.gravity = row(0, 0, -9.81);
    p.modes.push_back({1, 40e3});
    p.start.push_back({0, 0.5});

    constexpr real radius = 2e-3, side = 0.02, density = 7850;
    const real mass = density * 4 / 3 * pi * radius * radius * radius;
    dem::Cavity& cavity = p.cavities.emplace_back();
    cavity.shape = {row(0, 0, 1)};
    for (int axis = 0; axis < 3; ++axis)
        for (const int sign : {-1, 1}) {
            dem::Wall& box = cavity.walls.emplace_back();
            box.axis[axis] = sign;
            box.axis[3] = side / 2;
        }
    for (int k = 0; k < 48; ++k) {
        const int column = k % 4, line = k / 4 % 4, layer = k / 16;
        Row position = row(-6.5e-3 + 4.3e-3 * column, -6.5e-3 + 4.3e-3 * line, -7.5e-3 + 4.3e-3 * layer);
        position[2] += 1e-5 * (k * 7 % 5); // not a perfect lattice
        position[3] = radius;
        cavity.position.push_back(position);
        cavity.velocity.push_back(row(1e-2 * (k % 3), -1e-2 * (k % 2), 0));
        cavity.spin.push_back(row(0, 0, 0));
        cavity.mass.push_back(mass);
        cavity.inertia.push_back(0.4 * mass * radius * radius);
        cavity.species.push_back(0);
    }
    cavity.particle_pair = {dem::particle};
    cavity.wall_pair = {dem::wall};
    cavity.species_count = cavity.wall_material_count = 1;
    for (const int partner : {dem::particle, dem::wall}) {
        dem::PairLaw& pair = p.pair_laws.emplace_back();
        pair.size = partner == dem::wall ? PairSize{radius, mass} : PairSize{radius / 2, mass / 2};
        HertzTsuji law;
        law.stiffness = 4. / 3 * 2e9 * std::sqrt(pair.size.radius);
        law.mass = pair.size.mass;
        pair.normal.set(law);
        pair.restitution.set(ConstantRestitution{0.8, 1});
        pair.tangential.set(Mindlin{0.2, 8 * 0.8e9});
    }

    // The run continues from a saved state in a new simulation.
    const std::atomic<bool> stop{false};
    dem::Problem same = p;
    dem::Simulation first(std::move(p)), second(std::move(same));
    first.run(2500, 1, stop);
    Sizer size;
    first.serialize(size);
    Writer writer(size.bytes);
    first.serialize(writer);
    Reader reader(reinterpret_cast<const char*>(writer.bytes.data()), writer.bytes.size());
    second.restore(reader);
    second.run(5000, 2, stop);
    std::printf("particles: status %d, step %ld\n%.17g %.17g\n", static_cast<int>(second.status()),
                second.step(), second.modes()[0].q, second.modes()[0].p);
    for (const Row& x : second.beds()[0].position) std::printf("%.17g %.17g %.17g\n", x[0], x[1], x[2]);
}

} // namespace

int main() {
    run_impact_case();
    run_particle_case();
}
