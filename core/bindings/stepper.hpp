// Binding of packed cases and steppers.
#pragma once

#include <nanobind/stl/array.h>

#include "bindings/dem_problem.hpp"
#include "bindings/jobs.hpp"
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

// Makes a step with advance(stop). A long step runs on another thread, while this one checks for Ctrl-C,
// after which the stepper is where the step began.
template <class Advance> Status interruptible(Stepper& stepper, real length, Advance&& advance) {
    constexpr real noticeable = 0.1; // s
    if (!(stepper.computing_time(length) > noticeable)) return advance(never);
    const std::vector<std::uint8_t> before = stepper.save();
    Status status{};
    try {
        run_jobs(
            1, 1, 1, [&](std::size_t, int, const std::atomic<bool>& stop) { status = advance(stop); },
            [](std::size_t) { return true; });
    } catch (const nb::python_error&) {
        stepper.restore(before.data(), before.size());
        throw;
    }
    return status;
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
                const real* values = inputs_of(inputs, static_cast<std::size_t>(s.inputs()));
                return interruptible(s, length, [&](const std::atomic<bool>& stop) {
                    return s.advance(length, values, stop);
                });
            },
            nb::arg("length"), nb::arg("inputs"),
            "Advance by a step with accelerations of the attachment or values of the loads.")
        .def(
            "advance_to_velocity",
            [inputs_of](S& s, double length, const Vector& velocity) {
                const real* values = inputs_of(velocity, static_cast<std::size_t>(s.components()));
                return interruptible(s, length, [&](const std::atomic<bool>& stop) {
                    return s.advance_to_velocity(length, values, stop);
                });
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
        .def_prop_ro("start_jump", &S::start_jump,
                     "Change of the attachment's velocity in the first step if it is not followed by another "
                     "[m/s]; else 0.")
        .def_prop_ro("energy_residual", &S::energy_residual,
                     "Largest imbalance of the energies so far over the energy put in.")
        .def_prop_ro("status", &S::status)
        .def_prop_ro(
            "stopped",
            [](const S& s) { return nb::make_tuple(s.stop().damper, s.stop().member, s.stop().value); },
            nb::sig("def stopped(self) -> tuple[int, int, float]"),
            "Damper, its contact or particle, and the value of the status: where the stepper stopped.")
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
