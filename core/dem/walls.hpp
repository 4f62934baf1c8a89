// Exact distances to the walls of a cavity.
#pragma once

#include "dem/encounter.hpp"

namespace rattlebox::dem {

// Of a place seen from the centre of the cavity: the way to the nearest point of the wall, and how far it is.
struct Near {
    Row normal;
    real distance;
};

inline Near nearest(const Wall& wall, Row place) {
    const real along = dot(wall.axis, place);
    if (wall.form == Wall::plane)
        return {row(wall.axis[0], wall.axis[1], wall.axis[2]), wall.axis[3] - along};
    const real taken = wall.form == Wall::cylinder ? along : 0;
    const Row q = row(place[0] - taken * wall.axis[0], place[1] - taken * wall.axis[1],
                      place[2] - taken * wall.axis[2]);
    const real out = std::sqrt(dot(q, q));
    return {q / (out + 1e-290), wall.axis[3] - out};
}

// Of many places at once.
RATTLEBOX_INLINE Group distance(const Wall& wall, const Vector<Group>& place) {
    const Vector<Group> axis = {Group::all(wall.axis[0]), Group::all(wall.axis[1]), Group::all(wall.axis[2])};
    const Group along = dot(axis, place), offset = Group::all(wall.axis[3]);
    if (wall.form == Wall::plane) return offset - along;
    const Vector<Group> q = wall.form == Wall::cylinder ? place - along * axis : place;
    return offset - root(dot(q, q));
}

} // namespace rattlebox::dem
