// All that a simulation by a wide team reads and writes: views of one block of memory, and plain data.
//
// Whoever owns the block lays it out once (`lay`), for whatever address it will have: the same bytes serve on
// the processor and on a device. Nothing in here grows; what does not fit is told with the size that would.
//
// A contact belongs to the smaller of two particles, of equals to the one with the lower number in the case,
// and has a slot k of its owner i: what it remembers lies at k n + i. So it keeps its place as long as it
// lasts.
#pragma once

#include <cstddef>

#include "base/phases.hpp"
#include "base/status.hpp"
#include "dem/losses.hpp"
#include "dem/structure.hpp"
#include "dem/touch.hpp"

namespace rattlebox::dem::wide {

inline constexpr int most_slots = 32;  // of a particle: a bit each
inline constexpr int nobody = -1 - 64; // in a slot; the wall w is -1 - w
inline constexpr int nowhere = 2147483647;

inline int cells_at_most(int particles) { return 4 * particles + 64; }

// Kernels are compiled for the laws of a case: what both of its lists of contacts have in common is not
// asked.
inline Kind known(Kind k) {
#ifdef RATTLEBOX_NORMAL
    k.normal = static_cast<Kind::Normal>(RATTLEBOX_NORMAL);
#endif
#ifdef RATTLEBOX_RUBS // 0 smooth, 1 rough, 2 rolls too
    k.rough = RATTLEBOX_RUBS > 0, k.rolls = RATTLEBOX_RUBS > 1;
#endif
    return k;
}

// ---- sums

struct StepSum {
    real push[3] = {}, momentum[3] = {}; // of the particles on their cavity
    real drift = 0;                      // largest speed squared relative to the cavity

    void add(const StepSum& other) {
        for (int a = 0; a < 3; ++a) push[a] += other.push[a], momentum[a] += other.momentum[a];
        drift = larger(drift, other.drift);
    }
};

struct SampleSum {
    Losses lost;
    real kinetic = 0, rotation = 0, stored = 0;
    real place[3] = {}, twist[3] = {}; // mass times position; moment on the cavity
    real contacts[2] = {};

    void add(const SampleSum& other) {
        lost.add(other.lost);
        kinetic += other.kinetic, rotation += other.rotation, stored += other.stored;
        for (int a = 0; a < 3; ++a) place[a] += other.place[a], twist[a] += other.twist[a];
        for (int p = 0; p < 2; ++p) contacts[p] += other.contacts[p];
    }
};

struct Extent {
    real low[3] = {infinity, infinity, infinity}, high[3] = {-infinity, -infinity, -infinity};

    void add(const Extent& other) {
        for (int a = 0; a < 3; ++a)
            low[a] = smaller(low[a], other.low[a]), high[a] = larger(high[a], other.high[a]);
    }
};

// What the contacts of one particle come to: over the run, and at a sample.
struct Account {
    SampleSum sum;
    real deepest = 0, fastest = 0; // overlap over the smaller radius, approach
    int touches[2] = {}, extrapolated = 0;
    Status status = Status::finished;
    int wall = -1;
    real speed = 0;
};

// ---- views

struct Bed {
    int particles = 0, walls = 0, slots = 0, kinds = 0, wall_kinds = 0;
    real mass = 0, smallest = 0, largest = 0; // of all; radii
    Kind pair, at_wall;
    const Wall* wall = nullptr;
    const Row* shape = nullptr;
    const int *particle_entry = nullptr, *wall_entry = nullptr;

    // Of particles: see Bed of the other engine.
    Row *position = nullptr, *velocity = nullptr, *spin = nullptr, *acceleration = nullptr,
        *spin_rate = nullptr;
    int *name = nullptr, *kind = nullptr;
    int* touched = nullptr;       // in the step before
    unsigned* touching = nullptr; // slots, bit by bit
    int* used = nullptr;          // slots from which on all are empty
    Account* account = nullptr;

    // Of slots.
    int* partner = nullptr;
    Kept* kept = nullptr;
    KeptRolling* rolling = nullptr;
    Action* action = nullptr;
    Row* torque = nullptr; // of rolling, on the first
    Row* dent = nullptr;
    // Slots of others that are about a particle, from its begin to that of the next.
    int *incoming_begin = nullptr, *incoming_count = nullptr, *incoming = nullptr;

    // Cells.
    int *cell = nullptr, *cell_begin = nullptr, *cell_count = nullptr, *member = nullptr,
        *scan_part = nullptr;

    // Sums.
    StepSum* step_part = nullptr;
    SampleSum* sample_part = nullptr;
    Extent* extent_part = nullptr;

    // The leader's.
    real reach = 0, since_build = 0;
    CavityMotion motion;
    Row shown{}; // displacement of the cavity at the last step whose forces are known
    real low[3] = {}, cell_size = 0;
    int cells[3] = {};
    StepSum step;
    SampleSum before, now;

    // Everyone's, as counts.
    int short_of = 0;      // - slots that would be needed
    int stopped = nowhere; // lowest name of a particle that cannot go on
};

// What the step that is taken, and whoever called for it, must know.
enum class Pause : int {
    none = 0,
    slots = 1,   // a particle has more neighbours than slots
    samples = 2, // there is no room for another sample
};

struct Control {
    long step = 0, steps = 0, every = 1;
    Status status = Status::finished;
    Pause pause = Pause::none;
    int sample_count = 0, sample_room = 0, must_build = 0;
    int stopped_cavity = 0, stopped_particle = -1, stopped_wall = -1;
    real stopped_speed = 0;
    long builds = 0, since = 0; // steps since the last build
    Row body_before{};
};

struct World {
    Control control;
    Structure structure;
    const Encounter* encounter = nullptr;
    int encounters = 0, beds = 0, table_size = 0;
    Bed* bed = nullptr;
    real* table = nullptr;  // of laws and signals
    real* sample = nullptr; // each: time, q and p of modes, work of loads and of the base, viscous losses,
                            // sums of each bed
    real last = 0;

    int sample_width() const {
        const int numbers = static_cast<int>((sizeof(StepSum) + 2 * sizeof(SampleSum)) / sizeof(real));
        return 1 + 3 * structure.modes + 2 * structure.loads + beds * numbers;
    }
};

// ---- layout

// Deals out a block of memory that begins at an address, which nobody need have yet.
class Dealer {
    std::size_t base_, used_ = 0;

public:
    explicit Dealer(std::size_t base) : base_(base) {}
    std::size_t used() const { return used_; }

    template <class T> void operator()(T*& array, std::size_t count) {
        used_ = (used_ + 63) / 64 * 64;
        array = reinterpret_cast<T*>(base_ + used_);
        used_ += count * sizeof(T);
    }
    template <class T> void operator()(const T*& array, std::size_t count) {
        T* own;
        (*this)(own, count);
        array = own;
    }
};

template <class Deal> void lay(Deal& deal, Bed& b) {
    const auto n = static_cast<std::size_t>(b.particles), s = n * static_cast<std::size_t>(b.slots);
    const auto cells = static_cast<std::size_t>(cells_at_most(b.particles)) + 1;
    const auto rows = [&](auto&... array) { (deal(array, n), ...); };
    const auto slots = [&](auto&... array) { (deal(array, s), ...); };
    rows(b.position, b.velocity, b.spin, b.acceleration, b.spin_rate, b.name, b.kind, b.touched, b.touching,
         b.used, b.account, b.incoming_count, b.cell, b.member);
    slots(b.partner, b.kept, b.action, b.incoming);
    const bool rolls = b.pair.rolls || b.at_wall.rolls;
    const bool dents = b.pair.normal == Kind::plastic || b.at_wall.normal == Kind::plastic;
    deal(b.rolling, rolls ? s : 0), deal(b.torque, rolls ? s : 0), deal(b.dent, dents ? s : 0);
    deal(b.incoming_begin, n + 1), deal(b.cell_begin, cells), deal(b.cell_count, cells);
    deal(b.scan_part, static_cast<std::size_t>(scan_parts(cells_at_most(b.particles))));
    const auto room = static_cast<std::size_t>(tree_room(b.particles));
    deal(b.step_part, room), deal(b.sample_part, room), deal(b.extent_part, room);
}

} // namespace rattlebox::dem::wide
