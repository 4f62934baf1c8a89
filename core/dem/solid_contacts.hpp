// The points at which the particles of a chunk touch walls, in cavities with solids (dem/solids.hpp).
//
// The candidates of a particle are consecutive. In each step the nearest points of bodies and triangles are
// computed, those that are no contact are moved out of reach, and the history of a contact moves to the
// triangle on which it goes on. Lists of walls alone, also of planes in the place of triangles, need none of
// this.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

inline bool is_surface(const ContactList& list, const Cavity& cavity, int k) {
    return at(cavity.walls, at(list.second, k)).form == Wall::solid;
}

// Makes room for nearest points if a list has candidates that need them. Their gaps are unknown.
inline void find_surfaces(ContactList& list, const Cavity& cavity) {
    bool any = false;
    for (int k = 0; k < list.size(); ++k) any |= is_surface(list, cavity, k);
    list.near.assign(any ? static_cast<std::size_t>(list.size()) + lane_count : 0, Row{});
    list.gap.assign(any ? static_cast<std::size_t>(list.size()) : 0, 0);
}

// Moves the history of a contact that ends on one of the leaves near a particle to a leaf that begins one, if
// the surface continues there; calls changed(from, to) with the candidates if laws differ.
template <class Changed>
void move_history(ContactList& list, const Cavity& cavity, const LeafPoint& from,
                  const std::vector<LeafPoint>& points, Changed&& changed) {
    int& slot = at(list.slot, from.candidate);
    if (from.counts || slot == ContactList::none) return;
    const auto material = [&](const LeafPoint& p) {
        return at(cavity.walls, at(list.second, p.candidate)).material;
    };
    const LeafPoint* to = nullptr;
    for (const LeafPoint& next : points)
        if (next.counts && at(list.slot, next.candidate) == ContactList::none &&
            cavity.solids.continues(from, next) &&
            (!to || dot(from.near, next.near) > dot(from.near, to->near)))
            to = &next;
    if (!to) return;
    std::swap(slot, at(list.slot, to->candidate));
    if (material(from) != material(*to)) changed(from.candidate, to->candidate);
}

// Fills `near` of a list of the chunk that begins with a particle. `selects`: whether contacts are chosen;
// else the list keeps those of the last step. Calls changed(from, to) for contacts that continue with
// other laws.
template <class Changed>
void find_wall_points(ContactList& list, const Bed& bed, int begin, bool selects, Changed&& changed) {
    if (list.near.empty()) return;
    const Cavity& cavity = *bed.cavity;
    const Solids& solids = cavity.solids;
    const int leaves = solids.leaves(), count = list.size();
    std::fill(list.near.begin(), list.near.end(), row(0, 0, 0, 1e300)); // out of reach
    // Points of one particle: those that touch it, and those of contacts that have just ended, which show
    // where they go on.
    thread_local std::vector<LeafPoint> touching_points, ended_points;
    std::vector<LeafPoint>&touching = touching_points, &ended = ended_points;
    for (int k = 0; k < count;) {
        const int i = at(list.first, k);
        const real radius = at(bed.position, i)[3];
        const Row place = (at(bed.position, i) - bed.motion.displacement) * row(1, 1, 1, 0);
        touching.clear(), ended.clear();
        for (; k < count && at(list.first, k) == i; ++k) {
            if (!is_surface(list, cavity, k)) {
                const WallPoint near = nearest_wall_point(at(cavity.walls, at(list.second, k)), place);
                at(list.near, k) = near.normal * row(1, 1, 1, 0) + row(0, 0, 0, near.distance);
                continue;
            }
            // Most candidates do not touch: their gap has not closed since the scan, or their plane is beyond
            // reach.
            const bool has_slot = at(list.slot, k) != ContactList::none;
            if (!has_slot && list.approach < at(list.gap, k)) continue;
            const int leaf = at(list.origin, k) - (i - begin) * leaves;
            if (!has_slot && solids.is_beyond(leaf, place, radius)) continue;
            LeafPoint point = solids.nearest_on(leaf, place);
            point.candidate = k;
            if (!selects)
                at(list.near, k) = point.near;
            else if (solids.distance(point) < radius)
                touching.push_back(point);
            else if (has_slot)
                ended.push_back(point);
        }
        if (!selects || touching.empty()) continue;
        solids.select(place, radius, cavity.walls, touching.data(), static_cast<int>(touching.size()));
        for (const LeafPoint& p : touching)
            if (p.counts) at(list.near, p.candidate) = p.near;
        for (const auto* points : {&touching, &ended})
            for (const LeafPoint& p : *points) move_history(list, cavity, p, touching, changed);
    }
}

} // namespace rattlebox::dem
