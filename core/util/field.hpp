// Names of the coefficients of a law, so that they are set by name and not by position.
#pragma once

#include "math/real.hpp"

namespace rattlebox {

// View of a read-only array, which must outlive the law.
struct Table {
    const real* data = nullptr;
    int size = 0;
    real operator[](int i) const { return data[i]; }
};

template <class Law> struct Field {
    const char* name;
    real Law::* member;
};

template <class Law> struct TableField {
    const char* name;
    Table Law::* member;
};

} // namespace rattlebox
