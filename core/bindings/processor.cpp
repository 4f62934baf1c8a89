// A Python module of its own, built for the baseline instruction set, because it decides which core is
// loaded.

#include <nanobind/nanobind.h>

#include "util/processor.hpp"

NB_MODULE(_core_processor, module) {
    module.doc() = "The instructions of this processor.";
    module.def(
        "x86_64_level", &rattlebox::x86_64_level,
        "Return the highest of the x86-64 levels 1, 3 and 4 that processor and system offer; 0 elsewhere.");
}
