// Binding of the measures, for runs whose samples are arrays in Python.
#pragma once

#include "bindings/node.hpp"
#include "impact/observer.hpp"

namespace rattlebox::bindings {

// A window of a recorded run, as util/measures.hpp needs it. Arrays that the requested measures do not need
// may be empty, and numbers NaN. Energies count from the start of the window.
struct RecordedRun : Node {
    Table times, displacement, velocity; // of the point
    // Acceleration of the point relative to the base at both ends of each step, and that of the base in its
    // direction.
    Table start_acceleration, end_acceleration, base_acceleration;
    Table damper_force; // means between samples, one fewer than these
    Table base_force;
    Table motion_energy, gravity_energy, work_of_load, work_of_base, viscous_loss, contact_loss;
    double period = not_a_number, loss = not_a_number, content_mass = not_a_number, speed = not_a_number,
           effective_mass = not_a_number, damping_mass = not_a_number;

    static constexpr bool is_even = false; // a window may start between two samples

    std::size_t count() const { return times.shape(0); }
    std::size_t last() const { return count() - 1; }
    real time(std::size_t i) const { return times.data()[i]; }
    real length() const { return time(last()) - time(0); }
    real cycles() const { return length() / period; }

    ModeState point(std::size_t i) const { return {displacement.data()[i], velocity.data()[i]}; }
    std::array<real, 2> accelerations(std::size_t i, Frame frame) const {
        std::array<real, 2> ends{start_acceleration.data()[i - 1], end_acceleration.data()[i - 1]};
        if (frame == Frame::absolute)
            for (std::size_t end = 0; end < 2; ++end) ends[end] += base_acceleration.data()[i - 1 + end];
        return ends;
    }
    real mean_damper_force(std::size_t i) const { return damper_force.data()[i - 1]; }
    real interface_force(std::size_t i) const { return base_force.data()[i]; }

    real motion(std::size_t i) const { return motion_energy.data()[i]; }
    real gravity(std::size_t i) const { return gravity_energy.data()[i]; }
    real load_work(std::size_t i) const { return work_of_load.data()[i]; }
    real base_work(std::size_t i) const { return work_of_base.data()[i]; }
    real viscous(std::size_t i) const { return viscous_loss.data()[i]; }
    real impact(std::size_t i) const { return contact_loss.data()[i]; }
    real handled(std::size_t i, real moving, real potential) const {
        return moving + std::fabs(potential) + viscous(i) + std::fabs(load_work(i)) + std::fabs(base_work(i));
    }

    bool has_dampers() const { return true; }
    real loss_per_cycle() const { return loss; }
    real mass() const { return content_mass; }
    real cavity_speed() const { return speed; }
    std::complex<real> apparent_mass() const { return {effective_mass, -damping_mass}; }
};

inline std::vector<int> measure_indices(const std::vector<std::string>& names) {
    std::vector<int> indices;
    for (const std::string& name : names) {
        int number = -1;
        for (int m = 0; m < static_cast<int>(std::size(measures<Observer>)); ++m)
            if (name == measures<Observer>[m].name) number = m;
        if (number < 0) throw std::invalid_argument("the core has no measure named '" + name + "'");
        indices.push_back(number);
    }
    return indices;
}

inline std::vector<real> measure(const RecordedRun& run, const std::vector<std::string>& names) {
    std::vector<real> values;
    for (const int m : measure_indices(names)) {
        const Measure<RecordedRun>& each = measures<RecordedRun>[m];
        if (each.needs & single_impacts)
            throw std::invalid_argument(std::string(each.name) + " needs the impact log of a 1-D run");
        values.push_back(each.value(run));
    }
    return values;
}

// A row of the table without its formula.
struct MeasureRow : Node {
    std::string name, unit, meaning, average;
    bool cyclic = false, of_impacts = false, of_samples = false, of_base_force = false,
         of_loss_in_cycle = false, of_acceleration = false, of_first_harmonic = false;
};

inline std::vector<MeasureRow> measure_rows() {
    std::vector<MeasureRow> rows;
    for (const Measure<Observer>& m : measures<Observer>)
        rows.push_back({{},
                        m.name,
                        m.unit,
                        m.meaning,
                        m.average,
                        m.cyclic,
                        m.need(single_impacts),
                        m.need(samples),
                        m.need(force_on_base),
                        m.need(loss_in_cycle),
                        m.need(acceleration),
                        m.need(first_harmonic)});
    return rows;
}

inline void add_measures(nb::module_& module) {
    using R = RecordedRun;
    define<R>(module, "RecordedRun",
              "A window of a recorded run. Arrays that the requested measures do not need may be empty, and "
              "numbers "
              "NaN.",
              field("time", &R::times), field("displacement", &R::displacement),
              field("velocity", &R::velocity), field("start_acceleration", &R::start_acceleration),
              field("end_acceleration", &R::end_acceleration),
              field("base_acceleration", &R::base_acceleration), field("damper_force", &R::damper_force),
              field("base_force", &R::base_force), field("motion", &R::motion_energy),
              field("gravity", &R::gravity_energy), field("load_work", &R::work_of_load),
              field("base_work", &R::work_of_base), field("viscous_loss", &R::viscous_loss),
              field("contact_loss", &R::contact_loss), field("period", &R::period, not_a_number),
              field("loss_per_cycle", &R::loss, not_a_number), field("mass", &R::content_mass, not_a_number),
              field("cavity_speed", &R::speed, not_a_number),
              field("effective_mass", &R::effective_mass, not_a_number),
              field("damping_mass", &R::damping_mass, not_a_number));
    using M = MeasureRow;
    define<M>(module, "Measure", "Name, unit, meaning and requirements of a measure.",
              field("name", &M::name), field("unit", &M::unit), field("meaning", &M::meaning),
              field("average", &M::average), field("cyclic", &M::cyclic), field("of_impacts", &M::of_impacts),
              field("of_samples", &M::of_samples), field("of_base_force", &M::of_base_force),
              field("of_loss_in_cycle", &M::of_loss_in_cycle), field("of_acceleration", &M::of_acceleration),
              field("of_first_harmonic", &M::of_first_harmonic));
    module.def("measures", &measure_rows, "Return the measures in the order of their table.");
    module.def("measure", &measure, nb::arg("run"), nb::arg("names"), "Return measures of a recorded run.");
    module.attr("most_batches") = most_batches;
    module.def(
        "settled_after",
        [](const Table& time, const Table& values, real limit) {
            return settled_after([&](std::size_t i) { return time.data()[i]; },
                                 [&](std::size_t i) { return values.data()[i]; }, time.shape(0) - 1, limit);
        },
        nb::arg("time"), nb::arg("values"), nb::arg("limit"),
        "Return the time after which the magnitude of a signal is at most a limit; see "
        "`rattlebox.analysis.settling_time`.");
}

} // namespace rattlebox::bindings
