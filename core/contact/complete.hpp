// Concepts that a contact law must satisfy. The table of laws (contact/laws.hpp) checks them, so that an
// incomplete law is a compile error that names the missing part.
#pragma once

#include <concepts>

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"
#include "util/variant.hpp"

namespace rattlebox {

// A law with a name and a list of named coefficients.
template <class Law>
concept NamedLaw = std::default_initializable<Law> && requires {
    { Law::name } -> std::convertible_to<const char*>;
    { Law::fields[0] } -> std::convertible_to<Field<Law>>;
};

// The formula of a law without hysteresis, for a number type T.
template <class Law, class T>
concept ElasticAndDashpotForce =
    requires(const Law& law, const Coefficients<T>& k, const Depth<T>& depth, const T& rate) {
        { law.force(k, depth, rate) } -> std::same_as<NormalForce<T>>;
        { law.stored(k, depth) } -> std::same_as<T>;
    };

// A law without hysteresis: elastic force and dashpot.
template <class Law>
concept DashpotLaw = ElasticAndDashpotForce<Law, real> && ElasticAndDashpotForce<Law, Group> &&
                     requires(const Law& law, real e, real damping, real speed) {
                         { law.zero_overlap } -> std::convertible_to<real>;
                         { law.damping(e) } -> std::same_as<real>;
                         { law.damping_ratio(damping, speed) } -> std::same_as<real>;
                         { law.dashpot_exponent() } -> std::convertible_to<real>;
                         { law.tangential_share } -> std::convertible_to<real>;
                     };

// The curves of a law with hysteresis, for a number type T.
template <class Law, class T>
concept LoadingAndUnloadingForce =
    requires(const Law& law, const Coefficients<T>& k, const History<T>& history, const Depth<T>& depth) {
        { law.yield_overlap(k) } -> std::same_as<T>;
        { law.elastic_force(k, depth) } -> std::same_as<T>;
        { law.yielding_force(k, depth) } -> std::same_as<T>;
        { law.unloading_force(history, depth) } -> std::same_as<T>;
        { law.recovered(history, depth) } -> std::same_as<T>;
    };

// A law with hysteresis: the unloading curve differs from the loading curve.
template <class Law>
concept YieldingLaw = LoadingAndUnloadingForce<Law, real> && LoadingAndUnloadingForce<Law, Group> &&
                      requires(const Law& law, real deepest) {
                          { law.untouched() } -> std::same_as<History<real>>;
                          { law.unloaded_from(deepest) } -> std::same_as<History<real>>;
                          { law.plastic_loss(deepest) } -> std::same_as<real>;
                      };

template <class Law>
concept CompleteNormalLaw =
    NamedLaw<Law> && requires(const Law& law, PairSize from, PairSize to, real damping, real speed) {
        { Law::hysteretic } -> std::convertible_to<bool>;
        { law.stiffness } -> std::convertible_to<real>;
        { law.mass } -> std::convertible_to<real>;
        { law.needs_restitution() } -> std::same_as<bool>;
        { law.coefficients(damping, speed) } -> std::same_as<Coefficients<real>>;
        { law.resized(from, to) } -> std::same_as<Law>;
        { law.overlap_scale(speed) } -> std::same_as<real>;
        { law.largest_overlap(speed) } -> std::same_as<real>;
        { law.contact_time(speed) } -> std::same_as<real>;
        { law.same_shape(law) } -> std::same_as<bool>;
    };

// The stiffness and the dashpot of a tangential law, for a number type T.
template <class Law, class T>
concept TangentialForce = requires(const T& coefficient, const Depth<T>& depth) {
    { Law::stiffness(coefficient, depth) } -> std::same_as<T>;
    { Law::dashpot(coefficient, depth) } -> std::same_as<T>;
};

template <class Law>
concept CompleteTangentialLaw = NamedLaw<Law> && TangentialForce<Law, real> && TangentialForce<Law, Group> &&
                                requires(const Law& law, PairSize size, real normal_stiffness) {
                                    { law.friction } -> std::convertible_to<real>;
                                    { law.damping } -> std::convertible_to<real>;
                                    { law.coefficient(size, normal_stiffness) } -> std::same_as<real>;
                                };

template <class Law>
concept CompleteRestitutionLaw = NamedLaw<Law> && requires(const Law& law, real speed) {
    { Law::speed_scales_with_size } -> std::convertible_to<bool>;
    { law.maximum } -> std::convertible_to<real>;
    { law.limit() } -> std::same_as<real>;
    { law.beyond() } -> std::same_as<bool>;
    { law.value(speed) } -> std::same_as<real>;
};

// ---- the checks of the table

template <class Law, bool hysteretic> struct NormalForm {
    static_assert(DashpotLaw<Law>, "a law without history lacks a part that DashpotLaw lists");
};
template <class Law> struct NormalForm<Law, true> {
    static_assert(YieldingLaw<Law>, "a law with history lacks a part that YieldingLaw lists");
};
template <class Law> struct NormalEntry : NormalForm<Law, Law::hysteretic> {
    static_assert(CompleteNormalLaw<Law>, "a normal law lacks a part that CompleteNormalLaw lists");
    using type = Law;
};
template <class Law> struct TangentialEntry {
    static_assert(CompleteTangentialLaw<Law>,
                  "a tangential law lacks a part that CompleteTangentialLaw lists");
    using type = Law;
};
template <class Law> struct RestitutionEntry {
    static_assert(CompleteRestitutionLaw<Law>,
                  "a restitution law lacks a part that CompleteRestitutionLaw lists");
    using type = Law;
};

template <class... Laws> using NormalLaws = Variant<typename NormalEntry<Laws>::type...>;
template <class... Laws> using TangentialLaws = Variant<typename TangentialEntry<Laws>::type...>;
template <class... Laws> using RestitutionLaws = Variant<typename RestitutionEntry<Laws>::type...>;

} // namespace rattlebox
