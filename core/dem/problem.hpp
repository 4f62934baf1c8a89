// A particle damper as the core sees it: modes, signals, and cavities filled with spheres.
//
// Frame: the base. A cavity does not rotate; its centre is displaced by the sum of its mode shapes, three
// numbers each. Positions count from the place of the centre at rest. A base acceleration b'' acts as -m b''.
#pragma once

#include <stdexcept>
#include <vector>

#include "dem/pair_laws.hpp"
#include "dem/walls.hpp"
#include "structure/loads.hpp"
#include "structure/mode.hpp"

namespace rattlebox::dem {

struct Cavity {
    std::vector<Row> shape; // displacement of the centre per unit of each mode
    std::vector<Wall> walls;
    std::vector<Row> position, velocity,
        spin; // of each particle; the last number of a position is its radius
    std::vector<real> mass, inertia;
    std::vector<int> kind;
    std::vector<int> particle_entry, wall_entry; // of two kinds, and of a kind and a wall's: which encounter
    int kinds = 0, wall_kinds = 0;

    int particles() const { return static_cast<int>(position.size()); }
};

struct Problem {
    real dt = 0;
    long steps = 0, every = 1; // the last step, and between two samples
    real enduring = infinity;  // age beyond which a contact counts as enduring
    Row gravity{};
    std::vector<Mode> modes;
    std::vector<real> coupling; // of the modes by damping (structure/coupled_modes.hpp); empty: none
    std::vector<ModeState> start;
    std::vector<Load> loads;
    std::vector<Row> load_direction;
    std::vector<Cavity> cavities;
    std::vector<PairLaw> pair_laws;
};

// How contacts of these entries are computed.
inline ContactLaws contact_laws_of(const Problem& problem, const std::vector<int>& entries) {
    ContactLaws k;
    k.dt = problem.dt, k.enduring = problem.enduring / problem.dt;
    bool first = true, first_rough = true;
    for (const int entry : entries) {
        const PairLaw& e = problem.pair_laws.at(static_cast<std::size_t>(entry));
        if (first) k.normal = e.normal;
        first = false;
        e.normal.visit([&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            const Law* same = k.normal.template get_if<Law>();
            if (!same || !same->same_shape(law))
                throw std::invalid_argument(
                    "the contacts of one list need the same kind of normal law, ending and exponents");
            k.hysteretic = Law::hysteretic;
            if constexpr (!Law::hysteretic) k.never_pulls = law.zero_overlap == 0;
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
