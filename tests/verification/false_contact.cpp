// Begins a contact of the 1-D engine at a gap, with and without an approach, and prints the status of the run
// and the number of logged impacts.
#include <cstdio>
#include <cstdlib>

#include "impact/run.hpp"

namespace {

using namespace rattlebox;

void begin(Method method, real gap, real approach) {
    Problem p;
    Damper& damper = p.dampers.emplace_back();
    damper.balls = 1;
    damper.clearance = 2e-3;
    HertzTsuji law;
    law.stiffness = 1e10;
    law.mass = 0.1;
    for (int side = 0; side < 2; ++side) {
        Contact& contact = p.contacts.emplace_back();
        contact.mass = law.mass;
        (side == 0 ? contact.above : contact.below) = 0;
        contact.normal.set(law);
        contact.restitution.set(ConstantRestitution{0.9, 1});
    }
    p.ball_mass = {law.mass};
    p.ball_position = {1e-3 - gap};
    p.ball_velocity = {approach};
    p.ball_damper = {0};
    p.settings.method = method;
    p.settings.duration = 1;
    Trajectory trajectory(p);
    trajectory.contact_starter().start_at(1); // at the leading wall
    const Result& result = trajectory.run_state().result;
    std::printf("%d %zu\n", static_cast<int>(result.status), result.impacts.size());
}

} // namespace

int main(int, char** arguments) {
    const real gap = std::atof(arguments[1]), approach = std::atof(arguments[2]);
    for (const Method method : {Method::event_driven, Method::newton}) begin(method, gap, approach);
}
