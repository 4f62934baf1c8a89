#include "python/dem.hpp"

#include <chrono>

#include "util/archive.hpp"
#include "dem/simulation.hpp"
#include "python/crew.hpp"
#include "python/dem_case.hpp"

namespace rattlebox::door {

namespace {

using namespace dem;
using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

class Dem {
    rattlebox::Problem storage_; // of tables
    std::unique_ptr<Simulation> simulation_;
    int threads_ = 1;
    double seconds_ = 0;

    const Bed& bed(std::size_t b) const { return simulation_->beds().at(b); }

public:
    explicit Dem(const nb::dict& packed)
        : simulation_(std::make_unique<Simulation>(read_dem(storage_, packed))) {}

    bool run(long until, const nb::object& progress) {
        const auto from = std::chrono::steady_clock::now();
        const auto work = [&](std::size_t, int, const std::atomic<bool>& stop) {
            simulation_->run(until, threads_, stop);
        };
        const auto run_steps = [&](std::size_t) {
            return progress.is_none() || !progress(simulation_->step()).is(nb::bool_(false));
        };
        const auto measure = [&] {
            seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
        };
        try {
            const bool finished = work_off(1, 1, 1, work, run_steps);
            measure();
            return finished;
        } catch (...) {
            measure();
            throw;
        }
    }

    nb::dict records() { return write_records(simulation_->records(), simulation_->problem()); }

    nb::dict state() const {
        const real dt = simulation_->problem().dt, passed = simulation_->step() > 0 ? dt : 0;
        nb::list cavities;
        for (const Bed& b : simulation_->beds()) {
            const auto rates = [&](int i) {
                return at(b.touched, i) ? at(b.rates, i) : Rates{simulation_->body_shown(), {}};
            };
            cavities.append(write_bed(b, b.particles(), b.name, rates, passed));
        }
        const auto& modes = simulation_->modes();
        return write_state(simulation_->step(), dt, modes, modes.size(), cavities);
    }

    // Those that touched at the last instant, where `advance` was asked to end, and the force on the first of
    // each.
    nb::dict contacts(std::size_t number) const {
        const Bed& b = bed(number);
        Touching touching;
        if (!simulation_->has_contact_forces())
            throw std::logic_error("single contacts are known where a run was asked to end");
        for (const Chunk& chunk : b.chunks)
            for (const ContactList* list : {&chunk.pairs, &chunk.walls})
                for (int a = 0; a < list->touching_count; ++a) {
                    const int k = at(list->touching, a), j = at(list->second, k);
                    touching.add(at(b.name, at(list->first, k)),
                                 list == &chunk.pairs ? at(b.name, j) : b.particles() + j,
                                 at(list->contact_forces.all, a).force);
                }
        return touching.write();
    }

    nb::dict counters() const {
        Counts counts;
        std::int64_t candidates = 0;
        std::vector<real> enduring;
        for (const Bed& b : simulation_->beds()) {
            counts.begin();
            enduring.push_back(0);
            for (const Chunk& c : b.chunks) {
                candidates += c.pairs.size() + c.walls.size();
                counts.see(c.tally.first_touches, c.tally.deepest.ratio(), c.tally.fastest);
                counts.extrapolated += c.tally.extrapolated;
                for (const Lanes& lost : c.tally.enduring) enduring.back() += total(lost);
            }
        }
        nb::dict d = counts.write(simulation_->beds().size(), simulation_->step(), simulation_->builds(),
                                  simulation_->scans(), simulation_->memory(), seconds_);
        d["candidates"] = candidates;
        d["enduring_loss"] = array(std::move(enduring));
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
        Sizer size;
        simulation_->keep(size);
        Writer writer(size.bytes);
        simulation_->keep(writer);
        return array(std::move(writer.bytes));
    }

    void restore(const Bytes& bytes) {
        BackReader reader(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
        simulation_->restore(reader);
    }

    int status() const { return static_cast<int>(simulation_->status()); }
    int threads() const { return threads_; }
    void set_threads(int n) {
        if (n < 1) throw std::invalid_argument("at least one thread is needed");
        threads_ = n;
    }
    long step() const { return simulation_->step(); }
    long serial_steps() const { return simulation_->serial_steps(); }
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
        .def_prop_ro("lone_steps", &Dem::serial_steps, "Of a team that was held up, by one of them.")
        .def_prop_rw("threads", &Dem::threads, &Dem::set_threads);
}

} // namespace rattlebox::door
