// The 3-D engine: a structure with cavities full of particles, advanced step by step on several threads.
//
// The structure is propagated exactly between two steps and kicked at each step by the loads and by the
// forces of the particles at the same instant, so that the coupling is of second order and action equals
// reaction.
#pragma once

#include <atomic>
#include <chrono>
#include <utility>

#include "dem/contact_loop.hpp"
#include "dem/integrator.hpp"
#include "dem/partition.hpp"
#include "dem/records.hpp"
#include "dem/restart_check.hpp"
#include "parallel/thread_pool.hpp"

namespace rattlebox::dem {

// Time for which a single worker runs when other programs use the cores (parallel/contention.hpp). It doubles
// if contention is detected again soon after.
class SerialFallback {
    using Clock = std::chrono::steady_clock;
    static constexpr Clock::duration shortest = std::chrono::milliseconds(20),
                                     longest = std::chrono::seconds(1);
    Clock::duration length_ = shortest;
    Clock::time_point end_{};

public:
    bool is_over() const { return Clock::now() >= end_; }
    void begin() {
        const auto now = Clock::now();
        length_ = now - end_ < length_ ? std::min(2 * length_, longest) : shortest;
        end_ = now + length_;
    }
};

// Work of each load by its force and by its base motion, and loss of each mode, up to a step.
struct StructureWork {
    std::vector<real> load, base, viscous;
};

class Simulation {
    Problem problem_;
    std::vector<Bed> beds_;
    std::vector<NeighbourList> neighbours_;
    std::vector<ContactLoop> contact_loops_;
    std::vector<Integrator> integrators_;
    Structure structure_;
    long step_ = 0;
    Status status_ = Status::finished;
    int stopped_cavity_ = 0;
    StopReason stop_reason_;
    // Set after each step: end the run, or pause the other workers.
    struct LoopControl {
        bool halt = false, pause = false;
    } loop_control_;
    bool needs_rebuild_ = true; // before the next step
    long forces_known_at_ = -1; // step whose contact forces are stored
    long rebuilds_ = 0;
    SerialFallback serial_fallback_;
    long serial_steps_ = 0; // by one worker alone, because of contention
    Row body_before_{};
    long steps_since_ = 0;
    Partition partition_;
    Records records_;

    real now() const { return problem_.time_at(step_); }
    bool sampled(long step) const {
        return (step - problem_.first_step) % problem_.sample_interval == 0 || step == problem_.steps;
    }

    // Moves the particles from the cavity into the bed.
    void fill_bed(Bed& bed, Cavity& cavity, bool rolls) {
        bed.cavity = &cavity;
        bed.periods = Periods(cavity.period);
        bed.frame.start(cavity.rotation);
        const int n = cavity.particles();
        const auto size = static_cast<std::size_t>(n);
        bed.velocity.reserve(size), bed.spin.reserve(size), bed.id.reserve(size);
        for (int i = 0; i < n; ++i) {
            const real m = at(cavity.mass, i), radius = at(cavity.position, i)[3];
            Row u = at(cavity.velocity, i), w = at(cavity.spin, i);
            u[3] = 1 / m;
            w[3] = radius / at(cavity.inertia, i);
            bed.mass += m;
            bed.smallest = smaller(bed.smallest, radius);
            bed.velocity.push_back(u);
            bed.spin.push_back(w);
            bed.id.push_back(i);
        }
        if (!cavity.solids.empty()) {
            real largest = 0;
            for (const Row& p : cavity.position) largest = larger(largest, p[3]);
            // A scan lists walls within half of the smallest radius.
            cavity.solids.build(bed.smallest, largest, 0.5 * bed.smallest, cavity.walls);
        }
        bed.position.assign(cavity.position.begin(), cavity.position.end());
        bed.species.assign(cavity.species.begin(), cavity.species.end());
        for (auto* rows : {&cavity.position, &cavity.velocity, &cavity.spin}) std::vector<Row>().swap(*rows);
        for (auto* numbers : {&cavity.mass, &cavity.inertia}) std::vector<real>().swap(*numbers);
        std::vector<int>().swap(cavity.species);
        bed.touched.assign(size, 0);
        bed.rates.assign(size, Rates{});
        bed.rolls = rolls;
        bed.chunks.reserve((size + Bed::chunk_size - 1) / Bed::chunk_size);
        for (int from = 0; from < n; from += Bed::chunk_size)
            bed.chunks.emplace_back(from, std::min(from + Bed::chunk_size, n));
        bed.chunk_motion.assign(bed.chunks.size(), ChunkMotion{.approach = infinity});
    }

    // ---- the structure

    // Sums for each wall begin at zero, unless a state with the same walls has been read.
    void clear_wall_totals(Bed& bed) const {
        const auto labels = static_cast<std::size_t>(problem_.each_wall ? bed.cavity->wall_labels() : 0);
        for (Chunk& chunk : bed.chunks)
            if (chunk.each_wall.size() != labels) chunk.each_wall.assign(labels, WallTotals{});
    }

    // Adapts the structure and the contact laws to the step, gravity and loads of the problem.
    void set_inputs() {
        structure_.set_inputs(problem_.dt, problem_.gravity, problem_.coupling);
        for (ContactLoop& loop : contact_loops_) loop.update_step();
    }

    void update_cavity_motion(Bed& bed) {
        bed.motion = bed.frame.moved(structure_.cavity_motion(bed.cavity->shape.data()));
    }

    // Adds half of the work of the base and of the drives of cavities in this step; the momentum is that of
    // all particles.
    void work_on_particles(Row momentum) {
        for (Bed& bed : beds_) {
            if (!bed.frame.turns()) continue;
            Row moment{};
            for (const Chunk& c : bed.chunks) moment += c.diagnostics.wall_moment;
            bed.frame.drive_work +=
                0.5 * problem_.dt * bed.frame.drive_power(force_on(bed), moment, bed.motion.displacement);
        }
        structure_.work_on_particles(momentum);
    }

    // Returns the mean velocity of the particles, relative to the cavity.
    Row mean_velocity(const Bed& bed) const {
        const Row mean = momentum_of(bed) / bed.mass;
        if (!bed.frame.turns()) return row(mean[0], mean[1], mean[2]);
        Row centre{};
        for (const Chunk& c : bed.chunks) centre += c.diagnostics.mass_moment / bed.mass;
        return row(mean[0], mean[1], mean[2]) -
               bed.frame.point_velocity(bed.frame.radius(centre), bed.frame.now.rate);
    }

    // Acceleration by gravity and the base in cavities that turn.
    void set_body_accelerations() {
        for (Bed& bed : beds_)
            if (bed.frame.turns()) bed.frame.now.body = bed.frame.to_cavity(structure_.body_acceleration);
    }

    Row force_on(const Bed& bed) const {
        Row total{};
        for (const ChunkMotion& motion : bed.chunk_motion) total += row(motion.force_on_cavity);
        return total;
    }

    static Row momentum_of(const Bed& bed) {
        Row total{};
        for (const ChunkMotion& motion : bed.chunk_motion) total += row(motion.momentum);
        return total;
    }

    // In the machine frame.
    Row total_momentum() const {
        Row total{};
        for (const Bed& bed : beds_) total += bed.frame.to_machine(momentum_of(bed));
        return total;
    }

    void compute_modal_force() {
        structure_.clear_forces();
        for (const Bed& bed : beds_)
            structure_.add_force(bed.cavity->shape.data(), bed.frame.to_structure(force_on(bed)));
        structure_.add_loads();
    }

    // ---- saved states

    static void require(bool holds) {
        if (!holds) throw std::invalid_argument("the state is damaged");
    }

    template <class Reader> void read(Reader& reader, const std::vector<RestartCheck>& fixed) {
        serialize(reader);
        check_state(reader, fixed);
        for (Bed& bed : beds_) {
            clear_wall_totals(bed), update_cavity_motion(bed);
            for (Chunk& c : bed.chunks) find_surfaces(c.walls, *bed.cavity);
        }
    }

    template <class Reader>
    void check_state(const Reader& reader, const std::vector<RestartCheck>& fixed) const {
        if (!reader.at_end()) throw std::invalid_argument("the state is of another case");
        require(step_ >= 0 && steps_since_ >= 0);
        require(stopped_cavity_ >= 0 && stopped_cavity_ < static_cast<int>(beds_.size()));
        const Bed& where = at(beds_, stopped_cavity_);
        require(RestartCheck::is_possible(status_) &&
                RestartCheck::is_possible(stop_reason_, static_cast<int>(where.position.size()),
                                          static_cast<int>(where.cavity->walls.size())));
        for (const std::size_t size : {structure_.state.size(), structure_.output.size(),
                                       structure_.force.size(), structure_.viscous.size()})
            require(size == problem_.modes.size());
        for (const std::size_t size : {structure_.load_work.size(), structure_.base_work.size()})
            require(size == problem_.loads.size());
        for (std::size_t b = 0; b < beds_.size(); ++b) fixed[b].check(beds_[b], has_contact_forces());
    }

    // ---- neighbours

    Chunk& chunk(ChunkIndex p) { return at(at(beds_, p.bed).chunks, p.chunk); }

    void choose_reach(Bed& bed) {
        constexpr real steps = 80; // measured; the optimum is flat
        const real smallest = bed.smallest, since = approach_since_rebuild(bed);
        bed.reach =
            steps_since_ > 0 && since < infinity
                ? std::clamp(since / static_cast<real>(steps_since_) * steps, 0.02 * smallest, 0.6 * smallest)
                : 0.2 * smallest;
    }

    template <class Worker> void rebuild(Worker& worker) {
        const auto each_chunk = [&](auto&& f) {
            partition_.each_chunk(
                worker.rank(), [&](ChunkIndex p) { f(at(neighbours_, p.bed), at(beds_, p.bed), p.chunk); });
        };
        // Contacts leave their chunks first, since the sort by cell changes the index of each particle and
        // the chunk that owns it.
        each_chunk([](NeighbourList& n, Bed& bed, int c) { n.collect_contacts(bed, at(bed.chunks, c)); });
        worker.sync([&] {
            for (std::size_t b = 0; b < beds_.size(); ++b)
                choose_reach(beds_[b]), neighbours_[b].set_up_cells(beds_[b]);
        });
        // The cells depend on the extent of the whole bed, which is known only now.
        each_chunk([](NeighbourList& n, const Bed& bed, int c) { n.assign_cells(bed, at(bed.chunks, c)); });
        worker.sync([&] {
            for (std::size_t b = 0; b < beds_.size(); ++b) neighbours_[b].sort_by_cell(beds_[b]);
        });
        const WorkerRange& range = partition_.range(worker.rank());
        const auto each_bed = [&](auto&& f) {
            for (int b = 0; b < static_cast<int>(beds_.size()); ++b)
                f(at(neighbours_, b), at(beds_, b), at(range.first, b), at(range.until, b));
        };
        // The arrays are permuted one after the other through one buffer, which costs a barrier each and
        // saves the memory of a copy of the bed.
        for (int phase = 0; phase < NeighbourList::sort_phases; ++phase) {
            each_bed([phase](NeighbourList& n, Bed& bed, int first, int until) {
                n.sort(bed, phase, first, until);
            });
            worker.sync([&] {
                for (std::size_t b = 0; b < beds_.size(); ++b) neighbours_[b].swap_buffers(beds_[b], phase);
            });
        }
        each_chunk([](const NeighbourList& n, Bed& bed, int c) {
            // Particles are now in the order of cells: each chunk is searched, and its bounds of motion start
            // again.
            n.search(bed, at(bed.chunks, c));
            at(bed.chunk_motion, c) = ChunkMotion{}, at(bed.chunks, c).approach = 0;
        });
        each_bed([](NeighbourList& n, Bed& bed, int first, int until) {
            n.distribute_contacts(bed, first, until);
        });
        worker.sync();
        each_chunk([](NeighbourList& n, Bed& bed, int c) { n.clear_outgoing(at(bed.chunks, c)); });
        worker.sync([&] {
            partition_.divide(worker.size());
            // The work of each range has changed with the order of the particles.
            ++rebuilds_;
            steps_since_ = 0;
        });
        partition_.find_dependencies(worker.rank());
    }

    // ---- steps

    // Prefetches for the next chunks of the same bed and range.
    Prefetch prefetch(const WorkerRange& range, int k) const {
        const ChunkIndex here = partition_.chunk_index(k);
        if (!at(integrators_, here.bed).is_far()) return {};
        const auto after = [&](int places) -> const Chunk& {
            const ChunkIndex there = partition_.chunk_index(std::min(k + places, range.end - 1));
            return at(at(beds_, here.bed).chunks, there.bed == here.bed ? there.chunk : here.chunk);
        };
        return {at(beds_, here.bed), after(1), after(2), after(3)};
    }

    // Contact forces stay in the chunks in the last step and where another range needs them. Otherwise all
    // chunks share one buffer that stays in the caches.
    template <class Worker> void advance(Worker& worker, bool first, bool sample, bool last) {
        WorkerRange& range = partition_.range(worker.rank());
        const Row body = structure_.body_acceleration;
        std::vector<char>& computed = range.computed;
        // Chunks at the border of a range exert forces on particles of other ranges. They are computed first,
        // so that no worker waits for the whole range of another one.
        computed.assign(range.at_border.begin(), range.at_border.end());
        const auto forces = [&](int k, const Prefetch& prefetch = {}) {
            const ChunkIndex p = partition_.chunk_index(k);
            at(contact_loops_, p.bed).pair_forces(at(neighbours_, p.bed), chunk(p), sample, prefetch);
            at(contact_loops_, p.bed).wall_forces(at(neighbours_, p.bed), chunk(p), sample);
        };
        for (int k = range.begin; k < range.end; ++k)
            if (at(computed, k - range.begin)) forces(k);
        worker.report();
        // Meanwhile this worker computes forces of its own, chunk by chunk, until the others have reported.
        worker.wait_for_lower([&, k = range.begin]() mutable {
            while (k < range.end && at(computed, k - range.begin)) ++k;
            if (k == range.end) return false;
            at(computed, k - range.begin) = true;
            forces(k);
            return true;
        });
        // Forces of lower ranges are added before those of this range: the order of the sums, and so the
        // bits, does not depend on the number of workers.
        for (const ChunkIndex in : range.incoming)
            at(contact_loops_, in.bed)
                .add_incoming(at(range.sums, in.bed), chunk(in), at(range.first, in.bed),
                              at(range.until, in.bed));
        for (int k = range.begin; k < range.end; ++k) {
            const ChunkIndex p = partition_.chunk_index(k);
            Chunk& own = chunk(p);
            ForceSums& sums = at(range.sums, p.bed);
            ContactLoop& loop = at(contact_loops_, p.bed);
            // A chunk is integrated as soon as all its forces are known, while it is in the caches.
            const bool is_known = at(computed, k - range.begin);
            const auto swap_buffers = [&] {
                if (is_known || last) return;
                own.walls.contact_forces.swap(range.wall_forces);
                own.pairs.contact_forces.swap(range.pair_forces);
            };
            swap_buffers();
            if (!is_known) forces(k, prefetch(range, k));
            const int until = at(range.until, p.bed);
            loop.add_own(sums, own, until);
            swap_buffers();
            at(integrators_, p.bed).advance(sums, own, until, body, body_before_, first, sample);
        }
    }

    void check_chunks() {
        for (std::size_t b = 0; b < beds_.size(); ++b)
            for (const Chunk& c : beds_[b].chunks) {
                if (at(beds_[b].chunk_motion, c.begin / Bed::chunk_size).moved < infinity) continue;
                if (c.stop_reason.status == Status::finished || status_ != Status::finished) continue;
                status_ = c.stop_reason.status;
                stop_reason_ = c.stop_reason;
                stopped_cavity_ = static_cast<int>(b);
                const Row along = at(beds_[b].velocity, stop_reason_.particle) - beds_[b].motion.velocity;
                if (status_ == Status::escaped) stop_reason_.value = std::sqrt(dot(along, along));
                stop_reason_.particle = at(beds_[b].id, stop_reason_.particle);
            }
    }

    // Returns a bound on the approach of any two particles since the rebuild.
    static real approach_since_rebuild(const Bed& bed) {
        real since = 0, moved = 0;
        for (const ChunkMotion& motion : bed.chunk_motion)
            moved = larger(moved, motion.moved), since = larger(since, motion.approach + motion.moved);
        return since + moved;
    }

    void advance_structure() {
        structure_.kick();
        structure_.drift();
        needs_rebuild_ = false;
        for (Bed& bed : beds_) {
            // What matters for neighbours is the motion of particles relative to each other: the mean
            // velocity of the bed is subtracted from all.
            const Row before = bed.motion.displacement, mean = mean_velocity(bed);
            if (bed.frame.turns()) bed.frame.advance(problem_.time_at(step_ + 1), problem_.dt);
            update_cavity_motion(bed);
            const Row apart = bed.motion.displacement - before - bed.reference_velocity * problem_.dt;
            bed.cavity_moved = std::sqrt(dot(apart, apart)) * (1 + 1e-9);
            bed.reference_velocity = mean;
            const real since = approach_since_rebuild(bed);
            // Written so that NaN asks for a rebuild as well.
            needs_rebuild_ |= !(since < bed.reach);
            if (status_ == Status::finished && !(since + bed.cavity_moved < infinity))
                status_ = Status::not_finite;
        }
        __atomic_store_n(&step_, step_ + 1, __ATOMIC_RELAXED);
        ++steps_since_;
    }

    // Predicts the next step, which was predicted with another time step and other inputs, from the state at
    // the last step.
    void predict_again(real dt_before) {
        const bool has_forces = has_contact_forces();
        structure_.state = structure_.output;
        --step_, --steps_since_;
        structure_.clear_forces(); // the velocity of the cavities is then that at the last step
        for (std::size_t b = 0; b < beds_.size(); ++b) {
            beds_[b].frame.now = beds_[b].frame.before;
            update_cavity_motion(beds_[b]);
            for (const Chunk& c : beds_[b].chunks) integrators_[b].go_back(c, dt_before, body_before_);
            if (dt_before != problem_.dt)
                for (Chunk& c : beds_[b].chunks) contact_loops_[b].change_step(c, dt_before, has_forces);
        }
        structure_.load_values(now());
        for (Bed& bed : beds_)
            if (bed.frame.turns()) bed.frame.restart(now(), problem_.dt);
        compute_modal_force();
        work_on_particles(total_momentum());
        set_body_accelerations();
        const Row body = structure_.body_acceleration;
        for (std::size_t b = 0; b < beds_.size(); ++b)
            for (const Chunk& c : beds_[b].chunks) integrators_[b].predict(c, body_before_, body);
        body_before_ = body;
        advance_structure();
    }

    // Computes the data of the next step that all workers need. Called by one worker.
    void prepare_step() {
        structure_.load_values(now());
        set_body_accelerations();
        if (sampled(step_)) records_.begin_sample(beds_);
    }

    // Applies the forces of this step to the structure and takes the sample. Called by one worker.
    void finish_step(bool first, bool sample) {
        compute_modal_force();
        // Half of this kick was part of the prediction; the forces at the start have had no prediction.
        if (!first) structure_.kick();
        structure_.store_output();
        for (Bed& bed : beds_) bed.output_displacement = bed.motion.displacement;
        const Row momentum = total_momentum();
        // The sum of the momentum is a cheap sign of numbers that are not finite anywhere in the bed.
        if (!(std::fabs(momentum[0] + momentum[1] + momentum[2]) < infinity)) status_ = Status::not_finite;
        if (!first) work_on_particles(momentum);
        if (sample) records_.add_sample(now(), beds_, structure_, problem_.gravity);
        work_on_particles(momentum);
        check_chunks();
        body_before_ = structure_.body_acceleration;
        advance_structure();
    }

    // Advances until step `until` is done, the run stops, or pause() returns true after a step.
    template <class Worker, class Pause>
    void run_steps(Worker& worker, long until, const std::atomic<bool>& stop, Pause&& pause) {
        while (step_ <= until && status_ == Status::finished && !loop_control_.halt && !loop_control_.pause) {
            // Neighbours are rebuilt before the step in which a pair outside of the lists could touch.
            if (needs_rebuild_) rebuild(worker);
            const bool first = step_ == 0, sample = sampled(step_);
            advance(worker, first, sample, step_ == until);
            worker.sync([&] {
                if (step_ == until) forces_known_at_ = step_;
                finish_step(first, sample);
                prepare_step();
                loop_control_ = {stop, pause()};
            });
        }
    }

    template <class Worker> void run(Worker& worker, long until, const std::atomic<bool>& stop) {
        partition_.find_dependencies(worker.rank());
        worker.sync([&] {
            prepare_step();
            loop_control_ = {.pause = worker.size() > 1 && !serial_fallback_.is_over()};
        });
        const auto run_all = [&] {
            run_steps(worker, until, stop, [&] {
                const bool contended = worker.is_contended();
                if (contended) serial_fallback_.begin();
                return contended;
            });
        };
        run_all();
        while (loop_control_.pause) {
            worker.sync([&] { run_serially(until, stop, worker.size()); });
            partition_.find_dependencies(worker.rank());
            worker.sync([&] { worker.reset_wait_times(); });
            run_all();
        }
    }

    // Runs on one worker while the others wait.
    void run_serially(long until, const std::atomic<bool>& stop, int workers) {
        SingleThread worker;
        partition_.divide(1);
        partition_.find_dependencies(0);
        loop_control_.pause = false;
        serial_steps_ -= step_;
        run_steps(worker, until, stop, [&] { return serial_fallback_.is_over(); });
        serial_steps_ += step_;
        loop_control_.pause = false;
        partition_.divide(workers);
    }

public:
    explicit Simulation(Problem&& problem)
        : problem_(std::move(problem)),
          structure_(problem_.modes, problem_.start, problem_.loads, problem_.load_direction) {
        for (PairLaw& e : problem_.pair_laws) e.constant_damping = constant_damping(e);
        set_inputs();
        const std::size_t count = problem_.cavities.size();
        beds_.reserve(count), neighbours_.resize(count);
        for (std::size_t b = 0; b < count; ++b) {
            Cavity& cavity = problem_.cavities[b];
            const ContactLaws pair = contact_laws_of(problem_, cavity.particle_pair),
                              wall = contact_laws_of(problem_, cavity.wall_pair);
            Bed& bed = beds_.emplace_back();
            fill_bed(bed, cavity, pair.rolls || wall.rolls);
            const auto prepare = [](ContactList& list, const ContactLaws& laws) {
                list.history.rolls = laws.rolls, list.history.yields = laws.hysteretic;
                list.resize(0);
            };
            for (Chunk& chunk : bed.chunks) prepare(chunk.pairs, pair), prepare(chunk.walls, wall);
            clear_wall_totals(bed);
            neighbours_[b].start(bed);
            const ContactLoop& loop = contact_loops_.emplace_back(bed, problem_, pair, wall);
            integrators_.emplace_back(bed, problem_, loop.has_friction(), loop.has_rolling());
        }
        partition_.start(beds_);
        for (Bed& bed : beds_) {
            if (bed.frame.turns()) bed.frame.set(now(), problem_.dt);
            update_cavity_motion(bed);
            bed.output_displacement = bed.motion.displacement;
        }
    }

    // Beds point into the problem, and contact loops to beds.
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    // Advances until the sample of step `until` is taken or the run stops.
    void run(long until, int threads, const std::atomic<bool>& stop) {
        until = std::min(until, problem_.steps);
        threads = std::min(threads, partition_.chunks());
        partition_.divide(threads);
        run_parallel(threads, [&](auto worker) { run(worker, until, stop); });
    }

    // Sets the time step, gravity, and the constant values of all loads from now on. run() has predicted the
    // next step with the former ones, so it is predicted again from the state at the last step, which must
    // have been sampled: `work` has the sums up to that sample. `steps` is the number of steps that follow.
    void change_inputs(real dt, long steps, Row gravity, const std::vector<real>& values,
                       const StructureWork& work) {
        const bool began = step_ > 0;
        bool changed = dt != problem_.dt || gravity[0] != problem_.gravity[0] ||
                       gravity[1] != problem_.gravity[1] || gravity[2] != problem_.gravity[2];
        std::vector<Signal>& signals = structure_.signals;
        for (std::size_t l = 0; l < values.size(); ++l) changed |= values[l] != signals[l].amplitude;
        problem_.steps = problem_.sample_interval = std::max(step_ - 1, 0L) + steps;
        if (!changed) return;
        const real dt_before = problem_.dt;
        problem_.dt = dt, problem_.gravity = gravity;
        for (std::size_t l = 0; l < values.size(); ++l) signals[l].amplitude = values[l];
        set_inputs();
        if (!began) return;
        structure_.load_work = work.load, structure_.base_work = work.base;
        structure_.viscous = work.viscous;
        predict_again(dt_before);
    }

    // Writes or reads all that the next step needs, in a fixed order.
    template <class Archive> void serialize(Archive& archive) {
        archive(step_, body_before_, status_, stopped_cavity_, stop_reason_, rebuilds_, needs_rebuild_,
                forces_known_at_, steps_since_, structure_.state, structure_.output, structure_.force,
                structure_.load_work, structure_.base_work, structure_.viscous);
        for (Bed& bed : beds_) bed.serialize(archive);
    }

    // Writes or reads what change_inputs() sets; it belongs before the state.
    template <class Archive> void serialize_inputs(Archive& archive) {
        archive(problem_.dt, problem_.steps, problem_.sample_interval, problem_.gravity);
        for (Signal& signal : structure_.signals) archive(signal.amplitude);
        if constexpr (!Archive::reads) return;
        if (!(problem_.dt > 0 && problem_.dt < infinity) || problem_.sample_interval < 1)
            throw std::invalid_argument("the state is damaged");
        set_inputs();
    }

    // What a state of this case must agree with; of a new object, or one whose state is sound.
    std::vector<RestartCheck> restart_check() const { return {beds_.begin(), beds_.end()}; }

    // Reads a saved state. Throws if it is not a state of this case; go_back() must follow before the object
    // is used.
    template <class Reader> void restore(Reader& reader) { restore(reader, restart_check()); }
    template <class Reader> void restore(Reader& reader, const std::vector<RestartCheck>& fixed) {
        read(reader, fixed);
        require(step_ <= problem_.steps + 1);
    }

    // Reads the state at the end of a run of the same case, which this run continues: counts and extremes
    // begin anew, work and losses continue.
    template <class Reader> void restart(Reader& reader) {
        restore(reader);
        require(step_ > 0 && status_ == Status::finished);
        rebuilds_ = 0;
        for (Bed& bed : beds_)
            for (Chunk& c : bed.chunks) c.diagnostics.reset_extremes();
    }

    // Reads a state that this object has saved, also after a restore() that threw.
    template <class Reader> void go_back(Reader& reader) {
        serialize(reader);
        for (Bed& bed : beds_) update_cavity_motion(bed);
    }

    // Reads the state at the last sample of a run with the same particles and structure, but another time
    // step or other signals, and makes that sample the start of this run: time, work and extremes count from
    // there. Losses continue.
    template <class Reader> void continue_from(Reader& reader, real dt_before) {
        const std::vector<RestartCheck> fixed = restart_check();
        serialize(reader);
        for (auto* sums : {&structure_.load_work, &structure_.base_work}) // of other loads
            sums->assign(problem_.loads.size(), 0);
        structure_.viscous.assign(problem_.modes.size(), 0);
        for (Bed& bed : beds_) bed.frame.drive_work = 0;
        check_state(reader, fixed);
        for (Bed& bed : beds_) clear_wall_totals(bed), update_cavity_motion(bed);
        require(step_ > 0 && status_ == Status::finished && dt_before > 0 && dt_before < infinity);
        step_ = 1, forces_known_at_ = -1, rebuilds_ = 0;
        for (Bed& bed : beds_)
            for (Chunk& c : bed.chunks) c.diagnostics.reset_extremes();
        predict_again(dt_before);
    }

    // Whether the contact forces of the last step are stored; they are at the step where a call of run()
    // ended.
    bool has_contact_forces() const { return forces_known_at_ >= 0 && forces_known_at_ == step_ - 1; }
    const Problem& problem() const { return problem_; }
    const std::vector<ModeState>& modes() const { return structure_.output; }
    Row output_body_acceleration() const { return body_before_; }
    int stopped_cavity() const { return stopped_cavity_; }
    std::size_t memory() const {
        std::size_t bytes = 0;
        for (std::size_t b = 0; b < beds_.size(); ++b) bytes += beds_[b].memory() + neighbours_[b].memory();
        return bytes;
    }
    long step() const { return __atomic_load_n(&step_, __ATOMIC_RELAXED); } // also during a run
    long serial_steps() const { return serial_steps_; }
    long rebuilds() const { return rebuilds_; }
    long scans() const { // mean over chunks
        long sum = 0;
        for (const Bed& bed : beds_)
            for (const Chunk& c : bed.chunks) sum += c.diagnostics.scans;
        return sum / partition_.chunks();
    }
    Status status() const { return status_; }
    const StopReason& stop_reason() const { return stop_reason_; }
    Records& records() { return records_; }
    const std::vector<Bed>& beds() const { return beds_; }
};

} // namespace rattlebox::dem
