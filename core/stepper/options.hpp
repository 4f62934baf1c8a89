// Choices for a packed case before its first step: restitution and friction, where all its contacts have the
// same constant, and the velocity of the attachment of a damper alone.
#pragma once

#include "stepper/packed_case.hpp"

namespace rattlebox {

// NaN for the value of the packed case. As a property of a case, NaN where its contacts have different
// values, or laws without such a constant.
struct Options {
    real restitution = not_a_number, friction = not_a_number;
    real velocity[3] = {not_a_number, not_a_number, not_a_number};
};

namespace contact_parameters {

// Calls f(e) with the restitution of each contact that uses one; NaN for a law that depends on the speed.
template <class Contacts, class F> void each_restitution(Contacts& contacts, bool hard, F&& f) {
    for (auto& contact : contacts) {
        const bool uses =
            hard || contact.normal.visit([](const auto& law) { return law.needs_restitution(); });
        if (!uses) continue;
        const ConstantRestitution* law = contact.restitution.template get_if<ConstantRestitution>();
        real e = law ? law->e : not_a_number;
        const real before = e;
        f(e);
        if (!law || e == before) continue;
        ConstantRestitution changed = *law;
        changed.e = e;
        contact.restitution.set(changed);
    }
}

// Calls f(friction) for each pair of species, and each species and wall.
template <class F> void each_friction(std::vector<dem::PairLaw>& pairs, F&& f) {
    for (dem::PairLaw& pair : pairs) {
        const auto change = [&](auto law) {
            const real before = law.friction;
            f(law.friction);
            if (law.friction != before) pair.tangential.set(law);
        };
        pair.tangential.visit([&](const auto& law) { change(law); });
    }
}

// Accumulates a value that must be the same everywhere.
struct Common {
    real value = not_a_number;
    bool first = true;
    void operator()(real one) {
        value = first || one == value ? one : not_a_number;
        first = false;
    }
};

template <class EachRestitution, class EachFriction>
Options find(EachRestitution&& each_restitution, EachFriction&& each_friction) {
    Common restitution, friction;
    each_restitution([&](real& e) { restitution(e); });
    each_friction([&](real& mu) { friction(mu); });
    return {restitution.value, friction.value > 0 ? friction.value : not_a_number};
}

} // namespace contact_parameters

// Replaces the parameters that are not NaN, which the case must have, and returns those of the case before.
template <class EachRestitution, class EachFriction>
Options replace_contacts(const Options& wanted, EachRestitution&& each_restitution,
                         EachFriction&& each_friction) {
    const Options own = contact_parameters::find(each_restitution, each_friction);
    const auto given = [](real value) { return !std::isnan(value); };
    if (given(wanted.restitution)) {
        if (!given(own.restitution))
            throw std::invalid_argument("the contacts have no common constant restitution");
        if (!(wanted.restitution > 0 && wanted.restitution <= 1))
            throw std::invalid_argument("the restitution must be above 0 and at most 1");
        each_restitution([&](real& e) { e = wanted.restitution; });
    }
    if (given(wanted.friction)) {
        if (!given(own.friction)) throw std::invalid_argument("the contacts have no common friction");
        if (!(wanted.friction > 0 && wanted.friction < 100))
            throw std::invalid_argument("the friction must be above 0 and below 100");
        each_friction([&](real& mu) { mu = wanted.friction; });
    }
    return own;
}

// Adds a velocity to all balls or particles, one component after the other.
inline void add_velocity(rattlebox::Problem& problem, const real* v) {
    for (real& velocity : problem.ball_velocity) velocity += v[0];
}
inline void add_velocity(dem::Problem& problem, const real* v) {
    for (dem::Cavity& cavity : problem.cavities)
        for (Row& velocity : cavity.velocity) velocity += row(v);
}

inline Options replace_contacts(rattlebox::Problem& problem, const Options& wanted) {
    return replace_contacts(
        wanted,
        [&](auto&& f) {
            contact_parameters::each_restitution(problem.contacts, problem.settings.method == Method::newton,
                                                 f);
        },
        [](auto&&) {});
}

inline Options replace_contacts(dem::Problem& problem, const Options& wanted) {
    return replace_contacts(
        wanted, [&](auto&& f) { contact_parameters::each_restitution(problem.pair_laws, false, f); },
        [&](auto&& f) { contact_parameters::each_friction(problem.pair_laws, f); });
}

// Applies the options and returns the contact parameters that then hold.
template <class Problem> Options apply(const Options& options, PackedCase<Problem>& packed) {
    Options result = replace_contacts(packed.problem, options);
    if (!std::isnan(options.restitution)) result.restitution = options.restitution;
    if (!std::isnan(options.friction)) result.friction = options.friction;
    for (int a = 0; a < 3; ++a) {
        real& own = packed.component.velocity[a];
        result.velocity[a] = own;
        if (std::isnan(options.velocity[a])) continue;
        if (!packed.component.alone || !(std::fabs(options.velocity[a]) < infinity))
            throw std::invalid_argument("the velocity of the attachment is not finite, or there is none");
        real change[3] = {};
        change[a] = own - options.velocity[a];
        add_velocity(packed.problem, change);
        own = result.velocity[a] = options.velocity[a];
    }
    return result;
}

} // namespace rattlebox
