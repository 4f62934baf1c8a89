// The contact laws as Python sees them: the choice of the time step and the curves that users draw compute
// with the formulas of the engines.
#pragma once

#include <memory>

#include "python/read.hpp"
#include "python/write.hpp"

namespace rattlebox::door {

template <class Laws> Laws read_law(const nb::dict& d, rattlebox::Problem& storage) {
    storage.tables.reserve(8);
    Laws law;
    Reader(storage, nullptr).choose(law, d);
    return law;
}

// A normal law, and the tables that it points to.
struct BoundNormalLaw {
    std::shared_ptr<rattlebox::Problem> storage = std::make_shared<rattlebox::Problem>();
    NormalLaw law;

    explicit BoundNormalLaw(const nb::dict& d) : law(read_law<NormalLaw>(d, *storage)) {}

    BoundNormalLaw resized(real radius, real mass, real new_radius, real new_mass) const {
        BoundNormalLaw other = *this;
        law.visit(
            [&](const auto& own) { other.law.set(own.resized({radius, mass}, {new_radius, new_mass})); });
        return other;
    }
};

struct BoundTangentialLaw {
    TangentialLaw law;

    explicit BoundTangentialLaw(const nb::dict& d) {
        rattlebox::Problem storage;
        law = read_law<TangentialLaw>(d, storage);
    }
};

template <class F> nb::object each_value(const Array& arguments, F&& f) {
    std::vector<real> values(arguments.shape(0));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(arguments.data()[i]);
    return array(std::move(values));
}

inline void add_laws(nb::module_& module) {
    using N = BoundNormalLaw;
    const auto visit = [](auto&& f) {
        return [f](const N& n, real speed) {
            return n.law.visit([&](const auto& law) -> real { return f(law, speed); });
        };
    };
    nb::class_<N>(module, "NormalLaw", "A normal contact law with the coefficients of one pair.")
        .def(nb::init<const nb::dict&>(), nb::arg("coefficients"))
        .def("resized", &N::resized, nb::arg("radius"), nb::arg("mass"), nb::arg("new_radius"),
             nb::arg("new_mass"),
             "Return the law of a pair of another size, given R* [m] and m* [kg] of both pairs.")
        .def("contact_time", visit([](const auto& law, real speed) { return law.contact_time(speed); }),
             nb::arg("speed"), "Return the duration of an undamped impact at this speed [s].")
        .def("largest_overlap", visit([](const auto& law, real speed) { return law.largest_overlap(speed); }),
             nb::arg("speed"), "Return an upper bound of the overlap of an impact at this speed [m].")
        .def(
            "damping_ratio",
            [](const N& n, real e, real speed) {
                return n.law.visit([&](const auto& law) -> real {
                    if constexpr (std::decay_t<decltype(law)>::hysteretic)
                        return 0;
                    else
                        return law.damping_ratio(law.damping(e), speed);
                });
            },
            nb::arg("restitution"), nb::arg("speed"),
            "Return the damping ratio of an impact with this restitution and speed; 0 of a law that yields.")
        .def_prop_ro(
            "needs_restitution",
            [](const N& n) { return n.law.visit([](const auto& law) { return law.needs_restitution(); }); },
            "Whether the dashpot follows from a restitution.")
        .def_prop_ro(
            "stiffness",
            [](const N& n) { return n.law.visit([](const auto& law) { return law.stiffness; }); },
            "Coefficient of the elastic force.")
        .def_prop_ro(
            "mass", [](const N& n) { return n.law.visit([](const auto& law) { return law.mass; }); },
            "Effective mass of the pair [kg].");

    using T = BoundTangentialLaw;
    nb::class_<T>(module, "TangentialLaw", "A tangential contact law.")
        .def(nb::init<const nb::dict&>(), nb::arg("coefficients"))
        .def(
            "stiffness",
            [](const T& t, real radius, real mass, real normal_stiffness, real overlap) {
                return t.law.visit([&](const auto& law) {
                    const real coefficient = law.coefficient({radius, mass}, normal_stiffness);
                    return law.stiffness(coefficient, depth_from_overlap(overlap));
                });
            },
            nb::arg("radius"), nb::arg("mass"), nb::arg("normal_stiffness"), nb::arg("overlap"),
            "Return the tangential stiffness of a pair at an overlap [N/m].");

    module.def(
        "restitution",
        [](const nb::dict& law, const Array& speeds) {
            rattlebox::Problem storage;
            const auto choice = read_law<RestitutionLaw>(law, storage);
            return each_value(speeds, [&](real speed) {
                const Rebound r = rebound(choice, speed);
                return r.outside ? not_a_number : r.e;
            });
        },
        nb::arg("law"), nb::arg("speeds"), "Return the restitution at each speed; NaN beyond the law.");
    module.def(
        "restitution_of_damping",
        [](const Array& ratios, bool zero_overlap) {
            return each_value(ratios,
                              [&](real zeta) { return std::exp(log_restitution(zeta, zero_overlap)); });
        },
        nb::arg("damping_ratio"), nb::arg("zero_overlap"),
        "Return the restitution that each damping ratio gives.");
    module.def(
        "damping_of_restitution",
        [](const Array& e, bool zero_overlap) {
            return each_value(e, [&](real value) { return damping_ratio(value, zero_overlap); });
        },
        nb::arg("restitution"), nb::arg("zero_overlap"),
        "Return the damping ratio that gives each restitution.");
}

} // namespace rattlebox::door
