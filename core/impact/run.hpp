// Runs one problem with the method of its settings.
#pragma once

#include "impact/trajectory.hpp"
#include "impact/two_step.hpp"

namespace rattlebox {

inline Result run(const Problem& problem, const std::atomic<bool>* stop = nullptr) {
    if (problem.settings.method == Method::two_step) return TwoStep(problem, stop).run();
    return Trajectory(problem, stop).run();
}

} // namespace rattlebox
