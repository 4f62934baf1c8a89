// All that a simulation by a wide team reads and writes: views of one block of memory, and plain data.
//
// Whoever owns the block lays it out once (`lay`), for whatever address it will have: the same bytes serve on
// the processor and on a device. Nothing in here grows; what does not fit is told with the size that would.
//
// Particles lie in the order of the cells they are in, which each build of neighbours finds anew; a
// particle's name is its number in the case. A contact belongs to the smaller of two particles, of equals to
// the one with the lower name, and keeps a slot k of its owner i as long as it lasts: what it remembers lies
// at k n + i.
#pragma once

#include <cstddef>

#include "base/phases.hpp"
#include "base/status.hpp"
#include "dem/losses.hpp"
#include "dem/structure.hpp"
#include "dem/touch.hpp"

namespace rattlebox::dem::wide {

// Of a particle, a bit each. Enough for six walls and for as many spheres of its size or larger as there can
// be within reach, 0.6 of its radius at most: seen from its centre, those that overlap by less than a
// twentieth of their diameters are at least 42.8 degrees apart, and L. Fejes Toth's bound lets no more than
// 26 be so.
inline constexpr int most_slots = 32;
inline constexpr int slot_bits = 5;
inline constexpr int most_particles = (1 << (31 - slot_bits)) - 1; // of a cavity
inline constexpr int nobody = -1 - 64;                             // in a slot; the wall w is -1 - w
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

    static real join(int k, real a, real b) { return k == 6 ? larger(a, b) : a + b; }
};

// At samples, of contacts.
struct LossSum {
    Losses lost; // from the start

    static real join(int, real a, real b) { return a + b; }
};
struct ContactSum {
    real stored = 0;
    real slid[2] = {}, rolled[2] = {}; // lost by then, beyond half of what the step loses
    real twist[3] = {};                // moment on the cavity
    real contacts[2] = {};

    static real join(int, real a, real b) { return a + b; }
};

// At samples, of particles.
struct MotionSum {
    StepSum step;
    real kinetic = 0, rotation = 0;
    real place[3] = {}; // mass times position

    static real join(int k, real a, real b) { return StepSum::join(k, a, b); }
};

struct Extent {
    real low[3] = {infinity, infinity, infinity}, high[3] = {-infinity, -infinity, -infinity};

    static real join(int k, real a, real b) { return k < 3 ? smaller(a, b) : larger(a, b); }
};

// What happens to a particle now and then.
struct Account {
    real fastest = 0; // approach
    int touches[2] = {}, extrapolated = 0;
    Status status = Status::finished;
    int wall = -1;
    real speed = 0;
};

// ---- views

// Sizes within an octave: their particles lie in cells of a grid of their own.
struct Layer {
    real largest = 0; // radius
    real size = 0;    // of its cells
    int cells[3] = {};
    int begin = 0; // number of its first cell
};

struct Bed {
    int particles = 0, walls = 0, slots = 0, kinds = 0, wall_kinds = 0, layers = 0;
    real mass = 0, smallest = 0; // of all; radius
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
    // Lost by own contacts so far: in normal direction, to particles and walls, and by sliding; by yielding
    // and rolling.
    Row *lost = nullptr, *lost_more = nullptr;
    real* deepest = nullptr;    // overlap of own contacts, over the smaller radius
    ContactSum* seen = nullptr; // at a sample
    Account* account = nullptr; // by name

    // Of slots.
    int* partner = nullptr;
    Kept* kept = nullptr;
    KeptRolling* rolling = nullptr;
    Action* action = nullptr; // at builds, room for what is sorted
    Row* torque = nullptr;    // of rolling, on the first
    Row* dent = nullptr;
    // Slots of others that are about a particle, from its begin to that of the next: owner << slot_bits |
    // slot.
    int *incoming_begin = nullptr, *incoming_count = nullptr, *incoming = nullptr;

    // Cells, the finest layer first, and who of the order before lies where.
    Layer* layer = nullptr;
    int *cell = nullptr, *cell_begin = nullptr, *cell_count = nullptr, *member = nullptr, *order = nullptr,
        *place = nullptr, *scan_part = nullptr;

    // Sums.
    StepSum* step_part = nullptr;
    LossSum* loss_part = nullptr;
    ContactSum* contact_part = nullptr;
    MotionSum* motion_part = nullptr;
    Extent* extent_part = nullptr;

    // The leader's.
    real reach = 0, since_build = 0;
    CavityMotion motion;
    Row shown{}; // displacement of the cavity at the last step whose forces are known
    real low[3] = {};
    Extent extent;
    StepSum step;
    LossSum before, now;
    ContactSum contacts;
    MotionSum motions;

    // Everyone's, as counts.
    int short_of = 0;      // - slots that would be needed
    int stopped = nowhere; // lowest name of a particle that cannot go on

    bool rolls() const { return pair.rolls || at_wall.rolls; }
    bool dents() const { return pair.normal == Kind::plastic || at_wall.normal == Kind::plastic; }
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
        const int numbers =
            static_cast<int>((2 * sizeof(LossSum) + sizeof(ContactSum) + sizeof(MotionSum)) / sizeof(real));
        return 1 + 3 * structure.modes + 2 * structure.loads + beds * numbers;
    }
};

// ---- totals

// Of a reduce over the particles of a bed, after a sync: the leader has it.
template <class T, class Team> void total(Team& team, Bed& bed, T* Bed::* part, T Bed::* whole) {
    const Summed<T> left = sum_up(team, bed.particles, bed.*part);
    if (!team.leads()) return;
    const T sum = team.total(left.items, left.part);
    if (team.first()) bed.*whole = sum;
}

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
    rows(b.position, b.velocity, b.spin, b.acceleration, b.spin_rate, b.lost, b.deepest, b.seen, b.name,
         b.kind, b.touched, b.touching, b.used, b.account, b.incoming_count, b.cell, b.member, b.order,
         b.place);
    slots(b.partner, b.kept, b.action, b.incoming);
    deal(b.rolling, b.rolls() ? s : 0), deal(b.torque, b.rolls() ? s : 0), deal(b.dent, b.dents() ? s : 0);
    deal(b.lost_more, b.rolls() || b.dents() ? n : 0);
    deal(b.layer, static_cast<std::size_t>(b.layers));
    deal(b.incoming_begin, n + 1), deal(b.cell_begin, cells), deal(b.cell_count, cells);
    deal(b.scan_part, static_cast<std::size_t>(scan_parts(cells_at_most(b.particles))));
    const auto room = static_cast<std::size_t>(tree_room(b.particles));
    deal(b.step_part, room), deal(b.loss_part, room), deal(b.contact_part, room), deal(b.motion_part, room),
        deal(b.extent_part, room);
}

} // namespace rattlebox::dem::wide
