// Neighbour lists with two cut-off distances: neighbours within `reach`, found by cell lists and rebuilt
// rarely, and among these the candidate pairs within a Verlet skin, which every step tests.
//
// A pair with a gap larger than `reach` at the last rebuild cannot touch before it has approached by that
// much; likewise for the candidate pairs of a chunk and their `skin`. The bound on the approach is computed
// for each chunk: each step adds the displacement of the fastest particle of the chunk and of the fastest
// particle of the chunks in which it has neighbours. Displacements are measured relative to the mean
// velocity, which changes no distance. Particles are sorted by cell at each rebuild, so that neighbours are
// close in memory and a row of three cells is one range of indices. Measured on one core as time with one
// range over time with two: 1.10 with 1000 particles shaken, 1.00 at rest, 1.01 and 1.01 with 100 000.
//
// L. Verlet, Phys. Rev. 159 (1967) 98, doi:10.1103/PhysRev.159.98.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "dem/bed.hpp"
#include "dem/cell_list.hpp"
#include "dem/solid_contacts.hpp"
#include "dem/walls.hpp"
#include "math/masks.hpp"

namespace rattlebox::dem {

class NeighbourList {
    static constexpr int none = ContactList::none;

    // A contact that changes its chunk in a sort, with indices from before the sort.
    struct MovedContact {
        int first, second, leaf, slot; // particle and none, or none and a leaf of the walls
    };
    // The contacts of a chunk before the sort, their histories, and the bounding box of its particles.
    struct OutgoingContacts {
        std::vector<MovedContact> moving;
        ContactHistory pairs, walls;
        Row low = row(infinity, infinity, infinity), high = -low;
    };

    // Buffers in which the arrays of a bed are sorted, one at a time.
    std::vector<Row> rows_;
    std::vector<int> numbers_;
    std::vector<char> flags_;

    CellList cells_;
    std::vector<real> coordinates_[4];       // x, y, z and radius, for searches in SIMD lanes
    std::vector<OutgoingContacts> outgoing_; // by chunk before the sort

    // Number of steps that a skin should last, measured; the optima are flat. A scan for walls visits all
    // particles of the chunk and finds few candidates, so that it pays to scan less often than for pairs.
    static constexpr real steps_of_pairs = 9, steps_of_walls = 30;

    // Chooses a skin that lasts for a number of steps at the approach per step since the last scan.
    static void choose_skin(ContactList& list, real smallest, real largest, real steps) {
        if (list.steps_since_scan > 0 && list.approach < infinity)
            list.approach_per_step = list.approach / static_cast<real>(list.steps_since_scan);
        list.skin = list.approach_per_step > 0
                        ? std::clamp(list.approach_per_step * steps, 2e-3 * smallest, largest)
                        : 0.1 * largest;
        list.approach = 0, list.steps_since_scan = 0;
    }

public:
    void start(Bed& bed) {
        cells_.start(bed);
        outgoing_.resize(bed.chunks.size());
        const auto n = static_cast<std::size_t>(bed.particles());
        rows_.resize(n), numbers_.resize(n), flags_.resize(n);
        for (auto& values : coordinates_) values.resize(n + lane_count);
    }

    std::size_t memory() const {
        std::size_t bytes =
            rows_.capacity() * sizeof(Row) + numbers_.capacity() * sizeof(int) + flags_.capacity();
        for (const auto& values : coordinates_) bytes += values.capacity() * sizeof(real);
        return bytes + cells_.memory();
    }

    // ---- rebuild: collect the contacts, sort the particles, search each chunk, distribute the contacts

    void collect_contacts(const Bed& bed, Chunk& chunk) {
        OutgoingContacts& outgoing = at(outgoing_, chunk.begin / Bed::chunk_size);
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Row& p = at(bed.position, i);
            outgoing.low = p < outgoing.low ? p : outgoing.low;
            outgoing.high = p > outgoing.high ? p : outgoing.high;
        }
        outgoing.moving.reserve(
            static_cast<std::size_t>(chunk.pairs.touching_count + chunk.walls.touching_count));
        // Only touching contacts move: candidates without a history are found again by the search.
        for (const ContactList* list : {&chunk.pairs, &chunk.walls})
            for (int a = 0; a < list->touching_count; ++a) {
                const int k = at(list->touching, a), i = at(list->first, k), j = at(list->second, k);
                const bool at_wall = list == &chunk.walls;
                // At walls the leaf identifies the contact, of which a surface may have many.
                const int leaf = at(list->origin, k) - (i - chunk.begin) * bed.cavity->leaves();
                outgoing.moving.push_back({i, at_wall ? none : j, at_wall ? leaf : none, at(list->slot, k)});
            }
        chunk.pairs.move_history(outgoing.pairs), chunk.walls.move_history(outgoing.walls);
    }

    void set_up_cells(const Bed& bed) {
        Row low = row(infinity, infinity, infinity), high = -low;
        for (const OutgoingContacts& from : outgoing_) {
            low = from.low < low ? from.low : low;
            high = from.high > high ? from.high : high;
        }
        cells_.set_up(bed, low, high);
    }

    void assign_cells(const Bed& bed, const Chunk& chunk) { cells_.assign_cells(bed, chunk); }
    void sort_by_cell(const Bed& bed) { cells_.sort_by_cell(bed); }

    static constexpr int sort_phases = 6;

    // Sorts the data of the particles with new indices from `first` to `until`: each phase gathers some of
    // the arrays in the new order into the buffers; after a barrier the buffers are swapped or copied back.
    void sort(Bed& bed, int phase, int first, int until) {
        const auto gather = [&](auto& list, auto&& from) {
            for (int i = first; i < until; ++i) at(list, i) = from(cells_.old_index(i));
        };
        const auto store_rates = [&](Row Rates::* part) {
            for (int i = first; i < until; ++i) at(bed.rates, i).*part = at(rows_, i);
        };
        if (phase == 0) {
            gather(rows_, [&](int i) { return at(bed.position, i); });
            gather(numbers_, [&](int i) { return at(bed.id, i); });
            gather(flags_, [&](int i) { return at(bed.touched, i); });
        } else if (phase == 1) {
            gather(rows_, [&](int i) { return at(bed.velocity, i); });
            gather(numbers_, [&](int i) { return at(bed.species, i); });
            for (int i = first; i < until; ++i)
                for (int a = 0; a < 4; ++a) at(coordinates_[a], i) = at(bed.position, i)[a];
        } else if (phase == 2) {
            gather(rows_, [&](int i) { return at(bed.spin, i); });
        } else if (phase == 3) {
            gather(rows_, [&](int i) { return at(bed.rates, i).velocity; });
        } else if (phase == 4) {
            store_rates(&Rates::velocity);
            gather(rows_, [&](int i) { return at(bed.rates, i).spin; });
        } else {
            store_rates(&Rates::spin);
        }
    }

    void swap_buffers(Bed& bed, int phase) {
        if (phase == 0) bed.position.swap(rows_), bed.id.swap(numbers_), bed.touched.swap(flags_);
        if (phase == 1) bed.velocity.swap(rows_), bed.species.swap(numbers_);
        if (phase == 2) bed.spin.swap(rows_);
    }

    // Lists the neighbours j > i of a particle in a periodic cavity; returns their number. After the
    // last cell of a periodic axis follows the first one.
    int search_images(const Bed& bed, int i, int* found) const {
        const Row& p = at(bed.position, i);
        const real reach = p[3] + bed.reach;
        const auto& levels = cells_.levels();
        int count = 0;
        for (std::size_t k = 0; k < levels.size(); ++k) {
            const CellLevel& level = levels[k];
            const auto [x, y, z] = cells_.cells_around(level, p, reach + level.largest);
            const auto visit = [&](int line, int from, int until) {
                for (int m = at(level.begin, line + from); m < at(level.begin, line + until); ++m) {
                    const int j = k == 0 ? m : at(level.member, m);
                    const Row other = at(bed.position, j);
                    if (j <= i || (k == 0 && other[3] > level.largest)) continue; // coarse levels hold them
                    Row apart = other - p;
                    apart += bed.periods.to_nearest_image(apart);
                    if (square(reach + other[3]) > dot(apart, apart)) found[count++] = j;
                }
            };
            for (int b = 0; b < z.count; ++b)
                for (int a = 0; a < y.count; ++a) {
                    const int line =
                        level.line((y.first + a) % level.cells[1], (z.first + b) % level.cells[2]);
                    const int until = x.first + x.count, over = until - level.cells[0];
                    visit(line, x.first, std::min(until, level.cells[0]));
                    if (over > 0) visit(line, 0, over);
                }
        }
        return count;
    }

    // The same in a cavity without periods.
    int search_cells(const Bed& bed, int i, int* found) const {
        // Particles of very different sizes are on several levels of cells: one level for the smallest would
        // make a search around a large one visit thousands of cells.
        const auto& levels = cells_.levels();
        const CellLevel& fine = levels.front();
        const Group fits = Group::all(fine.largest);
        const bool mixed = levels.size() > 1;
        const Row& p = at(bed.position, i);
        const real reach = p[3] + bed.reach;
        const Vector<Group> place = {Group::all(p[0]), Group::all(p[1]), Group::all(p[2])};
        const Group around = Group::all(reach);
        int count = 0;
        // Particles are sorted by cell, so that a line of cells is one range of particles and is compared in
        // registers.
        const auto search_range = [&](int from, int to) {
            for (int j = from; j < to; j += group) {
                const auto others = [&](int a) { return unaligned(&at(coordinates_[a], j)); };
                const Vector<Group> apart = place - Vector<Group>{others(0), others(1), others(2)};
                const Group near = around + others(3);
                unsigned within = positive(near * near - dot(apart, apart));
                if (mixed) within &= ~positive(others(3) - fits); // the coarse levels hold them
                count += list_lanes(within & first_lanes(std::min(group, to - j)), j, found + count);
            }
        };
        if (bed.particles() <= Bed::chunk_size && !mixed) {
            search_range(i + 1, bed.particles());
            return count;
        }
        // Each pair is found once: by the particle with the lower index, in its own cell behind itself and in
        // cells that follow.
        const Cell own = cells_.cell(fine, p);
        const CellBox box = p[3] <= fine.largest ? cells_.adjacent_cells(fine, own)
                                                 : cells_.cells_within(fine, p, reach + fine.largest);
        for (int z = own[2]; z <= box.high[2]; ++z)
            for (int y = z == own[2] ? own[1] : box.low[1]; y <= box.high[1]; ++y) {
                const int line = fine.line(y, z);
                const bool has_own = z == own[2] && y == own[1];
                search_range(has_own ? i + 1 : at(fine.begin, line + box.low[0]),
                             at(fine.begin, line + box.high[0] + 1));
            }
        // Larger particles have lists of members, which are few, and both orders of indices occur: the lower
        // index searches.
        for (std::size_t k = 1; k < levels.size(); ++k) {
            const CellLevel& level = levels[k];
            const CellBox there = cells_.cells_within(level, p, reach + level.largest);
            for (int z = there.low[2]; z <= there.high[2]; ++z)
                for (int y = there.low[1]; y <= there.high[1]; ++y) {
                    const int line = level.line(y, z), to = at(level.begin, line + there.high[0] + 1);
                    for (int m = at(level.begin, line + there.low[0]); m < to; ++m) {
                        const int j = at(level.member, m);
                        const Row apart = p - at(bed.position, j);
                        if (j > i && square(reach + at(bed.position, j)[3]) > dot(apart, apart))
                            found[count++] = j;
                    }
                }
        }
        return count;
    }

    void search(const Bed& bed, Chunk& chunk) const {
        thread_local std::vector<int> buffer;
        thread_local std::vector<std::uint8_t> first_buffer;
        std::vector<int>& found = buffer;
        std::vector<std::uint8_t>& first = first_buffer;
        first.clear();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            // A particle has fewer neighbours than the bed has particles; lanes are written as a whole.
            const std::size_t room = first.size() + bed.position.size() + lane_count;
            if (found.size() < room) found.resize(room);
            int* const next = found.data() + first.size();
            const int count = bed.periods.any ? search_images(bed, i, next) : search_cells(bed, i, next);
            first.insert(first.end(), static_cast<std::size_t>(count),
                         static_cast<std::uint8_t>(i - chunk.begin));
        }
        // The lists are copied at the end, with a byte for the first partner: neighbours are read in each
        // scan and must fit into the caches.
        chunk.neighbour_first.assign(first.begin(), first.end());
        chunk.neighbour_second.assign(found.data(), found.data() + first.size());
        chunk.highest_neighbour = chunk.end - 1;
        for (const int j : chunk.neighbour_second)
            chunk.highest_neighbour = std::max(chunk.highest_neighbour, j);
    }

    // Moves contacts to the chunks of their first partners, if these are from `first` to `until`.
    void distribute_contacts(Bed& bed, int first, int until) const {
        const int leaves = bed.cavity->leaves();
        for (const OutgoingContacts& from : outgoing_)
            for (const MovedContact& m : from.moving) {
                // The sort may have exchanged which partner has the lower index, and with it the owner of the
                // contact and the sign of its springs.
                int i = cells_.new_index(m.first), j = m.leaf == none ? cells_.new_index(m.second) : i;
                const bool swapped = i > j;
                if (swapped) std::swap(i, j);
                if (i < first || i >= until) continue;
                Chunk& chunk = at(bed.chunks, i / Bed::chunk_size);
                const auto own = static_cast<std::uint8_t>(i - chunk.begin);
                if (m.leaf != none) {
                    chunk.walls.add_contact(i, bed.cavity->wall_of(m.leaf), own * leaves + m.leaf,
                                            chunk.walls.history.add(from.walls, m.slot, 1));
                    continue;
                }
                // A contact keeps its history if its pair is still a neighbour; the neighbours of a particle
                // are consecutive.
                const auto& firsts = chunk.neighbour_first;
                auto p = static_cast<int>(std::ranges::lower_bound(firsts, own) - firsts.begin());
                const auto is_own = [&] {
                    return p < static_cast<int>(firsts.size()) && at(firsts, p) == own;
                };
                while (is_own() && at(chunk.neighbour_second, p) != j) ++p;
                if (!is_own()) continue; // the gap exceeds the reach after one step
                chunk.pairs.add_contact(i, j, p,
                                        chunk.pairs.history.add(from.pairs, m.slot, swapped ? -1 : 1));
            }
    }

    void clear_outgoing(const Chunk& chunk) {
        at(outgoing_, chunk.begin / Bed::chunk_size) = OutgoingContacts();
    }

    // ---- scan of a chunk: candidate pairs among the neighbours, and at walls

    // Returns the history slots of touching candidates, by origin.
    static const std::vector<int>& slots_by_origin(const ContactList& list, int origins) {
        thread_local std::vector<int> slots;
        slots.assign(static_cast<std::size_t>(origins), none);
        for (int a = 0; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            at(slots, at(list.origin, k)) = at(list.slot, k);
        }
        return slots;
    }

    void scan_pairs(const Bed& bed, Chunk& chunk) const {
        // Neighbours hold for many steps, candidates for fewer: a thinner skin leaves fewer pairs to test in
        // each step, and a scan is cheaper than a search.
        choose_skin(chunk.pairs, bed.smallest, 0.4 * bed.reach, steps_of_pairs);
        const real skin = chunk.pairs.skin;
        thread_local std::vector<int> candidate_pairs;
        const int count = static_cast<int>(chunk.neighbour_second.size());
        candidate_pairs.resize(static_cast<std::size_t>(count) + lane_count);
        int* const candidate_pair = candidate_pairs.data();
        int candidates = 0;
        for (int p = 0; p < count; p += group) {
            auto apart = columns_of([&](int l) __attribute__((always_inline)) {
                const int q = std::min(p + l, count - 1);
                const Row a = at(bed.position, chunk.begin + at(chunk.neighbour_first, q));
                return at(bed.position, at(chunk.neighbour_second, q)) + row(-1, -1, -1, 1) * a;
            });
            if (bed.periods.any) apart = bed.periods.nearest_image(apart);
            const Group limit = apart.w + Group::all(skin);
            const unsigned within = positive(limit * limit - dot(apart.vector(), apart.vector()));
            candidates +=
                list_lanes(within & first_lanes(std::min(group, count - p)), p, candidate_pair + candidates);
        }
        ContactList& pairs = chunk.pairs;
        // Contacts that last keep their history across the scan, which replaces the list of candidates.
        const std::vector<int>& slot = slots_by_origin(pairs, count);
        pairs.resize(candidates);
        for (int k = 0; k < candidates; ++k) {
            const int p = candidate_pair[k];
            pairs.set_candidate(k, chunk.begin + at(chunk.neighbour_first, p), at(chunk.neighbour_second, p),
                                p, at(slot, p));
        }
        pairs.pad(chunk.begin, chunk.begin);
    }

    void scan_walls(const Bed& bed, Chunk& chunk) const {
        choose_skin(chunk.walls, bed.smallest, 0.5 * bed.smallest, steps_of_walls);
        const real skin = chunk.walls.skin;
        const auto& all_walls = bed.cavity->walls;
        const Solids& solids = bed.cavity->solids;
        const int walls = solids.empty() ? static_cast<int>(all_walls.size()) : solids.plain_walls();
        const int last = bed.particles() - 1;
        const Row c = bed.motion.displacement;
        const Group zero = Group::all(0);
        thread_local std::vector<std::uint32_t> masks;
        masks.resize(static_cast<std::size_t>(chunk.end - chunk.begin) + group);
        int count = 0;
        for (int i = chunk.begin; i < chunk.end; i += group) {
            const auto a = columns([&](int l) { return &at(bed.position, std::min(i + l, last)); });
            const Vector<Group> place = {a.x - Group::all(c[0]), a.y - Group::all(c[1]),
                                         a.z - Group::all(c[2])};
            const int used = std::min(group, chunk.end - i);
            // A bit for each wall of a particle, as a number; 32 walls are the most that a cavity has.
            Group bits = zero, least = Group::all(infinity);
            for (int w = 0; w < walls; ++w) {
                const Group far = distance(at(all_walls, w), place);
                bits += choose(Group::all(skin) + a.w - far, Group::all(static_cast<real>(1u << w)), zero);
                least = smaller(least, far);
            }
            if (positive(zero - least) & first_lanes(used)) // the centre is outside the cavity
                for (int w = 0; w < walls; ++w)
                    each_lane(positive(zero - distance(at(all_walls, w), place)) & first_lanes(used),
                              [&](int l) { chunk.stop_reason = {Status::escaped, i + l, w, 0}; });
            alignas(64) real of[group];
            pack<group>(of) = bits;
            std::uint32_t* mask = &at(masks, i - chunk.begin);
            for (int l = 0; l < group; ++l) mask[l] = static_cast<std::uint32_t>(of[l]);
            for (int l = 0; l < used; ++l) count += std::popcount(mask[l]);
        }
        if (!solids.empty()) return scan_solids(bed, chunk, masks.data());
        ContactList& list = chunk.walls;
        const std::vector<int>& slot = slots_by_origin(list, (chunk.end - chunk.begin) * walls);
        list.resize(count);
        for (int i = chunk.begin, k = 0; i < chunk.end; ++i)
            for (std::uint32_t rest = at(masks, i - chunk.begin); rest != 0; rest &= rest - 1, ++k) {
                const int w = __builtin_ctz(rest), own = i - chunk.begin, origin = own * walls + w;
                list.set_candidate(k, i, w, origin, at(slot, origin));
            }
        list.pad(chunk.begin, 0);
    }

    // The same where there are solids, whose leaves follow the plain walls; `masks` has the plain walls of
    // each particle.
    static void scan_solids(const Bed& bed, Chunk& chunk, const std::uint32_t* masks) {
        const Solids& solids = bed.cavity->solids;
        const int leaves = solids.leaves();
        ContactList& list = chunk.walls;
        thread_local std::vector<int> origins;
        thread_local std::vector<real> gaps;
        thread_local std::vector<std::pair<int, int>> touching; // origin and slot
        origins.clear(), gaps.clear(), touching.clear();
        for (int a = 0; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            touching.emplace_back(at(list.origin, k), at(list.slot, k));
        }
        std::sort(touching.begin(), touching.end());
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const int from = (i - chunk.begin) * leaves;
            for (std::uint32_t rest = masks[i - chunk.begin]; rest != 0; rest &= rest - 1)
                origins.push_back(from + __builtin_ctz(rest)), gaps.push_back(0);
            const Row place = (at(bed.position, i) - bed.motion.displacement) * row(1, 1, 1, 0);
            const real radius = at(bed.position, i)[3];
            const int outside = solids.near(place, radius + list.skin, [&](int leaf, real distance) {
                origins.push_back(from + leaf), gaps.push_back(distance * (1 - 1e-12) - radius);
            });
            if (outside >= 0) chunk.stop_reason = {Status::escaped, i, outside, 0};
        }
        const int count = static_cast<int>(origins.size());
        list.resize(count);
        auto old = touching.begin();
        for (int k = 0; k < count; ++k) {
            const int origin = at(origins, k), own = origin / leaves;
            while (old != touching.end() && old->first < origin) ++old;
            const bool has_slot = old != touching.end() && old->first == origin;
            list.set_candidate(k, chunk.begin + own, solids.wall_of(origin - own * leaves), origin,
                               has_slot ? old->second : none);
            if (has_slot) old->second = none;
        }
        list.pad(chunk.begin, 0);
        for (const auto& [origin, slot] : touching)
            if (slot != none) keep_contact(bed, chunk, origin, slot);
        find_surfaces(list, *bed.cavity);
        if (!list.gap.empty()) list.gap.assign(gaps.begin(), gaps.end());
    }

    // Gives the history of a contact whose leaf is not listed any more to the leaf that has taken its place:
    // a plane, or the nearest of the triangles in it.
    static void keep_contact(const Bed& bed, Chunk& chunk, int origin, int slot) {
        const Solids& solids = bed.cavity->solids;
        const int leaves = solids.leaves(), from = origin / leaves * leaves;
        const Row place = at(bed.position, chunk.begin + origin / leaves) - bed.motion.displacement;
        ContactList& list = chunk.walls;
        const auto begin = std::ranges::lower_bound(list.origin, from) - list.origin.begin();
        int to = none;
        real least = infinity;
        for (int k = static_cast<int>(begin); k < list.size() && at(list.origin, k) < from + leaves; ++k) {
            const int leaf = at(list.origin, k) - from;
            if (at(list.slot, k) != none || !solids.is_in_place_of(origin - from, leaf)) continue;
            const real apart = leaf < solids.first_plane()
                                   ? solids.distance(solids.nearest_on(leaf, place * row(1, 1, 1, 0)))
                                   : 0;
            if (apart < least) least = apart, to = k;
        }
        if (to != none) at(list.slot, to) = slot;
    }
};

} // namespace rattlebox::dem
