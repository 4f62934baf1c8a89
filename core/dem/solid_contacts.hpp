// The points at which the particles of a chunk touch walls, in cavities with solids (dem/solids.hpp).
//
// The candidates of a particle are consecutive. In each step their nearest points are computed, those that
// are no contact are moved out of reach, and the history of a contact moves to the triangle on which it goes
// on.
#pragma once

#include "dem/bed.hpp"

namespace rattlebox::dem {

// Fills `near` of a list. `selects`: whether contacts are chosen; else the list keeps those of the last step.
inline void find_wall_points(ContactList& list, const Bed& bed, bool selects) {
    const Cavity& cavity = *bed.cavity;
    const Solids& solids = cavity.solids;
    const int leaves = solids.leaves(), plain = solids.plain_walls(), count = list.size();
    const Row out_of_reach = row(0, 0, 0, 1e300);
    list.near.assign(static_cast<std::size_t>(count) + lane_count, out_of_reach);
    thread_local std::vector<LeafPoint> points;
    thread_local std::vector<int> candidate;
    for (int k = 0; k < count;) {
        const int i = at(list.first, k);
        const real radius = at(bed.position, i)[3];
        const Row place = (at(bed.position, i) - bed.motion.displacement) * row(1, 1, 1, 0);
        points.clear(), candidate.clear();
        for (; k < count && at(list.first, k) == i; ++k) {
            const int own = at(list.origin, k) / leaves, leaf = at(list.origin, k) - own * leaves;
            if (leaf < plain) {
                const WallPoint near = nearest_wall_point(at(cavity.walls, leaf), place);
                at(list.near, k) = near.normal * row(1, 1, 1, 0) + row(0, 0, 0, near.distance);
                continue;
            }
            // Most candidates do not touch. Where a contact has just ended, the point shows where it goes on.
            if (at(list.slot, k) == ContactList::none && solids.is_beyond(leaf, place, radius)) continue;
            points.push_back(solids.nearest_on(leaf, place)), candidate.push_back(k);
        }
        if (points.empty()) continue;
        const int n = static_cast<int>(points.size());
        if (selects) solids.select(place, radius, cavity.walls, points.data(), n);
        for (int a = 0; a < n; ++a)
            if (!selects || at(points, a).counts) at(list.near, at(candidate, a)) = at(points, a).near;
        if (!selects) continue;
        const auto material = [&](int a) {
            return at(cavity.walls, at(list.second, at(candidate, a))).material;
        };
        for (int a = 0; a < n; ++a) {
            int& slot = at(list.slot, at(candidate, a));
            if (at(points, a).counts || slot == ContactList::none) continue;
            // The contact on this leaf ends: where a leaf near it begins one, it goes on there.
            int to = -1;
            for (int b = 0; b < n; ++b) {
                const LeafPoint& next = at(points, b);
                if (next.counts && at(list.slot, at(candidate, b)) == ContactList::none &&
                    solids.continues(at(points, a), next) && material(a) == material(b) &&
                    (to < 0 ||
                     dot(at(points, a).near, next.near) > dot(at(points, a).near, at(points, to).near)))
                    to = b;
            }
            if (to >= 0) std::swap(slot, at(list.slot, at(candidate, to)));
        }
    }
}

} // namespace rattlebox::dem
