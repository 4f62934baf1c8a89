#include <nanobind/stl/string.h>

#include <chrono>

#include "dem/wide/near.hpp"
#include "dem/wide/simulation.hpp"
#include "python/crew.hpp"
#include "python/dem.hpp"
#include "python/dem_case.hpp"

namespace rattlebox::door {

namespace {

using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using wide::Account;

Order order_named(const std::string& name) {
    const char* names[] = {"forward", "reverse", "interleaved", "shuffled"};
    for (int k = 0; k < 4; ++k)
        if (name == names[k]) return static_cast<Order>(k);
    throw std::invalid_argument("order must be forward, reverse, interleaved or shuffled, not " + name);
}

class DemWide {
    rattlebox::Problem storage_; // of tables
    wide::Simulation simulation_;
    Records records_;
    double seconds_ = 0;

    const wide::World& world() const { return simulation_.world(); }
    std::size_t beds() const { return static_cast<std::size_t>(world().beds); }

public:
    DemWide(const nb::dict& packed, int slots, int samples)
        : simulation_(read_dem(storage_, packed), slots, samples) {}

    bool run(long until, int threads, const std::string& order, const nb::object& progress) {
        if (threads < 1) throw std::invalid_argument("at least one thread is needed");
        const Order which = order_named(order);
        const auto from = std::chrono::steady_clock::now();
        const auto work = [&](std::size_t, int, const std::atomic<bool>& stop) {
            simulation_.run(until, threads, which, stop, records_);
            seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
        };
        return work_off(1, 1, 1, work, [&](std::size_t) {
            return progress.is_none() || !progress(step()).is(nb::bool_(false));
        });
    }

    nb::dict records() {
        simulation_.take(records_);
        return write_records(records_, simulation_.problem());
    }

    nb::dict state() const {
        const wide::World& w = world();
        nb::list cavities;
        for (std::size_t k = 0; k < beds(); ++k) {
            const wide::Bed& b = w.bed[k];
            const auto rates = [&](int i) {
                return b.touched[i] ? Rates{b.acceleration[i], b.spin_rate[i]}
                                    : Rates{w.control.body_before, {}};
            };
            cavities.append(write_bed(b, b.particles, b.name, rates, step() > 0 ? w.structure.dt : 0));
        }
        return write_state(step(), w.structure.dt, w.structure.shown,
                           static_cast<std::size_t>(w.structure.modes), cavities);
    }

    nb::dict contacts(std::size_t number) const {
        if (number >= beds()) throw std::out_of_range("there is no such cavity");
        const wide::Bed& b = world().bed[number];
        Touching touching;
        for (int i = 0; i < b.particles; ++i)
            for (int k = 0; k < b.slots; ++k) {
                if (!(b.touching[i] >> k & 1u)) continue;
                const int s = k * b.particles + i, partner = b.partner[s];
                touching.add(b.name[i], partner < 0 ? b.particles - 1 - partner : b.name[partner],
                             b.action[s].force);
            }
        return touching.write();
    }

    nb::dict counters() const {
        Counts counts;
        for (std::size_t k = 0; k < beds(); ++k) {
            const wide::Bed& b = world().bed[k];
            counts.begin();
            for (int i = 0; i < b.particles; ++i) {
                const Account& a = b.account[i];
                counts.see(a.touches, b.deepest[i], a.fastest);
                counts.extrapolated += a.extrapolated;
            }
        }
        nb::dict d = counts.write(beds(), step(), world().control.builds, 0, simulation_.memory(), seconds_);
        std::vector<std::int64_t> slots;
        for (std::size_t k = 0; k < beds(); ++k) slots.push_back(world().bed[k].slots);
        d["slots"] = array(std::move(slots));
        return d;
    }

    nb::dict stopped() const {
        const wide::Control& c = world().control;
        nb::dict d;
        d["cavity"] = c.stopped_cavity, d["particle"] = c.stopped_particle, d["wall"] = c.stopped_wall;
        d["time"] = static_cast<real>(c.step - 1) * world().structure.dt, d["speed"] = c.stopped_speed;
        return d;
    }

    nb::object image(std::size_t address) const {
        const std::vector<char> bytes = simulation_.image(address);
        return array(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    }
    void absorb(const Bytes& bytes) {
        simulation_.absorb(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
    }
    bool make_room() {
        simulation_.take(records_);
        return simulation_.make_room();
    }

    int status() const { return static_cast<int>(world().control.status); }
    int pause() const { return static_cast<int>(world().control.pause); }
    long step() const { return world().control.step; }
    std::size_t memory() const { return simulation_.memory(); }

    int near() const { return wide::near_bytes(world()); }
};

} // namespace

void add_dem_wide(nb::module_& module) {
    nb::class_<DemWide>(module, "DemWide",
                        "A granular damper laid out for wide teams; see rattlebox/engines/dem_wide.py.")
        .def(nb::init<const nb::dict&, int, int>(), nb::arg("packed"), nb::arg("slots") = 8,
             nb::arg("samples") = 256)
        .def("run", &DemWide::run, nb::arg("until"), nb::arg("threads") = 1, nb::arg("order") = "forward",
             nb::arg("progress") = nb::none(),
             "Go on until the sample of step `until` is taken; False when it was stopped before.")
        .def("records", &DemWide::records, "Samples taken since the last call.")
        .def("state", &DemWide::state)
        .def("contacts", &DemWide::contacts, nb::arg("cavity"))
        .def("counters", &DemWide::counters)
        .def("stopped", &DemWide::stopped)
        .def("image", &DemWide::image, nb::arg("address") = 0,
             "All of it as it has to lie at an address, which is a multiple of 64.")
        .def("absorb", &DemWide::absorb, nb::arg("bytes"), "Take back an image, whoever worked on it.")
        .def("make_room", &DemWide::make_room, "Take samples out, and grow what was too small; was anything?")
        .def_prop_ro("status", &DemWide::status)
        .def_prop_ro("pause", &DemWide::pause)
        .def_prop_ro("near", &DemWide::near, "Bytes of the arrays that every step uses.")
        .def_prop_ro("memory", &DemWide::memory)
        .def_prop_ro("step", &DemWide::step);
}

} // namespace rattlebox::door
