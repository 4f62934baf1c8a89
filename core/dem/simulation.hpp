// A structure with cavities full of particles, advanced together step by step.
//
// The structure is propagated exactly between the steps; at each step it is kicked by the loads and by the
// forces that the particles of its cavities have at the very same instant: second order, and action equals
// reaction.
#pragma once

#include <atomic>
#include <stdexcept>

#include "base/team.hpp"
#include "dem/bed_step.hpp"
#include "dem/division.hpp"
#include "dem/records.hpp"

namespace rattlebox::dem {

class Simulation {
    Problem problem_;
    std::vector<Bed> beds_;
    std::vector<Neighbours> neighbours_;
    std::vector<BedStep> steps_;
    std::vector<ModeState> modes_,
        modes_shown_; // at the next step, and at the last one whose forces are known
    std::vector<std::pair<ModeState, ModeState>> turns_; // where a step takes displacement 1 and velocity 1
    std::vector<real> modal_force_, load_value_;
    std::vector<real> load_work_, base_work_, viscous_;
    Loads loads_;
    long step_ = 0;
    Status status_ = Status::finished;
    int stopped_cavity_ = 0;
    Stopped stopped_;
    long builds_ = 0, scans_ = 0;
    bool halted_ = false;
    Row body_before_{};
    long steps_since_ = 0;
    Division division_;
    Records records_;

    real h() const { return 0.5 * problem_.dt; }
    real now() const { return static_cast<real>(step_) * problem_.dt; }
    bool sampled() const { return step_ % problem_.every == 0 || step_ == problem_.steps; }

    static Kind kind_of(const Encounter& e) {
        Kind k;
        e.normal.visit([&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            k.normal = std::is_same_v<Law, HertzTsuji>      ? Kind::hertz
                       : std::is_same_v<Law, LinearDashpot> ? Kind::linear
                                                            : Kind::plastic;
            if constexpr (!std::is_same_v<Law, Thornton>) k.how.never_pulls = law.zero_overlap == 0;
        });
        return k;
    }

    Kind kind_of(const std::vector<int>& entries) const {
        Kind k = entries.empty() ? Kind{} : kind_of(at(problem_.encounters, entries.front()));
        for (const int e : entries) {
            const Encounter& one = at(problem_.encounters, e);
            const Kind other = kind_of(one);
            if (other.normal != k.normal || other.how.never_pulls != k.how.never_pulls)
                throw std::invalid_argument("one list of contacts has one kind of normal law and one ending");
            if (one.friction > 0 && k.rough && k.how.mindlin != (one.shear > 0))
                throw std::invalid_argument("one list of contacts has one kind of tangential spring");
            if (one.friction > 0) k.rough = true, k.how.mindlin = one.shear > 0;
            k.rolls |= one.rolling > 0;
        }
        k.rough |= k.rolls;
        k.how.dt = problem_.dt;
        return k;
    }

    void fill_bed(Bed& bed, const Cavity& cavity, bool rolls) {
        bed.cavity = &cavity;
        const int n = cavity.particles();
        const auto size = static_cast<std::size_t>(n);
        for (int i = 0; i < n; ++i) {
            const real m = at(cavity.mass, i), radius = at(cavity.position, i)[3];
            Row u = at(cavity.velocity, i), w = at(cavity.spin, i);
            u[3] = 1 / m;
            w[3] = radius / at(cavity.inertia, i);
            bed.smallest = smaller(bed.smallest, radius);
            bed.position.push_back(at(cavity.position, i));
            bed.velocity.push_back(u);
            bed.spin.push_back(w);
            bed.name.push_back(i);
        }
        bed.kind = cavity.kind;
        bed.touched.assign(size, 0);
        for (auto* rows : {&bed.acceleration, &bed.spin_rate, &bed.force, &bed.couple})
            rows->assign(size, Row{});
        if (rolls) bed.roll.assign(size, Row{});
        for (int from = 0; from < n; from += Bed::chunk_size) {
            Chunk& chunk = bed.chunks.emplace_back();
            chunk.begin = from, chunk.end = std::min(from + Bed::chunk_size, n);
        }
    }

    // ---- the structure

    void place(Bed& bed) const {
        bed.motion = {};
        for (std::size_t m = 0; m < modes_.size(); ++m) {
            bed.motion.displacement += bed.cavity->shape[m] * modes_[m].q;
            // As it will be after the last force has acted for half a step more.
            bed.motion.velocity += bed.cavity->shape[m] * (modes_[m].p + h() * modal_force_[m]);
        }
    }

    void load_values() {
        loads_.advance(now());
        for (std::size_t l = 0; l < load_value_.size(); ++l) load_value_[l] = loads_.piece(l).value(now());
    }

    Row body() const {
        Row b = problem_.gravity;
        for (std::size_t l = 0; l < load_value_.size(); ++l)
            if (problem_.loads[l].base) b -= problem_.load_direction[l] * load_value_[l];
        return b;
    }

    Row force_on(const Bed& bed) const {
        Row total{};
        for (const Chunk& c : bed.chunks) total += c.tally.wall_force;
        return total;
    }

    void find_modal_force() {
        std::fill(modal_force_.begin(), modal_force_.end(), 0.0);
        for (const Bed& bed : beds_) {
            const Row force = force_on(bed);
            for (std::size_t m = 0; m < modes_.size(); ++m)
                modal_force_[m] += dot(bed.cavity->shape[m], force);
        }
        for (std::size_t l = 0; l < load_value_.size(); ++l)
            for (std::size_t m = 0; m < modes_.size(); ++m)
                modal_force_[m] += problem_.loads[l].shape[m] * load_value_[l];
    }

    void kick() {
        for (std::size_t m = 0; m < modes_.size(); ++m) {
            const real mean = modes_[m].p + 0.5 * h() * modal_force_[m];
            for (std::size_t l = 0; l < load_value_.size(); ++l) {
                const real work = problem_.loads[l].shape[m] * load_value_[l] * h() * mean;
                (problem_.loads[l].base ? base_work_ : load_work_)[l] += work;
            }
            modes_[m].p += h() * modal_force_[m];
        }
    }

    void drift() {
        for (std::size_t m = 0; m < modes_.size(); ++m) {
            const Mode& mode = problem_.modes[m];
            const ModeState from = modes_[m];
            const auto& [of_q, of_p] = turns_[m];
            modes_[m] = {of_q.q * from.q + of_p.q * from.p, of_q.p * from.q + of_p.p * from.p};
            if (mode.decay > 0) viscous_[m] += from.energy(mode) - modes_[m].energy(mode);
        }
    }

    // Half of the work of the base on the particles in this step.
    void base_work(Row momentum) {
        for (std::size_t l = 0; l < load_value_.size(); ++l)
            if (problem_.loads[l].base)
                base_work_[l] -= h() * load_value_[l] * dot(problem_.load_direction[l], momentum);
    }

    // ---- neighbours

    void choose_reach(Bed& bed) {
        // A build costs as much as some ten scans, and a scan as some steps: measured, and flat about these
        // numbers.
        constexpr real steps_of_build = 80, steps_of_scan = 9;
        const real smallest = bed.smallest;
        const real rate = steps_since_ > 0 ? bed.since_build / static_cast<real>(steps_since_) : 0;
        bed.reach = rate > 0 ? std::clamp(2 * rate * steps_of_build, 0.02 * smallest, 0.6 * smallest)
                             : 0.2 * smallest;
        bed.skin = std::fmin(0.4 * bed.reach, rate > 0 ? std::fmax(2 * rate * steps_of_scan, 2e-3 * smallest)
                                                       : 0.1 * bed.reach);
    }

    // The next step may bring together what is on no list.
    static bool is_stale(real since, real reach) { return !(2 * since < reach); }

    template <class Team> void renew(Team& team) {
        bool build = false;
        for (const Bed& bed : beds_) build |= is_stale(bed.since_build, bed.reach - bed.skin);
        const auto each_chunk = [&](auto&& f) {
            division_.each_chunk(team.rank(),
                                 [&](Place p) { f(at(neighbours_, p.bed), at(beds_, p.bed), p.chunk); });
        };
        if (build) {
            each_chunk([](Neighbours& n, Bed& bed, int c) { n.pack_up(bed, at(bed.chunks, c)); });
            team.sync([&] {
                for (std::size_t b = 0; b < beds_.size(); ++b)
                    choose_reach(beds_[b]), neighbours_[b].find_order(beds_[b]);
            });
            for (std::size_t b = 0; b < beds_.size(); ++b) neighbours_[b].sort(beds_[b], team);
            team.sync([&] {
                for (Bed& bed : beds_) bed.since_build = 0;
                ++builds_;
                steps_since_ = 0;
            });
            each_chunk([](const Neighbours& n, Bed& bed, int c) { n.search(bed, at(bed.chunks, c)); });
            const Part& part = division_.part(team.rank());
            for (int b = 0; b < static_cast<int>(beds_.size()); ++b)
                at(neighbours_, b).unpack(at(beds_, b), at(part.first, b), at(part.until, b));
        }
        each_chunk([](const Neighbours& n, Bed& bed, int c) { n.scan(bed, at(bed.chunks, c)); });
        team.sync([&] {
            for (Neighbours& n : neighbours_) n.forget_moves();
            for (Bed& bed : beds_) bed.since_scan = 0;
            ++scans_;
            division_.divide(team.size());
        });
        division_.look_around(team.rank());
    }

    // ---- steps

    void advance(const Part& part, bool first, bool sample) {
        for (const Incoming& in : part.incoming)
            at(steps_, in.bed).incoming(at(at(beds_, in.bed).chunks, in.chunk).pairs, in.candidate);
        const Row all = body();
        for (int k = part.begin; k < part.end; ++k) {
            const Place p = division_.place(k);
            Bed& bed = at(beds_, p.bed);
            Chunk& chunk = at(bed.chunks, p.chunk);
            BedStep& step = at(steps_, p.bed);
            step.outgoing(chunk, at(part.until, p.bed));
            if (sample)
                step.advance<true>(chunk, all, body_before_, bed.motion.velocity, first);
            else
                step.advance<false>(chunk, all, body_before_, bed.motion.velocity, first);
        }
    }

    void check() {
        for (std::size_t b = 0; b < beds_.size(); ++b)
            for (const Chunk& c : beds_[b].chunks) {
                if (c.stopped.status == Status::finished || status_ != Status::finished) continue;
                status_ = c.stopped.status;
                stopped_ = c.stopped;
                stopped_cavity_ = static_cast<int>(b);
                const Row along = at(beds_[b].velocity, stopped_.particle) - beds_[b].motion.velocity;
                if (status_ == Status::escaped) stopped_.value = std::sqrt(dot(along, along));
                stopped_.particle = at(beds_[b].name, stopped_.particle);
            }
    }

    // On to the next step; particles may have moved as far from their neighbours as the fastest of them.
    void move_on() {
        kick();
        drift();
        for (Bed& bed : beds_) {
            const Motion before = bed.motion;
            place(bed);
            real fastest = 0;
            for (const Chunk& c : bed.chunks) fastest = larger(fastest, c.tally.drift);
            // Displacements of particles are counted from that which the cavity's velocity makes.
            const Row apart = bed.motion.displacement - before.displacement - before.velocity * problem_.dt;
            const real moved = problem_.dt * std::sqrt(fastest) + std::sqrt(dot(apart, apart));
            bed.since_build += moved;
            bed.since_scan += moved;
            if (!(moved < infinity)) status_ = Status::not_finite;
        }
        ++step_;
        ++steps_since_;
    }

    bool must_renew() const {
        for (const Bed& bed : beds_)
            if (is_stale(bed.since_scan, bed.skin)) return true;
        return false;
    }

    // What all need to know of the step to come; done by one.
    void prepare() {
        load_values();
        if (sampled()) records_.before(beds_);
    }

    // What follows from the forces of this step; done by one.
    void conclude(bool first, bool sample) {
        find_modal_force();
        if (!first) kick();
        modes_shown_ = modes_;
        Row momentum{};
        for (Bed& bed : beds_) {
            bed.shown = bed.motion.displacement;
            for (const Chunk& c : bed.chunks) momentum += c.tally.momentum;
        }
        if (!(std::fabs(momentum[0] + momentum[1] + momentum[2]) < infinity)) status_ = Status::not_finite;
        base_work(momentum);
        if (sample) records_.take(now(), beds_, modes_, problem_.gravity, load_work_, base_work_, viscous_);
        base_work(momentum);
        check();
        body_before_ = body();
        move_on();
    }

    template <class Team> void run(Team& team, long until, const std::atomic<bool>& stop) {
        division_.look_around(team.rank());
        team.sync([&] { prepare(); });
        while (step_ <= until && status_ == Status::finished && !halted_) {
            if (must_renew()) renew(team);
            const bool first = step_ == 0, sample = sampled();
            const Part& part = division_.part(team.rank());
            const auto forces = [&](Place p) {
                at(steps_, p.bed).forces(at(at(beds_, p.bed).chunks, p.chunk), sample);
            };
            for (const Place p : part.reaching) forces(p);
            team.report();
            for (const Place p : part.inside) forces(p);
            team.await_lower();
            advance(part, first, sample);
            team.sync([&] {
                conclude(first, sample);
                prepare();
                halted_ = stop;
            });
        }
    }

public:
    explicit Simulation(Problem&& problem) : problem_(std::move(problem)), loads_(problem_.loads) {
        for (Encounter& e : problem_.encounters) e.constant_zeta = constant_zeta(e);
        modes_ = problem_.start;
        for (const Mode& mode : problem_.modes) {
            FreeMode of_q(mode), of_p(mode);
            of_q.begin({1, 0});
            of_p.begin({0, 1});
            turns_.push_back({of_q.at(problem_.dt), of_p.at(problem_.dt)});
        }
        modal_force_.assign(modes_.size(), 0);
        viscous_.assign(modes_.size(), 0);
        for (auto* numbers : {&load_value_, &load_work_, &base_work_})
            numbers->assign(problem_.loads.size(), 0);
        const std::size_t count = problem_.cavities.size();
        beds_.resize(count), neighbours_.resize(count);
        for (std::size_t b = 0; b < count; ++b) {
            const Cavity& cavity = problem_.cavities[b];
            const Kind pair = kind_of(cavity.particle_entry), wall = kind_of(cavity.wall_entry);
            Bed& bed = beds_[b];
            fill_bed(bed, cavity, pair.rolls || wall.rolls);
            const auto prepare = [](Contacts& list, const Kind& kind) {
                list.rolls = kind.rolls, list.dents = kind.normal == Kind::plastic;
                list.forget_all();
            };
            for (Chunk& chunk : bed.chunks) prepare(chunk.pairs, pair), prepare(chunk.walls, wall);
            neighbours_[b].start(bed);
            steps_.emplace_back(bed, problem_, pair, wall);
        }
        division_.start(beds_);
        modes_shown_ = modes_;
        for (Bed& bed : beds_) {
            place(bed);
            bed.shown = bed.motion.displacement;
        }
    }

    // Beds point into the problem, and steps at beds.
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    // Goes on until the sample of step `until` is taken, or something stops it.
    void run(long until, int threads, const std::atomic<bool>& stop) {
        until = std::min(until, problem_.steps);
        threads = std::min(threads, division_.chunks());
        halted_ = false;
        division_.divide(threads);
        together(threads, [&](auto team) { run(team, until, stop); });
    }

    // All that the next step needs, in a fixed order: to write it down and to read it back.
    template <class Archive> void keep(Archive& archive) {
        archive(step_, body_before_, status_, stopped_cavity_, stopped_, builds_, scans_, steps_since_,
                modes_, modes_shown_, modal_force_, load_work_, base_work_, viscous_);
        for (Bed& bed : beds_) bed.keep(archive);
    }

    // After the state has been read back.
    void resume() {
        for (Bed& bed : beds_) place(bed);
    }

    const Problem& problem() const { return problem_; }
    const std::vector<ModeState>& modes() const { return modes_shown_; }
    Row body_shown() const { return body_before_; }
    int stopped_cavity() const { return stopped_cavity_; }
    std::size_t memory() const {
        std::size_t bytes = 0;
        for (std::size_t b = 0; b < beds_.size(); ++b) bytes += beds_[b].memory() + neighbours_[b].memory();
        return bytes;
    }
    long step() const { return step_; }
    long builds() const { return builds_; }
    long scans() const { return scans_; }
    Status status() const { return status_; }
    const Stopped& stopped() const { return stopped_; }
    Records& records() { return records_; }
    const std::vector<Bed>& beds() const { return beds_; }
};

} // namespace rattlebox::dem
