// Cell lists on several levels: the particles near a place are found without a search through all.
//
// In cells that fit the largest particle a small one has far too many others around it. The finest level
// therefore fits most particles only. It holds all of them, in the order of memory, so that a line of cells
// is one range; larger particles are also on levels of coarser cells, one for each octave of sizes. Measured
// on one core as time with a single level over time with several: 5.7 with 10 000 particles and one 16 times
// as large, 22 with 100 000 and a dozen; 4.2 and 13 in mixtures of five sizes, 1 to 16, of equal volume. With
// one size there is one level.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "dem/bed.hpp"

namespace rattlebox::dem {

// Numbers of a cell along each axis.
using Cell = std::array<int, 3>;

struct CellBox {
    Cell low, high;
};

struct CellLevel {
    real largest = 0;        // radius of those that are looked for in it
    real size = 0;           // of its cells
    Cell cells{};            // along lines of cells, across them in a plane, across planes
    std::vector<int> begin;  // of the members of each cell, cells one behind the other
    std::vector<int> member; // ascending in each cell; of the finest layer, they are all particles themselves

    int count() const { return cells[0] * cells[1] * cells[2]; }
    int line(int y, int z) const { return (z * cells[1] + y) * cells[0]; }

    // Puts each member in its place, cells one behind the other: put(member, place).
    template <class CellOf, class Put> void lay_out(int members, CellOf&& cell_of, Put&& put) {
        begin.assign(static_cast<std::size_t>(count() + 1), 0);
        for (int m = 0; m < members; ++m) ++at(begin, cell_of(m) + 1);
        for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
        for (int m = 0; m < members; ++m) put(m, at(begin, cell_of(m))++);
        for (std::size_t c = begin.size() - 1; c > 0; --c) begin[c] = begin[c - 1];
        begin[0] = 0;
    }
};

class CellList {
    struct SizeOctave {
        real largest = 0; // radius
        int count = 0;
    };

    std::vector<SizeOctave> octaves_; // of sizes, that of the smallest first
    std::vector<CellLevel> levels_;   // the finest first
    std::vector<int> order_, place_, cell_, large_;
    real low_[3] = {};
    // Along lines of cells, across them in a plane, across planes. Short axes come first, so that neighbours
    // in other lines and planes are near in memory too.
    int axis_[3] = {};

    int along(const CellLevel& level, real x, int a) const {
        const int c = static_cast<int>((x - low_[a]) / level.size);
        return std::clamp(c, 0, level.cells[a] - 1);
    }

    int number(const CellLevel& level, const Row& p) const {
        const Cell c = cell(level, p);
        return level.line(c[1], c[2]) + c[0];
    }

    // How many others a search looks at, about, where the finest cells fit those up to some octave.
    real looks(std::size_t finest, int particles, real volume, real reach) const {
        constexpr real per_line = 4; // a line of cells takes as long as so many particles
        const real fits = octaves_[finest].largest, size = 2 * fits + reach;
        real sum = 9 * per_line * particles * static_cast<real>(octaves_.size() - 1 - finest);
        for (const SizeOctave& o : octaves_) {
            const real around = 2 * std::ceil((o.largest + fits + reach) / size) + 1; // cells, along an axis
            const real there = smaller(around * around * around * size * size * size / volume, 1) * particles;
            sum += 0.5 * o.count * (there + per_line * around * around); // half of them come before
        }
        return sum;
    }

    std::size_t find_finest(int particles, real volume, real reach) const {
        std::size_t best = octaves_.size() - 1;
        for (std::size_t k = best; k-- > 0;)
            if (looks(k, particles, volume, reach) < looks(best, particles, volume, reach)) best = k;
        return best;
    }

public:
    void start(const Bed& bed) {
        real largest = 0;
        for (const Row& p : bed.position) largest = larger(largest, p[3]);
        std::vector<SizeOctave> octaves;
        for (const Row& p : bed.position) {
            const auto k = static_cast<std::size_t>(std::log2(largest / p[3]));
            if (k >= octaves.size()) octaves.resize(k + 1);
            octaves[k].largest = larger(octaves[k].largest, p[3]);
            ++octaves[k].count;
        }
        std::erase_if(octaves, [](const SizeOctave& o) { return o.count == 0; });
        octaves_.assign(octaves.rbegin(), octaves.rend());
    }

    std::size_t memory() const {
        std::size_t numbers = 0;
        for (const auto* v : {&order_, &place_, &cell_, &large_}) numbers += v->capacity();
        for (const CellLevel& level : levels_) numbers += level.begin.capacity() + level.member.capacity();
        return numbers * sizeof(int);
    }

    // The first is the finest.
    const std::vector<CellLevel>& levels() const { return levels_; }
    // Which particle lies where from now on, and where each does that did lie there.
    int order(int i) const { return at(order_, i); }
    int place(int i) const { return at(place_, i); }

    void lay(const Bed& bed, const Row& low, const Row& high) {
        const Row span = high - low;
        const auto order = [&](int& inner, int& outer) {
            if (span[inner] > 1.5 * span[outer]) std::swap(inner, outer);
        };
        auto& [line, plane, rest] = axis_;
        line = 0, plane = 1, rest = 2;
        order(line, plane), order(plane, rest), order(line, plane);
        const Row around = span + row(2 * octaves_.back().largest);
        const std::size_t finest = find_finest(bed.particles(), around[0] * around[1] * around[2], bed.reach);
        levels_.resize(octaves_.size() - finest);
        for (std::size_t k = 0; k < levels_.size(); ++k) {
            CellLevel& level = levels_[k];
            const int members = k == 0 ? bed.particles() : octaves_[finest + k].count;
            level.largest = octaves_[finest + k].largest;
            level.size = (2 * level.largest + bed.reach) * (1 + 1e-12);
            for (;; level.size *= 1.25) { // few in a large cavity need no more cells than they are
                real total = 1;
                for (int a = 0; a < 3; ++a) total *= std::floor(span[a] / level.size) + 1;
                if (total <= 4.0 * members + 64) break;
            }
            for (int a = 0; a < 3; ++a) level.cells[a] = static_cast<int>(span[axis_[a]] / level.size) + 1;
        }
        for (int a = 0; a < 3; ++a) low_[a] = low[axis_[a]];
        for (auto* v : {&order_, &place_, &cell_}) v->resize(bed.position.size());
    }

    void find(const Bed& bed, const Chunk& chunk) {
        for (int i = chunk.begin; i < chunk.end; ++i)
            at(cell_, i) = number(levels_.front(), at(bed.position, i));
    }

    // The order of the particles by cell, and the layers of the large ones in it.
    void find_order(const Bed& bed) {
        const int n = bed.particles();
        levels_.front().lay_out(
            n, [&](int i) { return at(cell_, i); }, [&](int i, int place) { at(place_, i) = place; });
        for (int i = 0; i < n; ++i) at(order_, at(place_, i)) = i;
        if (levels_.size() == 1) return;
        large_.clear();
        const auto radius = [&](int place) { return at(bed.position, order(place))[3]; };
        for (int i = 0; i < n; ++i)
            if (radius(i) > levels_.front().largest) large_.push_back(i);
        for (std::size_t k = 1; k < levels_.size(); ++k) {
            CellLevel& level = levels_[k];
            std::vector<int> members;
            std::ranges::copy_if(large_, std::back_inserter(members), [&](int i) {
                return radius(i) > levels_[k - 1].largest && radius(i) <= level.largest;
            });
            level.member.resize(members.size());
            level.lay_out(
                static_cast<int>(members.size()),
                [&](int m) { return number(level, at(bed.position, order(at(members, m)))); },
                [&](int m, int place) { at(level.member, place) = at(members, m); });
        }
    }

    Cell cell(const CellLevel& level, const Row& p) const {
        const auto of = [&](int a) { return along(level, p[axis_[a]], a); };
        return {of(0), of(1), of(2)};
    }

    // A cell and those next to it.
    static CellBox next_to(const CellLevel& level, const Cell& cell) {
        CellBox box;
        for (std::size_t a = 0; a < 3; ++a)
            box.low[a] = std::max(cell[a] - 1, 0), box.high[a] = std::min(cell[a] + 1, level.cells[a] - 1);
        return box;
    }

    // Cells that hold all that is not farther than `far` from a place.
    CellBox around(const CellLevel& level, const Row& p, real far) const {
        return {cell(level, p - row(far)), cell(level, p + row(far))};
    }
};

} // namespace rattlebox::dem
