// Reads the dictionaries that rattlebox/engines/pack.py writes into a Problem. Everything goes by name.
//
// In a batch any number may be an array over the batch's grid, and any vector an array of components over it:
// the problem then holds the first member's number, and a column tells where the others are.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <stdexcept>
#include <string>

#include "impact/batch.hpp"

namespace rattlebox::door {

namespace nb = nanobind;
using Array = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Grid = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

inline std::vector<real> reals(nb::handle object) {
    const auto array = nb::cast<Array>(object);
    return {array.data(), array.data() + array.shape(0)};
}

// What is read must not move afterwards: columns point into the problem.
class Reader {
    Problem& problem_;
    Batch* batch_;

    // One number for each member, from an array whose axes from `first` on are those of the batch.
    void column(real& target, const Grid& array, std::size_t first, std::size_t offset) {
        target = array.data()[offset];
        if (array.ndim() == first) return;
        const std::size_t axes = array.ndim() - first;
        if (!batch_ || axes != batch_->shape.size())
            throw std::invalid_argument("an array has the wrong number of axes");
        Column column{&target, array.data() + offset, std::vector<std::size_t>(axes, 0)};
        std::size_t step = 1;
        for (std::size_t k = axes; k-- > 0;) {
            const std::size_t size = array.shape(first + k);
            if (size != 1 && size != batch_->shape[k])
                throw std::invalid_argument("an array does not fit the grid");
            if (size != 1) column.stride[k] = step;
            step *= size;
        }
        if (step > 1) batch_->columns.push_back(std::move(column));
    }

public:
    Reader(Problem& problem, Batch* batch) : problem_(problem), batch_(batch) {}

    void number(real& target, nb::handle value) {
        if (nb::ndarray_check(value))
            column(target, nb::cast<Grid>(value), 0, 0);
        else
            target = nb::cast<real>(value);
    }

    void number(real& target, const nb::dict& d, const char* key) { number(target, d[key]); }

    std::size_t length(nb::handle vector) const { return nb::cast<Grid>(vector).shape(0); }

    // Component i of a vector.
    void component(real& target, nb::handle vector, std::size_t i) {
        const auto array = nb::cast<Grid>(vector);
        std::size_t each = 1;
        for (std::size_t k = 1; k < array.ndim(); ++k) each *= array.shape(k);
        column(target, array, 1, i * each);
    }

    void vector(std::vector<real>& target, nb::handle value) {
        target.resize(length(value));
        for (std::size_t i = 0; i < target.size(); ++i) component(target[i], value, i);
    }

private:
    Table keep(std::vector<real> values) {
        problem_.tables.push_back(std::move(values));
        return {problem_.tables.back().data(), static_cast<int>(problem_.tables.back().size())};
    }

public:
    // Fills the coefficients of a law by their names.
    template <class Law> void fill(Law& law, const nb::dict& d) {
        for (const auto& field : Law::fields)
            if (d.contains(field.name)) number(law.*field.member, d, field.name);
    }

    // Sets `choice` to the law that carries this name.
    template <class Laws> void choose(Laws& choice, const nb::dict& d) {
        const auto name = nb::cast<std::string>(d["law"]);
        bool found = false;
        Laws::each_type([&](auto* null) {
            using Law = std::remove_const_t<std::remove_pointer_t<decltype(null)>>;
            if (name != Law::name) return;
            Law& law = choice.set(Law{});
            fill(law, d);
            if constexpr (requires { Law::tables; })
                for (const auto& table : Law::tables) law.*table.member = keep(reals(d[table.name]));
            found = true;
        });
        if (!found) throw std::invalid_argument("the core has no law named '" + name + "'");
    }

    void signal(Signal& s, const nb::dict& d) {
        const auto kind = nb::cast<std::string>(d["kind"]);
        if (kind == "record") {
            s.kind = Signal::Kind::record;
            s.times = keep(reals(d["times"]));
            s.values = keep(reals(d["values"]));
            return;
        }
        s.kind = kind == "half_sine" ? Signal::Kind::half_sine : Signal::Kind::harmonic;
        number(s.amplitude, d, "amplitude");
        number(s.frequency, d, "frequency");
        number(s.phase, d, "phase");
        number(s.start, d, "start");
        number(s.stop, d, "stop");
    }

private:
    void settings(Settings& s, const nb::dict& d) {
        const auto method = nb::cast<std::string>(d["method"]);
        s.method = method == "newton"     ? Method::newton
                   : method == "two_step" ? Method::two_step
                                          : Method::event_driven;
        number(s.duration, d, "duration");
        if (d.contains("tolerance")) number(s.tolerance, d, "tolerance");
        if (d.contains("max_events")) s.max_events = nb::cast<long>(d["max_events"]);
        if (d.contains("stick")) number(s.stick, d, "stick");
        if (d.contains("dt_flight")) number(s.dt_flight, d, "dt_flight");
        if (d.contains("dt_contact")) number(s.dt_contact, d, "dt_contact");
        if (d.contains("adaptive_inner")) s.adaptive_inner = nb::cast<bool>(d["adaptive_inner"]);
        if (d.contains("collocation")) s.collocation = nb::cast<bool>(d["collocation"]);
    }

    void damper(Damper& damper, const nb::dict& d) {
        number(damper.clearance, d, "clearance");
        number(damper.gravity, d, "gravity");
        vector(damper.shape, d["shape"]);
        for (std::size_t i = 0; i < static_cast<std::size_t>(damper.balls); ++i) {
            const std::size_t ball = static_cast<std::size_t>(damper.first_ball) + i;
            component(problem_.ball_mass[ball], d["mass"], i);
            component(problem_.ball_position[ball], d["position"], i);
            component(problem_.ball_velocity[ball], d["velocity"], i);
        }
    }

public:
    void problem(const nb::dict& d) {
        const std::size_t modes = length(d["mode_decay"]);
        problem_.modes.resize(modes);
        if (d.contains("mode_coupling")) vector(problem_.coupling, d["mode_coupling"]);
        problem_.start.resize(modes);
        for (std::size_t k = 0; k < modes; ++k) {
            component(problem_.modes[k].decay, d["mode_decay"], k);
            component(problem_.modes[k].stiffness, d["mode_stiffness"], k);
            component(problem_.start[k].q, d["mode_displacement"], k);
            component(problem_.start[k].p, d["mode_velocity"], k);
        }
        const auto loads = nb::cast<nb::list>(d["loads"]), dampers = nb::cast<nb::list>(d["dampers"]),
                   contacts = nb::cast<nb::list>(d["contacts"]);
        problem_.tables.reserve(2 * loads.size() + 8 * contacts.size());
        problem_.loads.resize(loads.size());
        for (std::size_t l = 0; l < loads.size(); ++l) {
            const auto entry = nb::cast<nb::dict>(loads[l]);
            signal(problem_.loads[l].signal, entry);
            vector(problem_.loads[l].shape, entry["shape"]);
            problem_.loads[l].base = nb::cast<bool>(entry["base"]);
        }
        problem_.dampers.resize(dampers.size());
        problem_.contacts.resize(contacts.size());
        std::size_t balls = 0;
        for (std::size_t i = 0; i < dampers.size(); ++i) {
            Damper& damper = problem_.dampers[i];
            damper.first_ball = static_cast<int>(balls);
            damper.first_contact = static_cast<int>(balls + i);
            damper.balls = static_cast<int>(length(nb::cast<nb::dict>(dampers[i])["mass"]));
            balls += static_cast<std::size_t>(damper.balls);
            for (int k = 0; k <= damper.balls; ++k) {
                Contact& contact = problem_.contacts.at(static_cast<std::size_t>(damper.first_contact + k));
                contact.damper = static_cast<int>(i);
                contact.below = k == 0 ? wall : damper.first_ball + k - 1;
                contact.above = k == damper.balls ? wall : damper.first_ball + k;
            }
            problem_.ball_damper.resize(balls, static_cast<int>(i));
        }
        problem_.ball_mass.resize(balls);
        problem_.ball_position.resize(balls);
        problem_.ball_velocity.resize(balls);
        for (std::size_t i = 0; i < dampers.size(); ++i)
            damper(problem_.dampers[i], nb::cast<nb::dict>(dampers[i]));
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const auto entry = nb::cast<nb::dict>(contacts[c]);
            number(problem_.contacts[c].mass, entry, "mass");
            choose(problem_.contacts[c].normal, nb::cast<nb::dict>(entry["normal"]));
            choose(problem_.contacts[c].restitution, nb::cast<nb::dict>(entry["restitution"]));
        }
        if (d.contains("sample_times")) problem_.sample_times = reals(d["sample_times"]);
        settings(problem_.settings, nb::cast<nb::dict>(d["settings"]));
        if (d.contains("contact_samples"))
            problem_.settings.contact_samples = nb::cast<long>(d["contact_samples"]);
    }
};

} // namespace rattlebox::door
