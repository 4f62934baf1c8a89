// A law lists its coefficients by name, so that they are filled by name and never by position.
#pragma once

#include "math/real.hpp"

namespace rattlebox {

// A read-only array that must outlive the law it belongs to.
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
