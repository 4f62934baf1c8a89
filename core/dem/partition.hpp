// The partition of the chunks among workers: contiguous ranges of about the same estimated cost, over all
// beds.
//
// Results do not depend on it. A contact belongs to the chunk of its first particle, and acts on particles of
// its own range or a higher one. Where it reaches into another range, its force is computed before any of
// these particles is integrated. Correcting the estimate by measured times brought nothing (0.94 to 1.03 with
// it removed).
#pragma once

#include <bit>
#include <numeric>

#include "dem/bed.hpp"

namespace rattlebox::dem {

struct Place {
    int bed, chunk;
};

// What acts on the particles of a part that are at hand, whose numbers lie close together: a ring.
class ForceSums {
    std::vector<ContactForce> sums_;
    std::vector<Row> torque_;
    int mask_ = 0;

public:
    ContactForce& of(int i) { return at(sums_, i & mask_); }
    Row& torque(int i) { return at(torque_, i & mask_); } // of rolling

    // All is zero between two steps.
    void make_room(int span, bool rolls) {
        const auto size = std::bit_ceil(static_cast<std::size_t>(span));
        mask_ = static_cast<int>(size) - 1;
        sums_.assign(size, ContactForce{});
        torque_.assign(rolls ? size : 1, Row{});
    }
};

// What one member works on; in lines of memory of its own, since it writes there in each step.
struct alignas(64) WorkerRange {
    int begin = 0, end = 0; // among the chunks of all beds
    // Of each of them: has neighbours in higher parts, or particles that lower parts reach; and whether its
    // forces are known in this step.
    std::vector<char> at_border, computed;
    std::vector<Place> incoming;      // chunks of lower parts that reach here
    std::vector<int> first, until;    // particles of each bed
    std::vector<ForceSums> sums;      // of each bed
    ContactForces at_pairs, at_walls; // of the chunk at work
};

class Partition {
    const std::vector<Bed>* beds_ = nullptr;
    std::vector<Place> all_;
    std::vector<WorkerRange> parts_;

    // Nanoseconds, about: where the time goes was measured.
    static real cost(const Chunk& c) {
        const int touching = c.pairs.memory.used() + c.walls.memory.used();
        return 7.0 * (c.end - c.begin) + 2.0 * static_cast<real>(c.near_second.size()) + 18.0 * touching;
    }

    const Chunk& chunk(Place p) const { return at(at(*beds_, p.bed).chunks, p.chunk); }

public:
    void start(const std::vector<Bed>& beds) {
        beds_ = &beds;
        for (int b = 0; b < static_cast<int>(beds.size()); ++b)
            for (int c = 0; c < at(beds, b).chunk_count(); ++c) all_.push_back({b, c});
    }

    int chunks() const { return static_cast<int>(all_.size()); }
    const WorkerRange& part(int rank) const { return at(parts_, rank); }
    WorkerRange& part(int rank) { return at(parts_, rank); }
    Place place(int k) const { return at(all_, k); }

    template <class F> void each_chunk(int rank, F&& f) const {
        for (int k = part(rank).begin; k < part(rank).end; ++k) f(at(all_, k));
    }

    void divide(int members) {
        std::vector<real> costs;
        for (const Place p : all_) costs.push_back(cost(chunk(p)));
        const real share = std::accumulate(costs.begin(), costs.end(), real{}) / members;
        parts_.resize(static_cast<std::size_t>(members));
        real sum = 0;
        int k = 0;
        for (int rank = 0; rank < members; ++rank) {
            WorkerRange& part = at(parts_, rank);
            part.begin = k;
            // A chunk belongs where its middle lies.
            for (; k < chunks() && (rank == members - 1 || sum + at(costs, k) / 2 < share * (rank + 1)); ++k)
                sum += at(costs, k);
            part.end = k;
        }
    }

    // What a member needs to know of its part, once all neighbours are known.
    void find_dependencies(int rank) {
        WorkerRange& part = at(parts_, rank);
        const std::size_t beds = beds_->size();
        part.incoming.clear();
        part.first.assign(beds, 0), part.until.assign(beds, 0), part.sums.resize(beds);
        for (int k = part.end; k-- > part.begin;) {
            const Place p = at(all_, k);
            at(part.first, p.bed) = chunk(p).begin;
            at(part.until, p.bed) = std::max(at(part.until, p.bed), chunk(p).end);
        }
        std::vector<int> reached(beds, -1); // highest particle
        for (int k = 0; k < part.begin; ++k) {
            const Place p = at(all_, k);
            const int first = at(part.first, p.bed), until = at(part.until, p.bed);
            if (chunk(p).highest < first || first == until) continue;
            part.incoming.push_back(p);
            at(reached, p.bed) = std::max(at(reached, p.bed), std::min(chunk(p).highest, until - 1));
        }
        part.at_border.clear();
        std::vector<int> prefetch = reached, span(beds, 1); // from the first particle that has not moved on
        each_chunk(rank, [&](Place p) {
            const Chunk& c = chunk(p);
            const int until = at(part.until, p.bed);
            part.at_border.push_back(c.highest >= until || c.begin <= at(reached, p.bed));
            at(prefetch, p.bed) = std::max({at(prefetch, p.bed), std::min(c.highest, until - 1), c.end - 1});
            at(span, p.bed) = std::max(at(span, p.bed), at(prefetch, p.bed) - c.begin + 1);
        });
        part.computed.assign(part.at_border.size(), false);
        for (std::size_t b = 0; b < beds; ++b) part.sums[b].make_room(span[b], (*beds_)[b].rolls);
    }
};

} // namespace rattlebox::dem
