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
#include <span>

#include "dem/bed.hpp"
#include "dem/walls.hpp"

namespace rattlebox::dem {

class Neighbours {
    static constexpr int none = -1;

    ContactList old_pairs_, old_walls_;
    std::vector<int> order_, place_, cell_, cell_start_;
    std::vector<std::vector<int>> found_first_, found_second_; // of each chunk
    std::vector<int> near_first_, chunk_near_;
    std::vector<int> kept_; // neighbours that are candidates, from chunk_near_ on, tier by tier
    std::vector<char> kept_tier_;
    std::vector<int> near_place_; // contact of each neighbour before a scan, or none
    std::vector<std::uint32_t> wall_keep_;
    std::vector<int> wall_place_;
    std::vector<Row> moved_;
    std::vector<int> moved_numbers_;
    std::vector<char> moved_marks_;
    real largest_ = 0, low_[3] = {}, size_ = 0;
    int cells_[3] = {};

    static int swapped(int k) { return -2 - k; }

    // Those of a chunk that touched in the last step.
    static std::span<const int> range_of(const ContactList& list, int chunk) {
        return {list.active.data() + list.begin(chunk, 0), static_cast<std::size_t>(at(list.actives, chunk))};
    }

    template <class T>
    static void permute(std::vector<T>& values, std::vector<T>& spare, const std::vector<int>& order) {
        spare.resize(values.size());
        for (std::size_t i = 0; i < order.size(); ++i) spare[i] = at(values, order[i]);
        std::copy(values.begin() + static_cast<std::ptrdiff_t>(order.size()), values.end(),
                  spare.begin() + static_cast<std::ptrdiff_t>(order.size()));
        values.swap(spare);
    }

    int cell_along(real x, int axis) const {
        const int c = static_cast<int>((x - low_[axis]) / size_);
        return std::clamp(c, 0, cells_[axis] - 1);
    }

    void lay_cells(const Bed& bed) {
        real high[3];
        for (int a = 0; a < 3; ++a) low_[a] = infinity, high[a] = -infinity;
        for (int i = 0; i < bed.particles(); ++i)
            for (int a = 0; a < 3; ++a) {
                low_[a] = std::fmin(low_[a], at(bed.position, i)[a]);
                high[a] = std::fmax(high[a], at(bed.position, i)[a]);
            }
        size_ = (2 * largest_ + bed.reach) * (1 + 1e-12);
        for (;;
             size_ *= 1.25) { // few particles in a large cavity need no more cells than there are particles
            real total = 1;
            for (int a = 0; a < 3; ++a) total *= std::floor((high[a] - low_[a]) / size_) + 1;
            if (total <= 8.0 * bed.particles() + 64) break;
        }
        for (int a = 0; a < 3; ++a) cells_[a] = static_cast<int>((high[a] - low_[a]) / size_) + 1;
    }

public:
    void start(const Bed& bed) {
        largest_ = 0;
        for (int i = 0; i < bed.particles(); ++i) largest_ = std::fmax(largest_, at(bed.position, i)[3]);
        old_pairs_.rolls = bed.pairs.rolls, old_pairs_.dents = bed.pairs.dents;
        old_walls_.rolls = bed.walls.rolls, old_walls_.dents = bed.walls.dents;
        const auto chunks = static_cast<std::size_t>(bed.chunks());
        found_first_.resize(chunks), found_second_.resize(chunks);
        wall_place_.assign(static_cast<std::size_t>(bed.particles()) * bed.cavity->walls.size(), none);
        wall_keep_.assign(static_cast<std::size_t>(bed.particles()), 0);
    }

    std::size_t memory() const {
        std::size_t bytes = old_pairs_.memory() + old_walls_.memory() + moved_.capacity() * sizeof(Row);
        for (const auto* v : {&order_, &place_, &cell_, &cell_start_, &near_first_, &chunk_near_, &kept_,
                              &near_place_, &wall_place_, &moved_numbers_})
            bytes += v->capacity() * sizeof(int);
        for (const auto* lists : {&found_first_, &found_second_})
            for (const auto& v : *lists) bytes += v.capacity() * sizeof(int);
        return bytes + kept_tier_.capacity() + wall_keep_.capacity() * sizeof(std::uint32_t);
    }

    template <class Archive> void keep(Archive& a) {
        a(near_first_, chunk_near_, near_place_, wall_place_);
        if (a.reads) kept_.resize(near_first_.size()), kept_tier_.resize(near_first_.size());
    }

    // ---- a build: sort, search each chunk, join

    void sort(Bed& bed) {
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
        for (auto* rows : {&bed.position, &bed.velocity, &bed.acceleration, &bed.spin, &bed.spin_rate})
            permute(*rows, moved_, order_);
        permute(bed.touched, moved_marks_, order_);
        permute(bed.name, moved_numbers_, order_);
        permute(bed.kind, moved_numbers_, order_);
        bed.since_build = 0;
    }

    void search(const Bed& bed, int chunk) {
        auto& first = at(found_first_, chunk);
        auto& second = at(found_second_, chunk);
        first.clear(), second.clear();
        const int n = bed.particles();
        for (int i = bed.begin(chunk); i < bed.end(chunk); ++i) {
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
                        if (room[l] > 0) first.push_back(i), second.push_back(j + l);
                }
            };
            range(cy, cz, true);
            range(cy + 1, cz, false);
            for (int y = cy - 1; y <= cy + 1; ++y) range(y, cz + 1, false);
        }
    }

    void join(Bed& bed) {
        const int chunks = bed.chunks();
        chunk_near_.assign(static_cast<std::size_t>(chunks) + 1, 0);
        for (int k = 0; k < chunks; ++k)
            at(chunk_near_, k + 1) = at(chunk_near_, k) + static_cast<int>(at(found_first_, k).size());
        const auto total = static_cast<std::size_t>(chunk_near_.back());
        near_first_.resize(total + lane_count), bed.near_second.resize(total + lane_count);
        near_place_.assign(total, none);
        kept_.resize(total + lane_count), kept_tier_.resize(total + lane_count);
        for (int k = 0; k < chunks; ++k) {
            std::copy(at(found_first_, k).begin(), at(found_first_, k).end(),
                      near_first_.begin() + at(chunk_near_, k));
            std::copy(at(found_second_, k).begin(), at(found_second_, k).end(),
                      bed.near_second.begin() + at(chunk_near_, k));
        }
        bed.near_start.assign(static_cast<std::size_t>(bed.particles()) + 1, 0);
        for (std::size_t p = 0; p < total; ++p) ++at(bed.near_start, near_first_[p] + 1);
        for (int i = 0; i < bed.particles(); ++i) at(bed.near_start, i + 1) += at(bed.near_start, i);
        // Contacts of before the sort find their new places.
        for (int k = 0; k < bed.pairs.size(); ++k) {
            if (!at(bed.pairs.touching, k)) continue;
            int i = at(place_, at(bed.pairs.first, k)), j = at(place_, at(bed.pairs.second, k));
            const bool turned = i > j;
            if (turned) std::swap(i, j);
            for (int p = at(bed.near_start, i); p < at(bed.near_start, i + 1); ++p)
                if (at(bed.near_second, p) == j) at(near_place_, p) = turned ? swapped(k) : k;
        }
        std::fill(wall_place_.begin(), wall_place_.end(), none);
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (int k = 0; k < bed.walls.size(); ++k)
            if (at(bed.walls.touching, k))
                at(wall_place_, at(place_, at(bed.walls.first, k)) * walls + at(bed.walls.second, k)) = k;
    }

    // ---- a scan: count in each chunk, lay out, fill each chunk

    // Contacts of the chunk leave word of themselves with their neighbours; not needed right after a build.
    void mark(const Bed& bed, int chunk) {
        for (const int p : range_of(bed.pairs, chunk)) at(near_place_, at(bed.pairs.origin, p)) = p;
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (const int k : range_of(bed.walls, chunk))
            at(wall_place_, at(bed.walls.first, k) * walls + at(bed.walls.second, k)) = k;
    }

    void count(const Bed& bed, int chunk, int* tiers, int& walls, Stopped& stopped) {
        const int from = at(chunk_near_, chunk), to = at(chunk_near_, chunk + 1);
        int found = from;
        int numbers[ContactList::tiers + 1] = {};
        for (int p = from; p < to; p += lane_count) {
            const auto a = columns(
                [&](int l) { return &at(bed.position, near_first_[static_cast<std::size_t>(p + l)]); });
            const auto b = columns(
                [&](int l) { return &at(bed.position, bed.near_second[static_cast<std::size_t>(p + l)]); });
            const auto apart = a.vector() - b.vector();
            const Lanes near = a.w + b.w, distance = dot(apart, apart);
            Lanes tier = Lanes::all(0);
            for (int t = 1; t <= ContactList::tiers; ++t) {
                const Lanes limit = near + Lanes::all(bed.skin * t / ContactList::tiers);
                tier += choose(limit * limit - distance, Lanes::all(0), Lanes::all(1));
            }
            alignas(64) real number[lane_count];
            lanes(number) = tier;
            for (int l = 0; l < std::min(lane_count, to - p); ++l) {
                const int t = static_cast<int>(number[l]);
                kept_[static_cast<std::size_t>(found)] = p + l;
                kept_tier_[static_cast<std::size_t>(found)] = static_cast<char>(t);
                found += t < ContactList::tiers;
                ++numbers[t];
            }
        }
        std::copy(numbers, numbers + ContactList::tiers, tiers);
        walls = 0;
        const auto& all_walls = bed.cavity->walls;
        const Row c = bed.motion.displacement;
        for (int i = bed.begin(chunk); i < bed.end(chunk); i += lane_count) {
            const int last = bed.particles() - 1;
            const auto a = columns([&](int l) { return &at(bed.position, std::min(i + l, last)); });
            const Vector<Lanes> place = {a.x - Lanes::all(c[0]), a.y - Lanes::all(c[1]),
                                         a.z - Lanes::all(c[2])};
            const int used = std::min(lane_count, bed.end(chunk) - i);
            std::uint32_t mask[lane_count] = {};
            for (std::size_t w = 0; w < all_walls.size(); ++w) {
                alignas(64) real room[lane_count];
                lanes(room) = Lanes::all(bed.skin) + a.w - distance(all_walls[w], place);
                for (int l = 0; l < lane_count; ++l) mask[l] |= static_cast<std::uint32_t>(room[l] > 0) << w;
                if (largest(lanes(room) - a.w) > bed.skin) [[unlikely]] // a centre is outside
                    for (int l = 0; l < used; ++l)
                        if (room[l] - at(bed.position, i + l)[3] > bed.skin)
                            stopped = {Status::escaped, i + l, static_cast<int>(w), 0};
            }
            for (int l = 0; l < used; ++l) {
                at(wall_keep_, i + l) = mask[l];
                walls += __builtin_popcount(mask[l]);
            }
        }
    }

    // Makes room for new lists; `tiers` holds how many pairs of each tier each chunk has.
    void lay_out(Bed& bed, const std::vector<int>& tiers, const std::vector<int>& walls) {
        std::swap(bed.pairs, old_pairs_);
        std::swap(bed.walls, old_walls_);
        bed.pairs.lay_out(tiers, ContactList::tiers);
        bed.walls.lay_out(walls, 1);
        bed.since_scan = 0;
    }

    void fill(Bed& bed, int chunk) {
        int next[ContactList::tiers];
        for (int t = 0; t < ContactList::tiers; ++t) next[t] = bed.pairs.begin(chunk, t);
        const int pairs = bed.pairs.end(chunk) - bed.pairs.begin(chunk, 0);
        for (int n = at(chunk_near_, chunk); n < at(chunk_near_, chunk) + pairs; ++n) {
            const int p = at(kept_, n), k = next[static_cast<int>(at(kept_tier_, n))]++;
            at(bed.pairs.first, k) = at(near_first_, p);
            at(bed.pairs.second, k) = at(bed.near_second, p);
            at(bed.pairs.origin, k) = p;
            bed.pairs.forget(k);
            const int before = at(near_place_, p);
            if (before == none) continue;
            at(near_place_, p) = none;
            bed.pairs.remember(k, old_pairs_, before < none ? swapped(before) : before,
                               before < none ? -1 : 1);
        }
        int k = bed.walls.begin(chunk, 0);
        const int walls = static_cast<int>(bed.cavity->walls.size());
        for (int i = bed.begin(chunk); i < bed.end(chunk); ++i)
            for (std::uint32_t mask = at(wall_keep_, i); mask != 0; mask &= mask - 1, ++k) {
                const int w = __builtin_ctz(mask);
                at(bed.walls.first, k) = i;
                at(bed.walls.second, k) = w;
                bed.walls.forget(k);
                int& before = at(wall_place_, i * walls + w);
                if (before == none) continue;
                bed.walls.remember(k, old_walls_, before, 1);
                before = none;
            }
    }
};

} // namespace rattlebox::dem
