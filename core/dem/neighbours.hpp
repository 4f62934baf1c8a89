// Who may touch whom soon: cells, neighbours within reach, and of these the candidates that every step looks
// at.
//
// A pair farther apart than `reach` at the last build cannot touch before both have moved by reach / 2, and
// likewise for the candidates and `skin`: both bounds are kept by adding up the largest speed of each step.
// Candidates lie in tiers by how far apart they were at the scan, and a step looks at the tiers that may have
// closed by then. Particles are sorted by cell at each build, so that neighbours are near in memory too, and
// a row of three cells is one range.
#pragma once

#include <cstdint>

#include "dem/bed.hpp"
#include "dem/walls.hpp"

namespace rattlebox::dem {

class Neighbours {
    static constexpr int none = Contacts::none;

    // A contact on its way from the order before a sort to that after it.
    struct Moving {
        int first, second, wall;
        Carried memory;
    };

    std::vector<int> order_, place_, cell_, cell_start_;
    std::vector<std::vector<Moving>> moving_; // by chunk before the sort
    real largest_ = 0, low_[3] = {}, size_ = 0;
    int cells_[3] = {};

    int cell_along(real x, int axis) const {
        const int c = static_cast<int>((x - low_[axis]) / size_);
        return std::clamp(c, 0, cells_[axis] - 1);
    }

    void lay_cells(const Bed& bed) {
        real high[3];
        for (int a = 0; a < 3; ++a) low_[a] = infinity, high[a] = -infinity;
        for (const Row& p : bed.position)
            for (int a = 0; a < 3; ++a) {
                low_[a] = smaller(low_[a], p[a]);
                high[a] = larger(high[a], p[a]);
            }
        size_ = (2 * largest_ + bed.reach) * (1 + 1e-12);
        for (;;
             size_ *= 1.25) { // few particles in a large cavity need no more cells than there are particles
            real total = 1;
            for (int a = 0; a < 3; ++a) total *= std::floor((high[a] - low_[a]) / size_) + 1;
            if (total <= 4.0 * bed.particles() + 64) break;
        }
        for (int a = 0; a < 3; ++a) cells_[a] = static_cast<int>((high[a] - low_[a]) / size_) + 1;
    }

public:
    void start(const Bed& bed) {
        largest_ = 0;
        moving_.resize(bed.chunks.size());
        for (const Row& p : bed.position) largest_ = larger(largest_, p[3]);
    }

    std::size_t memory() const {
        std::size_t bytes = 0;
        for (const auto* v : {&order_, &place_, &cell_, &cell_start_}) bytes += v->capacity() * sizeof(int);
        for (const auto& m : moving_) bytes += m.capacity() * sizeof(Moving);
        return bytes;
    }

    // ---- a build: contacts leave their chunks, particles are sorted, each chunk is searched, contacts
    // arrive

    void pack_up(const Bed& bed, Chunk& chunk) {
        std::vector<Moving>& moving = at(moving_, chunk.begin / Bed::chunk_size);
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (std::size_t p = 0; p < chunk.near_slot.size(); ++p)
            if (chunk.near_slot[p] != none)
                moving.push_back({chunk.near_first[p], chunk.near_second[p], none,
                                  chunk.pairs.carried(chunk.near_slot[p])});
        for (int p = 0; p < static_cast<int>(chunk.wall_slot.size()); ++p)
            if (at(chunk.wall_slot, p) != none)
                moving.push_back(
                    {chunk.begin + p / walls, none, p % walls, chunk.walls.carried(at(chunk.wall_slot, p))});
        chunk.pairs.forget_all(), chunk.walls.forget_all();
    }

    // The order of the particles by cell.
    void find_order(const Bed& bed) {
        lay_cells(bed);
        const int n = bed.particles();
        cell_.resize(static_cast<std::size_t>(n)), order_.resize(cell_.size()), place_.resize(cell_.size());
        cell_start_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2] + 1), 0);
        for (int i = 0; i < n; ++i) {
            const Row& p = at(bed.position, i);
            at(cell_, i) =
                (cell_along(p[2], 2) * cells_[1] + cell_along(p[1], 1)) * cells_[0] + cell_along(p[0], 0);
            ++at(cell_start_, at(cell_, i) + 1);
        }
        for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
        for (int i = 0; i < n; ++i) at(place_, i) = at(cell_start_, at(cell_, i))++;
        for (std::size_t c = cell_start_.size() - 1; c > 0; --c) cell_start_[c] = cell_start_[c - 1];
        cell_start_[0] = 0;
        for (int i = 0; i < n; ++i) at(order_, at(place_, i)) = i;
    }

    // Each array is one job.
    template <class Team> void sort(Bed& bed, const Team& team) const {
        int job = 0;
        const auto permute = [&]<class T>(std::vector<T>& values) {
            if (job++ % team.size() != team.rank()) return;
            std::vector<T> sorted;
            sorted.reserve(values.size());
            for (const int i : order_) sorted.push_back(at(values, i));
            values.swap(sorted);
        };
        for (auto* rows : {&bed.position, &bed.velocity, &bed.acceleration, &bed.spin, &bed.spin_rate})
            permute(*rows);
        permute(bed.touched), permute(bed.name), permute(bed.kind);
    }

    void search(const Bed& bed, Chunk& chunk) const {
        chunk.near_first.clear(), chunk.near_second.clear();
        const int n = bed.particles();
        for (int i = chunk.begin; i < chunk.end; ++i) {
            const Row& p = at(bed.position, i);
            const int cx = cell_along(p[0], 0), cy = cell_along(p[1], 1), cz = cell_along(p[2], 2);
            const auto range = [&](int y, int z, bool own) {
                if (y < 0 || y >= cells_[1] || z >= cells_[2]) return;
                const int line = (z * cells_[1] + y) * cells_[0];
                const int from = own ? i + 1 : at(cell_start_, line + std::max(cx - 1, 0));
                const int to = at(cell_start_, line + std::min(cx + 1, cells_[0] - 1) + 1);
                for (int j = from; j < to; j += lane_count) {
                    const auto q = columns([&](int l) { return &at(bed.position, std::min(j + l, n - 1)); });
                    const Vector<Lanes> apart = {Lanes::all(p[0]) - q.x, Lanes::all(p[1]) - q.y,
                                                 Lanes::all(p[2]) - q.z};
                    const Lanes near = q.w + Lanes::all(p[3] + bed.reach);
                    alignas(64) real room[lane_count];
                    lanes(room) = near * near - dot(apart, apart);
                    for (int l = 0; l < lane_count && j + l < to; ++l)
                        if (room[l] > 0) chunk.near_first.push_back(i), chunk.near_second.push_back(j + l);
                }
            };
            range(cy, cz, true);
            range(cy + 1, cz, false);
            for (int y = cy - 1; y <= cy + 1; ++y) range(y, cz + 1, false);
        }
        chunk.near_slot.assign(chunk.near_first.size(), none);
        chunk.wall_slot.assign(static_cast<std::size_t>(chunk.end - chunk.begin) * bed.cavity->walls.size(),
                               none);
    }

    // Contacts arrive where their first partner is now, if that is from `first` to `until`.
    void unpack(Bed& bed, int first, int until) const {
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (const auto& from_chunk : moving_)
            for (const Moving& m : from_chunk) {
                int i = at(place_, m.first), j = m.wall == none ? at(place_, m.second) : i;
                const bool turned = i > j;
                if (turned) std::swap(i, j);
                if (i < first || i >= until) continue;
                Chunk& chunk = at(bed.chunks, i / Bed::chunk_size);
                if (m.wall != none) {
                    at(chunk.wall_slot, (i - chunk.begin) * walls + m.wall) =
                        chunk.walls.remember(m.memory, 1);
                    continue;
                }
                auto p = std::lower_bound(chunk.near_first.begin(), chunk.near_first.end(), i) -
                         chunk.near_first.begin();
                while (chunk.near_second[static_cast<std::size_t>(p)] != j)
                    ++p; // touching, so among the neighbours
                chunk.near_slot[static_cast<std::size_t>(p)] =
                    chunk.pairs.remember(m.memory, turned ? -1 : 1);
            }
    }

    void forget_moves() {
        for (auto& moving : moving_) std::vector<Moving>().swap(moving);
    }

    // ---- a scan of a chunk: candidates among the neighbours, and walls

    void scan(const Bed& bed, Chunk& chunk) const {
        scan_pairs(bed, chunk);
        scan_walls(bed, chunk);
    }

private:
    void scan_pairs(const Bed& bed, Chunk& chunk) const {
        thread_local std::vector<int> kept;
        thread_local std::vector<char> kept_tier;
        const int count = static_cast<int>(chunk.near_slot.size());
        kept.resize(static_cast<std::size_t>(count) + lane_count);
        kept_tier.resize(kept.size());
        int found = 0, numbers[Contacts::tiers + 1] = {};
        for (int p = 0; p < count; p += lane_count) {
            const auto partner = [&](const std::vector<int>& of) {
                return columns([&](int l) { return &at(bed.position, at(of, std::min(p + l, count - 1))); });
            };
            const auto a = partner(chunk.near_first), b = partner(chunk.near_second);
            const auto apart = a.vector() - b.vector();
            const Lanes near = a.w + b.w, distance = dot(apart, apart);
            Lanes tier = Lanes::all(0);
            for (int t = 1; t <= Contacts::tiers; ++t) {
                const Lanes limit = near + Lanes::all(bed.skin * t / Contacts::tiers);
                tier += choose(limit * limit - distance, Lanes::all(0), Lanes::all(1));
            }
            alignas(64) real number[lane_count];
            lanes(number) = tier;
            for (int l = 0; l < std::min(lane_count, count - p); ++l) {
                const int t = static_cast<int>(number[l]);
                at(kept, found) = p + l;
                at(kept_tier, found) = static_cast<char>(t);
                found += t < Contacts::tiers;
                ++numbers[t];
            }
        }
        Contacts& pairs = chunk.pairs;
        int next[Contacts::tiers], sum = 0;
        for (int t = 0; t < Contacts::tiers; ++t) {
            next[t] = sum;
            pairs.tier_end[t] = sum += numbers[t];
        }
        pairs.resize(sum);
        chunk.highest = -1;
        for (int n = 0; n < found; ++n) {
            const int p = at(kept, n), k = next[static_cast<int>(at(kept_tier, n))]++;
            at(pairs.first, k) = at(chunk.near_first, p);
            at(pairs.second, k) = at(chunk.near_second, p);
            at(pairs.origin, k) = p;
            at(pairs.slot, k) = at(chunk.near_slot, p);
            chunk.highest = std::max(chunk.highest, at(pairs.second, k));
        }
        pairs.pad(chunk.begin, chunk.begin);
    }

    static void scan_walls(const Bed& bed, Chunk& chunk) {
        const auto& all_walls = bed.cavity->walls;
        const int walls = static_cast<int>(all_walls.size()), last = bed.particles() - 1;
        const Row c = bed.motion.displacement;
        thread_local std::vector<std::uint32_t> masks;
        masks.assign(static_cast<std::size_t>(chunk.end - chunk.begin) + lane_count, 0);
        int count = 0;
        for (int i = chunk.begin; i < chunk.end; i += lane_count) {
            const auto a = columns([&](int l) { return &at(bed.position, std::min(i + l, last)); });
            const Vector<Lanes> place = {a.x - Lanes::all(c[0]), a.y - Lanes::all(c[1]),
                                         a.z - Lanes::all(c[2])};
            const int used = std::min(lane_count, chunk.end - i);
            std::uint32_t* mask = &at(masks, i - chunk.begin);
            for (int w = 0; w < walls; ++w) {
                alignas(64) real room[lane_count];
                lanes(room) = Lanes::all(bed.skin) + a.w - distance(at(all_walls, w), place);
                for (int l = 0; l < lane_count; ++l) mask[l] |= static_cast<std::uint32_t>(room[l] > 0) << w;
                if (largest(lanes(room) - a.w) > bed.skin) [[unlikely]] // a centre is outside
                    for (int l = 0; l < used; ++l)
                        if (room[l] - at(bed.position, i + l)[3] > bed.skin)
                            chunk.stopped = {Status::escaped, i + l, w, 0};
            }
            for (int l = 0; l < used; ++l) count += __builtin_popcount(mask[l]);
        }
        Contacts& list = chunk.walls;
        list.resize(count);
        for (int& end : list.tier_end) end = count;
        for (int i = chunk.begin, k = 0; i < chunk.end; ++i)
            for (std::uint32_t rest = at(masks, i - chunk.begin); rest != 0; rest &= rest - 1, ++k) {
                const int w = __builtin_ctz(rest);
                at(list.first, k) = i;
                at(list.second, k) = w;
                at(list.origin, k) = (i - chunk.begin) * walls + w;
                at(list.slot, k) = at(chunk.wall_slot, at(list.origin, k));
            }
        list.pad(chunk.begin, 0);
    }
};

} // namespace rattlebox::dem
