// Periodic directions: pairs of opposite faces of a box through which particles leave and enter.
//
// Coordinates are not wrapped: a particle that crosses a face goes on, and every particle stands for its
// images, one period apart. Two particles touch through the nearest of their images. A period of more than
// two diameters, which the preparation of a run ensures, is wide enough that no pair touches twice.
//
// M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, 2nd edition, Oxford University Press (2017),
// section 1.6.
#pragma once

#include "math/rows.hpp"

namespace rattlebox::dem {

// Rounds to the nearest integer, halves to the even one; |a| < 2^51.
template <class T> RATTLEBOX_INLINE T nearest_integer(const T& a) {
    const T shift = all(a, 0x1.8p52);
    return (a + shift) - shift;
}

struct Periods {
    Row length{};  // along each axis; 0 if it is not periodic
    Row inverse{}; // 1 / length, or 0
    bool any = false;

    Periods() = default;
    explicit Periods(Row length) : length(length) {
        for (int a = 0; a < 3; ++a)
            if (length[a] > 0) inverse[a] = 1 / length[a], any = true;
    }

    // Returns the shift from a branch vector to that of the nearest image.
    Row to_nearest_image(Row branch) const {
        Row shift{};
        for (int a = 0; a < 3; ++a) shift[a] = -length[a] * nearest_integer(branch[a] * inverse[a]);
        return shift;
    }

    // Returns the branch vectors to the nearest images, in SIMD lanes.
    RATTLEBOX_INLINE Columns nearest_image(const Columns& branch) const {
        const auto of = [&](const Group& x, int a) __attribute__((always_inline)) {
            return x - length[a] * nearest_integer(inverse[a] * x);
        };
        return {of(branch.x, 0), of(branch.y, 1), of(branch.z, 2), branch.w};
    }
};

} // namespace rattlebox::dem
