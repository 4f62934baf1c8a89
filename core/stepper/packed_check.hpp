// Validation of a packed case, once, when it is read: every index, count and number that the engines use
// without a check must be in its range, so that a damaged or made file cannot cause reads out of bounds or
// endless loops.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "dem/problem.hpp"
#include "impact/problem.hpp"

namespace rattlebox {

// Data of a stepper in addition to the problem.
struct Component {
    bool alone = false;                  // a damper alone, driven by the motion of its attachment
    real velocity[3] = {};               // of the attachment at the start, if alone
    std::vector<std::vector<real>> rows; // displacement of each output for a unit of each mode
};

inline void check(bool holds) {
    if (!holds) throw std::invalid_argument("the packed case is damaged");
}
inline void check_index(int i, std::size_t count) { check(i >= 0 && static_cast<std::size_t>(i) < count); }

// Numbers beyond these would overflow or underflow when they are squared or multiplied.
inline constexpr real largest_number = 1e100, smallest_number = 1e-100;

inline void check_number(real value) { check(std::fabs(value) <= largest_number); }
inline void check_positive(real value) { check(value >= smallest_number && value <= largest_number); }
inline void check_not_negative(real value) {
    if (value != 0) check_positive(value);
}
inline void check_row(const Row& row) {
    for (int a = 0; a < 4; ++a) check_number(row[a]);
}
inline void check_numbers(const std::vector<real>& values) {
    for (const real value : values) check_number(value);
}

// Coefficients are not negative. NaN and infinity are allowed where they are the default.
template <class Law> void check_law(const Law& law) {
    for (const auto& field : Law::fields) {
        const real value = law.*field.member, standard = Law{}.*field.member;
        if (std::isnan(standard) && std::isnan(value)) continue;
        check(value >= 0 && (value <= largest_number || value == standard));
    }
    if constexpr (requires { law.is_possible(); }) check(law.is_possible());
}

inline void check_contact(const NormalLaw& normal, const RestitutionLaw& restitution) {
    normal.visit([](const auto& law) {
        check_law(law);
        check_positive(law.stiffness), check_positive(law.mass);
    });
    restitution.visit([](const auto& law) {
        check_law(law);
        check(law.maximum <= 1);
    });
}

template <class Problem> void check_structure(const Problem& problem, const Component& component) {
    const std::size_t modes = problem.modes.size();
    check(problem.start.size() == modes);
    check(problem.coupling.empty() || problem.coupling.size() == modes * modes);
    check_numbers(problem.coupling);
    for (const Mode& mode : problem.modes) check_not_negative(mode.decay), check_not_negative(mode.stiffness);
    for (const ModeState& state : problem.start) check_number(state.q), check_number(state.p);
    for (const Load& load : problem.loads) check(load.shape.size() == modes), check_numbers(load.shape);
    for (const auto& row : component.rows) check(row.size() == modes), check_numbers(row);
    for (const real v : component.velocity) check_number(v);
}

inline void check(const Settings& settings) {
    check(settings.method == Method::event_driven || settings.method == Method::newton);
    check(settings.tolerance >= 1e-14 && settings.tolerance <= 1e-3);
    check(settings.max_events >= 1 && settings.stick >= 0 && settings.stick <= 0.1);
    check_not_negative(settings.duration);
}

inline void check(const rattlebox::Problem& problem, const Component& component) {
    check_structure(problem, component);
    check(problem.settings);
    const std::size_t balls = problem.ball_mass.size();
    check(problem.ball_position.size() == balls && problem.ball_velocity.size() == balls &&
          problem.ball_damper.size() == balls);
    for (const real mass : problem.ball_mass) check_positive(mass);
    check_numbers(problem.ball_position), check_numbers(problem.ball_velocity);
    // The balls and contacts of each damper follow those of the one before.
    int first_ball = 0, first_contact = 0;
    for (std::size_t d = 0; d < problem.dampers.size(); ++d) {
        const Damper& damper = problem.dampers[d];
        // Stops, which have no balls, come after all dampers, and act on points that move.
        check(damper.first_ball == first_ball && damper.first_contact == first_contact && damper.balls >= 0);
        check(damper.is_stop() == (d >= problem.first_stop()));
        check(!damper.is_stop() || std::any_of(damper.shape.begin(), damper.shape.end(),
                                               [](real s) { return std::fabs(s) >= smallest_number; }));
        check(static_cast<std::size_t>(damper.balls) <= balls - static_cast<std::size_t>(first_ball));
        check(static_cast<std::size_t>(damper.balls) <
              problem.contacts.size() - static_cast<std::size_t>(first_contact));
        check_not_negative(damper.clearance), check_number(damper.gravity);
        check(damper.shape.size() == problem.modes.size()), check_numbers(damper.shape);
        for (int i = 0; i <= damper.balls; ++i) {
            const Contact& contact = problem.contacts[static_cast<std::size_t>(first_contact + i)];
            check(contact.damper == static_cast<int>(d));
            check(contact.below == (i == 0 ? wall : first_ball + i - 1));
            check(contact.above == (i < damper.balls ? first_ball + i : damper.is_stop() ? ground : wall));
            // An effective mass is at most that of the lighter body.
            check_positive(contact.mass);
            for (const int ball : {contact.below, contact.above})
                if (ball >= 0)
                    check(contact.mass <= 1.000001 * problem.ball_mass[static_cast<std::size_t>(ball)]);
            check_contact(contact.normal, contact.restitution);
            if (i < damper.balls)
                check(problem.ball_damper[static_cast<std::size_t>(first_ball + i)] == static_cast<int>(d));
        }
        first_ball += damper.balls, first_contact += damper.balls + 1;
    }
    check(static_cast<std::size_t>(first_ball) == balls &&
          static_cast<std::size_t>(first_contact) == problem.contacts.size());
    check(!component.alone || (problem.loads.size() == 1 && problem.dampers.size() == 1));
}

inline void check(const dem::Cavity& cavity, const dem::Problem& problem) {
    const std::size_t n = cavity.position.size();
    check(cavity.velocity.size() == n && cavity.spin.size() == n && cavity.mass.size() == n &&
          cavity.inertia.size() == n && cavity.species.size() == n && n > 0);
    check(cavity.shape.size() == problem.modes.size() && !cavity.walls.empty() && cavity.walls.size() <= 32);
    check(cavity.species_count >= 1 && cavity.wall_material_count >= 1);
    const auto species = static_cast<std::size_t>(cavity.species_count),
               materials = static_cast<std::size_t>(cavity.wall_material_count);
    check(cavity.particle_pair.size() == species * species && cavity.wall_pair.size() == species * materials);
    for (const int s : cavity.species) check_index(s, species);
    for (const auto* pairs : {&cavity.particle_pair, &cavity.wall_pair})
        for (const int pair : *pairs) check_index(pair, problem.pair_laws.size());
    for (const dem::Wall& wall : cavity.walls) {
        check_index(wall.material, materials);
        check(wall.form >= dem::Wall::plane && wall.form <= dem::Wall::sphere);
        check_row(wall.axis);
        check(wall.form == dem::Wall::sphere || std::fabs(dot(wall.axis, wall.axis) - 1) < 1e-6);
    }
    // A pair of particles must not touch through two images.
    real largest = 0;
    for (const Row& p : cavity.position) largest = std::fmax(largest, p[3]);
    check_row(cavity.period);
    for (int a = 0; a < 3; ++a) check(cavity.period[a] == 0 || cavity.period[a] > 4 * largest);
    for (std::size_t i = 0; i < n; ++i) {
        for (const auto* rows : {&cavity.position, &cavity.velocity, &cavity.spin}) check_row((*rows)[i]);
        for (const real value : {cavity.position[i][3], cavity.mass[i], cavity.inertia[i]})
            check_positive(value);
        // As in a saved state: cells are numbered by integers.
        for (int a = 0; a < 3; ++a) check(std::fabs(cavity.position[i][a]) < 1e30);
    }
    for (const Row& shape : cavity.shape) check_row(shape);
}

inline void check(const dem::Problem& problem, const Component& component) {
    check_structure(problem, component);
    check_positive(problem.dt), check_row(problem.gravity);
    check(problem.enduring > 0 && problem.load_direction.size() == problem.loads.size());
    for (const Row& direction : problem.load_direction) check_row(direction);
    check(!problem.cavities.empty());
    for (const dem::Cavity& cavity : problem.cavities) check(cavity, problem);
    for (const dem::PairLaw& pair : problem.pair_laws) {
        check_contact(pair.normal, pair.restitution);
        pair.tangential.visit([](const auto& law) { check_law(law); });
        check_law(pair.rolling);
        check_positive(pair.size.radius), check_positive(pair.size.mass);
    }
    check(!component.alone || (problem.loads.size() == 3 && problem.cavities.size() == 1));
}

} // namespace rattlebox
