// The problem of the 1-D engine: modes, signals, balls in rows, contacts between neighbours, stops.
//
// The frame of reference is the base. Positions of balls are reduced: s = 0 for each ball of a closely
// packed, centred row, so that each gap is a difference of positions. Contact 0 of a damper with n balls is
// at its left wall, contact n at its right wall, and contact i between balls i and i + 1.
//
// A stop is a damper without balls, after all dampers with balls. Its one contact is between the wall and the
// ground, a body at position 0 that never moves, so that the gap is half of the clearance minus the
// displacement of the wall. Between two points, the shape is the difference of their mode shapes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/laws.hpp"
#include "impact/tolerances.hpp"
#include "math/real.hpp"
#include "structure/coupled_modes.hpp"
#include "structure/loads.hpp"

namespace rattlebox {

inline constexpr int wall = -1, ground = -2;

struct Damper {
    int first_ball = 0, balls = 0, first_contact = 0;
    real clearance = 0;      // G, total
    real gravity = 0;        // along the line, m/s^2
    std::vector<real> shape; // mode shapes at the damper's point
    real base = 0;           // of a stop: force on the base per contact force, 1, -1, or 0 between two points

    bool is_stop() const { return balls == 0; }
};

struct Contact {
    int damper = 0;
    int below = wall, above = wall; // global index of the ball on each side, wall or ground
    real mass = 0;                  // effective mass, kg; that of a wall follows from the mode shapes
    NormalLaw normal;
    RestitutionLaw restitution;
};

enum class Method : int { event_driven = 0, newton = 1, two_step = 2 };

struct Settings {
    Method method = Method::event_driven;
    real duration = 0;
    real tolerance = 1e-12;
    long max_events = 10'000'000;
    real stick = 1e-6;                        // newton: bounces shorter than this x the shortest period stick
    real dt_flight = 5e-6, dt_contact = 3e-8; // two_step
    bool adaptive_inner = false;              // two_step: Dormand-Prince instead of classical Runge-Kutta
    bool collocation = true;                  // event_driven: isolated Hertz contacts by collocation

    // Number of events up to which samples are also taken at start, deepest overlap and end of contacts and
    // in the middle of flights; 0 for none.
    long contact_samples = 0;

    bool peaks = true;     // whether the peaks of force and overlap of each impact are computed
    bool keep_end = false; // whether the result has the states from which another run continues

    // Largest energy residual over the energy supplied for which a run with this method counts as finished,
    // apart from the permitted errors of its steps (Result::permitted_error).
    real energy_residual_limit() const { return method == Method::two_step ? worst_energy_residual : 1e-8; }
};

struct Problem {
    std::vector<Mode> modes;
    std::vector<real> coupling; // modal damping without its diagonal (structure/coupled_modes.hpp), or empty
    std::vector<ModeState> start;
    std::vector<Load> loads;
    std::vector<Damper> dampers;
    std::vector<Contact> contacts;
    std::vector<real> ball_mass, ball_position, ball_velocity;
    std::vector<int> ball_damper;
    int stop_count = 0;             // the last dampers
    std::vector<real> sample_times; // increasing, within [0, duration]
    Settings settings;

    // State of another run from which this one continues (EndStates), or empty. If the problem has `changed`
    // since, the modes have the displacements and velocities of `start`.
    std::vector<std::uint8_t> start_state;
    bool changed = false;

    int mode_count() const { return static_cast<int>(modes.size()); }
    int ball_count() const { return static_cast<int>(ball_mass.size()); }
    int contact_count() const { return static_cast<int>(contacts.size()); }
    int damper_count() const { return static_cast<int>(dampers.size()); }
    std::size_t first_stop() const { return dampers.size() - static_cast<std::size_t>(stop_count); }
    std::size_t motion_size() const { return 2 * (modes.size() + ball_mass.size()); }
    std::size_t state_size() const { return motion_size() + static_cast<std::size_t>(stop_count); }
};

} // namespace rattlebox
