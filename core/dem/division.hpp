// Which chunks each member of a team works on: parts of about the same cost, of all beds together.
//
// Contacts belong to the chunk of their first partner, and act on particles of their own part or a higher
// one. Where they reach into another part, forces of both sides come early: before any of these particles
// moves on.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

struct Place {
    int bed, chunk;
};

// A candidate that a lower part owns and that acts here.
struct Incoming {
    int bed, chunk, candidate;
};

struct Part {
    int begin = 0, end = 0; // among the chunks of all beds
    std::vector<char>
        early; // of each of them: has candidates in higher parts, or particles that lower parts reach
    std::vector<Incoming> incoming;
    std::vector<int> first, until; // particles of each bed
};

class Division {
    const std::vector<Bed>* beds_ = nullptr;
    std::vector<Place> all_;
    std::vector<Part> parts_;

    // Nanoseconds, about: where the time goes was measured.
    static long cost(const Chunk& c) {
        const auto touching = [](const Contacts& list) {
            return static_cast<long>(list.kept.size() - list.free.size());
        };
        return 7 * (c.end - c.begin) + 2 * (c.pairs.size() + c.walls.size()) +
               20 * (touching(c.pairs) + touching(c.walls));
    }

    const Chunk& chunk(Place p) const { return at(at(*beds_, p.bed).chunks, p.chunk); }

public:
    void start(const std::vector<Bed>& beds) {
        beds_ = &beds;
        for (int b = 0; b < static_cast<int>(beds.size()); ++b)
            for (int c = 0; c < at(beds, b).chunk_count(); ++c) all_.push_back({b, c});
    }

    int chunks() const { return static_cast<int>(all_.size()); }
    const Part& part(int rank) const { return at(parts_, rank); }
    Place place(int k) const { return at(all_, k); }

    template <class F> void each_chunk(int rank, F&& f) const {
        for (int k = part(rank).begin; k < part(rank).end; ++k) f(at(all_, k));
    }

    void divide(int members) {
        long total = 0, sum = 0;
        for (const Place p : all_) total += cost(chunk(p));
        parts_.resize(static_cast<std::size_t>(members));
        int rank = 0;
        for (int k = 0; k < chunks(); ++k) {
            // A chunk belongs where its middle lies.
            const long own = cost(chunk(at(all_, k)));
            for (; (2 * sum + own) * members >= 2 * total * (rank + 1); ++rank) at(parts_, rank).end = k;
            sum += own;
        }
        for (; rank < members; ++rank) at(parts_, rank).end = chunks();
        for (int r = 0; r < members; ++r) at(parts_, r).begin = r == 0 ? 0 : at(parts_, r - 1).end;
    }

    // What a member needs to know of its part, once all candidates are known.
    void look_around(int rank) {
        Part& part = at(parts_, rank);
        part.incoming.clear();
        part.first.assign(beds_->size(), 0), part.until.assign(beds_->size(), 0);
        for (int k = part.end; k-- > part.begin;) {
            const Place p = at(all_, k);
            at(part.first, p.bed) = chunk(p).begin;
            at(part.until, p.bed) = std::max(at(part.until, p.bed), chunk(p).end);
        }
        std::vector<int> reached(beds_->size(), -1); // highest particle
        for (int k = 0; k < part.begin; ++k) {
            const Place p = at(all_, k);
            const int first = at(part.first, p.bed), until = at(part.until, p.bed);
            if (chunk(p).highest < first || first == until) continue;
            const Contacts& pairs = chunk(p).pairs;
            for (int c = 0; c < pairs.size(); ++c)
                if (const int j = at(pairs.second, c); j >= first && j < until) {
                    part.incoming.push_back({p.bed, p.chunk, c});
                    at(reached, p.bed) = std::max(at(reached, p.bed), j);
                }
        }
        part.early.clear();
        each_chunk(rank, [&](Place p) {
            const Chunk& c = chunk(p);
            part.early.push_back(c.highest >= at(part.until, p.bed) || c.begin <= at(reached, p.bed));
        });
    }
};

} // namespace rattlebox::dem
