// One line of motion as the core sees it: modes, signals, balls in rows, contacts between neighbours.
//
// Frame: the base. Balls have reduced positions s: a row packed tight and centred has s = 0 for each ball, so
// every gap is a difference. Contact 0 of a damper is its left wall, contact n its right wall, contact i lies
// between ball i and i + 1.
#pragma once

#include <algorithm>
#include <vector>

#include "contact/laws.hpp"
#include "math/real.hpp"
#include "structure/coupled_modes.hpp"
#include "structure/loads.hpp"

namespace rattlebox {

inline constexpr int wall = -1;

struct Damper {
    int first_ball = 0, balls = 0, first_contact = 0;
    real clearance = 0;      // G, total
    real gravity = 0;        // along the line, m/s^2
    std::vector<real> shape; // mode shapes at the damper's point
};

struct Contact {
    int damper = 0;
    int below = wall, above = wall; // global index of the ball on each side
    real mass = 0;                  // reduced mass, walls count with the structure's effective mass
    NormalLaw normal;
    RestitutionLaw restitution;
};

// Energy residual over the energy put in beyond which no run counts as finished, whatever its method.
inline constexpr real worst_energy_residual = 0.01;
// Balls that move no faster are at rest [m/s]: a residual below their energy is rounding.
inline constexpr real speed_at_rest = 1e-9;

enum class Method : int { event_driven = 0, newton = 1, two_step = 2 };

struct Settings {
    Method method = Method::event_driven;
    real duration = 0;
    real tolerance = 1e-12;
    long max_events = 10'000'000;
    real stick = 1e-6;                        // newton: bounce shorter than this x the shortest period sticks
    real dt_flight = 5e-6, dt_contact = 3e-8; // two_step
    bool adaptive_inner = false;              // two_step: dopri5 instead of rk4
    bool collocation = true;                  // event_driven: lone contacts by collocation in phase

    // Largest number of events up to which samples are also taken at begin, deepest overlap and end of
    // contacts and in the middle of the flights between; 0: never.
    long contact_samples = 0;

    bool peaks = true; // of force and overlap are found for the impact log

    // Largest energy residual of a run that counts as finished, over the energy put in.
    real energy_residual_limit() const {
        if (method == Method::two_step) return worst_energy_residual;
        return method == Method::newton ? 1e-8 : std::clamp(1e4 * tolerance, 1e-8, worst_energy_residual);
    }
};

struct Problem {
    std::vector<Mode> modes;
    std::vector<real> coupling; // of the modes by damping (structure/coupled_modes.hpp); empty: none
    std::vector<ModeState> start;
    std::vector<Load> loads;
    std::vector<Damper> dampers;
    std::vector<Contact> contacts;
    std::vector<real> ball_mass, ball_position, ball_velocity;
    std::vector<int> ball_damper;
    std::vector<real> sample_times; // increasing, within [0, duration]
    Settings settings;

    int mode_count() const { return static_cast<int>(modes.size()); }
    int ball_count() const { return static_cast<int>(ball_mass.size()); }
    int contact_count() const { return static_cast<int>(contacts.size()); }
    int damper_count() const { return static_cast<int>(dampers.size()); }
};

} // namespace rattlebox
