// Restitution from a table of the user: linear in the speed between points, constant outside.
#pragma once

#include <algorithm>

#include "util/field.hpp"

namespace rattlebox {

struct TabulatedRestitution {
    Table speeds, values; // m/s increasing, -
    real maximum = 1;

    static constexpr bool speed_scales_with_size = false;
    static constexpr const char* name = "table";
    static constexpr Field<TabulatedRestitution> fields[] = {{"maximum", &TabulatedRestitution::maximum}};
    static constexpr TableField<TabulatedRestitution> tables[] = {{"speeds", &TabulatedRestitution::speeds},
                                                                  {"values", &TabulatedRestitution::values}};

    bool is_possible() const {
        const auto* last = speeds.data + speeds.size;
        return speeds.size >= 1 && speeds.size == values.size &&
               std::adjacent_find(speeds.data, last, [](real a, real b) { return !(a < b); }) == last &&
               std::all_of(values.data, values.data + values.size, [](real e) { return e >= 0 && e <= 1; });
    }
    real limit() const { return infinity; }
    bool beyond() const { return true; }
    real value(real speed) const {
        const real* last = speeds.data + speeds.size;
        const auto after = static_cast<int>(std::upper_bound(speeds.data, last, speed) - speeds.data);
        if (after == 0) return values[0];
        if (after == speeds.size) return values[speeds.size - 1];
        const real part = (speed - speeds[after - 1]) / (speeds[after] - speeds[after - 1]);
        return values[after - 1] + part * (values[after] - values[after - 1]);
    }
};

} // namespace rattlebox
