// Binding of packed cases and steppers.
#pragma once

#include <nanobind/stl/array.h>

#include "bindings/dem_problem.hpp"
#include "stepper/engines.hpp"
#include "stepper/stepper.hpp"

namespace rattlebox::bindings {

inline Component component(bool alone, const std::array<double, 3>& velocity,
                           const std::vector<std::vector<double>>& outputs) {
    Component c{.alone = alone, .rows = outputs};
    std::copy_n(velocity.begin(), 3, c.velocity);
    return c;
}

inline nb::bytes as_bytes(const std::vector<std::uint8_t>& bytes) {
    return nb::bytes(bytes.data(), bytes.size());
}
inline const std::uint8_t* data(const nb::bytes& bytes) {
    return static_cast<const std::uint8_t*>(bytes.data());
}

inline void add_stepper(nb::module_& module) {
    const auto pack_arguments = [&](auto pack, const char* doc) {
        module.def("pack_case", pack, nb::arg("problem"), nb::arg("alone"), nb::arg("velocity"),
                   nb::arg("outputs"), doc);
    };
    using Outputs = std::vector<std::vector<double>>;
    pack_arguments(
        [](const ProblemNumbers& numbers, bool alone, const std::array<double, 3>& velocity,
           const Outputs& outputs) {
            PackedCase<rattlebox::Problem> packed;
            fill_problem(packed.problem, numbers);
            packed.component = component(alone, velocity, outputs);
            return as_bytes(pack_case(packed));
        },
        "Return the bytes of a case with impact dampers, for a stepper.");
    pack_arguments(
        [](const DemNumbers& numbers, bool alone, const std::array<double, 3>& velocity,
           const Outputs& outputs) {
            PackedCase<dem::Problem> packed;
            packed.problem = dem_problem(numbers);
            packed.component = component(alone, velocity, outputs);
            return as_bytes(pack_case(packed));
        },
        "Return the bytes of a case with particle dampers, for a stepper.");

    using S = Stepper;
    const auto each_damper = [](std::vector<Components> StepResult::* member) {
        return [member](const S& s) {
            std::vector<real> values;
            const auto& rows = s.result().*member;
            for (const Components& row : rows) values.insert(values.end(), row.begin(), row.end());
            return owned<Doubles<2>>(std::move(values), {rows.size(), 3});
        };
    };
    const auto inputs_of = [](const Vector& values, std::size_t count) {
        require(values.ndim() == 1 && values.shape(0) == count, "a step has the wrong number of inputs");
        return values.data();
    };
    nb::class_<S>(module, "Stepper", "Dampers that are advanced step by step.")
        .def(
            "__init__", [](S* self, const nb::bytes& packed) { new (self) S(data(packed), packed.size()); },
            nb::arg("packed"))
        .def(
            "advance",
            [inputs_of](S& s, double length, const Vector& inputs) {
                return s.advance(length, inputs_of(inputs, static_cast<std::size_t>(s.inputs())));
            },
            nb::arg("length"), nb::arg("inputs"),
            "Advance by a step with accelerations of the attachment or values of the loads.")
        .def(
            "advance_to_velocity",
            [inputs_of](S& s, double length, const Vector& velocity) {
                return s.advance_to_velocity(length,
                                             inputs_of(velocity, static_cast<std::size_t>(s.components())));
            },
            nb::arg("length"), nb::arg("velocity"),
            "Advance by a step at whose end the attachment has this velocity.")
        .def_prop_ro("force", each_damper(&StepResult::force), nb::rv_policy::automatic,
                     "Mean force by damper [N].")
        .def_prop_ro("moment", each_damper(&StepResult::moment), nb::rv_policy::automatic,
                     "Mean moment by damper [N m].")
        .def_prop_ro("work", [](const S& s) { return s.result().work; })
        .def_prop_ro("loss", [](const S& s) { return s.result().loss; })
        .def_prop_ro("stored", [](const S& s) { return s.result().stored; })
        .def_prop_ro(
            "largest_overlap", [](const S& s) { return owned<Doubles<1>>(s.extremes().overlap); },
            nb::rv_policy::automatic,
            "Largest overlap by contact of impact dampers [m], or by particle damper over the radius.")
        .def_prop_ro(
            "largest_approach_speed", [](const S& s) { return owned<Doubles<1>>(s.extremes().speed); },
            nb::rv_policy::automatic,
            "Largest speed of approach by contact of impact dampers, or by particle damper [m/s].")
        .def_prop_ro("status", &S::status)
        .def_prop_ro("restitution", [](const S& s) { return s.options().restitution; })
        .def_prop_ro("friction", [](const S& s) { return s.options().friction; })
        .def_prop_ro("gravity", &S::gravity)
        .def_prop_ro("time", &S::time)
        .def_prop_ro("inputs", &S::inputs)
        .def_prop_ro("components", &S::components)
        .def_prop_ro("velocity", &S::velocity, "Velocity of the attachment [m/s].")
        .def_prop_ro("displacement", &S::displacement, "Displacement of the attachment [m].")
        .def("set_gravity", &S::set_gravity, nb::arg("gravity"))
        .def(
            "outputs",
            [](const S& s, bool velocity) {
                std::vector<real> values;
                for (int i = 0; i < s.outputs(); ++i) values.push_back(s.output(i, velocity));
                return owned<Doubles<1>>(std::move(values));
            },
            nb::arg("velocity") = false, "Displacements or velocities of the output points.")
        .def(
            "save", [](S& s) { return as_bytes(s.save()); }, "Return the state.")
        .def(
            "restore", [](S& s, const nb::bytes& state) { s.restore(data(state), state.size()); },
            nb::arg("state"), "Continue from a saved state.");
}

} // namespace rattlebox::bindings
