// The particles of one cavity, in the order of the cells they lie in, and their contacts, chunk by chunk.
#pragma once

#include <algorithm>
#include <cstddef>

#include "dem/contacts.hpp"
#include "dem/problem.hpp"
#include "dem/structure.hpp"
#include "dem/tally.hpp"
#include "dem/touch.hpp"

namespace rattlebox::dem {

// Some hundred particles that follow each other, and the contacts whose first partners they are.
struct Chunk {
    int begin = 0, end = 0;
    int highest = -1; // particle among the candidates
    std::vector<int> near_first, near_second,
        near_slot;              // neighbours within reach, and memory of those that touch
    std::vector<int> wall_slot; // of each particle at each wall
    Contacts pairs, walls;
    Tally tally;
    Stopped stopped;
    std::vector<std::pair<int, Late>> late; // of contacts that begin in this step, by slot

    std::size_t memory() const {
        std::size_t bytes = pairs.memory() + walls.memory() + sizeof(Chunk);
        for (const auto* v : {&near_first, &near_second, &near_slot, &wall_slot})
            bytes += v->capacity() * sizeof(int);
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(highest, near_first, near_second, near_slot, wall_slot, tally, stopped);
        pairs.keep(a);
        walls.keep(a);
    }
};

struct Bed {
    static constexpr int chunk_size = 128;

    const Cavity* cavity = nullptr;
    std::vector<Row> position; // and radius
    std::vector<Row> velocity; // predicted for the end of the step, and 1 / mass
    std::vector<Row> spin;     // predicted, and radius / inertia
    // Of those that touched something in the step before (others were accelerated as all are, and turned
    // evenly), and of those that do in this.
    std::vector<Row> acceleration, spin_rate, force, couple, roll;
    std::vector<char> touched;   // bits: in the step before, in this step
    std::vector<int> name, kind; // number in the case, material
    std::vector<Chunk> chunks;

    real smallest = infinity;             // radius
    real mass = 0;                        // of all
    real reach = 0, skin = 0;             // neighbours closer than reach, candidates closer than skin
    real since_build = 0, since_scan = 0; // bound on how far a particle has moved since
    CavityMotion motion;
    Row shown{}; // displacement of the cavity at the last step whose forces are known

    int particles() const { return static_cast<int>(position.size()); }
    int chunk_count() const { return static_cast<int>(chunks.size()); }

    std::size_t memory() const {
        std::size_t bytes = touched.capacity() + (name.capacity() + kind.capacity()) * sizeof(int);
        for (const auto* v : {&position, &velocity, &acceleration, &spin, &spin_rate, &force, &couple, &roll})
            bytes += v->capacity() * sizeof(Row);
        for (const Chunk& c : chunks) bytes += c.memory();
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(position, velocity, acceleration, spin, spin_rate, touched, name, kind, reach, skin, since_build,
          since_scan, shown);
        for (Chunk& c : chunks) c.keep(a);
    }
};

} // namespace rattlebox::dem
