// A structure with cavities full of particles, advanced run_parallel step by step.
//
// The structure is propagated exactly between the steps; at each step it is kicked by the loads and by the
// forces that the particles of its cavities have at the very same instant: second order, and action equals
// reaction.
#pragma once

#include <atomic>
#include <utility>

#include "dem/contact_loop.hpp"
#include "dem/integrator.hpp"
#include "dem/partition.hpp"
#include "dem/records.hpp"
#include "dem/restart_check.hpp"
#include "parallel/thread_pool.hpp"

namespace rattlebox::dem {

// How long one worker runs alone where other programs have the cores (parallel/contention.hpp). The time
// doubles where contention is found again soon after.
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

class Simulation {
    Problem problem_;
    std::vector<Bed> beds_;
    std::vector<NeighbourList> neighbours_;
    std::vector<ContactLoop> contact_loops_;
    std::vector<Integrator> integrators_;
    std::vector<ModeState> modes_,
        modes_shown_; // at the next step, and at the last one whose forces are known
    std::vector<Turn> turns_;
    std::vector<real> transition_;
    std::vector<ModeState> moved_;
    std::vector<real> modal_force_, load_value_;
    std::vector<real> load_work_, base_work_, viscous_;
    std::vector<Signal> signals_;
    std::vector<real> load_shape_;
    std::vector<int> load_base_;
    long step_ = 0;
    Status status_ = Status::finished;
    int stopped_cavity_ = 0;
    Stopped stopped_;
    // After a step: end the run, or leave the team.
    struct Break {
        bool halt = false, pause = false;
    } taken_;
    bool must_build_ = true;    // before the next step
    long forces_known_at_ = -1; // the step whose single contacts are still known
    long builds_ = 0;
    SerialFallback serial_fallback_;
    long serial_steps_ = 0; // by one for a team that was held up
    Row body_before_{};
    long steps_since_ = 0;
    Partition partition_;
    Records records_;

    real now() const { return static_cast<real>(step_) * problem_.dt; }
    bool sampled(long step) const { return step % problem_.every == 0 || step == problem_.steps; }

    // Takes the particles over from the cavity.
    void fill_bed(Bed& bed, Cavity& cavity, bool rolls) {
        bed.cavity = &cavity;
        const int n = cavity.particles();
        const auto size = static_cast<std::size_t>(n);
        bed.velocity.reserve(size), bed.spin.reserve(size), bed.name.reserve(size);
        for (int i = 0; i < n; ++i) {
            const real m = at(cavity.mass, i), radius = at(cavity.position, i)[3];
            Row u = at(cavity.velocity, i), w = at(cavity.spin, i);
            u[3] = 1 / m;
            w[3] = radius / at(cavity.inertia, i);
            bed.mass += m;
            bed.smallest = smaller(bed.smallest, radius);
            bed.velocity.push_back(u);
            bed.spin.push_back(w);
            bed.name.push_back(i);
        }
        bed.position.assign(cavity.position.begin(), cavity.position.end());
        bed.kind.assign(cavity.kind.begin(), cavity.kind.end());
        for (auto* rows : {&cavity.position, &cavity.velocity, &cavity.spin}) std::vector<Row>().swap(*rows);
        for (auto* numbers : {&cavity.mass, &cavity.inertia}) std::vector<real>().swap(*numbers);
        std::vector<int>().swap(cavity.kind);
        bed.touched.assign(size, 0);
        bed.rates.assign(size, Rates{});
        bed.rolls = rolls;
        bed.chunks.reserve((size + Bed::chunk_size - 1) / Bed::chunk_size);
        for (int from = 0; from < n; from += Bed::chunk_size)
            bed.chunks.emplace_back(from, std::min(from + Bed::chunk_size, n));
        bed.chunk_motion.assign(bed.chunks.size(), ChunkMotion{.approached = infinity});
    }

    // ---- the structure

    // Views of what this owns.
    Structure structure() {
        return {static_cast<int>(modes_.size()),
                static_cast<int>(signals_.size()),
                problem_.dt,
                problem_.gravity,
                problem_.modes.data(),
                turns_.data(),
                transition_.empty() ? nullptr : transition_.data(),
                moved_.data(),
                modes_.data(),
                modes_shown_.data(),
                modal_force_.data(),
                viscous_.data(),
                signals_.data(),
                load_shape_.data(),
                load_base_.data(),
                problem_.load_direction.data(),
                load_value_.data(),
                load_work_.data(),
                base_work_.data()};
    }

    void prepare_structure() {
        modes_ = modes_shown_ = problem_.start;
        for (const Mode& mode : problem_.modes) turns_.push_back(turn(mode, problem_.dt));
        if (!problem_.coupling.empty())
            transition_ = transition(problem_.modes, problem_.coupling, problem_.dt);
        moved_.resize(modes_.size());
        for (const Load& load : problem_.loads) {
            signals_.push_back(load.signal);
            load_shape_.insert(load_shape_.end(), load.shape.begin(), load.shape.end());
            load_base_.push_back(load.base);
        }
        modal_force_.assign(modes_.size(), 0);
        viscous_.assign(modes_.size(), 0);
        for (auto* numbers : {&load_value_, &load_work_, &base_work_}) numbers->assign(signals_.size(), 0);
    }

    void place(Bed& bed) { bed.motion = structure().place(bed.cavity->shape.data()); }

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

    void find_modal_force() {
        Structure s = structure();
        s.no_force();
        for (const Bed& bed : beds_) s.add_force(bed.cavity->shape.data(), force_on(bed));
        s.add_loads();
    }

    // ---- neighbours

    Chunk& chunk(Place p) { return at(at(beds_, p.bed).chunks, p.chunk); }

    void choose_reach(Bed& bed) {
        constexpr real steps = 80; // a build costs as much as some ten scans: measured, and flat about this
        const real smallest = bed.smallest, since = closing(bed);
        bed.reach =
            steps_since_ > 0 && since < infinity
                ? std::clamp(since / static_cast<real>(steps_since_) * steps, 0.02 * smallest, 0.6 * smallest)
                : 0.2 * smallest;
    }

    template <class Team> void build(Team& team) {
        const auto each_chunk = [&](auto&& f) {
            partition_.each_chunk(team.rank(),
                                  [&](Place p) { f(at(neighbours_, p.bed), at(beds_, p.bed), p.chunk); });
        };
        each_chunk([](NeighbourList& n, Bed& bed, int c) { n.collect_contacts(bed, at(bed.chunks, c)); });
        team.sync([&] {
            for (std::size_t b = 0; b < beds_.size(); ++b)
                choose_reach(beds_[b]), neighbours_[b].lay_cells(beds_[b]);
        });
        each_chunk([](NeighbourList& n, const Bed& bed, int c) { n.find_cells(bed, at(bed.chunks, c)); });
        team.sync([&] {
            for (std::size_t b = 0; b < beds_.size(); ++b) neighbours_[b].find_order(beds_[b]);
        });
        const WorkerRange& part = partition_.part(team.rank());
        const auto each_bed = [&](auto&& f) {
            for (int b = 0; b < static_cast<int>(beds_.size()); ++b)
                f(at(neighbours_, b), at(beds_, b), at(part.first, b), at(part.until, b));
        };
        for (int turn = 0; turn < NeighbourList::turns; ++turn) {
            each_bed([turn](NeighbourList& n, Bed& bed, int first, int until) {
                n.sort(bed, turn, first, until);
            });
            team.sync([&] {
                for (std::size_t b = 0; b < beds_.size(); ++b) neighbours_[b].exchange(beds_[b], turn);
            });
        }
        each_chunk([](const NeighbourList& n, Bed& bed, int c) {
            n.search(bed, at(bed.chunks, c));
            at(bed.chunk_motion, c) = ChunkMotion{}, at(bed.chunks, c).approached = 0;
        });
        each_bed([](NeighbourList& n, Bed& bed, int first, int until) {
            n.distribute_contacts(bed, first, until);
        });
        team.sync();
        each_chunk([](NeighbourList& n, Bed& bed, int c) { n.clear_outgoing(at(bed.chunks, c)); });
        team.sync([&] {
            partition_.divide(team.size());
            ++builds_;
            steps_since_ = 0;
        });
        partition_.find_dependencies(team.rank());
    }

    // ---- steps

    // What to ask memory for at a chunk: for what those after it need, of the same bed and part.
    Prefetch prefetch(const WorkerRange& part, int k) const {
        const Place here = partition_.place(k);
        if (!at(integrators_, here.bed).is_far()) return {};
        const auto after = [&](int places) -> const Chunk& {
            const Place there = partition_.place(std::min(k + places, part.end - 1));
            return at(at(beds_, here.bed).chunks, there.bed == here.bed ? there.chunk : here.chunk);
        };
        return {at(beds_, here.bed), after(1), after(2), after(3)};
    }

    // In the last step forces of single contacts are kept; else only what others need.
    template <class Team> void advance(Team& team, bool first, bool sample, bool last) {
        WorkerRange& part = partition_.part(team.rank());
        const Row all = structure().body();
        std::vector<char>& computed = part.computed;
        computed.assign(part.at_border.begin(), part.at_border.end());
        const auto forces = [&](int k, const Prefetch& prefetch = {}) {
            const Place p = partition_.place(k);
            at(contact_loops_, p.bed).pair_forces(at(neighbours_, p.bed), chunk(p), sample, prefetch);
            at(contact_loops_, p.bed).wall_forces(at(neighbours_, p.bed), chunk(p), sample);
        };
        for (int k = part.begin; k < part.end; ++k)
            if (at(computed, k - part.begin)) forces(k);
        team.report();
        team.wait_for_lower([&, k = part.begin]() mutable {
            while (k < part.end && at(computed, k - part.begin)) ++k;
            if (k == part.end) return false;
            at(computed, k - part.begin) = true;
            forces(k);
            return true;
        });
        for (const Place in : part.incoming)
            at(contact_loops_, in.bed)
                .add_incoming(at(part.sums, in.bed), chunk(in), at(part.first, in.bed),
                              at(part.until, in.bed));
        for (int k = part.begin; k < part.end; ++k) {
            const Place p = partition_.place(k);
            Chunk& own = chunk(p);
            ForceSums& sums = at(part.sums, p.bed);
            ContactLoop& loop = at(contact_loops_, p.bed);
            const bool is_known = at(computed, k - part.begin);
            const auto swap_buffers = [&] {
                if (is_known || last) return;
                own.walls.contact_forces.swap(part.at_walls);
                own.pairs.contact_forces.swap(part.at_pairs);
            };
            swap_buffers();
            if (!is_known) forces(k, prefetch(part, k));
            const int until = at(part.until, p.bed);
            loop.add_own(sums, own, until);
            swap_buffers();
            at(integrators_, p.bed).advance(sums, own, until, all, body_before_, first, sample);
        }
    }

    void check() {
        for (std::size_t b = 0; b < beds_.size(); ++b)
            for (const Chunk& c : beds_[b].chunks) {
                if (at(beds_[b].chunk_motion, c.begin / Bed::chunk_size).moved < infinity) continue;
                if (c.stopped.status == Status::finished || status_ != Status::finished) continue;
                status_ = c.stopped.status;
                stopped_ = c.stopped;
                stopped_cavity_ = static_cast<int>(b);
                const Row along = at(beds_[b].velocity, stopped_.particle) - beds_[b].motion.velocity;
                if (status_ == Status::escaped) stopped_.value = std::sqrt(dot(along, along));
                stopped_.particle = at(beds_[b].name, stopped_.particle);
            }
    }

    // How much nearer to each other any two particles may have come since the build.
    static real closing(const Bed& bed) {
        real since = 0, moved = 0;
        for (const ChunkMotion& motion : bed.chunk_motion)
            moved = larger(moved, motion.moved), since = larger(since, motion.approached + motion.moved);
        return since + moved;
    }

    // On to the next step.
    void advance_structure() {
        structure().kick();
        structure().drift();
        must_build_ = false;
        for (Bed& bed : beds_) {
            const Row before = bed.motion.displacement, momentum = momentum_of(bed);
            place(bed);
            const Row apart = bed.motion.displacement - before - bed.reference * problem_.dt;
            bed.apart = std::sqrt(dot(apart, apart)) * (1 + 1e-9);
            bed.reference = row(momentum[0], momentum[1], momentum[2]) / bed.mass;
            const real since = closing(bed);
            must_build_ |= !(since < bed.reach);
            if (status_ == Status::finished && !(since + bed.apart < infinity)) status_ = Status::not_finite;
        }
        __atomic_store_n(&step_, step_ + 1, __ATOMIC_RELAXED);
        ++steps_since_;
    }

    // What all need to know of the step to come; done by one.
    void prepare_step() {
        structure().load_values(now());
        if (sampled(step_)) records_.before(beds_);
    }

    // What follows from the forces of this step; done by one.
    void finish_step(bool first, bool sample) {
        find_modal_force();
        if (!first) structure().kick();
        structure().show();
        Row momentum{};
        for (Bed& bed : beds_) {
            bed.shown = bed.motion.displacement;
            momentum += momentum_of(bed);
        }
        if (!(std::fabs(momentum[0] + momentum[1] + momentum[2]) < infinity)) status_ = Status::not_finite;
        if (!first) structure().work_on_particles(momentum);
        if (sample) records_.take(now(), beds_, modes_, problem_.gravity, load_work_, base_work_, viscous_);
        structure().work_on_particles(momentum);
        check();
        body_before_ = structure().body();
        advance_structure();
    }

    // Goes on until that step is done, something stops it, or a pause is asked for after a step.
    template <class Team, class Pause>
    void run_steps(Team& team, long until, const std::atomic<bool>& stop, Pause&& pause) {
        while (step_ <= until && status_ == Status::finished && !taken_.halt && !taken_.pause) {
            if (must_build_) build(team);
            const bool first = step_ == 0, sample = sampled(step_);
            advance(team, first, sample, step_ == until);
            team.sync([&] {
                if (step_ == until) forces_known_at_ = step_;
                finish_step(first, sample);
                prepare_step();
                taken_ = {stop, pause()};
            });
        }
    }

    template <class Team> void run(Team& team, long until, const std::atomic<bool>& stop) {
        partition_.find_dependencies(team.rank());
        team.sync([&] {
            prepare_step();
            taken_ = {.pause = team.size() > 1 && !serial_fallback_.is_over()};
        });
        const auto run_all = [&] {
            run_steps(team, until, stop, [&] {
                const bool contended = team.is_contended();
                if (contended) serial_fallback_.begin();
                return contended;
            });
        };
        run_all();
        while (taken_.pause) {
            team.sync([&] { run_serially(until, stop, team.size()); });
            partition_.find_dependencies(team.rank());
            team.sync([&] { team.reset_wait_times(); });
            run_all();
        }
    }

    // For the others, who wait.
    void run_serially(long until, const std::atomic<bool>& stop, int members) {
        SingleThread alone;
        partition_.divide(1);
        partition_.find_dependencies(0);
        taken_.pause = false;
        serial_steps_ -= step_;
        run_steps(alone, until, stop, [&] { return serial_fallback_.is_over(); });
        serial_steps_ += step_;
        taken_.pause = false;
        partition_.divide(members);
    }

public:
    explicit Simulation(Problem&& problem) : problem_(std::move(problem)) {
        for (PairLaw& e : problem_.pair_laws) e.constant_damping = constant_damping(e);
        prepare_structure();
        const std::size_t count = problem_.cavities.size();
        beds_.reserve(count), neighbours_.resize(count);
        for (std::size_t b = 0; b < count; ++b) {
            Cavity& cavity = problem_.cavities[b];
            const ContactLaws pair = contact_laws_of(problem_, cavity.particle_entry),
                              wall = contact_laws_of(problem_, cavity.wall_entry);
            Bed& bed = beds_.emplace_back();
            fill_bed(bed, cavity, pair.rolls || wall.rolls);
            const auto prepare_step = [](ContactList& list, const ContactLaws& kind) {
                list.memory.rolls = kind.rolls, list.memory.yields = kind.hysteretic;
                list.resize(0);
            };
            for (Chunk& chunk : bed.chunks) prepare_step(chunk.pairs, pair), prepare_step(chunk.walls, wall);
            neighbours_[b].start(bed);
            const ContactLoop& loop = contact_loops_.emplace_back(bed, problem_, pair, wall);
            integrators_.emplace_back(bed, problem_.dt, loop.has_friction(), loop.has_rolling());
        }
        partition_.start(beds_);
        for (Bed& bed : beds_) {
            place(bed);
            bed.shown = bed.motion.displacement;
        }
    }

    // Beds barrier into the problem, and steps at beds.
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    // Goes on until the sample of step `until` is taken, or something stops it.
    void run(long until, int threads, const std::atomic<bool>& stop) {
        until = std::min(until, problem_.steps);
        threads = std::min(threads, partition_.chunks());
        partition_.divide(threads);
        run_parallel(threads, [&](auto team) { run(team, until, stop); });
    }

    // All that the next step needs, in a fixed order: to write it down and to read it back.
    template <class Archive> void keep(Archive& archive) {
        archive(step_, body_before_, status_, stopped_cavity_, stopped_, builds_, must_build_,
                forces_known_at_, steps_since_, modes_, modes_shown_, modal_force_, load_work_, base_work_,
                viscous_);
        for (Bed& bed : beds_) bed.keep(archive);
    }

    // Reads a state back. Throws where it is not one of this case; this must then not be used any more.
    template <class Reader> void restore(Reader& reader) {
        const std::vector<RestartCheck> fixed(beds_.begin(), beds_.end());
        keep(reader);
        if (!reader.at_end()) throw std::invalid_argument("the state is of another case");
        const auto require = [](bool holds) {
            if (!holds) throw std::invalid_argument("the state is damaged");
        };
        require(step_ >= 0 && step_ <= problem_.steps + 1 && steps_since_ >= 0);
        require(stopped_cavity_ >= 0 && stopped_cavity_ < static_cast<int>(beds_.size()));
        const Bed& where = at(beds_, stopped_cavity_);
        require(RestartCheck::is_possible(status_) &&
                RestartCheck::is_possible(stopped_, static_cast<int>(where.position.size()),
                                          static_cast<int>(where.cavity->walls.size())));
        for (const std::size_t size :
             {modes_.size(), modes_shown_.size(), modal_force_.size(), viscous_.size()})
            require(size == problem_.modes.size());
        require(load_work_.size() == signals_.size() && base_work_.size() == signals_.size());
        for (std::size_t b = 0; b < beds_.size(); ++b) fixed[b].check(beds_[b], has_contact_forces());
        for (Bed& bed : beds_) place(bed);
    }

    // Are forces of single contacts known, of the last step? They are where a run was asked to end.
    bool has_contact_forces() const { return forces_known_at_ >= 0 && forces_known_at_ == step_ - 1; }
    const Problem& problem() const { return problem_; }
    const std::vector<ModeState>& modes() const { return modes_shown_; }
    Row body_shown() const { return body_before_; }
    int stopped_cavity() const { return stopped_cavity_; }
    std::size_t memory() const {
        std::size_t bytes = 0;
        for (std::size_t b = 0; b < beds_.size(); ++b) bytes += beds_[b].memory() + neighbours_[b].memory();
        return bytes;
    }
    long step() const { return __atomic_load_n(&step_, __ATOMIC_RELAXED); } // while it runs, too
    long serial_steps() const { return serial_steps_; }
    long builds() const { return builds_; }
    long scans() const { // of a chunk, on average
        long sum = 0;
        for (const Bed& bed : beds_)
            for (const Chunk& c : bed.chunks) sum += c.tally.scans;
        return sum / partition_.chunks();
    }
    Status status() const { return status_; }
    const Stopped& stopped() const { return stopped_; }
    Records& records() { return records_; }
    const std::vector<Bed>& beds() const { return beds_; }
};

} // namespace rattlebox::dem
