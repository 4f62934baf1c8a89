// Where energy goes, between particles and at walls.
#pragma once

#include "base/real.hpp"

namespace rattlebox::dem {

struct Losses {
    real normal[2] = {}, plastic[2] = {}, sliding[2] = {}, rolling[2] = {};

    void add(const Losses& other) {
        for (int p = 0; p < 2; ++p) {
            normal[p] += other.normal[p], plastic[p] += other.plastic[p];
            sliding[p] += other.sliding[p], rolling[p] += other.rolling[p];
        }
    }
};

} // namespace rattlebox::dem
