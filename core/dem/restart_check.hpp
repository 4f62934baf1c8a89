// Validation of a saved state: every count and index that the engine uses without a check must be in its
// range, so that a damaged file cannot cause reads out of bounds.
#pragma once

#include <array>
#include <stdexcept>
#include <utility>

#include "dem/bed.hpp"

namespace rattlebox::dem {

// Compares a restored bed with the particle properties that a run never changes, by number in the case.
class RestartCheck {
    std::vector<std::array<real, 3>> numbers_; // radius, 1 / mass, radius / inertia
    std::vector<int> species_;
    std::size_t chunks_;

    static void require(bool holds) {
        if (!holds) throw std::invalid_argument("the state is damaged");
    }
    static bool is_within(int i, int from, int until) { return i >= from && i < until; }
    static bool is_finite(Row r) { return std::fabs(r[0]) + std::fabs(r[1]) + std::fabs(r[2]) < infinity; }
    static std::array<real, 3> numbers(const Bed& bed, int i) {
        return {at(bed.position, i)[3], at(bed.velocity, i)[3], at(bed.spin, i)[3]};
    }

    static void check(const ContactHistory& history) {
        const std::size_t slots = history.state.size();
        require(history.rolling.size() == (history.rolls ? slots : 0));
        for (const std::size_t size : {history.yield_history.size(), history.began_at.size()})
            require(size == (history.yields ? slots : 0));
        require(history.start_step.size() == slots);
        require(history.free.size() <= slots);
        for (const int slot : history.free) require(is_within(slot, 0, static_cast<int>(slots)));
    }

    // Checks a list whose second partners are below `partners` and whose origins are below `origins`;
    // matches_origin(k) returns whether candidate k is the pair of its origin.
    template <class Origin>
    static void check(const ContactList& list, const Chunk& chunk, int partners, int origins, bool has_forces,
                      Origin&& matches_origin) {
        require(!(list.approach < 0) && !(list.skin < 0) && list.candidate_count >= 0);
        const auto listed = static_cast<std::size_t>(list.size()), padded = listed + lane_count;
        for (const auto* numbers : {&list.first, &list.second, &list.slot, &list.touching})
            require(numbers->size() == padded);
        require(list.origin.size() == listed && is_within(list.touching_count, 0, list.size() + 1));
        check(list.history);
        for (const int w : list.history.began_at) require(is_within(w, -1, partners));
        std::vector<char> touches(listed, false);
        for (int a = 0, last = -1; a < list.touching_count; ++a) {
            const int k = at(list.touching, a);
            require(is_within(k, last + 1, list.size()));
            at(touches, last = k) = true;
        }
        const int slots = static_cast<int>(list.history.state.size());
        for (int k = 0; k < list.size(); ++k) {
            require(is_within(at(list.first, k), chunk.begin, chunk.end));
            require(is_within(at(list.second, k), 0, partners));
            require(is_within(at(list.origin, k), 0, origins) && matches_origin(k));
            require(at(touches, k) ? is_within(at(list.slot, k), 0, slots)
                                   : at(list.slot, k) == ContactList::none);
        }
        for (std::size_t k = listed; k < padded; ++k) { // padding
            const int i = static_cast<int>(k);
            require(is_within(at(list.first, i), 0, chunk.end) && is_within(at(list.second, i), 0, partners));
        }
        const auto contacts = static_cast<std::size_t>(list.touching_count);
        if (has_forces)
            require(list.contact_forces.all.size() >= contacts &&
                    (!list.history.rolls || list.contact_forces.torque.size() >= contacts));
    }

    static void check(const Bed& bed, const Chunk& chunk, bool has_forces) {
        const int n = bed.particles(), walls = static_cast<int>(bed.cavity->walls.size());
        const int leaves = bed.cavity->leaves();
        const int near = static_cast<int>(chunk.neighbour_second.size());
        require(chunk.neighbour_first.size() == chunk.neighbour_second.size());
        require(is_within(chunk.highest_neighbour, 0, n));
        for (int p = 0; p < near; ++p)
            require(chunk.begin + at(chunk.neighbour_first, p) < chunk.end &&
                    is_within(at(chunk.neighbour_second, p), 0, n));
        require(is_possible(chunk.stop_reason, n, walls));
        const ContactList &pairs = chunk.pairs, &at_walls = chunk.walls;
        check(pairs, chunk, n, near, has_forces, [&](int k) {
            const int p = at(pairs.origin, k);
            return chunk.begin + at(chunk.neighbour_first, p) == at(pairs.first, k) &&
                   at(chunk.neighbour_second, p) == at(pairs.second, k);
        });
        check(at_walls, chunk, walls, (chunk.end - chunk.begin) * leaves, has_forces, [&](int k) {
            const int leaf = at(at_walls.origin, k) - (at(at_walls.first, k) - chunk.begin) * leaves;
            return is_within(leaf, 0, leaves) && bed.cavity->wall_of(leaf) == at(at_walls.second, k);
        });
    }

public:
    explicit RestartCheck(const Bed& bed) : chunks_(bed.chunk_motion.size()) {
        const auto n = static_cast<std::size_t>(bed.particles());
        numbers_.resize(n), species_.resize(n);
        for (int i = 0; i < bed.particles(); ++i)
            at(numbers_, at(bed.id, i)) = numbers(bed, i), at(species_, at(bed.id, i)) = at(bed.species, i);
    }

    static bool is_possible(Status status) {
        return is_within(static_cast<int>(status), 0, static_cast<int>(Status::no_rebound) + 1);
    }
    static bool is_possible(const StopReason& s, int particles, int walls) {
        return is_possible(s.status) && is_within(s.wall, -1, walls) &&
               is_within(s.particle, s.status == Status::finished ? -1 : 0, particles);
    }

    // Throws if the bed cannot be a state of this case; `has_forces` is whether it includes contact forces.
    void check(const Bed& bed, bool has_forces) const {
        const std::size_t n = numbers_.size();
        require(bed.position.size() == n && bed.velocity.size() == n && bed.spin.size() == n);
        require(bed.rates.size() == n && bed.touched.size() == n);
        require(bed.id.size() == n && bed.species.size() == n && bed.chunk_motion.size() == chunks_);
        std::vector<char> named(n, false);
        for (int i = 0; i < bed.particles(); ++i) {
            const int id = at(bed.id, i);
            require(is_within(id, 0, bed.particles()) && !at(named, id));
            at(named, id) = true;
            require(at(bed.species, i) == at(species_, id) && numbers(bed, i) == at(numbers_, id));
            require(is_finite(at(bed.position, i)) && is_finite(at(bed.velocity, i)) &&
                    is_finite(at(bed.spin, i)));
            for (int a = 0; a < 3; ++a) require(std::fabs(at(bed.position, i)[a]) < 1e30);
        }
        require(bed.reach >= 0 && bed.reach < infinity && !(bed.cavity_moved < 0));
        require(bed.frame.is_finite());
        for (const ChunkMotion& motion : bed.chunk_motion)
            require(!(motion.moved < 0) && !(motion.approach < 0));
        for (const Chunk& chunk : bed.chunks) check(bed, chunk, has_forces);
    }
};

} // namespace rattlebox::dem
