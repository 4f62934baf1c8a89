// A granular damper as the core sees it: modes, signals, and cavities full of spheres.
//
// Frame: the base. A cavity does not rotate; its centre is displaced by the sum of its mode shapes, three
// numbers each. Positions count from the place of the centre at rest. A base acceleration b'' acts as -m b''.
#pragma once

#include <vector>

#include "base/rows.hpp"
#include "contact/laws.hpp"
#include "structure/loads.hpp"
#include "structure/mode.hpp"

namespace rattlebox::dem {

// A wall, seen from the centre of its cavity.
struct Wall {
    enum Form : int { plane = 0, cylinder = 1, sphere = 2 };
    Row axis{}; // outward normal of a plane, axis of a cylinder; the last number is the distance or the
                // radius
    Form form = plane;
    int kind = 0; // of its material
};

// What two materials do to each other; laws hold for a reference pair and are scaled to the sizes that meet.
struct Encounter {
    NormalLaw normal;
    RestitutionLaw restitution;
    real radius = 1, mass = 1;         // R* [m] and m* [kg] of the reference pair
    bool by_time = false;              // linear spring of given contact time: stiffness grows with m*
    real friction = 0;                 // mu
    real shear = 0;                    // 8 G* [Pa]: Mindlin's stiffness is 8 G* a, a = sqrt(R* d)
    real tangential_stiffness = 0;     // [N/m] of a linear spring
    real tangential_damping = 1;       // damping ratio of the tangential dashpot over that of the normal one
    real rolling = 0;                  // mu_r
    real rolling_stiffness = 0;        // over k_t R*^2
    real rolling_damping = 0;          // damping ratio
    real constant_zeta = not_a_number; // where neither speed nor size changes it
};

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

} // namespace rattlebox::dem
