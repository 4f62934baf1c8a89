#include "python/dem.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <chrono>

#include "base/archive.hpp"
#include "dem/simulation.hpp"
#include "python/crew.hpp"
#include "python/read.hpp"
#include "python/write.hpp"

namespace rattlebox::door {

namespace {

using namespace dem;
using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::int64_t, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::vector<Row> rows(nb::handle object) {
    const auto array = nb::cast<Matrix>(object);
    std::vector<Row> result;
    for (std::size_t i = 0; i < array.shape(0); ++i)
        result.push_back(row(array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]));
    return result;
}

Row one_row(nb::handle object) {
    const auto v = reals(object);
    return row(v.at(0), v.at(1), v.at(2));
}

std::vector<int> numbers(nb::handle object) {
    const auto array = nb::cast<Numbers>(object);
    return {array.data(), array.data() + array.size()};
}

Cavity cavity(const nb::dict& d) {
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

class Dem {
    rattlebox::Problem storage_; // of tables
    std::unique_ptr<Simulation> simulation_;
    int threads_ = 1;
    double seconds_ = 0;

    dem::Problem read(const nb::dict& d) {
        Reader reader(storage_, nullptr);
        dem::Problem p;
        reader.number(p.dt, d, "dt");
        p.steps = nb::cast<long>(d["steps"]), p.every = nb::cast<long>(d["every"]);
        p.gravity = one_row(d["gravity"]);
        const auto decay = reals(d["mode_decay"]), stiffness = reals(d["mode_stiffness"]);
        const auto q = reals(d["mode_displacement"]), v = reals(d["mode_velocity"]);
        for (std::size_t m = 0; m < decay.size(); ++m) {
            p.modes.push_back({decay[m], stiffness.at(m)});
            p.start.push_back({q.at(m), v.at(m)});
        }
        const auto loads = nb::cast<nb::list>(d["loads"]), contacts = nb::cast<nb::list>(d["contacts"]);
        storage_.tables.reserve(2 * loads.size() + 2 * contacts.size());
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
            Encounter e;
            reader.choose(e.normal, nb::cast<nb::dict>(entry["normal"]));
            reader.choose(e.restitution, nb::cast<nb::dict>(entry["restitution"]));
            e.by_time = nb::cast<bool>(entry["by_time"]);
            reader.number(e.radius, entry, "radius");
            reader.number(e.mass, entry, "mass");
            reader.number(e.friction, entry, "friction");
            reader.number(e.shear, entry, "shear");
            reader.number(e.tangential_stiffness, entry, "tangential_stiffness");
            reader.number(e.tangential_damping, entry, "tangential_damping");
            reader.number(e.rolling, entry, "rolling");
            reader.number(e.rolling_stiffness, entry, "rolling_stiffness");
            reader.number(e.rolling_damping, entry, "rolling_damping");
            p.encounters.push_back(e);
        }
        for (nb::handle item : nb::cast<nb::list>(d["cavities"]))
            p.cavities.push_back(cavity(nb::cast<nb::dict>(item)));
        return p;
    }

    const Bed& bed(std::size_t b) const { return simulation_->beds().at(b); }

    // Values of particles in the order of the case.
    template <class F> nb::object sorted(const Bed& bed, std::size_t width, F&& f) const {
        std::vector<real> values(static_cast<std::size_t>(bed.particles()) * width);
        for (int i = 0; i < bed.particles(); ++i) {
            const Row r = f(i);
            for (std::size_t a = 0; a < width; ++a)
                values[static_cast<std::size_t>(at(bed.name, i)) * width + a] = r[a];
        }
        const auto n = static_cast<std::size_t>(bed.particles());
        return array(std::move(values),
                     width == 1 ? std::vector<std::size_t>{n} : std::vector<std::size_t>{n, width});
    }

public:
    explicit Dem(const nb::dict& packed) : simulation_(std::make_unique<Simulation>(read(packed))) {}

    bool run(long until, const nb::object& progress) {
        const auto from = std::chrono::steady_clock::now();
        const auto work = [&](std::size_t, int, const std::atomic<bool>& stop) {
            simulation_->run(until, threads_, stop);
        };
        const auto go_on = [&](std::size_t) {
            return progress.is_none() || !progress(simulation_->step()).is(nb::bool_(false));
        };
        const auto measure = [&] {
            seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
        };
        try {
            const bool finished = work_off(1, 1, 1, work, go_on);
            measure();
            return finished;
        } catch (...) {
            measure();
            throw;
        }
    }

    nb::dict records() {
        Records& r = simulation_->records();
        const std::size_t s = r.time.size(), m = simulation_->modes().size(), c = simulation_->beds().size();
        const std::size_t l = simulation_->problem().loads.size();
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

    // At the last step whose forces are known: taken back from where particles are going to.
    nb::dict state() const {
        const long last = std::max(simulation_->step() - 1, 0L);
        const real dt = simulation_->step() > 0 ? simulation_->problem().dt : 0;
        nb::dict d;
        nb::list cavities;
        for (const Bed& b : simulation_->beds()) {
            const auto touched = [&](int i) { return (at(b.touched, i) & 1) != 0; };
            const auto pull = [&](int i) {
                return touched(i) ? at(b.acceleration, i) : simulation_->body_shown();
            };
            nb::dict one;
            one["position"] = sorted(b, 3, [&](int i) {
                return at(b.position, i) - (at(b.velocity, i) - pull(i) * (0.5 * dt)) * dt;
            });
            one["velocity"] = sorted(b, 3, [&](int i) { return at(b.velocity, i) - pull(i) * dt; });
            one["spin"] = sorted(b, 3, [&](int i) {
                return touched(i) ? at(b.spin, i) - at(b.spin_rate, i) * dt : at(b.spin, i);
            });
            std::vector<real> place;
            for (int a = 0; a < 3; ++a) place.push_back(b.shown[a]);
            one["displacement"] = array(std::move(place));
            cavities.append(one);
        }
        d["step"] = last;
        d["time"] = static_cast<real>(last) * simulation_->problem().dt;
        d["cavities"] = cavities;
        std::vector<real> q, p;
        for (const ModeState& m : simulation_->modes()) q.push_back(m.q), p.push_back(m.p);
        d["q"] = array(std::move(q)), d["p"] = array(std::move(p));
        return d;
    }

    // Those that touched at the last instant, and the force on the first of each.
    nb::dict contacts(std::size_t number) const {
        const Bed& b = bed(number);
        std::vector<std::int64_t> first, second;
        std::vector<real> force;
        for (const Chunk& chunk : b.chunks)
            for (const Contacts* list : {&chunk.pairs, &chunk.walls})
                for (int k = 0; k < list->size(); ++k) {
                    const int s = at(list->slot, k), j = at(list->second, k);
                    if (s == Contacts::none) continue;
                    first.push_back(at(b.name, at(list->first, k)));
                    second.push_back(list == &chunk.pairs ? at(b.name, j) : b.particles() + j);
                    for (int a = 0; a < 3; ++a) force.push_back(at(list->kept, s).force[a]);
                }
        nb::dict d;
        const std::size_t n = first.size();
        d["first"] = array(std::move(first)), d["second"] = array(std::move(second));
        d["force"] = array(std::move(force), {n, 3});
        return d;
    }

    nb::dict counters() const {
        nb::dict d;
        std::vector<std::int64_t> touches;
        real deepest = 0, fastest = 0;
        std::int64_t extrapolated = 0;
        for (const Bed& b : simulation_->beds()) {
            std::int64_t sum[2] = {};
            for (const Chunk& c : b.chunks) {
                const Tally& t = c.tally;
                for (int k = 0; k < 2; ++k) sum[k] += t.first_touches[k];
                deepest = std::fmax(deepest, largest(t.deepest));
                fastest = std::fmax(fastest, t.fastest);
                extrapolated += t.extrapolated;
            }
            touches.insert(touches.end(), sum, sum + 2);
        }
        const std::size_t cavities = simulation_->beds().size();
        d["steps"] = simulation_->step(), d["rebuilds"] = simulation_->builds(),
        d["refreshes"] = simulation_->scans();
        d["first_touches"] = array(std::move(touches), {cavities, 2});
        d["largest_overlap"] = deepest, d["largest_approach_speed"] = fastest,
        d["extrapolated"] = extrapolated;
        d["memory_bytes"] = simulation_->memory();
        d["seconds"] = seconds_;
        return d;
    }

    nb::dict stopped() const {
        nb::dict d;
        const Stopped& s = simulation_->stopped();
        d["cavity"] = simulation_->stopped_cavity(), d["particle"] = s.particle, d["wall"] = s.wall;
        d["time"] = static_cast<real>(simulation_->step() - 1) * simulation_->problem().dt,
        d["speed"] = s.value;
        return d;
    }

    nb::object save() {
        Writer writer;
        simulation_->keep(writer);
        std::vector<std::uint8_t> bytes(writer.bytes.begin(), writer.bytes.end());
        return array(std::move(bytes));
    }

    void restore(const Bytes& bytes) {
        BackReader reader(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
        simulation_->keep(reader);
        if (!reader.at_end()) throw std::invalid_argument("the state is of another case");
        simulation_->resume();
    }

    int status() const { return static_cast<int>(simulation_->status()); }
    int threads() const { return threads_; }
    void set_threads(int n) {
        if (n < 1) throw std::invalid_argument("at least one thread is needed");
        threads_ = n;
    }
    long step() const { return simulation_->step(); }
};

} // namespace

void add_dem(nb::module_& module) {
    nb::class_<Dem>(module, "Dem", "A granular damper that is run in pieces; see rattlebox/engines/dem.py.")
        .def(nb::init<const nb::dict&>(), nb::arg("packed"))
        .def("run", &Dem::run, nb::arg("until"), nb::arg("progress") = nb::none(),
             "Go on until the sample of step `until` is taken; False when it was stopped before.")
        .def("records", &Dem::records, "Samples taken since the last call.")
        .def("state", &Dem::state)
        .def("contacts", &Dem::contacts, nb::arg("cavity"))
        .def("counters", &Dem::counters)
        .def("stopped", &Dem::stopped)
        .def("save", &Dem::save, "All that a bitwise restart needs.")
        .def("restore", &Dem::restore, nb::arg("bytes"))
        .def_prop_ro("status", &Dem::status)
        .def_prop_ro("step", &Dem::step)
        .def_prop_rw("threads", &Dem::threads, &Dem::set_threads);
}

} // namespace rattlebox::door
