// The particles of one cavity, sorted by cell, and their contacts, in chunks.
#pragma once

#include <algorithm>
#include <cstddef>

#include "dem/contact_begin.hpp"
#include "dem/contact_list.hpp"
#include "dem/problem.hpp"
#include "dem/structure.hpp"
#include "dem/tally.hpp"

namespace rattlebox::dem {

// Some hundred particles that follow each other, and the contacts whose first partners they are.
struct Chunk {
    int begin, end;
    int highest = 0;            // particle that the chunk's particles have as a neighbour
    real approached = infinity; // how much nearer to each other any two may have come since the build
    std::vector<std::uint8_t> near_first; // neighbours within reach: which of the chunk's particles,
    std::vector<int> near_second;         // and the number of the other
    ContactList pairs, walls;
    Tally tally;
    Stopped stopped;
    std::vector<std::pair<int, FirstStepShare>>
        first_step; // of contacts that begin in this step, by candidate

    Chunk(int begin, int end) : begin(begin), end(end) {}

    std::size_t memory() const {
        return pairs.bytes() + walls.bytes() + sizeof(Chunk) + near_first.capacity() +
               near_second.capacity() * sizeof(int);
    }

    template <class Archive> void keep(Archive& a) {
        a(highest, approached, near_first, near_second, tally, stopped);
        pairs.keep(a);
        walls.keep(a);
    }
};

// What all need to know of a chunk in a step: a line of memory.
struct alignas(64) ChunkMotion {
    // On the cavity, and how far any particle has moved beyond the reference: to infinity if one stops the
    // run.
    real force_on_cavity[3] = {}, moved = 0;
    real momentum[3] = {}, approached = 0; // the chunk's
};

// How velocity and spin change: a line of memory.
struct alignas(64) Rates {
    Row velocity, spin;
};

struct Bed {
    static constexpr int chunk_size = 128; // numbers of particles in their chunk fit a byte
    static constexpr int cached = 20'000;  // of more particles caches hold only a part

    const Cavity* cavity = nullptr;
    std::vector<Row> position; // and radius
    std::vector<Row> velocity; // predicted for the end of the step, and 1 / mass
    std::vector<Row> spin;     // predicted, and radius / inertia
    // Of those that touched something in the step before: others were accelerated as all are, and turned
    // evenly.
    std::vector<Rates> rates;
    std::vector<char> touched;   // something in the step before
    std::vector<int> name, kind; // number in the case, material
    std::vector<Chunk> chunks;
    std::vector<ChunkMotion> chunk_motion; // of the chunks

    real smallest = infinity; // radius
    real mass = 0;            // of all
    bool rolls = false;       // some contacts resist rolling
    real reach = 0;           // neighbours were closer than that at the build
    Row reference{}; // velocity, beyond which motions of particles are counted: their mean in the step before
    real apart = 0;  // how far the cavity has moved beyond the reference in the last step
    CavityMotion motion;
    Row shown{}; // displacement of the cavity at the last step whose forces are known

    int particles() const { return static_cast<int>(position.size()); }
    int chunk_count() const { return static_cast<int>(chunks.size()); }

    std::size_t memory() const {
        std::size_t bytes = touched.capacity() + (name.capacity() + kind.capacity()) * sizeof(int);
        for (const auto* v : {&position, &velocity, &spin}) bytes += v->capacity() * sizeof(Row);
        bytes += rates.capacity() * sizeof(Rates);
        for (const Chunk& c : chunks) bytes += c.memory();
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(position, velocity, spin, rates, touched, name, kind, chunk_motion, reach, reference, apart, shown);
        for (Chunk& c : chunks) c.keep(a);
    }
};

} // namespace rattlebox::dem
