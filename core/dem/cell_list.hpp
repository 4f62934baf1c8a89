// Cell lists on several levels, for particles of very different sizes.
//
// With cells as large as the largest particle, a small particle would have far too many others in adjacent
// cells. The cells of the finest level therefore fit most particles only. That level holds all particles in
// the order of memory, so that a line of cells is one range of indices. Larger particles are also stored on
// coarser levels, one for each factor of two in size (as in T. Iwai, C.-W. Hong, P. Greil, Int. J. Mod. Phys.
// C 10 (1999) 823). Measured on one core as time with a single level over time with several: 5.7 with 10 000
// particles and one 16 times as large, 22 with 100 000 and a dozen; 4.2 and 13 in mixtures of five sizes, 1
// to 16, of equal volume. With one size there is one level.
//
// B. Quentrec, C. Brot, J. Comput. Phys. 13 (1973) 430, doi:10.1016/0021-9991(73)90046-6 (cell lists); V.
// Ogarko, S. Luding, Comput. Phys. Commun. 183 (2012) 931, doi:10.1016/j.cpc.2011.12.019 (levels).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "dem/bed.hpp"

namespace rattlebox::dem {

// Indices of a cell along the axes.
using Cell = std::array<int, 3>;

struct CellBox {
    Cell low, high;
};

struct CellLevel {
    real largest = 0;       // radius of the particles that a search on this level returns
    real size = 0;          // edge length of a cell
    Cell cells{};           // number of cells along lines, across lines in a plane, across planes
    std::vector<int> begin; // index of the first member of each cell
    std::vector<int>
        member; // ascending in each cell; not used on the finest level, which holds all particles

    int count() const { return cells[0] * cells[1] * cells[2]; }
    int line(int y, int z) const { return (z * cells[1] + y) * cells[0]; }

    // Counting sort of the members by cell; calls put(member, place).
    template <class CellOf, class Put> void counting_sort(int members, CellOf&& cell_of, Put&& put) {
        begin.assign(static_cast<std::size_t>(count() + 1), 0);
        for (int m = 0; m < members; ++m) ++at(begin, cell_of(m) + 1);
        for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
        for (int m = 0; m < members; ++m) put(m, at(begin, cell_of(m))++);
        // Each entry has advanced to the start of the next cell; the shift restores it without a second
        // array.
        for (std::size_t c = begin.size() - 1; c > 0; --c) begin[c] = begin[c - 1];
        begin[0] = 0;
    }
};

class CellList {
    struct SizeClass {
        real largest = 0; // radius
        int count = 0;
    };

    std::vector<SizeClass> size_classes_; // smallest first
    std::vector<CellLevel> levels_;       // finest first
    std::vector<int> old_index_, new_index_, cell_, large_;
    real low_[3] = {}, period_[3] = {}; // along the axes of the cells; the period is 0 if there is none
    // Axes along lines of cells, across lines in a plane, across planes. Short axes come first, so that
    // neighbours in other lines and planes are close in memory.
    int axis_[3] = {};

    int along(const CellLevel& level, real x, int a) const {
        if (period_[a] > 0) x -= period_[a] * std::floor((x - low_[a]) / period_[a]);
        const int c = static_cast<int>((x - low_[a]) / level.size);
        return std::clamp(c, 0, level.cells[a] - 1);
    }

    int number(const CellLevel& level, const Row& p) const {
        const Cell c = cell(level, p);
        return level.line(c[1], c[2]) + c[0];
    }

    // Estimates the number of particles that all searches visit if the finest cells fit size class `finest`.
    real search_cost(std::size_t finest, int particles, real volume, real reach) const {
        constexpr real per_line = 4; // a line of cells costs as much as this many particles
        const real fits = size_classes_[finest].largest, size = 2 * fits + reach;
        real sum = 9 * per_line * particles * static_cast<real>(size_classes_.size() - 1 - finest);
        for (const SizeClass& o : size_classes_) {
            const real around = 2 * std::ceil((o.largest + fits + reach) / size) + 1; // cells along an axis
            const real there = smaller(around * around * around * size * size * size / volume, 1) * particles;
            sum += 0.5 * o.count * (there + per_line * around * around); // each pair once
        }
        return sum;
    }

    std::size_t choose_finest(int particles, real volume, real reach) const {
        std::size_t best = size_classes_.size() - 1;
        for (std::size_t k = best; k-- > 0;)
            if (search_cost(k, particles, volume, reach) < search_cost(best, particles, volume, reach))
                best = k;
        return best;
    }

public:
    void start(const Bed& bed) {
        real largest = 0;
        for (const Row& p : bed.position) largest = larger(largest, p[3]);
        std::vector<SizeClass> classes;
        for (const Row& p : bed.position) {
            // Size classes are octaves of the radius: within one, cells are at most twice as large as needed.
            const auto k = static_cast<std::size_t>(std::log2(largest / p[3]));
            if (k >= classes.size()) classes.resize(k + 1);
            classes[k].largest = larger(classes[k].largest, p[3]);
            ++classes[k].count;
        }
        std::erase_if(classes, [](const SizeClass& o) { return o.count == 0; });
        size_classes_.assign(classes.rbegin(), classes.rend());
    }

    std::size_t memory() const {
        std::size_t numbers = 0;
        for (const auto* v : {&old_index_, &new_index_, &cell_, &large_}) numbers += v->capacity();
        for (const CellLevel& level : levels_) numbers += level.begin.capacity() + level.member.capacity();
        return numbers * sizeof(int);
    }

    // Finest first.
    const std::vector<CellLevel>& levels() const { return levels_; }
    // Maps from the index of a particle after the sort to that before it, and back.
    int old_index(int i) const { return at(old_index_, i); }
    int new_index(int i) const { return at(new_index_, i); }

    void set_up(const Bed& bed, Row low, Row high) {
        for (int a = 0; a < 3; ++a)
            if (const real length = bed.periods.length[a]; length > 0)
                low[a] = -0.5 * length, high[a] = 0.5 * length;
        const Row span = high - low;
        const auto order = [&](int& inner, int& outer) {
            if (span[inner] > 1.5 * span[outer]) std::swap(inner, outer);
        };
        auto& [line, plane, rest] = axis_;
        line = 0, plane = 1, rest = 2;
        // A sorting network of three axes; the factor of 1.5 keeps the order, and with it the bits, when
        // spans fluctuate.
        order(line, plane), order(plane, rest), order(line, plane);
        const Row around = span + row(2 * size_classes_.back().largest);
        const std::size_t finest =
            choose_finest(bed.particles(), around[0] * around[1] * around[2], bed.reach);
        levels_.resize(size_classes_.size() - finest);
        for (std::size_t k = 0; k < levels_.size(); ++k) {
            CellLevel& level = levels_[k];
            const int members = k == 0 ? bed.particles() : size_classes_[finest + k].count;
            level.largest = size_classes_[finest + k].largest;
            // Partners of two particles of the level are then in adjacent cells; the margin covers the
            // rounding of their indices.
            level.size = (2 * level.largest + bed.reach) * (1 + 1e-12);
            for (;;
                 level.size *= 1.25) { // a few particles in a large cavity do not need more cells than this
                real total = 1;
                for (int a = 0; a < 3; ++a) total *= std::floor(span[a] / level.size) + 1;
                if (total <= 4.0 * members + 64) break;
            }
            for (int a = 0; a < 3; ++a) level.cells[a] = static_cast<int>(span[axis_[a]] / level.size) + 1;
        }
        for (int a = 0; a < 3; ++a) low_[a] = low[axis_[a]], period_[a] = bed.periods.length[axis_[a]];
        // The cells of a periodic axis fill the period: the last one is larger than the others.
        for (CellLevel& level : levels_)
            for (int a = 0; a < 3; ++a)
                if (period_[a] > 0) level.cells[a] = std::max(level.cells[a] - 1, 1);
        for (auto* v : {&old_index_, &new_index_, &cell_}) v->resize(bed.position.size());
    }

    void assign_cells(const Bed& bed, const Chunk& chunk) {
        for (int i = chunk.begin; i < chunk.end; ++i)
            at(cell_, i) = number(levels_.front(), at(bed.position, i));
    }

    // Computes the order of the particles by cell, and the coarse levels.
    void sort_by_cell(const Bed& bed) {
        const int n = bed.particles();
        levels_.front().counting_sort(
            n, [&](int i) { return at(cell_, i); }, [&](int i, int place) { at(new_index_, i) = place; });
        for (int i = 0; i < n; ++i) at(old_index_, at(new_index_, i)) = i;
        if (levels_.size() == 1) return;
        // Coarse levels list their members by index after the sort, which the first level defines.
        large_.clear();
        const auto radius = [&](int place) { return at(bed.position, old_index(place))[3]; };
        for (int i = 0; i < n; ++i)
            if (radius(i) > levels_.front().largest) large_.push_back(i);
        for (std::size_t k = 1; k < levels_.size(); ++k) {
            CellLevel& level = levels_[k];
            std::vector<int> members;
            std::ranges::copy_if(large_, std::back_inserter(members), [&](int i) {
                return radius(i) > levels_[k - 1].largest && radius(i) <= level.largest;
            });
            level.member.resize(members.size());
            level.counting_sort(
                static_cast<int>(members.size()),
                [&](int m) { return number(level, at(bed.position, old_index(at(members, m)))); },
                [&](int m, int place) { at(level.member, place) = at(members, m); });
        }
    }

    Cell cell(const CellLevel& level, const Row& p) const {
        const auto of = [&](int a) { return along(level, p[axis_[a]], a); };
        return {of(0), of(1), of(2)};
    }

    // Returns a cell and the adjacent ones.
    static CellBox adjacent_cells(const CellLevel& level, const Cell& cell) {
        CellBox box;
        for (std::size_t a = 0; a < 3; ++a)
            box.low[a] = std::max(cell[a] - 1, 0), box.high[a] = std::min(cell[a] + 1, level.cells[a] - 1);
        return box;
    }

    // Cells that follow each other along an axis; behind the last one comes the first one.
    struct CellRange {
        int first, count;
    };

    // Returns the cells that cover the images of a cube of half width `distance` around a position.
    std::array<CellRange, 3> cells_around(const CellLevel& level, const Row& p, real distance) const {
        std::array<CellRange, 3> ranges;
        for (int a = 0; a < 3; ++a) {
            const int n = level.cells[a];
            const real x = p[axis_[a]], rounding = 1e-9 * (distance + period_[a]);
            const int low = along(level, x - distance - rounding, a),
                      high = along(level, x + distance + rounding, a);
            // A cube that reaches its own image covers all cells; the last one has nearly twice the size.
            const bool is_covered = period_[a] > 0 && 2 * (distance + rounding + level.size) >= period_[a];
            ranges[static_cast<std::size_t>(a)] =
                is_covered ? CellRange{0, n} : CellRange{low, (high - low + n) % n + 1};
        }
        return ranges;
    }

    // Returns the cells that cover a cube of half width `distance` around a position.
    CellBox cells_within(const CellLevel& level, const Row& p, real distance) const {
        return {cell(level, p - row(distance)), cell(level, p + row(distance))};
    }
};

} // namespace rattlebox::dem
