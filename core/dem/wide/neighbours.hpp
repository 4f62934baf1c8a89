// Who may touch whom soon, found anew by all of a team.
//
// Particles are sorted by the cells that they are in, and by name within a cell, so that neighbours are near
// in memory too, and a row of three cells is one range. Each octave of sizes has cells of its own. Each
// particle looks for those that are larger than itself, or equal and higher in name, in the cells around it
// of its own octave and of coarser ones: a large one sees no small ones, of which there are many about it.
// Contacts that last keep their slots, others fill the rest in
// the order of memory. See Neighbours of the other engine for what `reach` promises.
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

inline void lay_cells(Bed& bed) {
    const Extent& extent = bed.extent;
    const auto along = [&](const Layer& layer, int a) {
        return std::floor((extent.high[a] - extent.low[a]) / layer.size) + 1;
    };
    for (int l = 0; l < bed.layers; ++l)
        bed.layer[l].size = (2 * bed.layer[l].largest + bed.reach) * (1 + 1e-12);
    for (;;) { // few particles in a large cavity need no more cells than particles
        real total = 0;
        for (int l = 0; l < bed.layers; ++l)
            total += along(bed.layer[l], 0) * along(bed.layer[l], 1) * along(bed.layer[l], 2);
        if (!(total > cells_at_most(bed.particles))) break;
        for (int l = 0; l < bed.layers; ++l) bed.layer[l].size *= 1.25;
    }
    int begin = 0;
    for (int l = 0; l < bed.layers; ++l) {
        Layer& layer = bed.layer[l];
        for (int a = 0; a < 3; ++a) layer.cells[a] = static_cast<int>(along(layer, a));
        layer.begin = begin;
        begin += layer.cells[0] * layer.cells[1] * layer.cells[2];
    }
    for (int a = 0; a < 3; ++a) bed.low[a] = extent.low[a];
}

inline int layer_of(const Bed& bed, real radius) {
    int l = 0;
    while (bed.layer[l].largest < radius) ++l;
    return l;
}

inline int cell_along(const Bed& bed, const Layer& layer, real x, int axis) {
    const int c = static_cast<int>((x - bed.low[axis]) / layer.size), last = layer.cells[axis] - 1;
    return c < 0 ? 0 : c > last ? last : c;
}

inline int line_of(const Layer& layer, int y, int z) {
    return layer.begin + (z * layer.cells[1] + y) * layer.cells[0];
}

inline bool owns(const Bed& bed, int i, int j) {
    const real a = bed.position[i][3], b = bed.position[j][3];
    return a < b || (a == b && bed.name[i] < bed.name[j]);
}

// ---- sorting

// Where each particle lies from now on: cells one behind the other, names rising within each.
template <class Team> void find_order(Team& team, Bed& bed) {
    const int n = bed.particles, cells = cells_at_most(n);
    team.each(n, [&](int i) {
        const Row p = bed.position[i];
        const Layer& layer = bed.layer[layer_of(bed, p[3])];
        const auto along = [&](int a) { return cell_along(bed, layer, p[a], a); };
        const int c = line_of(layer, along(1), along(2)) + along(0);
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
    team.each(n, [&](int i) {
        const int begin = bed.cell_begin[bed.cell[i]], end = bed.cell_begin[bed.cell[i] + 1];
        int before = 0;
        for (int m = begin; m < end; ++m) before += bed.name[bed.member[m]] < bed.name[i];
        bed.place[i] = begin + before;
        bed.order[begin + before] = i;
    });
    team.sync();
}

// Takes from each particle of the order before what it is to bring along, and puts it down where it is now.
template <class Team, class Take, class Put> void bring(Team& team, Bed& bed, Take&& take, Put&& put) {
    using T = decltype(take(0));
    static_assert(sizeof(T) <= sizeof(Action));
    T* room = reinterpret_cast<T*>(bed.action);
    team.each(bed.particles, [&](int i) { room[i] = take(bed.order[i]); });
    team.sync();
    team.each(bed.particles, [&](int i) { put(i, room[i]); });
    team.sync();
}

// The same of contacts that last.
template <class T, class Team> void bring_contacts(Team& team, Bed& bed, T* array) {
    static_assert(sizeof(T) <= sizeof(Action));
    T* room = reinterpret_cast<T*>(bed.action);
    const int n = bed.particles;
    const auto each = [&](auto&& f) {
        team.each(n, [&](int i) {
            for (unsigned rest = bed.touching[i]; rest != 0; rest &= rest - 1) f(lowest_bit(rest) * n, i);
        });
        team.sync();
    };
    each([&](int line, int i) { room[line + bed.place[i]] = array[line + i]; });
    team.each(n, [&](int i) {
        for (unsigned rest = bed.touching[bed.order[i]]; rest != 0; rest &= rest - 1) {
            const int s = lowest_bit(rest) * n + i;
            array[s] = room[s];
        }
    });
    team.sync();
}

template <class Team> void sort(Team& team, Bed& bed) {
    struct Rows {
        Row a, b;
    };
    struct Numbers {
        real deepest;
        int name, kind, touched;
        unsigned touching;
    };
    find_order(team, bed);
    const auto rows = [&](Row* a, Row* b) {
        bring(
            team, bed, [&](int i) { return Rows{a[i], b[i]}; },
            [&](int i, const Rows& r) { a[i] = r.a, b[i] = r.b; });
    };
    rows(bed.position, bed.velocity), rows(bed.spin, bed.lost), rows(bed.acceleration, bed.spin_rate);
    if (bed.rolls() || bed.dents()) rows(bed.lost_more, bed.lost_more);
    bring_contacts(team, bed, bed.kept);
    bring_contacts(team, bed, bed.partner);
    if (bed.rolls()) bring_contacts(team, bed, bed.rolling);
    if (bed.dents()) bring_contacts(team, bed, bed.dent);
    bring(
        team, bed,
        [&](int i) {
            return Numbers{bed.deepest[i], bed.name[i], bed.kind[i], bed.touched[i], bed.touching[i]};
        },
        [&](int i, const Numbers& p) {
            bed.deepest[i] = p.deepest, bed.name[i] = p.name, bed.kind[i] = p.kind;
            bed.touched[i] = p.touched, bed.touching[i] = p.touching;
            for (unsigned rest = p.touching; rest != 0; rest &= rest - 1) {
                int& partner = bed.partner[lowest_bit(rest) * bed.particles + i];
                if (partner >= 0) partner = bed.place[partner];
            }
        });
}

// ---- searching

// Free slots of a particle, filled one after the other.
class Filling {
    Bed& bed_;
    const int i_;
    const unsigned kept_;
    int wanted_ = 0, last_ = -1;

    int& partner(int k) const { return bed_.partner[k * bed_.particles + i_]; }

public:
    Filling(Bed& bed, int i) : bed_(bed), i_(i), kept_(bed.touching[i]) {
        for (int k = 0; k < bed.slots; ++k)
            if (!(kept_ >> k & 1u)) partner(k) = nobody;
    }

    void add(int candidate) {
        for (unsigned rest = kept_; rest != 0; rest &= rest - 1)
            if (partner(lowest_bit(rest)) == candidate) return;
        ++wanted_;
        do ++last_;
        while (last_ < bed_.slots && (kept_ >> last_ & 1u));
        if (last_ < bed_.slots) partner(last_) = candidate;
    }

    // Slots that would have been needed.
    int needed() const {
        int all = wanted_;
        for (unsigned rest = kept_; rest != 0; rest &= rest - 1) ++all;
        return all;
    }

    int used() const {
        int k = last_ + 1;
        while (k < bed_.slots && kept_ >> k != 0) ++k;
        return k;
    }
};

template <class Team> void fill_slots(Team& team, Bed& bed, int i) {
    Filling filling(bed, i);
    const Row p = bed.position[i];
    for (int l = layer_of(bed, p[3]); l < bed.layers; ++l) {
        const Layer& layer = bed.layer[l];
        int low[3], high[3];
        for (int a = 0; a < 3; ++a) {
            const int c = cell_along(bed, layer, p[a], a);
            low[a] = c > 0 ? c - 1 : 0, high[a] = c < layer.cells[a] - 1 ? c + 1 : c;
        }
        for (int z = low[2]; z <= high[2]; ++z)
            for (int y = low[1]; y <= high[1]; ++y) {
                const int line = line_of(layer, y, z);
                for (int j = bed.cell_begin[line + low[0]]; j < bed.cell_begin[line + high[0] + 1]; ++j) {
                    const Row q = bed.position[j], apart = p - q;
                    const real near = (p[3] + q[3]) + bed.reach;
                    if (near * near - dot(apart, apart) > 0 && owns(bed, i, j)) filling.add(j);
                }
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

// Slots of others that are about particle j, in order.
inline void sort_incoming(Bed& bed, int j) {
    const int begin = bed.incoming_begin[j], end = bed.incoming_begin[j + 1];
    for (int m = begin + 1; m < end; ++m) {
        const int own = bed.incoming[m];
        int k = m;
        for (; k > begin && bed.incoming[k - 1] > own; --k) bed.incoming[k] = bed.incoming[k - 1];
        bed.incoming[k] = own;
    }
}

template <class Team> void find_incoming(Team& team, Bed& bed) {
    const int n = bed.particles;
    const auto each = [&](auto&& f) {
        team.each(n, [&](int i) {
            for (int k = 0; k < bed.used[i]; ++k)
                if (const int j = bed.partner[k * n + i]; j >= 0) f(i << slot_bits | k, j);
        });
        team.sync();
    };
    each([&](int, int j) { team.count(bed.incoming_count[j]); });
    team.each(n, [&](int i) {
        bed.incoming_begin[i] = bed.incoming_count[i];
        bed.incoming_count[i] = 0;
    });
    team.sync();
    scan(team, n, bed.incoming_begin, bed.scan_part);
    each([&](int s, int j) { bed.incoming[bed.incoming_begin[j] + team.count(bed.incoming_count[j])] = s; });
    team.each(n, [&](int j) { sort_incoming(bed, j); });
}

template <class Team> RATTLEBOX_COLD void build(Team& team, World& world, Bed& bed) {
    const int n = bed.particles;
    team.reduce(n, bed.extent_part, [&](int i) {
        Extent e;
        for (int a = 0; a < 3; ++a) e.low[a] = e.high[a] = bed.position[i][a];
        return e;
    });
    team.each(cells_at_most(n), [&](int c) { bed.cell_begin[c] = bed.cell_count[c] = 0; });
    team.sync();
    total(team, bed, &Bed::extent_part, &Bed::extent);
    if (team.leads() && team.first()) {
        choose_reach(bed, world.control.since);
        lay_cells(bed);
        bed.short_of = 0;
    }
    team.sync();
    sort(team, bed);
    team.each(n, [&](int i) { fill_slots(team, bed, i); });
    team.sync();
    if (bed.short_of == 0)
        find_incoming(team, bed);
    else if (team.leads() && team.first())
        world.control.pause = Pause::slots;
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
