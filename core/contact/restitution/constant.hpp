// Constant restitution, e = const (Newton).
//
// B. Brogliato, Nonsmooth Mechanics, 3rd ed., Springer 2016, doi:10.1007/978-3-319-28664-8.
#pragma once

#include "util/field.hpp"

namespace rattlebox {

struct ConstantRestitution {
    real e = 1;
    real maximum = 1;

    static constexpr bool speed_scales_with_size = false;
    static constexpr const char* name = "constant";
    static constexpr Field<ConstantRestitution> fields[] = {{"e", &ConstantRestitution::e},
                                                            {"maximum", &ConstantRestitution::maximum}};

    real limit() const { return infinity; } // largest speed at which the law is valid
    bool beyond() const { return true; }    // whether it may be used above
    real value(real) const { return e; }
};

} // namespace rattlebox
