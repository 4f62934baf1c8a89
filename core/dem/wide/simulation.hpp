// The owner of a world: lays it out, lets teams of threads run it, and reads what they wrote.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "base/threads.hpp"
#include "dem/problem.hpp"
#include "dem/records.hpp"
#include "dem/wide/step.hpp"

namespace rattlebox::dem::wide {

class Simulation {
    dem::Problem problem_;
    // The world lies at the beginning of a block whose address is a multiple of 64.
    std::vector<char> block_;
    std::size_t begin_ = 0, size_ = 0;

    char* base() { return block_.data() + begin_; }

    // Remembers what is dealt, array by array.
    struct Listing {
        Dealer dealer;
        std::vector<std::pair<char*, std::size_t>> arrays;

        template <class T> void operator()(T*& array, std::size_t count) {
            dealer(array, count);
            arrays.emplace_back(reinterpret_cast<char*>(const_cast<std::remove_const_t<T>*>(array)),
                                count * sizeof(T));
        }
    };

    template <class Deal> static void lay_all(Deal& deal, World& w, Bed* beds) {
        Structure& s = w.structure;
        const auto m = static_cast<std::size_t>(s.modes), l = static_cast<std::size_t>(s.loads);
        deal(s.mode, m), deal(s.turns, m), deal(s.state, m), deal(s.shown, m), deal(s.force, m);
        deal(s.viscous, m), deal(s.signal, l), deal(s.load_shape, l * m), deal(s.base, l);
        deal(s.direction, l), deal(s.value, l), deal(s.load_work, l), deal(s.base_work, l);
        deal(w.encounter, static_cast<std::size_t>(w.encounters));
        deal(w.table, static_cast<std::size_t>(w.table_size));
        deal(w.sample,
             static_cast<std::size_t>(w.control.sample_room) * static_cast<std::size_t>(w.sample_width()));
        deal(w.bed, static_cast<std::size_t>(w.beds));
        for (int b = 0; b < w.beds; ++b) {
            Bed& bed = beds[b];
            deal(bed.wall, static_cast<std::size_t>(bed.walls)), deal(bed.shape, m);
            deal(bed.particle_entry, static_cast<std::size_t>(bed.kinds * bed.kinds));
            deal(bed.wall_entry, static_cast<std::size_t>(bed.kinds * bed.wall_kinds));
            lay(deal, bed);
        }
    }

    static std::size_t world_room() { return (sizeof(World) + 63) / 64 * 64; }

    // Tables of laws and signals move with the block.
    template <class Move>
    static void move_tables(Signal* signals, int loads, Encounter* encounters, int count, Move&& move) {
        const auto shifted = [&](Table t) { return Table{t.size > 0 ? move(t.data) : nullptr, t.size}; };
        for (int l = 0; l < loads; ++l)
            signals[l].times = shifted(signals[l].times), signals[l].values = shifted(signals[l].values);
        for (int e = 0; e < count; ++e)
            if (const auto* law = encounters[e].restitution.get_if<TabulatedRestitution>()) {
                TabulatedRestitution own = *law;
                own.speeds = shifted(own.speeds), own.values = shifted(own.values);
                encounters[e].restitution.set(own);
            }
    }

    // Makes a block what it has to be at an address, wherever it was before and is now.
    static void rebase(char* bytes, std::size_t address) {
        World w;
        std::memcpy(static_cast<void*>(&w), bytes, sizeof(World));
        const real* was = w.table;
        std::vector<Bed> beds(static_cast<std::size_t>(w.beds));
        {
            World found = w;
            Dealer find(world_room());
            lay_all(find, found, beds.data());
            std::memcpy(static_cast<void*>(beds.data()), bytes + reinterpret_cast<std::size_t>(found.bed),
                        beds.size() * sizeof(Bed));
        }
        Dealer deal(address + world_room());
        lay_all(deal, w, beds.data());
        const auto here = [&]<class T>(const T* there) {
            return reinterpret_cast<T*>(bytes + (reinterpret_cast<std::size_t>(there) - address));
        };
        move_tables(here(w.structure.signal), w.structure.loads, here(w.encounter), w.encounters,
                    [&](const real* t) { return w.table + (t - was); });
        std::memcpy(static_cast<void*>(here(w.bed)), beds.data(), beds.size() * sizeof(Bed));
        std::memcpy(bytes, &w, sizeof(World));
    }

    template <class Move> static void move_tables(World& w, Move&& move) {
        move_tables(const_cast<Signal*>(w.structure.signal), w.structure.loads,
                    const_cast<Encounter*>(w.encounter), w.encounters, move);
    }

    // A new block for these sizes; what there was before is taken along.
    void lay_out(World w, std::vector<Bed> beds) {
        std::size_t size;
        {
            Dealer measure(world_room());
            World copy = w;
            std::vector<Bed> own = beds;
            lay_all(measure, copy, own.data());
            size = world_room() + measure.used();
        }
        std::vector<char> block(size + 64, 0);
        const auto begin = (64 - reinterpret_cast<std::size_t>(block.data()) % 64) % 64;
        char* address = block.data() + begin;
        Listing list{Dealer(reinterpret_cast<std::size_t>(address) + world_room()), {}};
        lay_all(list, w, beds.data());
        const bool grows = !block_.empty();
        if (grows) {
            const World& old_world = world();
            World old = old_world;
            std::vector<Bed> old_beds(old.bed, old.bed + old.beds);
            Listing before{Dealer(reinterpret_cast<std::size_t>(base()) + world_room()), {}};
            lay_all(before, old, old_beds.data());
            for (std::size_t k = 0; k < list.arrays.size(); ++k)
                std::memcpy(list.arrays[k].first, before.arrays[k].first,
                            std::min(list.arrays[k].second, before.arrays[k].second));
            const real* was = old.table;
            move_tables(w, [&](const real* t) { return w.table + (t - was); });
        }
        std::memcpy(static_cast<void*>(w.bed), beds.data(), beds.size() * sizeof(Bed));
        std::memcpy(static_cast<void*>(address), &w, sizeof(World));
        block_.swap(block);
        begin_ = begin, size_ = size;
    }

    template <class T> static void fill(const T* to, const std::vector<T>& from) {
        if (!from.empty()) std::memcpy(const_cast<T*>(to), from.data(), from.size() * sizeof(T));
    }

    static std::length_error beyond(const char* who, int count, const char* what, int most) {
        return std::length_error(std::string(who) + " has " + std::to_string(count) + " " + what + ", " +
                                 std::to_string(most) + " at most can be followed");
    }

    void describe(int slots, int sample_room) {
        World w;
        Control& c = w.control;
        c.steps = problem_.steps, c.every = problem_.every;
        c.sample_room = sample_room;
        w.structure.modes = static_cast<int>(problem_.modes.size());
        w.structure.loads = static_cast<int>(problem_.loads.size());
        w.structure.dt = problem_.dt, w.structure.gravity = problem_.gravity;
        w.encounters = static_cast<int>(problem_.encounters.size());
        w.beds = static_cast<int>(problem_.cavities.size());
        const auto table = [&](Table t) { w.table_size += t.size; };
        each_table(table);
        std::vector<Bed> beds;
        for (const Cavity& cavity : problem_.cavities) {
            if (cavity.particles() > most_particles)
                throw beyond("a cavity", cavity.particles(), "particles", most_particles);
            Bed b;
            b.particles = cavity.particles(), b.walls = static_cast<int>(cavity.walls.size());
            b.kinds = cavity.kinds, b.wall_kinds = cavity.wall_kinds, b.slots = slots;
            b.pair = kind_of(problem_, cavity.particle_entry),
            b.at_wall = kind_of(problem_, cavity.wall_entry);
            b.layers = static_cast<int>(octaves(cavity.position).size());
            b.smallest = infinity;
            for (const Row& p : cavity.position) b.smallest = smaller(b.smallest, p[3]);
            for (const real m : cavity.mass) b.mass += m;
            beds.push_back(b);
        }
        lay_out(w, std::move(beds));
    }

    // Octaves of sizes, counted down from the largest, that have particles.
    static std::vector<Layer> octaves(const std::vector<Row>& position) {
        real largest = 0;
        for (const Row& p : position) largest = larger(largest, p[3]);
        std::map<int, real, std::greater<>> found; // the smallest sizes first
        for (const Row& p : position) {
            real& most = found[static_cast<int>(std::log2(largest / p[3]))];
            most = larger(most, p[3]);
        }
        std::vector<Layer> layers;
        for (const auto& [octave, most] : found) layers.push_back({.largest = most});
        return layers;
    }

    template <class F> void each_table(F&& f) const {
        for (const Load& load : problem_.loads) f(load.signal.times), f(load.signal.values);
        for (const Encounter& e : problem_.encounters)
            if (const auto* law = e.restitution.get_if<TabulatedRestitution>())
                f(law->speeds), f(law->values);
    }

    void fill_structure(World& w) {
        Structure& s = w.structure;
        fill(s.mode, problem_.modes), fill(s.state, problem_.start), fill(s.shown, problem_.start);
        std::vector<Turn> turns;
        for (const Mode& mode : problem_.modes) turns.push_back(turn(mode, problem_.dt));
        fill(s.turns, turns);
        std::vector<Signal> signals;
        std::vector<real> shapes;
        std::vector<int> base;
        for (const Load& load : problem_.loads) {
            signals.push_back(load.signal);
            shapes.insert(shapes.end(), load.shape.begin(), load.shape.end());
            base.push_back(load.base);
        }
        fill(s.signal, signals), fill(s.load_shape, shapes), fill(s.base, base);
        fill(s.direction, problem_.load_direction);
        fill(w.encounter, problem_.encounters);
        std::vector<std::pair<const real*, const real*>> moved;
        real* next = w.table;
        each_table([&](Table t) {
            if (t.size == 0) return;
            std::memcpy(next, t.data, static_cast<std::size_t>(t.size) * sizeof(real));
            moved.emplace_back(t.data, next);
            next += t.size;
        });
        move_tables(w, [&](const real* t) {
            for (const auto& [from, to] : moved)
                if (from == t) return to;
            return t;
        });
    }

    void fill_bed(Bed& b, const Cavity& cavity, std::size_t modes) {
        fill(b.wall, cavity.walls), fill(b.layer, octaves(cavity.position));
        if (modes > 0) fill(b.shape, cavity.shape);
        fill(b.particle_entry, cavity.particle_entry), fill(b.wall_entry, cavity.wall_entry);
        fill(b.position, cavity.position), fill(b.kind, cavity.kind);
        for (int i = 0; i < b.particles; ++i) {
            const auto k = static_cast<std::size_t>(i);
            b.velocity[i] = cavity.velocity[k], b.velocity[i][3] = 1 / cavity.mass[k];
            b.spin[i] = cavity.spin[k], b.spin[i][3] = cavity.position[k][3] / cavity.inertia[k];
            b.name[i] = i;
            b.account[i] = Account{};
        }
    }

public:
    explicit Simulation(dem::Problem&& problem, int slots = 8, int sample_room = 256)
        : problem_(std::move(problem)) {
        for (Encounter& e : problem_.encounters) e.constant_zeta = constant_zeta(e);
        describe(slots, sample_room);
        World& w = world();
        fill_structure(w);
        for (int b = 0; b < w.beds; ++b)
            fill_bed(w.bed[b], problem_.cavities[static_cast<std::size_t>(b)], problem_.modes.size());
        place_cavities(w);
        show(w);
    }

    const dem::Problem& problem() const { return problem_; }
    World& world() { return *reinterpret_cast<World*>(base()); }
    const World& world() const { return *reinterpret_cast<const World*>(block_.data() + begin_); }
    std::size_t memory() const { return size_; }

    // More room where it is wanting. False when nothing was.
    bool make_room() {
        World w = world();
        std::vector<Bed> beds(w.bed, w.bed + w.beds);
        if (w.control.pause != Pause::slots) return false;
        for (Bed& b : beds) {
            if (-b.short_of > most_slots)
                throw beyond("a particle", -b.short_of, "walls and particles of its size or larger about it",
                             most_slots);
            b.slots = std::min(most_slots, std::max(b.slots, -b.short_of + (b.short_of < 0 ? 1 : 0)));
            b.short_of = 0;
        }
        w.control.pause = Pause::none;
        lay_out(w, std::move(beds));
        return true;
    }

    // The samples taken so far, which are then forgotten.
    void take(Records& r) {
        World& w = world();
        const auto width = static_cast<std::size_t>(w.sample_width());
        for (int k = 0; k < w.control.sample_count; ++k) {
            const real* from = w.sample + static_cast<std::size_t>(k) * width;
            const auto list = [&](std::vector<real>& to, int count) {
                to.insert(to.end(), from, from + count);
                from += count;
            };
            const auto read = [&](auto& sum) {
                std::memcpy(static_cast<void*>(&sum), from, sizeof(sum));
                from += sizeof(sum) / sizeof(real);
            };
            const Structure& s = w.structure;
            list(r.time, 1), list(r.q, s.modes), list(r.p, s.modes), list(r.load_work, s.loads);
            list(r.base_work, s.loads), list(r.viscous, s.modes);
            for (int b = 0; b < w.beds; ++b) {
                LossSum before, now;
                ContactSum contacts;
                MotionSum motions;
                read(before), read(now), read(contacts), read(motions);
                r.take({.before = before.lost,
                        .now = now.lost,
                        .kinetic = motions.kinetic,
                        .rotation = motions.rotation,
                        .stored = contacts.stored,
                        .mass = w.bed[b].mass,
                        .slid = {contacts.slid[0], contacts.slid[1]},
                        .rolled = {contacts.rolled[0], contacts.rolled[1]},
                        .place = row(motions.place),
                        .momentum = row(motions.step.momentum),
                        .push = row(motions.step.push),
                        .twist = row(contacts.twist),
                        .contacts = {std::llround(contacts.contacts[0]), std::llround(contacts.contacts[1])}},
                       s.gravity);
            }
        }
        w.control.sample_count = 0;
    }

    // The block as it has to be at an address, and back again.
    std::vector<char> image(std::size_t address) const {
        const char* from = block_.data() + begin_;
        std::vector<char> bytes(from, from + size_);
        rebase(bytes.data(), address);
        return bytes;
    }
    void absorb(const char* bytes, std::size_t size) {
        World w;
        if (size < world_room()) throw std::invalid_argument("the state is cut short");
        std::memcpy(static_cast<void*>(&w), bytes, sizeof(World));
        const World& own = world();
        if (w.beds != own.beds || w.encounters != own.encounters || w.table_size != own.table_size ||
            w.structure.modes != own.structure.modes || w.structure.loads != own.structure.loads)
            throw std::invalid_argument("the state is of another case");
        std::vector<char> block(size + 64, 0);
        const auto begin = (64 - reinterpret_cast<std::size_t>(block.data()) % 64) % 64;
        std::memcpy(block.data() + begin, bytes, size);
        block_.swap(block);
        begin_ = begin, size_ = size;
        rebase(base(), reinterpret_cast<std::size_t>(base()));
    }

    void run(long until, int threads, Order order, const std::atomic<bool>& stop, Records& records) {
        until = std::min(until, problem_.steps);
        constexpr long piece = 256; // between two looks at whether to stop
        while (!stop) {
            const Control& c = world().control;
            if (c.step > until || c.status != Status::finished) break;
            const long to = std::min(until, c.step + piece);
            together(threads, [&](auto member) {
                Phased team(member, order);
                wide::run(team, world(), to);
            });
            take(records);
            make_room();
        }
    }
};

} // namespace rattlebox::dem::wide
