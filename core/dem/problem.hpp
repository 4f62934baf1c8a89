// A granular damper as the core sees it: modes, signals, and cavities full of spheres.
//
// Frame: the base. A cavity does not rotate; its centre is displaced by the sum of its mode shapes, three
// numbers each. Positions count from the place of the centre at rest. A base acceleration b'' acts as -m b''.
#pragma once

#include <stdexcept>
#include <vector>

#include "dem/encounter.hpp"
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
    Row gravity{};
    std::vector<Mode> modes;
    std::vector<ModeState> start;
    std::vector<Load> loads;
    std::vector<Row> load_direction;
    std::vector<Cavity> cavities;
    std::vector<Encounter> encounters;
    std::vector<std::vector<real>> tables; // storage of Table views
};

inline Kind kind_of(const Encounter& e) {
    Kind k;
    e.normal.visit([&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        k.normal = std::is_same_v<Law, HertzTsuji>      ? Kind::hertz
                   : std::is_same_v<Law, LinearDashpot> ? Kind::linear
                                                        : Kind::plastic;
        if constexpr (!std::is_same_v<Law, Thornton>) k.how.never_pulls = law.zero_overlap == 0;
    });
    return k;
}

// How contacts of these entries are computed.
inline Kind kind_of(const Problem& problem, const std::vector<int>& entries) {
    const auto encounter = [&](int e) { return problem.encounters.at(static_cast<std::size_t>(e)); };
    Kind k = entries.empty() ? Kind{} : kind_of(encounter(entries.front()));
    for (const int e : entries) {
        const Encounter one = encounter(e);
        const Kind other = kind_of(one);
        if (other.normal != k.normal || other.how.never_pulls != k.how.never_pulls)
            throw std::invalid_argument("one list of contacts has one kind of normal law and one ending");
        if (one.friction > 0 && k.rough && k.how.mindlin != (one.shear > 0))
            throw std::invalid_argument("one list of contacts has one kind of tangential spring");
        if (one.friction > 0) k.rough = true, k.how.mindlin = one.shear > 0;
        k.rolls |= one.rolling > 0;
    }
    k.rough |= k.rolls;
    k.how.dt = problem.dt;
    return k;
}

} // namespace rattlebox::dem
