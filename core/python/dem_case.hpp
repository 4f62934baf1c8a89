// Granular dampers through the door: packed cases in, records out.
#pragma once

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "dem/records.hpp"
#include "python/read.hpp"
#include "python/write.hpp"

namespace rattlebox::door {

using namespace dem;
using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::int64_t, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

inline std::vector<Row> rows(nb::handle object) {
    const auto array = nb::cast<Matrix>(object);
    std::vector<Row> result;
    for (std::size_t i = 0; i < array.shape(0); ++i)
        result.push_back(row(array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]));
    return result;
}

inline Row one_row(nb::handle object) {
    const auto v = reals(object);
    return row(v.at(0), v.at(1), v.at(2));
}

inline std::vector<int> numbers(nb::handle object) {
    const auto array = nb::cast<Numbers>(object);
    return {array.data(), array.data() + array.size()};
}

inline Cavity cavity(const nb::dict& d) {
    Cavity c;
    c.shape = rows(d["shape"]);
    const auto axis = rows(d["wall_axis"]);
    const auto offset = reals(d["wall_offset"]), curved = reals(d["wall_curved"]);
    const auto kind = numbers(d["wall_kind"]);
    if (axis.size() > 32) throw std::invalid_argument("a cavity has 32 walls at most");
    for (std::size_t w = 0; w < axis.size(); ++w) {
        Wall wall{axis[w], static_cast<Wall::Form>(static_cast<int>(curved.at(w))), kind.at(w)};
        wall.axis[3] = offset.at(w);
        c.walls.push_back(wall);
    }
    c.position = rows(d["position"]), c.velocity = rows(d["velocity"]), c.spin = rows(d["spin"]);
    const auto radius = reals(d["radius"]);
    for (std::size_t i = 0; i < radius.size(); ++i) c.position.at(i)[3] = radius[i];
    c.mass = reals(d["mass"]), c.inertia = reals(d["inertia"]);
    c.kind = numbers(d["kind"]);
    c.particle_entry = numbers(d["particle_entry"]), c.wall_entry = numbers(d["wall_entry"]);
    const auto shape = nb::cast<Numbers>(d["wall_entry"]);
    c.kinds = static_cast<int>(shape.shape(0)), c.wall_kinds = static_cast<int>(shape.shape(1));
    return c;
}

// `storage` keeps what tables point to.
inline dem::Problem read_dem(rattlebox::Problem& storage, const nb::dict& d) {
    Reader reader(storage, nullptr);
    dem::Problem p;
    reader.number(p.dt, d, "dt");
    if (d.contains("enduring")) reader.number(p.enduring, d, "enduring");
    p.steps = nb::cast<long>(d["steps"]), p.every = nb::cast<long>(d["every"]);
    p.gravity = one_row(d["gravity"]);
    const auto decay = reals(d["mode_decay"]), stiffness = reals(d["mode_stiffness"]);
    const auto q = reals(d["mode_displacement"]), v = reals(d["mode_velocity"]);
    for (std::size_t m = 0; m < decay.size(); ++m) {
        p.modes.push_back({decay[m], stiffness.at(m)});
        p.start.push_back({q.at(m), v.at(m)});
    }
    if (d.contains("mode_coupling")) p.coupling = reals(d["mode_coupling"]);
    const auto loads = nb::cast<nb::list>(d["loads"]), contacts = nb::cast<nb::list>(d["contacts"]);
    storage.tables.reserve(2 * loads.size() + 8 * contacts.size());
    for (nb::handle item : loads) {
        const auto entry = nb::cast<nb::dict>(item);
        Load load;
        reader.signal(load.signal, entry);
        load.shape = reals(entry["shape"]);
        load.base = nb::cast<bool>(entry["base"]);
        p.loads.push_back(std::move(load));
        p.load_direction.push_back(one_row(entry["direction"]));
    }
    for (nb::handle item : contacts) {
        const auto entry = nb::cast<nb::dict>(item);
        PairLaw e;
        reader.choose(e.normal, nb::cast<nb::dict>(entry["normal"]));
        reader.choose(e.restitution, nb::cast<nb::dict>(entry["restitution"]));
        reader.choose(e.tangential, nb::cast<nb::dict>(entry["tangential"]));
        reader.fill(e.rolling, nb::cast<nb::dict>(entry["rolling"]));
        reader.number(e.size.radius, entry, "radius");
        reader.number(e.size.mass, entry, "mass");
        p.pair_laws.push_back(e);
    }
    for (nb::handle item : nb::cast<nb::list>(d["cavities"]))
        p.cavities.push_back(cavity(nb::cast<nb::dict>(item)));
    return p;
}

// What is recorded is given away.
inline nb::dict write_records(Records& r, const dem::Problem& problem) {
    const std::size_t s = r.time.size(), m = problem.modes.size(), c = problem.cavities.size();
    const std::size_t l = problem.loads.size();
    nb::dict d;
    using Shape = std::vector<std::size_t>;
    d["time"] = array(std::move(r.time));
    d["q"] = array(std::move(r.q), Shape{s, m});
    d["p"] = array(std::move(r.p), Shape{s, m});
    d["load_work"] = array(std::move(r.load_work), Shape{s, l});
    d["base_work"] = array(std::move(r.base_work), Shape{s, l});
    d["viscous_loss"] = array(std::move(r.viscous), Shape{s, m});
    d["kinetic"] = array(std::move(r.kinetic), Shape{s, c});
    d["rotation"] = array(std::move(r.rotation), Shape{s, c});
    d["potential"] = array(std::move(r.potential), Shape{s, c});
    d["elastic"] = array(std::move(r.stored), Shape{s, c});
    d["centre"] = array(std::move(r.centre), Shape{s, c, 3});
    d["momentum"] = array(std::move(r.momentum), Shape{s, c, 3});
    d["force"] = array(std::move(r.force), Shape{s, c, 3});
    d["moment"] = array(std::move(r.moment), Shape{s, c, 3});
    d["normal_loss"] = array(std::move(r.normal), Shape{s, c, 2});
    d["plastic_loss"] = array(std::move(r.plastic), Shape{s, c, 2});
    d["sliding_loss"] = array(std::move(r.sliding), Shape{s, c, 2});
    d["rolling_loss"] = array(std::move(r.rolling), Shape{s, c, 2});
    d["contacts"] = array(std::move(r.contacts), Shape{s, c, 2});
    r = Records{};
    return d;
}

// Values f(i) of particles, in the order of their numbers in the case.
template <class Name, class F> nb::object by_name(int n, std::size_t width, Name&& name, F&& f) {
    const auto count = static_cast<std::size_t>(n);
    std::vector<real> values(count * width);
    for (int i = 0; i < n; ++i) {
        const Row r = f(i);
        for (std::size_t a = 0; a < width; ++a) values[static_cast<std::size_t>(name(i)) * width + a] = r[a];
    }
    return array(std::move(values), {count, width});
}

// Contacts of a cavity, and the force on the first of each.
struct Touching {
    std::vector<std::int64_t> first, second;
    std::vector<real> force;

    void add(int one, int other, Row force_on_cavity) {
        first.push_back(one), second.push_back(other);
        for (int a = 0; a < 3; ++a) force.push_back(force_on_cavity[a]);
    }

    nb::dict write() {
        nb::dict d;
        const std::size_t n = first.size();
        d["first"] = array(std::move(first)), d["second"] = array(std::move(second));
        d["force"] = array(std::move(force), {n, 3});
        return d;
    }
};

// Places, velocities and spins at the last step whose forces are known: taken back from where particles are
// going to.
template <class Bed, class N, class R>
nb::dict write_bed(const Bed& b, int n, const N& name, const R& rates, real dt) {
    const auto number = [&](int i) { return name[i]; };
    nb::dict one;
    one["position"] = by_name(n, 3, number, [&](int i) {
        return b.position[i] - (b.velocity[i] - rates(i).velocity * (0.5 * dt)) * dt;
    });
    one["velocity"] = by_name(n, 3, number, [&](int i) { return b.velocity[i] - rates(i).velocity * dt; });
    one["spin"] = by_name(n, 3, number, [&](int i) { return b.spin[i] - rates(i).spin * dt; });
    one["displacement"] = array(std::vector<real>{b.shown[0], b.shown[1], b.shown[2]});
    return one;
}

// At the last step whose forces are known; `step` is the one to come.
template <class Modes>
nb::dict write_state(long step, real dt, const Modes& modes, std::size_t count, const nb::list& cavities) {
    nb::dict d;
    const long last = std::max(step - 1, 0L);
    d["step"] = last, d["time"] = static_cast<real>(last) * dt, d["cavities"] = cavities;
    std::vector<real> q, p;
    for (std::size_t m = 0; m < count; ++m) q.push_back(modes[m].q), p.push_back(modes[m].p);
    d["q"] = array(std::move(q)), d["p"] = array(std::move(p));
    return d;
}

// What the contacts of each cavity have come to.
struct Counts {
    std::vector<std::int64_t> touches;
    std::vector<real> deepest, fastest;
    std::int64_t extrapolated = 0;

    // One cavity after the other.
    void begin() {
        touches.insert(touches.end(), 2, 0);
        deepest.push_back(0), fastest.push_back(0);
    }
    void see(const auto first_touches[2], real overlap, real speed) {
        for (std::size_t p = 0; p < 2; ++p) touches[touches.size() - 2 + p] += first_touches[p];
        deepest.back() = std::fmax(deepest.back(), overlap),
        fastest.back() = std::fmax(fastest.back(), speed);
    }

    nb::dict write(std::size_t cavities, long step, long rebuilds, long refreshes, std::size_t memory,
                   double seconds) {
        nb::dict d;
        d["steps"] = step, d["rebuilds"] = rebuilds, d["refreshes"] = refreshes;
        d["first_touches"] = array(std::move(touches), {cavities, 2});
        d["largest_overlap"] = array(std::move(deepest));
        d["largest_approach_speed"] = array(std::move(fastest));
        d["extrapolated"] = extrapolated, d["memory_bytes"] = memory, d["seconds"] = seconds;
        return d;
    }
};

} // namespace rattlebox::door
