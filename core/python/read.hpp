// Reads the dictionaries that rattlebox/engines/pack.py writes into a Problem. Everything goes by name.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <stdexcept>
#include <string>

#include "impact/problem.hpp"

namespace rattlebox::door {

namespace nb = nanobind;
using Array = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

inline std::vector<real> reals(nb::handle object) {
    const auto array = nb::cast<Array>(object);
    return {array.data(), array.data() + array.shape(0)};
}

inline real number(const nb::dict& d, const char* key) { return nb::cast<real>(d[key]); }

inline Table keep(Problem& problem, std::vector<real> values) {
    problem.tables.push_back(std::move(values));
    return {problem.tables.back().data(), static_cast<int>(problem.tables.back().size())};
}

template <class Law> void fill(Law& law, const nb::dict& d, Problem& problem) {
    for (const auto& field : Law::fields)
        if (d.contains(field.name)) law.*field.member = number(d, field.name);
    if constexpr (requires { Law::tables; })
        for (const auto& table : Law::tables) law.*table.member = keep(problem, reals(d[table.name]));
}

// Sets `choice` to the law that carries this name.
template <class Laws> void choose(Laws& choice, const nb::dict& d, Problem& problem) {
    const auto name = nb::cast<std::string>(d["law"]);
    bool found = false;
    Laws::each_type([&](auto* null) {
        using Law = std::remove_const_t<std::remove_pointer_t<decltype(null)>>;
        if (name != Law::name) return;
        Law law;
        fill(law, d, problem);
        choice.set(law);
        found = true;
    });
    if (!found) throw std::invalid_argument("the core has no law named '" + name + "'");
}

inline Signal read_signal(const nb::dict& d, Problem& problem) {
    Signal s;
    const auto kind = nb::cast<std::string>(d["kind"]);
    if (kind == "record") {
        s.kind = Signal::Kind::record;
        s.times = keep(problem, reals(d["times"]));
        s.values = keep(problem, reals(d["values"]));
        return s;
    }
    s.kind = kind == "half_sine" ? Signal::Kind::half_sine : Signal::Kind::harmonic;
    s.amplitude = number(d, "amplitude");
    s.frequency = number(d, "frequency");
    s.phase = number(d, "phase");
    s.start = number(d, "start");
    s.stop = number(d, "stop");
    return s;
}

inline void read_settings(Settings& s, const nb::dict& d) {
    const auto method = nb::cast<std::string>(d["method"]);
    s.method = method == "newton"     ? Method::newton
               : method == "two_step" ? Method::two_step
                                      : Method::event_driven;
    s.duration = number(d, "duration");
    if (d.contains("tolerance")) s.tolerance = number(d, "tolerance");
    if (d.contains("max_events")) s.max_events = nb::cast<long>(d["max_events"]);
    if (d.contains("stick")) s.stick = number(d, "stick");
    if (d.contains("dt_flight")) s.dt_flight = number(d, "dt_flight");
    if (d.contains("dt_contact")) s.dt_contact = number(d, "dt_contact");
    if (d.contains("adaptive_inner")) s.adaptive_inner = nb::cast<bool>(d["adaptive_inner"]);
    if (d.contains("collocation")) s.collocation = nb::cast<bool>(d["collocation"]);
}

inline void read(Problem& problem, const nb::dict& d) {
    const auto decay = reals(d["mode_decay"]), stiffness = reals(d["mode_stiffness"]);
    const auto q = reals(d["mode_displacement"]), p = reals(d["mode_velocity"]);
    for (std::size_t k = 0; k < decay.size(); ++k) {
        problem.modes.push_back({decay[k], stiffness[k]});
        problem.start.push_back({q[k], p[k]});
    }
    const auto loads = nb::cast<nb::list>(d["loads"]);
    const auto contacts = nb::cast<nb::list>(d["contacts"]);
    problem.tables.reserve(2 * loads.size() + 2 * contacts.size()); // Table views must not move
    for (nb::handle item : loads) {
        const auto l = nb::cast<nb::dict>(item);
        problem.loads.push_back({read_signal(l, problem), reals(l["shape"]), nb::cast<bool>(l["base"])});
    }
    for (nb::handle item : nb::cast<nb::list>(d["dampers"])) {
        const auto entry = nb::cast<nb::dict>(item);
        Damper damper;
        damper.first_ball = problem.ball_count();
        damper.clearance = number(entry, "clearance");
        damper.gravity = number(entry, "gravity");
        damper.shape = reals(entry["shape"]);
        const auto mass = reals(entry["mass"]), position = reals(entry["position"]),
                   velocity = reals(entry["velocity"]);
        damper.balls = static_cast<int>(mass.size());
        for (std::size_t i = 0; i < mass.size(); ++i) {
            problem.ball_mass.push_back(mass[i]);
            problem.ball_position.push_back(position[i]);
            problem.ball_velocity.push_back(velocity[i]);
            problem.ball_damper.push_back(problem.damper_count());
        }
        problem.dampers.push_back(std::move(damper));
    }
    std::size_t next = 0;
    for (int i = 0; i < problem.damper_count(); ++i) {
        Damper& damper = problem.dampers[static_cast<std::size_t>(i)];
        damper.first_contact = problem.contact_count();
        for (int k = 0; k <= damper.balls; ++k, ++next) {
            const auto entry = nb::cast<nb::dict>(contacts[next]);
            Contact contact;
            contact.damper = i;
            contact.below = k == 0 ? wall : damper.first_ball + k - 1;
            contact.above = k == damper.balls ? wall : damper.first_ball + k;
            contact.mass = number(entry, "mass");
            choose(contact.normal, nb::cast<nb::dict>(entry["normal"]), problem);
            choose(contact.restitution, nb::cast<nb::dict>(entry["restitution"]), problem);
            problem.contacts.push_back(contact);
        }
    }
    problem.sample_times = reals(d["sample_times"]);
    read_settings(problem.settings, nb::cast<nb::dict>(d["settings"]));
}

} // namespace rattlebox::door
