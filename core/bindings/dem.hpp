// Binding of the 3-D engine: a simulation that Python advances in portions.
#pragma once

#include <nanobind/nanobind.h>

namespace rattlebox::bindings {

void add_dem(nanobind::module_& module);

} // namespace rattlebox::bindings
