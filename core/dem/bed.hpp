// The particles of one cavity, in the order of the cells they lie in, and their contacts.
#pragma once

#include <algorithm>
#include <cstddef>

#include "dem/contacts.hpp"
#include "dem/problem.hpp"
#include "dem/tally.hpp"

namespace rattlebox::dem {

struct Motion {
    Row displacement{}, velocity{}; // of a cavity
};

struct Bed {
    const Cavity* cavity = nullptr;
    std::vector<Row> position; // and radius
    std::vector<Row> velocity; // predicted for the end of the step, and 1 / mass
    // Of those that touched something in the step before (others were accelerated as all are, and turned
    // evenly), and of those that do in this.
    std::vector<Row> acceleration, spin_rate, force, couple, roll;
    std::vector<char> touched;   // bits: in the step before, in this step
    std::vector<Row> spin;       // predicted, and radius / inertia
    std::vector<int> name, kind; // number in the case, material

    ContactList pairs, walls;
    std::vector<int> near_start, near_second; // neighbours of each particle
    int chunk = 128;                          // particles in a chunk
    std::vector<Tally> tally;                 // of each chunk

    real reach = 0, skin = 0;             // neighbours closer than reach, candidates closer than skin
    real since_build = 0, since_scan = 0; // bound on how far a particle has moved since
    Motion motion;

    std::size_t memory() const {
        std::size_t bytes = pairs.memory() + walls.memory() + tally.capacity() * sizeof(Tally);
        for (const auto* v : {&position, &velocity, &acceleration, &spin, &spin_rate, &force, &couple, &roll})
            bytes += v->capacity() * sizeof(Row);
        for (const auto* v : {&name, &kind, &near_start, &near_second}) bytes += v->capacity() * sizeof(int);
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(position, velocity, acceleration, spin, spin_rate, touched, name, kind, near_start, near_second,
          tally, reach, skin, since_build, since_scan);
        pairs.keep(a);
        walls.keep(a);
    }

    int particles() const { return static_cast<int>(position.size()); }
    int chunks() const { return static_cast<int>(tally.size()); }
    int begin(int k) const { return std::min(k * chunk, particles()); }
    int end(int k) const { return std::min((k + 1) * chunk, particles()); }
};

template <class T> T& at(std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T> const T& at(const std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }

} // namespace rattlebox::dem
