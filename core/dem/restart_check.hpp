// Validates a bed that was read back: every number, count and index that the engine uses without a check must
// be one that it can have written, so that a damaged or altered state cannot make it read elsewhere.
#pragma once

#include <array>
#include <stdexcept>
#include <utility>

#include "dem/bed.hpp"

namespace rattlebox::dem {

// What a run never changes, by number in the case.
class RestartCheck {
    std::vector<std::array<real, 3>> numbers_; // radius, 1 / mass, radius / inertia
    std::vector<int> kind_;
    std::size_t chunks_;

    static void require(bool holds) {
        if (!holds) throw std::invalid_argument("the state is damaged");
    }
    static bool is_within(int i, int from, int until) { return i >= from && i < until; }
    static bool is_finite(Row r) { return std::fabs(r[0]) + std::fabs(r[1]) + std::fabs(r[2]) < infinity; }
    static std::array<real, 3> numbers(const Bed& bed, int i) {
        return {at(bed.position, i)[3], at(bed.velocity, i)[3], at(bed.spin, i)[3]};
    }

    static void check(const ContactHistory& memory) {
        const std::size_t slots = memory.state.size();
        require(memory.rolling.size() == (memory.rolls ? slots : 0));
        require(memory.yield_history.size() == (memory.yields ? slots : 0));
        require(memory.since.size() == slots);
        require(memory.free.size() <= slots);
        for (const int slot : memory.free) require(is_within(slot, 0, static_cast<int>(slots)));
    }

    // Candidates of particles `begin` to `end` with numbers below `partners`; `origin(k)` is where one comes
    // from, of so many.
    template <class Origin>
    static void check(const ContactList& list, const Chunk& chunk, int partners, int origins, bool told,
                      Origin&& agrees) {
        require(!(list.since < 0) && !(list.skin < 0) && list.listed >= 0);
        const auto listed = static_cast<std::size_t>(list.size()), padded = listed + lane_count;
        for (const auto* numbers : {&list.first, &list.second, &list.slot, &list.touching})
            require(numbers->size() == padded);
        require(list.origin.size() == listed && is_within(list.touching_count, 0, list.size() + 1));
        check(list.memory);
        std::vector<char> touches(listed, false);
        for (int a = 0, last = -1; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            require(is_within(k, last + 1, list.size()));
            at(touches, last = k) = true;
        }
        const int slots = static_cast<int>(list.memory.state.size());
        for (int k = 0; k < list.size(); ++k) {
            require(is_within(at(list.first, k), chunk.begin, chunk.end));
            require(is_within(at(list.second, k), 0, partners));
            require(is_within(at(list.origin, k), 0, origins) && agrees(k));
            require(at(touches, k) ? is_within(at(list.slot, k), 0, slots)
                                   : at(list.slot, k) == ContactList::none);
        }
        for (std::size_t k = listed; k < padded; ++k) { // lanes past the end
            const int i = static_cast<int>(k);
            require(is_within(at(list.first, i), 0, chunk.end) && is_within(at(list.second, i), 0, partners));
        }
        const auto acting = static_cast<std::size_t>(list.touching_count);
        if (told)
            require(list.contact_forces.all.size() >= acting &&
                    (!list.memory.rolls || list.contact_forces.torque.size() >= acting));
    }

    static void check(const Bed& bed, const Chunk& chunk, bool told) {
        const int n = bed.particles(), walls = static_cast<int>(bed.cavity->walls.size());
        const int near = static_cast<int>(chunk.near_second.size());
        require(chunk.near_first.size() == chunk.near_second.size());
        require(is_within(chunk.highest, 0, n));
        for (int p = 0; p < near; ++p)
            require(chunk.begin + at(chunk.near_first, p) < chunk.end &&
                    is_within(at(chunk.near_second, p), 0, n));
        require(is_possible(chunk.stopped, n, walls));
        const ContactList &pairs = chunk.pairs, &at_walls = chunk.walls;
        check(pairs, chunk, n, near, told, [&](int k) {
            const int p = at(pairs.origin, k);
            return chunk.begin + at(chunk.near_first, p) == at(pairs.first, k) &&
                   at(chunk.near_second, p) == at(pairs.second, k);
        });
        check(at_walls, chunk, walls, (chunk.end - chunk.begin) * walls, told, [&](int k) {
            return at(at_walls.origin, k) ==
                   (at(at_walls.first, k) - chunk.begin) * walls + at(at_walls.second, k);
        });
    }

public:
    explicit RestartCheck(const Bed& bed) : chunks_(bed.chunk_motion.size()) {
        const auto n = static_cast<std::size_t>(bed.particles());
        numbers_.resize(n), kind_.resize(n);
        for (int i = 0; i < bed.particles(); ++i)
            at(numbers_, at(bed.name, i)) = numbers(bed, i), at(kind_, at(bed.name, i)) = at(bed.kind, i);
    }

    static bool is_possible(Status status) {
        return is_within(static_cast<int>(status), 0, static_cast<int>(Status::no_rebound) + 1);
    }
    static bool is_possible(const Stopped& s, int particles, int walls) {
        return is_possible(s.status) && is_within(s.wall, -1, walls) &&
               is_within(s.particle, s.status == Status::finished ? -1 : 0, particles);
    }

    // Throws where the bed cannot be one of this case; `told` if the forces of its contacts are asked for.
    void check(const Bed& bed, bool told) const {
        const std::size_t n = numbers_.size();
        require(bed.position.size() == n && bed.velocity.size() == n && bed.spin.size() == n);
        require(bed.rates.size() == n && bed.touched.size() == n);
        require(bed.name.size() == n && bed.kind.size() == n && bed.chunk_motion.size() == chunks_);
        std::vector<char> named(n, false);
        for (int i = 0; i < bed.particles(); ++i) {
            const int name = at(bed.name, i);
            require(is_within(name, 0, bed.particles()) && !at(named, name));
            at(named, name) = true;
            require(at(bed.kind, i) == at(kind_, name) && numbers(bed, i) == at(numbers_, name));
            require(is_finite(at(bed.position, i)) && is_finite(at(bed.velocity, i)) &&
                    is_finite(at(bed.spin, i)));
            for (int a = 0; a < 3; ++a) require(std::fabs(at(bed.position, i)[a]) < 1e30);
        }
        require(bed.reach >= 0 && bed.reach < infinity && !(bed.apart < 0));
        for (const ChunkMotion& motion : bed.chunk_motion)
            require(!(motion.moved < 0) && !(motion.approached < 0));
        for (const Chunk& chunk : bed.chunks) check(bed, chunk, told);
    }
};

} // namespace rattlebox::dem
