// Hands results to Python as NumPy arrays that own their memory.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <vector>

#include "impact/log.hpp"

namespace rattlebox::door {

namespace nb = nanobind;

template <class T> nb::object array(std::vector<T> values, std::vector<std::size_t> shape = {}) {
    auto* owned = new std::vector<T>(std::move(values));
    if (shape.empty()) shape = {owned->size()};
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.data(), owner));
}

template <class T, class F> nb::object column(const std::vector<Impact>& impacts, F&& f) {
    std::vector<T> values;
    values.reserve(impacts.size());
    for (const Impact& i : impacts) values.push_back(static_cast<T>(f(i)));
    return array(std::move(values));
}

inline nb::dict write(const Problem& problem, Result&& r, double seconds) {
    nb::dict d;
    Samples& s = r.samples;
    d["time"] = array(std::move(s.time));
    d["state"] = array(std::move(s.state));
    d["given"] = array(std::move(s.given));
    d["load_work"] = array(std::move(s.load_work));
    d["base_work"] = array(std::move(s.base_work));
    d["viscous"] = array(std::move(s.viscous));
    d["normal"] = array(std::move(s.normal));
    d["plastic"] = array(std::move(s.plastic));
    d["stored"] = array(std::move(s.stored));
    d["force"] = array(std::move(s.force));
    nb::dict i;
    const auto& log = r.impacts;
    const auto damper = [&](const Impact& x) {
        return problem.contacts[static_cast<std::size_t>(x.contact)].damper;
    };
    i["damper"] = column<std::int64_t>(log, damper);
    i["contact"] = column<std::int64_t>(log, [&](const Impact& x) {
        return x.contact - problem.dampers[static_cast<std::size_t>(damper(x))].first_contact;
    });
    i["time"] = column<double>(log, [](const Impact& x) { return x.time; });
    i["approach_speed"] = column<double>(log, [](const Impact& x) { return x.approach_speed; });
    i["restitution"] = column<double>(log, [](const Impact& x) { return x.restitution; });
    i["separation_speed"] = column<double>(log, [](const Impact& x) { return x.separation_speed; });
    i["duration"] = column<double>(log, [](const Impact& x) { return x.duration; });
    i["peak_overlap"] = column<double>(log, [](const Impact& x) { return x.peak_overlap; });
    i["peak_force"] = column<double>(log, [](const Impact& x) { return x.peak_force; });
    i["energy_lost"] = column<double>(log, [](const Impact& x) { return x.energy_lost; });
    i["complete"] = column<std::int8_t>(log, [](const Impact& x) { return x.complete; });
    d["impacts"] = i;
    nb::dict c;
    c["events"] = r.counts.events;
    c["flights"] = r.counts.flights;
    c["contact_steps"] = r.counts.contact_steps;
    c["rejected_steps"] = r.counts.rejected_steps;
    c["collocated"] = r.counts.collocated;
    c["extrapolated"] = r.counts.extrapolated;
    c["sticks"] = r.counts.sticks;
    d["counts"] = c;
    d["status"] = static_cast<int>(r.status);
    d["closure_bound"] = problem.settings.closure_bound();
    d["stopped_at"] = r.stopped_at;
    d["stopped_contact"] = r.stopped_contact;
    d["stopped_value"] = r.stopped_value;
    d["seconds"] = seconds;
    return d;
}

} // namespace rattlebox::door
