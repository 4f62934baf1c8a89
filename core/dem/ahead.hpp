// What the chunks to come will need, asked of memory little by little while one is at work: requests made all
// at once would have to be waited for. All is inlined: compilers take a call that only asks for one without
// effect.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

class Ahead {
    const Bed* bed_ = nullptr;
    const Contacts *next_ = nullptr, *later_ = nullptr;
    int first_ = 0, until_ = 0; // neighbours of the chunk two places on, which those before it have not

    static RATTLEBOX_INLINE void ask(const void* what) { __builtin_prefetch(what, 0, 2); }

    // Few touch a wall: these are asked for at once.
    static RATTLEBOX_INLINE void walls(const Contacts& next, const Contacts& later) {
        if (later.size() > 0)
            for (const auto* list : {&later.first, &later.second, &later.slot, &later.active})
                ask(list->data());
        for (int a = 0; a < next.actives; ++a) ask(&at(next.memory.kept, at(next.slot, at(next.active, a))));
    }

public:
    Ahead() = default; // asks for nothing

    // The chunks one, two and three places on.
    RATTLEBOX_INLINE Ahead(const Bed& bed, const Chunk& next, const Chunk& later, const Chunk& last)
        : bed_(&bed), next_(&next.pairs), later_(&later.pairs), first_(next.highest + 1),
          until_(later.highest + 1) {
        for (std::size_t b = 0; b < sizeof(Chunk); b += 64) ask(reinterpret_cast<const char*>(&last) + b);
        walls(next.walls, later.walls);
    }

    // While eight candidates from `base` on are looked at: lists, and as many neighbours.
    RATTLEBOX_INLINE void looking(int base) const {
        if (!bed_) return;
        if (base < later_->size())
            for (const auto* list : {&later_->first, &later_->second, &later_->slot}) ask(&at(*list, base));
        const int from = first_ + base;
        for (int j = from; j < std::min(from + lane_count, until_); j += 2) ask(&at(bed_->position, j));
    }

    // While eight that touch are worked on: what those have that touched in the step before.
    RATTLEBOX_INLINE void colliding(int base) const {
        if (!bed_) return;
        if (base < later_->actives) ask(&at(later_->active, base));
        for (int a = base; a < std::min(base + lane_count, next_->actives); ++a) {
            const int k = at(next_->active, a), j = at(next_->second, k);
            ask(&at(bed_->velocity, j)), ask(&at(bed_->spin, j));
            ask(&at(next_->memory.kept, at(next_->slot, k)));
        }
    }

    // Once those of the chunk at work are all looked at: what the next one has more of.
    RATTLEBOX_INLINE void rest(int looked, int collided) const {
        if (!bed_) return;
        const auto up = [](int n) { return (n + lane_count - 1) / lane_count * lane_count; };
        for (int k = up(looked); k < std::max(until_ - first_, later_->size()); k += lane_count) looking(k);
        for (int a = up(collided); a < next_->actives; a += lane_count) colliding(a);
    }

    // While a particle is moved: what moves the one a chunk on, if it is below `until`, and so of the same
    // part.
    static RATTLEBOX_INLINE void moving(const Bed& bed, int i, int until) {
        const int j = std::min(i + Bed::chunk_size, until - 1);
        ask(&at(bed.velocity, j));
        if (at(bed.touched, j)) ask(&at(bed.rates, j)), ask(&at(bed.spin, j));
    }
};

} // namespace rattlebox::dem
