// The problem of the 3-D engine: modes, signals, and cavities filled with spheres.
//
// The frame of reference is the base, for a cavity that turns its own axes (frame.hpp). The displacement of
// its centre is the sum of the modal displacements times its mode shapes (three components each). Positions
// are measured from the rest position of the centre. A base acceleration b'' acts on a mass m as the force -m
// b''.
#pragma once

#include <stdexcept>
#include <vector>

#include "dem/frame.hpp"
#include "dem/pair_laws.hpp"
#include "dem/periodic.hpp"
#include "dem/solids.hpp"
#include "dem/walls.hpp"
#include "structure/loads.hpp"
#include "structure/mode.hpp"

namespace rattlebox::dem {

struct Cavity {
    std::vector<Row> shape;  // displacement of the centre per unit of each mode
    std::vector<Wall> walls; // those of solids come last
    Solids solids;
    Row period{}; // distance of the images of a particle along each axis; 0 if it is not periodic
    Rotation rotation;
    std::vector<Row> position, velocity, spin; // by particle; the fourth number of a position is the radius
    std::vector<real> mass, inertia;
    std::vector<int> species;
    // Indices into Problem::pair_laws by two species, and by a species and a wall material.
    std::vector<int> particle_pair, wall_pair;
    int species_count = 0, wall_material_count = 0;

    int particles() const { return static_cast<int>(position.size()); }
    // What a particle can touch: plain walls, bodies, and triangles.
    int leaves() const { return solids.empty() ? static_cast<int>(walls.size()) : solids.leaves(); }
    int wall_of(int leaf) const { return solids.empty() ? leaf : solids.wall_of(leaf); }
    int wall_labels() const {
        int count = 0;
        for (const Wall& wall : walls) count = wall.label < count ? count : wall.label + 1;
        return count;
    }
};

struct Problem {
    real dt = 0;
    long steps = 0, sample_interval = 1; // last step, and steps between two samples
    long first_step = 0;                 // that of the first sample, of a run that continues another
    real origin = 0;                     // time of step 0 [s]
    real enduring = infinity;            // age beyond which a contact counts as enduring
    bool each_wall = false;              // whether forces and losses are also summed for each wall
    Row gravity{};
    std::vector<Mode> modes;
    std::vector<real> coupling; // modal damping without its diagonal (structure/coupled_modes.hpp), or empty
    std::vector<ModeState> start;
    std::vector<Load> loads;
    std::vector<Row> load_direction;
    std::vector<Cavity> cavities;
    std::vector<PairLaw> pair_laws;

    real time_at(long step) const { return origin + static_cast<real>(step) * dt; }
};

inline void set_step(ContactLaws& laws, const Problem& problem) {
    laws.dt = problem.dt, laws.enduring = problem.enduring / problem.dt;
}

// Returns what all contacts of one list have in common; `pairs` are indices into Problem::pair_laws.
inline ContactLaws contact_laws_of(const Problem& problem, const std::vector<int>& pairs) {
    ContactLaws k;
    set_step(k, problem);
    bool first = true, first_rough = true;
    for (const int pair : pairs) {
        const PairLaw& e = problem.pair_laws.at(static_cast<std::size_t>(pair));
        if (first) k.normal = e.normal;
        first = false;
        e.normal.visit([&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            const Law* same = k.normal.template get_if<Law>();
            if (!same || !same->same_shape(law))
                throw std::invalid_argument(
                    "the contacts of one list need the same kind of normal law, ending and exponents");
            k.hysteretic = Law::hysteretic;
            if constexpr (!Law::hysteretic) k.repulsive_only = law.zero_overlap == 0;
        });
        if (e.friction() > 0) {
            if (!first_rough && k.tangential != e.tangential.index())
                throw std::invalid_argument("the contacts of one list need the same kind of tangential law");
            k.tangential = e.tangential.index();
            k.rough = true, first_rough = false;
        }
        k.rolls |= e.rolling.coefficient > 0;
    }
    k.rough |= k.rolls;
    return k;
}

} // namespace rattlebox::dem
