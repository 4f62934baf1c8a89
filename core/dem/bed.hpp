// The particles of one cavity, sorted by cell, and their contacts, in chunks of consecutive particles.
#pragma once

#include <algorithm>
#include <cstddef>

#include "dem/contact_list.hpp"
#include "dem/contact_start.hpp"
#include "dem/diagnostics.hpp"
#include "dem/frame.hpp"
#include "dem/problem.hpp"
#include "dem/structure.hpp"

namespace rattlebox::dem {

// Consecutive particles, and the contacts of which they are the first partner.
struct Chunk {
    int begin, end;
    int highest_neighbour = 0; // highest index of a neighbour of the chunk's particles
    real approach = infinity;  // bound on the approach of any two particles since the rebuild, m
    // Pairs within reach: index of the first particle within the chunk, and index of the second one.
    std::vector<std::uint8_t> neighbour_first;
    std::vector<int> neighbour_second;
    ContactList pairs, walls;
    Diagnostics diagnostics;
    std::vector<WallTotals> each_wall; // by label; empty if they are not computed
    StopReason stop_reason;
    std::vector<std::pair<int, FirstStepShare>>
        first_step; // by candidate, of contacts that begin in this step

    Chunk(int begin, int end) : begin(begin), end(end) {}

    std::size_t memory() const {
        return pairs.bytes() + walls.bytes() + sizeof(Chunk) + neighbour_first.capacity() +
               neighbour_second.capacity() * sizeof(int);
    }

    template <class Archive> void serialize(Archive& a) {
        a(highest_neighbour, approach, neighbour_first, neighbour_second, diagnostics, each_wall,
          stop_reason);
        pairs.serialize(a);
        walls.serialize(a);
    }
};

// Part of a chunk that other workers read in each step; one cache line.
struct alignas(64) ChunkMotion {
    // Force on the cavity, and the largest displacement of a particle in the step relative to the reference
    // velocity; infinite if a particle stops the run.
    real force_on_cavity[3] = {}, moved = 0;
    // Of the chunk; the momentum in a cavity that turns is the absolute one, along the axes of the cavity.
    real momentum[3] = {}, approach = 0;
};

// Acceleration and angular acceleration; one cache line.
struct alignas(64) Rates {
    Row velocity, spin;
};

struct Bed {
    static constexpr int chunk_size = 128; // an index within a chunk fits a byte
    static constexpr int cached = 20'000;  // beds of more particles exceed the caches

    const Cavity* cavity = nullptr;
    Periods periods;
    std::vector<Row> position; // and radius
    std::vector<Row> velocity; // predicted for the end of the step, and 1 / mass
    std::vector<Row> spin;     // predicted for the end of the step, and radius / inertia
    // Valid for particles that had a contact in the previous step. All others had the acceleration of the
    // body forces and no angular acceleration.
    std::vector<Rates> rates;
    std::vector<char> touched;    // whether the particle had a contact in the previous step
    std::vector<int> id, species; // number in the case, and species
    std::vector<Chunk> chunks;
    std::vector<ChunkMotion> chunk_motion;

    real smallest = infinity; // radius, m
    real mass = 0;            // of all particles, kg
    bool rolls = false;       // whether contacts resist rolling
    real reach = 0;           // largest gap of neighbours at the rebuild, m
    // Displacements are measured relative to it: the mean velocity of the particles in the previous step.
    Row reference_velocity{};
    real cavity_moved = 0; // displacement of the cavity in the last step relative to the reference velocity
    CavityMotion motion;
    Frame frame;               // of a cavity that turns
    Row output_displacement{}; // displacement of the cavity at the last step whose forces are known

    int particles() const { return static_cast<int>(position.size()); }
    int chunk_count() const { return static_cast<int>(chunks.size()); }

    // Accelerations that were predicted for the next step of a particle in a cavity that turns.
    Rates predicted_rates(int i) const {
        return at(touched, i) ? at(rates, i) : Rates{frame.body_ahead(frame.before), Row{}};
    }

    std::size_t memory() const {
        std::size_t bytes = touched.capacity() + (id.capacity() + species.capacity()) * sizeof(int);
        for (const auto* v : {&position, &velocity, &spin}) bytes += v->capacity() * sizeof(Row);
        bytes += rates.capacity() * sizeof(Rates);
        for (const Chunk& c : chunks) bytes += c.memory();
        return bytes;
    }

    template <class Archive> void serialize(Archive& a) {
        a(position, velocity, spin, rates, touched, id, species, chunk_motion, reach, reference_velocity,
          cavity_moved, output_displacement);
        if (frame.turns()) frame.serialize(a);
        for (Chunk& c : chunks) c.serialize(a);
    }
};

} // namespace rattlebox::dem
