// Binding of the contact laws: one class for each law of the table, with its coefficients. The choice of the
// time step and the figures of the laws use the formulas of the engines.
#pragma once

#include <nanobind/stl/unique_ptr.h>

#include "bindings/fill.hpp"

namespace rattlebox::bindings {

template <class Law, std::size_t place> struct Coefficient {
    static constexpr const auto& entry = Law::fields[place];
    // A coefficient whose default is NaN is optional: the law computes it.
    static constexpr bool may_be_missing = Law{}.*entry.member != Law{}.*entry.member;
    using Value = std::conditional_t<may_be_missing, std::optional<Number>, Number>;
    const char* name = entry.name;

    Value get(const LawNumbers<Law>& law) const {
        const Number& number = law.numbers[place];
        if constexpr (may_be_missing)
            return !number.varies() && std::isnan(number.value) ? Value{} : Value{number};
        else
            return number;
    }
    void set(LawNumbers<Law>& law, Value value) const {
        if constexpr (may_be_missing)
            law.numbers[place] = value ? std::move(*value) : Number(not_a_number);
        else
            law.numbers[place] = std::move(value);
    }
    auto argument() const {
        if constexpr (may_be_missing)
            return nb::arg(name) = nb::none();
        else
            return nb::arg(name);
    }
};

template <class Law, std::size_t place> struct Curve {
    using Value = Table;
    const char* name = Law::tables[place].name;

    Table get(const LawNumbers<Law>& law) const { return law.tables[place]; }
    void set(LawNumbers<Law>& law, Table values) const { law.tables[place] = std::move(values); }
    auto argument() const { return nb::arg(name); }
};

// Returns the name of the class of a law: hertz_tsuji -> HertzTsuji.
inline std::string class_name(const std::string& law, const char* family) {
    std::string name;
    bool starts = true;
    for (const char c : law) {
        if (c != '_') name += starts ? static_cast<char>(std::toupper(c)) : c;
        starts = c == '_';
    }
    return name + family;
}

template <class Law> auto define_law(nb::module_& module, const char* name, const char* doc) {
    return [&]<std::size_t... number, std::size_t... table>(std::index_sequence<number...>,
                                                            std::index_sequence<table...>) {
        return define<LawNumbers<Law>>(module, name, doc, Coefficient<Law, number>{}...,
                                       Curve<Law, table>{}...);
    }(std::make_index_sequence<std::size(Law::fields)>{}, std::make_index_sequence<table_count<Law>>{});
}

// Adds a law of another package, given the address of its table, and returns its number.
inline int add_external_law(std::uintptr_t address) {
    const auto* table = reinterpret_cast<const RattleboxNormalLaw*>(address);
    auto& laws = external_laws();
    for (std::size_t i = 0; i < laws.size(); ++i)
        if (laws[i] == table) return static_cast<int>(i);
    if (table->version != RATTLEBOX_NORMAL_LAW_VERSION)
        throw std::invalid_argument("the law was compiled with the headers of another version");
    laws.push_back(table);
    return static_cast<int>(laws.size()) - 1;
}

// Returns a law of another package for one pair, with its coefficients by their names.
inline LawOf<NormalLaw> external_law(int number, const nb::dict& coefficients) {
    const RattleboxNormalLaw& table = *external_laws().at(static_cast<std::size_t>(number));
    LawNumbers<ExternalLaw> law;
    const auto set = [&](real ExternalLaw::* member, Number value) {
        for (std::size_t k = 0; k < law.numbers.size(); ++k)
            if (ExternalLaw::fields[k].member == member) law.numbers[k] = std::move(value);
    };
    for (Number& each : law.numbers) each = Number(0.0);
    for (int i = 0; i < table.count; ++i) {
        if (!coefficients.contains(table.names[i]))
            throw nb::type_error((std::string(table.name) + " needs " + table.names[i]).c_str());
        law.numbers[static_cast<std::size_t>(i)] = nb::cast<Number>(coefficients[table.names[i]]);
    }
    if (nb::len(coefficients) != static_cast<std::size_t>(table.count))
        throw nb::type_error((std::string(table.name) + " has no such coefficient").c_str());
    set(&ExternalLaw::number, Number(static_cast<real>(number)));
    set(&ExternalLaw::zero_overlap, Number(table.zero_overlap));
    set(&ExternalLaw::tangential_share, Number(table.tangential_share));
    return {law};
}

inline std::optional<LawOf<NormalLaw>> external_law(const std::string& name, const nb::dict& coefficients) {
    const auto& laws = external_laws();
    for (std::size_t i = 0; i < laws.size(); ++i)
        if (name == laws[i]->name) return external_law(static_cast<int>(i), coefficients);
    return {};
}

template <class Laws> void define_laws(nb::module_& module, const char* family, const char* lookup) {
    Laws::each([&]<class Law>(int) {
        const std::string doc =
            "The law '" + std::string(Law::name) + "' for one pair; see its header in core/contact.";
        define_law<Law>(module, class_name(Law::name, family).c_str(), doc.c_str());
    });
    using Any = LawOf<Laws>;
    module.def(
        lookup,
        [](const std::string& law, const nb::typed<nb::dict, nb::str, nb::object>& coefficients) {
            std::optional<Any> made;
            Laws::each([&]<class Law>(int) {
                if (law == Law::name)
                    made = Any{nb::cast<LawNumbers<Law>>(nb::type<LawNumbers<Law>>()(**coefficients))};
            });
            if constexpr (std::is_same_v<Laws, NormalLaw>)
                if (!made) made = external_law(law, coefficients);
            if (!made) throw std::invalid_argument("the core has no law named '" + law + "'");
            return *made;
        },
        nb::arg("law"), nb::arg("coefficients"),
        "Return a law by its name, with its coefficients by their names.");
}

template <class F> Doubles<1> each_value(const Table& arguments, F&& f) {
    std::vector<real> values(arguments.shape(0));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(arguments.data()[i]);
    return owned<Doubles<1>>(std::move(values));
}

inline void add_laws(nb::module_& module) {
    using N = NormalForce;
    const auto visit = [](auto&& f) {
        return [f](const N& own, real speed) {
            return own.choice().visit([&](const auto& law) -> real { return f(law, speed); });
        };
    };
    nb::class_<N, Node>(module, "NormalForce", "A normal contact law for one pair.")
        .def(
            "resized",
            [](const N& own, real radius, real mass, real new_radius, real new_mass) {
                return own.resized({radius, mass}, {new_radius, new_mass});
            },
            nb::arg("radius"), nb::arg("mass"), nb::arg("new_radius"), nb::arg("new_mass"),
            "Return the law of a pair of another size, given R* [m] and m* [kg] of both pairs.")
        .def("contact_time", visit([](const auto& law, real speed) { return law.contact_time(speed); }),
             nb::arg("speed"), "Return the duration of an undamped impact at this speed [s].")
        .def("largest_overlap", visit([](const auto& law, real speed) { return law.largest_overlap(speed); }),
             nb::arg("speed"), "Return an upper bound of the overlap of an impact at this speed [m].")
        .def(
            "damping_ratio",
            [](const N& own, real e, real speed) {
                return own.choice().visit([&](const auto& law) -> real {
                    if constexpr (std::decay_t<decltype(law)>::hysteretic)
                        return 0;
                    else
                        return law.damping_ratio(law.damping(e), speed);
                });
            },
            nb::arg("restitution"), nb::arg("speed"),
            "Return the damping ratio of an impact with this restitution and speed; 0 for a law with "
            "hysteresis.")
        .def_prop_ro(
            "needs_restitution",
            [](const N& own) {
                return own.choice().visit([](const auto& law) { return law.needs_restitution(); });
            },
            "Whether the dashpot follows from a restitution.")
        .def_prop_ro(
            "elastic_coefficient",
            [](const N& own) { return own.choice().visit([](const auto& law) { return law.stiffness; }); },
            "The coefficient of the elastic force, in the unit of the law.")
        .def_prop_ro(
            "effective_mass",
            [](const N& own) { return own.choice().visit([](const auto& law) { return law.mass; }); },
            "Effective mass of the pair [kg].");
    define_laws<NormalLaw>(module, "Force", "normal_law");
    module.def("add_external_law", &add_external_law, nb::arg("address"),
               "Add a normal law of another package, given the address of its table; return its number.");
    module.def(
        "external_law_name",
        [](int number) { return external_laws().at(static_cast<std::size_t>(number))->name; },
        nb::arg("number"), "Return the name of a law of another package.");
    module.def(
        "normal_law_names",
        [] {
            std::vector<std::string> names;
            NormalLaw::each([&]<class Law>(int) { names.emplace_back(Law::name); });
            return names;
        },
        "Return the names of the normal laws of the core.");

    nb::class_<TangentialForce, Node>(module, "TangentialForce", "A tangential contact law for one pair.")
        .def(
            "stiffness_at",
            [](const TangentialForce& own, real radius, real mass, real normal_stiffness, real overlap) {
                return own.choice().visit([&](const auto& law) {
                    const real coefficient = law.coefficient({radius, mass}, normal_stiffness);
                    return law.stiffness(coefficient, depth_from_overlap(overlap));
                });
            },
            nb::arg("radius"), nb::arg("mass"), nb::arg("normal_stiffness"), nb::arg("overlap"),
            "Return the tangential stiffness of a pair at an overlap [N/m].")
        .def_prop_ro(
            "friction_coefficient",
            [](const TangentialForce& own) {
                return own.choice().visit([](const auto& law) { return law.friction; });
            },
            "Friction over normal force.")
        .def_prop_ro(
            "damping_share",
            [](const TangentialForce& own) {
                return own.choice().visit([](const auto& law) { return law.damping; });
            },
            "Damping ratio of the tangential dashpot over that of the normal one.");
    define_laws<TangentialLaw>(module, "Friction", "tangential_law");

    nb::class_<Restitution, Node>(module, "Restitution", "A restitution law for one pair.")
        .def(
            "at",
            [](const Restitution& own, const Table& speeds) {
                const RestitutionLaw law = own.choice();
                return each_value(speeds, [&](real speed) {
                    const Rebound r = rebound(law, speed);
                    return r.outside ? not_a_number : r.e;
                });
            },
            nb::arg("speeds"), "Return the restitution at each speed; NaN outside the range of the law.");
    define_laws<RestitutionLaw>(module, "Restitution", "restitution_law");
    define_law<RollingResistance>(module, "RollingResistance", "Rolling resistance of one pair.");
    module.def(
        "restitution_of_damping",
        [](const Table& ratios, bool zero_overlap) {
            return each_value(ratios,
                              [&](real zeta) { return std::exp(log_restitution(zeta, zero_overlap)); });
        },
        nb::arg("damping_ratio"), nb::arg("zero_overlap"),
        "Return the restitution that each damping ratio gives.");
    module.def(
        "damping_of_restitution",
        [](const Table& e, bool zero_overlap) {
            return each_value(e, [&](real value) { return damping_ratio(value, zero_overlap); });
        },
        nb::arg("restitution"), nb::arg("zero_overlap"),
        "Return the damping ratio that gives each restitution.");
}

} // namespace rattlebox::bindings
