// Neighbour lists on two ranges: cells, neighbours within reach (rebuilt rarely), and of these the candidates
// within a Verlet skin, which every step tests.
//
// A pair farther apart than `reach` at the last rebuild cannot touch before it has come nearer by that much,
// and likewise for the candidates of a chunk and their `skin`. Both bounds are kept chunk by chunk: each step
// adds how far the chunk's fastest particle has moved and the fastest of the chunks where it has neighbours.
// Motions are counted relative to the mean one, which brings no two particles nearer to each other. Particles
// are sorted by cell at each rebuild, so that neighbours are near in memory, and a row of three cells is one
// range. Measured on one core as time with one range over time with two: 1.10 with 1000 particles
// shaken, 1.00 at rest, 1.01 and 1.01 with 100 000.
#pragma once

#include <cstdint>

#include "dem/bed.hpp"
#include "dem/cell_list.hpp"
#include "dem/walls.hpp"
#include "math/masks.hpp"

namespace rattlebox::dem {

class NeighbourList {
    static constexpr int none = ContactList::none;

    // A contact on its way from the order before a sort to that after it; and of a chunk, such contacts,
    // their memories, and where its particles are.
    struct MovedContact {
        int first, second, wall, slot;
    };
    struct OutgoingContacts {
        std::vector<MovedContact> moving;
        ContactHistory pairs, walls;
        Row low = row(infinity, infinity, infinity), high = -low;
    };

    // Where the lists of a bed are sorted, one at a time.
    std::vector<Row> rows_;
    std::vector<int> numbers_;
    std::vector<char> flags_;

    CellList cells_;
    std::vector<real> along_[4];             // places and radii once more, axis by axis: searched in lanes
    std::vector<OutgoingContacts> outgoing_; // by chunk before the sort

    // For some steps, if they go on as since the last scan.
    static void choose_skin(ContactList& list, real smallest, real largest) {
        constexpr real steps = 9; // a scan costs as much as some steps: measured, and flat about this number
        if (list.age > 0 && list.since < infinity) list.rate = list.since / static_cast<real>(list.age);
        list.skin = list.rate > 0 ? std::clamp(list.rate * steps, 2e-3 * smallest, largest) : 0.1 * largest;
        list.since = 0, list.age = 0;
    }

public:
    void start(Bed& bed) {
        cells_.start(bed);
        outgoing_.resize(bed.chunks.size());
        const auto n = static_cast<std::size_t>(bed.particles());
        rows_.resize(n), numbers_.resize(n), flags_.resize(n);
        for (auto& values : along_) values.resize(n + lane_count);
    }

    std::size_t memory() const {
        std::size_t bytes =
            rows_.capacity() * sizeof(Row) + numbers_.capacity() * sizeof(int) + flags_.capacity();
        for (const auto& values : along_) bytes += values.capacity() * sizeof(real);
        return bytes + cells_.memory();
    }

    // ---- a build: contacts leave their chunks, particles are sorted, each chunk is searched, contacts
    // arrive

    void collect_contacts(const Bed& bed, Chunk& chunk) {
        OutgoingContacts& outgoing = at(outgoing_, chunk.begin / Bed::chunk_size);
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Row& p = at(bed.position, i);
            outgoing.low = p < outgoing.low ? p : outgoing.low;
            outgoing.high = p > outgoing.high ? p : outgoing.high;
        }
        outgoing.moving.reserve(
            static_cast<std::size_t>(chunk.pairs.touching_count + chunk.walls.touching_count));
        for (const ContactList* list : {&chunk.pairs, &chunk.walls})
            for (int a = 0; a < list->touching_count; ++a) {
                const int k = at(list->touching, a), i = at(list->first, k), j = at(list->second, k);
                const bool at_wall = list == &chunk.walls;
                outgoing.moving.push_back({i, at_wall ? none : j, at_wall ? j : none, at(list->slot, k)});
            }
        chunk.pairs.leave(outgoing.pairs), chunk.walls.leave(outgoing.walls);
    }

    void lay_cells(const Bed& bed) {
        Row low = row(infinity, infinity, infinity), high = -low;
        for (const OutgoingContacts& from : outgoing_) {
            low = from.low < low ? from.low : low;
            high = from.high > high ? from.high : high;
        }
        cells_.lay(bed, low, high);
    }

    void find_cells(const Bed& bed, const Chunk& chunk) { cells_.find(bed, chunk); }
    void find_order(const Bed& bed) { cells_.find_order(bed); }

    static constexpr int turns = 6;

    // The particles that come to lie from `first` to `until`: in each turn one of their rows is laid in
    // order, all wait for each other, and it is put in its place.
    void sort(Bed& bed, int turn, int first, int until) {
        const auto lay = [&](auto& list, auto&& from) {
            for (int i = first; i < until; ++i) at(list, i) = from(cells_.order(i));
        };
        const auto put = [&](Row Rates::* part) {
            for (int i = first; i < until; ++i) at(bed.rates, i).*part = at(rows_, i);
        };
        if (turn == 0) {
            lay(rows_, [&](int i) { return at(bed.position, i); });
            lay(numbers_, [&](int i) { return at(bed.name, i); });
            lay(flags_, [&](int i) { return at(bed.touched, i); });
        } else if (turn == 1) {
            lay(rows_, [&](int i) { return at(bed.velocity, i); });
            lay(numbers_, [&](int i) { return at(bed.kind, i); });
            for (int i = first; i < until; ++i)
                for (int a = 0; a < 4; ++a) at(along_[a], i) = at(bed.position, i)[a];
        } else if (turn == 2) {
            lay(rows_, [&](int i) { return at(bed.spin, i); });
        } else if (turn == 3) {
            lay(rows_, [&](int i) { return at(bed.rates, i).velocity; });
        } else if (turn == 4) {
            put(&Rates::velocity);
            lay(rows_, [&](int i) { return at(bed.rates, i).spin; });
        } else {
            put(&Rates::spin);
        }
    }

    void exchange(Bed& bed, int turn) {
        if (turn == 0) bed.position.swap(rows_), bed.name.swap(numbers_), bed.touched.swap(flags_);
        if (turn == 1) bed.velocity.swap(rows_), bed.kind.swap(numbers_);
        if (turn == 2) bed.spin.swap(rows_);
    }

    void search(const Bed& bed, Chunk& chunk) const {
        thread_local std::vector<int> firsts, seconds;
        int count = 0, *first = firsts.data(), *second = seconds.data();
        const auto make_room = [&] {
            const auto room = static_cast<std::size_t>(count + lane_count);
            if (room <= firsts.size()) return;
            firsts.resize(2 * room), seconds.resize(2 * room);
            first = firsts.data(), second = seconds.data();
        };
        const auto& levels = cells_.levels();
        const CellLevel& fine = levels.front();
        const Group fits = Group::all(fine.largest);
        const bool mixed = levels.size() > 1;
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Row& p = at(bed.position, i);
            const real reach = p[3] + bed.reach;
            const Vector<Group> place = {Group::all(p[0]), Group::all(p[1]), Group::all(p[2])};
            const Group around = Group::all(reach);
            const auto look = [&](int from, int to) {
                for (int j = from; j < to; j += group) {
                    make_room();
                    const auto others = [&](int a) { return unaligned(&at(along_[a], j)); };
                    const Vector<Group> apart = place - Vector<Group>{others(0), others(1), others(2)};
                    const Group near = around + others(3);
                    unsigned found = positive(near * near - dot(apart, apart));
                    if (mixed) found &= ~positive(others(3) - fits); // they come below
                    for (int l = 0; l < lane_count; ++l) first[count + l] = i - chunk.begin;
                    count += list_lanes(found & first_lanes(std::min(group, to - j)), j, second + count);
                }
            };
            const Cell own = cells_.cell(fine, p);
            const CellBox box = p[3] <= fine.largest ? cells_.next_to(fine, own)
                                                     : cells_.around(fine, p, reach + fine.largest);
            for (int z = own[2]; z <= box.high[2]; ++z)
                for (int y = z == own[2] ? own[1] : box.low[1]; y <= box.high[1]; ++y) {
                    const int line = fine.line(y, z);
                    const bool has_own = z == own[2] && y == own[1];
                    look(has_own ? i + 1 : at(fine.begin, line + box.low[0]),
                         at(fine.begin, line + box.high[0] + 1));
                }
            for (std::size_t k = 1; k < levels.size(); ++k) {
                const CellLevel& level = levels[k];
                const CellBox there = cells_.around(level, p, reach + level.largest);
                for (int z = there.low[2]; z <= there.high[2]; ++z)
                    for (int y = there.low[1]; y <= there.high[1]; ++y) {
                        const int line = level.line(y, z), to = at(level.begin, line + there.high[0] + 1);
                        for (int m = at(level.begin, line + there.low[0]); m < to; ++m) {
                            const int j = at(level.member, m);
                            const Row apart = p - at(bed.position, j);
                            if (j <= i || !(square(reach + at(bed.position, j)[3]) > dot(apart, apart)))
                                continue;
                            make_room();
                            first[count] = i - chunk.begin, second[count] = j;
                            ++count;
                        }
                    }
            }
        }
        chunk.near_first.resize(static_cast<std::size_t>(count));
        std::transform(first, first + count, chunk.near_first.begin(),
                       [](int own) { return static_cast<std::uint8_t>(own); });
        chunk.near_second.assign(second, second + count);
        chunk.highest = chunk.end - 1;
        for (const int j : chunk.near_second) chunk.highest = std::max(chunk.highest, j);
    }

    // Contacts arrive where their first partner is now, if that is from `first` to `until`.
    void distribute_contacts(Bed& bed, int first, int until) const {
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (const OutgoingContacts& from : outgoing_)
            for (const MovedContact& m : from.moving) {
                int i = cells_.place(m.first), j = m.wall == none ? cells_.place(m.second) : i;
                const bool turned = i > j;
                if (turned) std::swap(i, j);
                if (i < first || i >= until) continue;
                Chunk& chunk = at(bed.chunks, i / Bed::chunk_size);
                const auto own = static_cast<std::uint8_t>(i - chunk.begin);
                if (m.wall != none) {
                    chunk.walls.arrive(i, m.wall, own * walls + m.wall,
                                       chunk.walls.memory.begin(from.walls, m.slot, 1));
                    continue;
                }
                const auto& firsts = chunk.near_first;
                auto p = static_cast<int>(std::ranges::lower_bound(firsts, own) - firsts.begin());
                const auto is_own = [&] {
                    return p < static_cast<int>(firsts.size()) && at(firsts, p) == own;
                };
                while (is_own() && at(chunk.near_second, p) != j) ++p;
                if (!is_own()) continue; // parted within a step by more than neighbours may be apart
                chunk.pairs.arrive(i, j, p, chunk.pairs.memory.begin(from.pairs, m.slot, turned ? -1 : 1));
            }
    }

    void clear_outgoing(const Chunk& chunk) {
        at(outgoing_, chunk.begin / Bed::chunk_size) = OutgoingContacts();
    }

    // ---- a scan of a chunk: candidates among the neighbours, and walls

    // Memory of those that touch, by origin.
    static const std::vector<int>& slots(const ContactList& list, int origins) {
        thread_local std::vector<int> slots;
        slots.assign(static_cast<std::size_t>(origins), none);
        for (int a = 0; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            at(slots, at(list.origin, k)) = at(list.slot, k);
        }
        return slots;
    }

    void scan_pairs(const Bed& bed, Chunk& chunk) const {
        choose_skin(chunk.pairs, bed.smallest, 0.4 * bed.reach);
        const real skin = chunk.pairs.skin;
        thread_local std::vector<int> found_pairs;
        const int count = static_cast<int>(chunk.near_second.size());
        found_pairs.resize(static_cast<std::size_t>(count) + lane_count);
        int* const found_pair = found_pairs.data();
        int found = 0;
        for (int p = 0; p < count; p += group) {
            const auto apart = columns_of([&](int l) __attribute__((always_inline)) {
                const int q = std::min(p + l, count - 1);
                const Row a = at(bed.position, chunk.begin + at(chunk.near_first, q));
                return at(bed.position, at(chunk.near_second, q)) + row(-1, -1, -1, 1) * a;
            });
            const Group limit = apart.w + Group::all(skin);
            const unsigned within = positive(limit * limit - dot(apart.vector(), apart.vector()));
            found += list_lanes(within & first_lanes(std::min(group, count - p)), p, found_pair + found);
        }
        ContactList& pairs = chunk.pairs;
        const std::vector<int>& slot = slots(pairs, count);
        pairs.resize(found);
        for (int k = 0; k < found; ++k) {
            const int p = found_pair[k];
            pairs.put(k, chunk.begin + at(chunk.near_first, p), at(chunk.near_second, p), p, at(slot, p));
        }
        pairs.pad(chunk.begin, chunk.begin);
    }

    void scan_walls(const Bed& bed, Chunk& chunk) const {
        choose_skin(chunk.walls, bed.smallest, 0.5 * bed.smallest);
        const real skin = chunk.walls.skin;
        const auto& all_walls = bed.cavity->walls;
        const int walls = static_cast<int>(all_walls.size()), last = bed.particles() - 1;
        const Row c = bed.motion.displacement;
        thread_local std::vector<std::uint32_t> masks;
        masks.assign(static_cast<std::size_t>(chunk.end - chunk.begin) + group, 0);
        int count = 0;
        for (int i = chunk.begin; i < chunk.end; i += group) {
            const auto a = columns([&](int l) { return &at(bed.position, std::min(i + l, last)); });
            const Vector<Group> place = {a.x - Group::all(c[0]), a.y - Group::all(c[1]),
                                         a.z - Group::all(c[2])};
            const int used = std::min(group, chunk.end - i);
            std::uint32_t* mask = &at(masks, i - chunk.begin);
            for (int w = 0; w < walls; ++w) {
                const Group far = distance(at(all_walls, w), place);
                each_lane(positive(Group::all(skin) + a.w - far), [&](int l) { mask[l] |= 1u << w; });
                each_lane(positive(Group::all(0) - far) & first_lanes(used), // a centre is outside
                          [&](int l) { chunk.stopped = {Status::escaped, i + l, w, 0}; });
            }
            for (int l = 0; l < used; ++l) count += __builtin_popcount(mask[l]);
        }
        ContactList& list = chunk.walls;
        const std::vector<int>& slot = slots(list, (chunk.end - chunk.begin) * walls);
        list.resize(count);
        for (int i = chunk.begin, k = 0; i < chunk.end; ++i)
            for (std::uint32_t rest = at(masks, i - chunk.begin); rest != 0; rest &= rest - 1, ++k) {
                const int w = __builtin_ctz(rest), own = i - chunk.begin, origin = own * walls + w;
                list.put(k, i, w, origin, at(slot, origin));
            }
        list.pad(chunk.begin, 0);
    }
};

} // namespace rattlebox::dem
