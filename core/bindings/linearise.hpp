// Runs of the 1-D engine with derivatives.
#pragma once

#include "bindings/node.hpp"

namespace rattlebox::bindings {

void add_linearise(nb::module_& module);

} // namespace rattlebox::bindings
