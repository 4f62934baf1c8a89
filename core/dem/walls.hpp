// Walls of a cavity (plane, cylinder, sphere) and exact distances to them.
#pragma once

#include "dem/pair_laws.hpp"

namespace rattlebox::dem {

// A wall in coordinates relative to the centre of its cavity.
struct Wall {
    enum Form : int { plane = 0, cylinder = 1, sphere = 2, solid = 3 }; // the last: dem/solids.hpp
    // Outward normal of a plane or axis of a cylinder; the fourth number is the distance or the radius.
    Row axis{};
    Form form = plane;
    int material = 0;
    int label = 0; // number of its name; walls with the same name are summed in results
};

// Outward direction from a position to the nearest point of a wall, and the distance.
struct WallPoint {
    Row normal;
    real distance;
};

inline WallPoint nearest_wall_point(const Wall& wall, Row place) {
    const real along = dot(wall.axis, place);
    if (wall.form == Wall::plane)
        return {row(wall.axis[0], wall.axis[1], wall.axis[2]), wall.axis[3] - along};
    const real axial = wall.form == Wall::cylinder ? along : 0;
    const Row q = row(place[0] - axial * wall.axis[0], place[1] - axial * wall.axis[1],
                      place[2] - axial * wall.axis[2]);
    const real radial = std::sqrt(dot(q, q));
    return {q / (radial + 1e-290), wall.axis[3] - radial};
}

// Distances of several positions, in SIMD lanes.
RATTLEBOX_INLINE Group distance(const Wall& wall, const Vector<Group>& place) {
    const Vector<Group> axis = {Group::all(wall.axis[0]), Group::all(wall.axis[1]), Group::all(wall.axis[2])};
    const Group along = dot(axis, place), offset = Group::all(wall.axis[3]);
    if (wall.form == Wall::plane) return offset - along;
    const Vector<Group> q = wall.form == Wall::cylinder ? place - along * axis : place;
    return offset - root(dot(q, q));
}

} // namespace rattlebox::dem
