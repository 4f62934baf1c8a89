#include <nanobind/nanobind.h>

namespace nb = nanobind;

NB_MODULE(RATTLEBOX_MODULE, module) {
    module.doc() = "Rattlebox core";
}
