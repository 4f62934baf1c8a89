// One problem by the method it asks for.
#pragma once

#include "impact/trajectory.hpp"
#include "impact/two_step.hpp"

namespace rattlebox {

inline Result run(const Problem& problem, const std::atomic<bool>* stop = nullptr) {
    if (problem.settings.method == Method::two_step) return TwoStep(problem, stop).run();
    return Trajectory(problem, stop).run();
}

} // namespace rattlebox
