// The door to the dem engine: one simulation as an object that Python runs in pieces.
#pragma once

#include <nanobind/nanobind.h>

namespace rattlebox::door {

void add_dem(nanobind::module_& module);

} // namespace rattlebox::door
