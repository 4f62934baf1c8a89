// Who may touch whom soon, found anew by all of a team.
//
// Particles are counted into cells; each looks for those that are smaller than itself, or equal and higher in
// number, in the cells around. Contacts that last keep their slots, the others are filled in the order of
// names, so that the order in memory does not matter. See Neighbours of the other engine for what `reach`
// promises.
#pragma once

#include "dem/walls.hpp"
#include "dem/wide/world.hpp"

namespace rattlebox::dem::wide {

// The next step may bring together what is in no slot.
inline bool is_stale(const Bed& b) { return !(2 * b.since_build < b.reach); }

inline void choose_reach(Bed& bed, long since) {
    constexpr real steps_of_build = 60;
    const real rate = since > 0 ? bed.since_build / static_cast<real>(since) : 0;
    const real wanted = rate > 0 ? 2 * rate * steps_of_build : 0.2 * bed.smallest;
    bed.reach = smaller(larger(wanted, 0.02 * bed.smallest), 0.6 * bed.smallest);
}

inline void lay_cells(Bed& bed, const Extent& extent) {
    bed.cell_size = (2 * bed.largest + bed.reach) * (1 + 1e-12);
    for (;; bed.cell_size *= 1.25) { // few particles in a large cavity need no more cells than particles
        real total = 1;
        for (int a = 0; a < 3; ++a) total *= std::floor((extent.high[a] - extent.low[a]) / bed.cell_size) + 1;
        if (!(total > cells_at_most(bed.particles))) break;
    }
    for (int a = 0; a < 3; ++a) {
        bed.low[a] = extent.low[a];
        bed.cells[a] = static_cast<int>((extent.high[a] - extent.low[a]) / bed.cell_size) + 1;
    }
}

inline int cell_along(const Bed& bed, real x, int axis) {
    const int c = static_cast<int>((x - bed.low[axis]) / bed.cell_size), last = bed.cells[axis] - 1;
    return c < 0 ? 0 : c > last ? last : c;
}

inline bool owns(const Bed& bed, int i, int j) {
    const real a = bed.position[i][3], b = bed.position[j][3];
    return a < b || (a == b && bed.name[i] < bed.name[j]);
}

// Empty slots of a particle, filled so that the names in them increase.
class Filling {
    Bed& bed_;
    const int i_;
    const unsigned kept_;
    int wanted_ = 0, last_ = -1;

    int& partner(int k) const { return bed_.partner[k * bed_.particles + i_]; }
    // Walls come after all particles.
    int rank(int partner) const { return partner < 0 ? nowhere + partner : bed_.name[partner]; }
    int next(int k) const {
        do ++k;
        while (k < most_slots && (kept_ >> k & 1u));
        return k;
    }
    int previous(int k) const {
        do --k;
        while (k >= 0 && (kept_ >> k & 1u));
        return k;
    }

public:
    Filling(Bed& bed, int i) : bed_(bed), i_(i), kept_(bed.touching[i]) {
        for (int k = 0; k < bed.slots; ++k)
            if (!(kept_ >> k & 1u)) partner(k) = nobody;
    }

    void add(int candidate) {
        for (int k = 0; k < bed_.slots; ++k)
            if ((kept_ >> k & 1u) && partner(k) == candidate) return;
        ++wanted_;
        int k = next(last_);
        if (k >= bed_.slots) return;
        last_ = k;
        for (int p; (p = previous(k)) >= 0 && rank(partner(p)) > rank(candidate); k = p)
            partner(k) = partner(p);
        partner(k) = candidate;
    }

    // Slots that would have been needed.
    int needed() const {
        int all = wanted_;
        for (unsigned rest = kept_; rest != 0; rest &= rest - 1) ++all;
        return all;
    }

    int used() const {
        int k = last_ + 1;
        while (k < most_slots && kept_ >> k != 0) ++k;
        return k;
    }
};

template <class Team> void fill_slots(Team& team, Bed& bed, int i) {
    Filling filling(bed, i);
    const Row p = bed.position[i];
    int c[3];
    for (int a = 0; a < 3; ++a) c[a] = cell_along(bed, p[a], a);
    const auto low = [&](int a) { return c[a] > 0 ? c[a] - 1 : 0; };
    const auto high = [&](int a) { return c[a] < bed.cells[a] - 1 ? c[a] + 1 : c[a]; };
    for (int z = low(2); z <= high(2); ++z)
        for (int y = low(1); y <= high(1); ++y) {
            const int line = (z * bed.cells[1] + y) * bed.cells[0];
            for (int m = bed.cell_begin[line + low(0)]; m < bed.cell_begin[line + high(0) + 1]; ++m) {
                const int j = bed.member[m];
                if (j == i || !owns(bed, i, j)) continue;
                const Row q = bed.position[j], apart = p - q;
                const real near = (p[3] + q[3]) + bed.reach;
                if (near * near - dot(apart, apart) > 0) filling.add(j);
            }
        }
    for (int w = 0; w < bed.walls; ++w) {
        const real distance = nearest(bed.wall[w], p - bed.motion.displacement).distance;
        if (p[3] + bed.reach - distance > 0) filling.add(-1 - w);
    }
    bed.used[i] = filling.used();
    bed.incoming_count[i] = 0;
    if (filling.needed() > bed.slots) team.least(bed.short_of, -filling.needed());
}

// Slots of others that are about particle j, in the order of the names of their owners.
inline void sort_incoming(Bed& bed, int j) {
    const int begin = bed.incoming_begin[j], end = bed.incoming_begin[j + 1], n = bed.particles;
    for (int m = begin + 1; m < end; ++m) {
        const int s = bed.incoming[m], name = bed.name[s % n];
        int k = m;
        for (; k > begin && bed.name[bed.incoming[k - 1] % n] > name; --k)
            bed.incoming[k] = bed.incoming[k - 1];
        bed.incoming[k] = s;
    }
}

template <class Team, class F> void each_incoming(Team& team, Bed& bed, F&& f) {
    team.each(bed.particles, [&](int i) {
        for (int k = 0; k < bed.used[i]; ++k) {
            const int s = k * bed.particles + i;
            if (bed.partner[s] >= 0) f(s, bed.partner[s]);
        }
    });
}

template <class Team> RATTLEBOX_COLD void build(Team& team, World& world, Bed& bed) {
    const int n = bed.particles, cells = cells_at_most(n);
    team.reduce(n, bed.extent_part, [&](int i) {
        Extent e;
        for (int a = 0; a < 3; ++a) e.low[a] = e.high[a] = bed.position[i][a];
        return e;
    });
    team.each(cells, [&](int c) { bed.cell_begin[c] = bed.cell_count[c] = 0; });
    team.sync();
    if (team.leads()) {
        const Extent extent = team.total(n, bed.extent_part);
        if (team.first()) {
            choose_reach(bed, world.control.since);
            lay_cells(bed, extent);
            bed.short_of = 0;
        }
    }
    team.sync();
    team.each(n, [&](int i) {
        const Row p = bed.position[i];
        const int c = (cell_along(bed, p[2], 2) * bed.cells[1] + cell_along(bed, p[1], 1)) * bed.cells[0] +
                      cell_along(bed, p[0], 0);
        bed.cell[i] = c;
        team.count(bed.cell_begin[c]);
    });
    team.sync();
    scan(team, cells, bed.cell_begin, bed.scan_part);
    team.each(n, [&](int i) {
        const int c = bed.cell[i];
        bed.member[bed.cell_begin[c] + team.count(bed.cell_count[c])] = i;
    });
    team.sync();
    team.each(n, [&](int i) { fill_slots(team, bed, i); });
    team.sync();
    if (bed.short_of < 0) {
        if (team.leads() && team.first()) world.control.pause = Pause::slots;
        return;
    }
    each_incoming(team, bed, [&](int, int j) { team.count(bed.incoming_count[j]); });
    team.sync();
    team.each(n, [&](int i) {
        bed.incoming_begin[i] = bed.incoming_count[i];
        bed.incoming_count[i] = 0;
    });
    team.sync();
    scan(team, n, bed.incoming_begin, bed.scan_part);
    each_incoming(team, bed, [&](int s, int j) {
        bed.incoming[bed.incoming_begin[j] + team.count(bed.incoming_count[j])] = s;
    });
    team.sync();
    team.each(n, [&](int j) { sort_incoming(bed, j); });
}

template <class Team> void build(Team& team, World& world) {
    for (int b = 0; b < world.beds; ++b) build(team, world, world.bed[b]);
    team.sync();
    if (world.control.pause != Pause::none) return;
    team.sync();
    if (team.leads() && team.first()) {
        for (int b = 0; b < world.beds; ++b) world.bed[b].since_build = 0;
        ++world.control.builds;
        world.control.since = 0, world.control.must_build = 0;
    }
    team.sync();
}

} // namespace rattlebox::dem::wide
