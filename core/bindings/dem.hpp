// The 3-D engine: one simulation as an object that Python runs in pieces.
#pragma once

#include <nanobind/nanobind.h>

namespace rattlebox::bindings {

void add_dem(nanobind::module_& module);

} // namespace rattlebox::bindings
