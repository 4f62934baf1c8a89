// Prefetches the data of later chunks while the current one is computed, for beds that exceed the caches.
//
// Requests are spread over the loops, because a core has at most about two dozen outstanding cache misses.
// All functions are inlined: compilers remove calls whose only effect is a prefetch. Used above 20 000
// particles (Bed::cached). Measured with 100 000 particles as time without it over time with it: 1.17 shaken
// and 1.18 at rest on one core, 1.08 and 1.13 on two.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

class Prefetch {
    const Bed* bed_ = nullptr;
    const ContactList *next_ = nullptr, *later_ = nullptr;
    int first_ = 0, until_ = 0; // neighbours of the chunk after next that no earlier chunk has

    static RATTLEBOX_INLINE void fetch(const void* what) { __builtin_prefetch(what, 0, 2); }

    // Contacts at walls are few, so all are fetched at once.
    static RATTLEBOX_INLINE void walls(const ContactList& next, const ContactList& later) {
        if (later.size() > 0)
            for (const auto* list : {&later.first, &later.second, &later.slot, &later.touching})
                fetch(list->data());
        for (int a = 0; a < next.touching_count; ++a)
            fetch(&at(next.history.state, at(next.slot, at(next.touching, a))));
    }

public:
    Prefetch() = default; // fetches nothing

    // `next`, `later` and `last` are the chunks one, two and three places later.
    RATTLEBOX_INLINE Prefetch(const Bed& bed, const Chunk& next, const Chunk& later, const Chunk& last)
        : bed_(&bed), next_(&next.pairs), later_(&later.pairs), first_(next.highest_neighbour + 1),
          until_(later.highest_neighbour + 1) {
        for (std::size_t b = 0; b < sizeof(Chunk); b += 64) fetch(reinterpret_cast<const char*>(&last) + b);
        walls(next.walls, later.walls);
    }

    // Called while the eight candidates from `base` are tested: fetches the lists of a later chunk and its
    // neighbours.
    RATTLEBOX_INLINE void for_candidates(int base) const {
        if (!bed_) return;
        if (base < later_->size())
            for (const auto* list : {&later_->first, &later_->second, &later_->slot}) fetch(&at(*list, base));
        const int from = first_ + base;
        for (int j = from; j < std::min(from + lane_count, until_); j += 2) fetch(&at(bed_->position, j));
    }

    // Called while the eight contacts from `base` are computed: fetches the data of the contacts that the
    // next chunk had in the last step.
    RATTLEBOX_INLINE void for_contacts(int base) const {
        if (!bed_) return;
        if (base < later_->touching_count) fetch(&at(later_->touching, base));
        for (int a = base; a < std::min(base + lane_count, next_->touching_count); ++a) {
            const int k = at(next_->touching, a), j = at(next_->second, k);
            fetch(&at(bed_->velocity, j)), fetch(&at(bed_->spin, j));
            fetch(&at(next_->history.state, at(next_->slot, k)));
        }
    }

    // Called after the last candidate and contact: fetches the rest if a later chunk has more of them.
    RATTLEBOX_INLINE void remaining(int looked, int collided) const {
        if (!bed_) return;
        const auto up = [](int n) { return (n + lane_count - 1) / lane_count * lane_count; };
        for (int k = up(looked); k < std::max(until_ - first_, later_->size()); k += lane_count)
            for_candidates(k);
        for (int a = up(collided); a < next_->touching_count; a += lane_count) for_contacts(a);
    }

    // Called while particle i is integrated: fetches the particle one chunk later, at most `until` - 1.
    static RATTLEBOX_INLINE void for_particle(const Bed& bed, int i, int until) {
        const int j = std::min(i + Bed::chunk_size, until - 1);
        fetch(&at(bed.velocity, j));
        if (at(bed.touched, j)) fetch(&at(bed.rates, j)), fetch(&at(bed.spin, j));
    }
};

} // namespace rattlebox::dem
