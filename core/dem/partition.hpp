// The partition of the chunks among workers: contiguous ranges of about the same estimated cost, over all
// beds.
//
// Results do not depend on it. A contact belongs to the chunk of its first particle, and acts on particles of
// its own range or a higher one. If it acts on another range, its force is computed before any particle of
// that range is integrated. Correcting the estimate by measured times has no benefit (time with the
// correction over time without: 0.94 to 1.03).
#pragma once

#include <bit>
#include <numeric>

#include "dem/bed.hpp"

namespace rattlebox::dem {

struct ChunkIndex {
    int bed, chunk;
};

// Ring buffer of the forces on the particles that are being worked on, whose indices are close together.
class ForceSums {
    std::vector<ContactForce> sums_;
    std::vector<Row> torque_;
    int mask_ = 0;

public:
    ContactForce& of(int i) { return at(sums_, i & mask_); }
    Row& torque(int i) { return at(torque_, i & mask_); } // of rolling resistance

    // All entries are zero between two steps.
    void resize(int span, bool rolls) {
        const auto size = std::bit_ceil(static_cast<std::size_t>(span));
        mask_ = static_cast<int>(size) - 1;
        sums_.assign(size, ContactForce{});
        torque_.assign(rolls ? size : 1, Row{});
    }
};

// The chunks of one worker and its buffers. Aligned to cache lines because the worker writes to it in each
// step.
struct alignas(64) WorkerRange {
    int begin = 0, end = 0; // indices into the chunks of all beds
    // By chunk: whether a contact of it crosses the boundary of the range, and whether its forces have been
    // computed in this step.
    std::vector<char> at_border, computed;
    std::vector<ChunkIndex> incoming;       // chunks of lower ranges with contacts that act on this range
    std::vector<int> first, until;          // range of particles, by bed
    std::vector<ForceSums> sums;            // by bed
    ContactForces pair_forces, wall_forces; // of the current chunk
};

class Partition {
    const std::vector<Bed>* beds_ = nullptr;
    std::vector<ChunkIndex> chunks_;
    std::vector<WorkerRange> ranges_;

    // Returns the estimated time of a step in nanoseconds. The coefficients were measured.
    static real cost(const Chunk& c) {
        const int touching = c.pairs.history.used() + c.walls.history.used();
        return 7.0 * (c.end - c.begin) + 2.0 * static_cast<real>(c.neighbour_second.size()) + 18.0 * touching;
    }

    const Chunk& chunk(ChunkIndex p) const { return at(at(*beds_, p.bed).chunks, p.chunk); }

public:
    void start(const std::vector<Bed>& beds) {
        beds_ = &beds;
        for (int b = 0; b < static_cast<int>(beds.size()); ++b)
            for (int c = 0; c < at(beds, b).chunk_count(); ++c) chunks_.push_back({b, c});
    }

    int chunks() const { return static_cast<int>(chunks_.size()); }
    const WorkerRange& range(int rank) const { return at(ranges_, rank); }
    WorkerRange& range(int rank) { return at(ranges_, rank); }
    ChunkIndex chunk_index(int k) const { return at(chunks_, k); }

    template <class F> void each_chunk(int rank, F&& f) const {
        for (int k = range(rank).begin; k < range(rank).end; ++k) f(at(chunks_, k));
    }

    void divide(int workers) {
        std::vector<real> costs;
        for (const ChunkIndex p : chunks_) costs.push_back(cost(chunk(p)));
        const real share = std::accumulate(costs.begin(), costs.end(), real{}) / workers;
        ranges_.resize(static_cast<std::size_t>(workers));
        real sum = 0;
        int k = 0;
        for (int rank = 0; rank < workers; ++rank) {
            WorkerRange& range = at(ranges_, rank);
            range.begin = k;
            // A chunk belongs to the range in which the middle of its cost lies.
            for (; k < chunks() && (rank == workers - 1 || sum + at(costs, k) / 2 < share * (rank + 1)); ++k)
                sum += at(costs, k);
            range.end = k;
        }
    }

    // Computes what a worker must know about its range, once all neighbour lists are built.
    void find_dependencies(int rank) {
        WorkerRange& range = at(ranges_, rank);
        const std::size_t beds = beds_->size();
        range.incoming.clear();
        range.first.assign(beds, 0), range.until.assign(beds, 0), range.sums.resize(beds);
        for (int k = range.end; k-- > range.begin;) {
            const ChunkIndex p = at(chunks_, k);
            at(range.first, p.bed) = chunk(p).begin;
            at(range.until, p.bed) = std::max(at(range.until, p.bed), chunk(p).end);
        }
        std::vector<int> reached(beds, -1); // highest particle in a contact with a lower range
        for (int k = 0; k < range.begin; ++k) {
            const ChunkIndex p = at(chunks_, k);
            const int first = at(range.first, p.bed), until = at(range.until, p.bed);
            if (chunk(p).highest_neighbour < first || first == until) continue;
            range.incoming.push_back(p);
            at(reached, p.bed) =
                std::max(at(reached, p.bed), std::min(chunk(p).highest_neighbour, until - 1));
        }
        range.at_border.clear();
        std::vector<int> prefetch = reached, span(beds, 1); // `span`: indices in use at once
        each_chunk(rank, [&](ChunkIndex p) {
            const Chunk& c = chunk(p);
            const int until = at(range.until, p.bed);
            range.at_border.push_back(c.highest_neighbour >= until || c.begin <= at(reached, p.bed));
            at(prefetch, p.bed) =
                std::max({at(prefetch, p.bed), std::min(c.highest_neighbour, until - 1), c.end - 1});
            at(span, p.bed) = std::max(at(span, p.bed), at(prefetch, p.bed) - c.begin + 1);
        });
        range.computed.assign(range.at_border.size(), false);
        for (std::size_t b = 0; b < beds; ++b) range.sums[b].resize(span[b], (*beds_)[b].rolls);
    }
};

} // namespace rattlebox::dem
