// Binding of the 3-D engine: a simulation that Python advances in portions.
#include "bindings/dem.hpp"

#include <chrono>

#include "bindings/dem_problem.hpp"
#include "bindings/jobs.hpp"
#include "bindings/stepper.hpp"
#include "dem/simulation.hpp"
#include "util/archive.hpp"

namespace rattlebox::bindings {

namespace {

using namespace dem;
using Progress = std::optional<nb::typed<nb::callable, nb::object(long)>>;

class Dem {
    DemNumbers packed_; // owns the arrays of tables that the simulation uses
    std::unique_ptr<Simulation> simulation_;
    int threads_ = 1;
    double seconds_ = 0;

    const Bed& bed(std::size_t b) const { return simulation_->beds().at(b); }

    // Returns positions, velocities and spins at the last step whose forces are known, computed back from the
    // next step.
    CavityState cavity_state(const Bed& b) const {
        // Particles are predicted to the next step; the state of the last one follows by undoing the
        // prediction.
        const real dt = simulation_->step() > 0 ? simulation_->problem().dt : 0;
        const auto rates = [&](std::size_t i) {
            const int k = static_cast<int>(i);
            return at(b.touched, k) ? at(b.rates, k) : Rates{simulation_->output_body_acceleration(), {}};
        };
        const std::vector<int> number(b.id.begin(), b.id.end());
        if (b.frame.turns() && dt > 0) return turning_state(b, number, dt);
        return {{},
                in_order(number,
                         [&](std::size_t i) {
                             return b.position[i] - (b.velocity[i] - rates(i).velocity * (0.5 * dt)) * dt;
                         }),
                in_order(number, [&](std::size_t i) { return b.velocity[i] - rates(i).velocity * dt; }),
                in_order(number, [&](std::size_t i) { return b.spin[i] - rates(i).spin * dt; }),
                owned<Doubles<1>>(std::vector<real>{b.output_displacement[0], b.output_displacement[1],
                                                    b.output_displacement[2]})};
    }

    // The same in a cavity that turns; velocities and spins are relative to it.
    static CavityState turning_state(const Bed& b, const std::vector<int>& number, real dt) {
        const Frame& frame = b.frame;
        const auto motion = [&](std::size_t i) {
            const int k = static_cast<int>(i);
            Rates rates = b.predicted_rates(k);
            return frame.undo(at(b.position, k), at(b.velocity, k), at(b.spin, k), rates, dt);
        };
        return {{},
                in_order(number, [&](std::size_t i) { return motion(i).position; }),
                in_order(number,
                         [&](std::size_t i) {
                             const AbsoluteMotion m = motion(i);
                             return m.velocity -
                                    frame.point_velocity(frame.radius(m.position), frame.before.speed);
                         }),
                in_order(number,
                         [&](std::size_t i) { return motion(i).spin - frame.axis() * frame.before.speed; }),
                owned<Doubles<1>>(std::vector<real>{b.output_displacement[0], b.output_displacement[1],
                                                    b.output_displacement[2]})};
    }

public:
    explicit Dem(const DemNumbers& packed)
        : packed_(packed), simulation_(std::make_unique<Simulation>(dem_problem(packed_))) {}

    bool run(long until, const Progress& progress) {
        const auto from = std::chrono::steady_clock::now();
        const auto work = [&](std::size_t, int, const std::atomic<bool>& stop) {
            simulation_->run(until, threads_, stop);
        };
        const auto should_continue = [&](std::size_t) {
            return !progress || !(*progress)(simulation_->step()).is(nb::bool_(false));
        };
        const auto measure = [&] {
            seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
        };
        try {
            // As a single job, so that Ctrl-C and progress work as in batches; the simulation has threads of
            // its own.
            const bool finished = run_jobs(1, 1, 1, work, should_continue);
            measure();
            return finished;
        } catch (...) {
            measure();
            throw;
        }
    }

    RecordArrays records() {
        const dem::Problem& p = simulation_->problem();
        std::size_t walls = 0;
        for (const Cavity& cavity : p.cavities)
            walls += static_cast<std::size_t>(p.each_wall ? cavity.wall_labels() : 0);
        return {std::move(simulation_->records()), p.modes.size(), p.loads.size(), p.cavities.size(), walls};
    }

    DemState state() const {
        DemState s;
        s.step = std::max(simulation_->step() - 1, 0L);
        s.time = simulation_->problem().time_at(s.step);
        std::vector<real> q, p;
        for (const ModeState& m : simulation_->modes()) q.push_back(m.q), p.push_back(m.p);
        s.q = owned<Doubles<1>>(std::move(q)), s.p = owned<Doubles<1>>(std::move(p));
        for (const Bed& b : simulation_->beds()) s.cavities.push_back(cavity_state(b));
        return s;
    }

    // Returns the contacts at the step where the last call of run() ended.
    ContactRows contacts(std::size_t cavity) const {
        const Bed& b = bed(cavity);
        if (!simulation_->has_contact_forces())
            throw std::logic_error(
                "contact forces are stored only at the step where run() ended; call run() first");
        std::vector<std::int64_t> first, second;
        std::vector<real> force;
        for (const Chunk& chunk : b.chunks)
            for (const ContactList* list : {&chunk.pairs, &chunk.walls})
                for (int a = 0; a < list->touching_count; ++a) {
                    const int k = at(list->touching, a), j = at(list->second, k);
                    first.push_back(at(b.id, at(list->first, k)));
                    second.push_back(list == &chunk.pairs ? at(b.id, j) : b.particles() + j);
                    const Row push = at(list->contact_forces.all, a).force;
                    for (int x = 0; x < 3; ++x) force.push_back(push[x]);
                }
        const std::size_t n = first.size();
        return {{},
                owned<Integers<1>>(std::move(first)),
                owned<Integers<1>>(std::move(second)),
                owned<Doubles<2>>(std::move(force), {n, 3})};
    }

    DemCounts counts() const {
        DemCounts sum;
        std::vector<std::int64_t> touches;
        std::vector<real> deepest, fastest, enduring;
        for (const Bed& b : simulation_->beds()) {
            std::int64_t own[2] = {};
            deepest.push_back(0), fastest.push_back(0), enduring.push_back(0);
            for (const Chunk& c : b.chunks) {
                sum.candidates += c.pairs.size() + c.walls.size();
                sum.extrapolated += c.diagnostics.extrapolated;
                for (int p = 0; p < 2; ++p) own[p] += c.diagnostics.first_touches[p];
                deepest.back() = std::fmax(deepest.back(), c.diagnostics.largest_overlap.ratio());
                fastest.back() = std::fmax(fastest.back(), c.diagnostics.largest_approach_speed);
                for (const Lanes& lost : c.diagnostics.enduring) enduring.back() += total(lost);
            }
            touches.insert(touches.end(), own, own + 2);
        }
        sum.steps = simulation_->step(), sum.rebuilds = simulation_->rebuilds();
        sum.refreshes = simulation_->scans();
        sum.memory_bytes = simulation_->memory(), sum.seconds = seconds_;
        sum.first_touches = owned<Integers<2>>(std::move(touches), {simulation_->beds().size(), 2});
        sum.largest_overlap = owned<Doubles<1>>(std::move(deepest));
        sum.largest_approach_speed = owned<Doubles<1>>(std::move(fastest));
        sum.enduring_loss = owned<Doubles<1>>(std::move(enduring));
        return sum;
    }

    StoppedAt stopped() const {
        const StopReason& s = simulation_->stop_reason();
        return {{},
                simulation_->stopped_cavity(),
                s.particle,
                s.wall,
                simulation_->problem().time_at(simulation_->step() - 1),
                s.value};
    }

    Bytes save() {
        // Two passes: the first counts bytes, so that a state of gigabytes is allocated once.
        Sizer size;
        simulation_->serialize(size);
        Writer writer(size.bytes);
        simulation_->serialize(writer);
        return owned<Bytes>(std::move(writer.bytes));
    }

    void restore(const SavedState& bytes) {
        Reader reader(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
        simulation_->restore(reader);
    }

    void restart(const SavedState& bytes) {
        Reader reader(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
        simulation_->restart(reader);
    }

    void continue_from(const SavedState& bytes, double dt) {
        Reader reader(reinterpret_cast<const char*>(bytes.data()), bytes.shape(0));
        simulation_->continue_from(reader, dt);
    }

    Status status() const { return simulation_->status(); }
    int threads() const { return threads_; }
    void set_threads(int n) {
        if (n < 1) throw std::invalid_argument("the number of threads must be at least 1");
        threads_ = n;
    }
    long step() const { return simulation_->step(); }
    long serial_steps() const { return simulation_->serial_steps(); }
};

} // namespace

void add_dem(nb::module_& module) {
    add_dem_problem(module);
    add_stepper(module);
    nb::class_<Dem>(module, "Dem", "A simulation of particle dampers, which is advanced in portions.")
        .def(nb::init<const DemNumbers&>(), nb::arg("problem"))
        .def("run", &Dem::run, nb::arg("until"), nb::arg("progress") = nb::none(),
             "Run until the sample of step `until` is taken; return False if it was stopped before.")
        .def("records", &Dem::records, "Return the samples taken since the last call.")
        .def("state", &Dem::state, "Return the state at the last step whose forces are known.")
        .def("contacts", &Dem::contacts, nb::arg("cavity"),
             "Return the contacts at the step where the last call of `run` ended.")
        .def("counts", &Dem::counts, "Return counts and extremes since the start.")
        .def("stopped", &Dem::stopped, "Return where the run stopped.")
        .def("save", &Dem::save, "Return all that a bitwise restart needs.")
        .def("restore", &Dem::restore, nb::arg("bytes"), "Continue from a saved state.")
        .def("restart", &Dem::restart, nb::arg("bytes"),
             "Continue a run of the same case from its end; counts and extremes begin anew.")
        .def("continue_from", &Dem::continue_from, nb::arg("bytes"), nb::arg("dt"),
             "Start from the last sample of a run with the same particles and structure; dt is the step of "
             "that run.")
        .def_prop_ro("status", &Dem::status)
        .def_prop_ro("step", &Dem::step, "The next step.")
        .def_prop_ro("serial_steps", &Dem::serial_steps,
                     "Number of steps that ran on a single thread because of contention.")
        .def_prop_rw("threads", &Dem::threads, &Dem::set_threads);
}

} // namespace rattlebox::bindings
