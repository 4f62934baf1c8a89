// Surfaces of a cavity that are no plain walls: rods, plates and balls inside, and closed surfaces of
// triangles, which are cavities or bodies. A body is one wall with a name, and so is each group of triangles
// of a surface; the leaves, the body or each of its triangles, are what a particle can touch.
//
// A particle has one contact for each distinct point at which its distance from the surfaces has a local
// minimum:
//  - of the triangles that share an edge or a corner, only the nearest counts where the nearest point lies on
//    that edge or corner; so edges and corners that stick out are touched once, and coplanar edges not at
//    all;
//  - where two triangles meet at a smooth edge, only the nearest of them counts: facets of a curved surface
//    act as one surface. The potential of a contact is then continuous across the edge;
//  - a contact point behind a nearer surface does not count.
// Where triangles of several groups are equally near, the contact is with the one whose normal has the
// smallest angle with that of the contact, and else with the first group, whatever the order of the
// triangles.
//
// Leaves near a point are found in a grid of cells in the frame of the cavity, which is built once. In a cell
// near which the space of the particles is convex, between planes that meet at 120 degrees or less, the
// planes take the place of all triangles: the foot of a particle on such a plane is on the surface, since
//  - the space near the cell is what is below all planes: a straight line that leaves it crosses a triangle,
//    and one that does not leave it crosses none, because all triangles are below all planes;
//  - the foot is below the other planes, unless the centre is nearer to one of them than half of its radius.
// Such a plane is one more wall (Cavity::walls) and one more leaf, however many triangles of a group lie in
// it. Where groups meet in one plane the triangles remain.
#pragma once

#include <memory>

#include "dem/triangles.hpp"
#include "dem/walls.hpp"

namespace rattlebox::dem {

// A body or a surface, in coordinates relative to the centre of its cavity.
struct Solid {
    enum Form : int { rod = 0, plate = 1, ball = 2, mesh = 3 };
    Form form = ball;
    int wall = 0;  // index in Cavity::walls; that of the first group
    Row centre{};  // of a body
    Row axis[3]{}; // unit vectors; the third is along a rod
    Row size{};    // half of the edges of a plate; radius and half of the length of a rod; radius of a ball
    real smooth = 0.9; // cosine of the largest angle between the normals at a smooth edge
    std::shared_ptr<const Triangles> triangles;
    std::vector<int> group; // by triangle; empty if there is one

    int group_of(int face) const { return group.empty() ? 0 : group[static_cast<std::size_t>(face)]; }
    int leaves() const { return form == mesh ? triangles->faces() : 1; }

    Row local(Row p) const {
        const Row q = p - centre;
        return row(dot(q, axis[0]), dot(q, axis[1]), dot(q, axis[2]));
    }
    Row global(Row v) const { return axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]; }

    // Direction from a position to the nearest point of a body, and the distance, which is negative inside.
    WallPoint nearest_on_body(Row p) const {
        if (form == ball) {
            const Row q = centre - p;
            const real apart = length(q);
            return {q / (apart + 1e-290), apart - size[0]};
        }
        const Row q = local(p);
        if (form == rod) {
            const real radial = std::sqrt(q[0] * q[0] + q[1] * q[1]);
            const Row inward = row(-q[0], -q[1], 0) / (radial + 1e-290);
            const real side = radial - size[0], end = std::fabs(q[2]) - size[1], up = q[2] > 0 ? -1 : 1;
            if (side > 0 && end > 0) {
                const real apart = std::sqrt(side * side + end * end);
                return {global((inward * side + row(0, 0, up * end)) / apart), apart};
            }
            return side > end ? WallPoint{global(inward), side} : WallPoint{global(row(0, 0, up)), end};
        }
        Row apart{}, direction{};
        real squared = 0;
        int nearest = 0;
        for (int a = 0; a < 3; ++a) {
            apart[a] = std::fabs(q[a]) - size[a];
            direction[a] = q[a] > 0 ? -1 : 1;
            if (apart[a] > 0) squared += apart[a] * apart[a];
            if (apart[a] > apart[nearest]) nearest = a;
        }
        if (squared > square(apart[nearest]) && apart[nearest] > 0) { // an edge or a corner
            const real distance = std::sqrt(squared);
            for (int a = 0; a < 3; ++a) apart[a] = apart[a] > 0 ? direction[a] * apart[a] / distance : 0;
            return {global(apart), distance};
        }
        return {axis[nearest] * direction[nearest], apart[nearest]};
    }

    // Distance of a position from the surface, positive on the side of the particles, and the nearest group.
    std::pair<real, int> nearest_group(Row p) const {
        if (form != mesh) return {nearest_on_body(p).distance, 0};
        const auto [face, point] = triangles->nearest(p);
        return {triangles->signed_distance(p, face, point), group_of(face)};
    }
    real signed_distance(Row p) const { return nearest_group(p).first; }

    // Half of the edges of the bounding box around the centre of a body.
    Row reach() const {
        const Row half = form == plate ? size
                         : form == rod ? row(size[0], size[0], size[1])
                                       : row(size[0], size[0], size[0]);
        Row sum{};
        for (int a = 0; a < 3; ++a)
            for (int k = 0; k < 3; ++k)
                sum[k] += std::fabs((form == ball ? real(a == k) : axis[a][k])) * half[a];
        return sum;
    }
    Row low() const { return form == mesh ? triangles->low() : centre - reach(); }
    Row high() const { return form == mesh ? triangles->high() : centre + reach(); }
};

// The nearest point of one leaf to a particle.
struct LeafPoint {
    int leaf = 0, candidate = 0; // number of the leaf, and in the list of a chunk
    Row near{};                  // outward normal, and the distance
    Row place{};
    int region = Triangles::on_face;
    bool counts = false; // whether it is a contact
};

class Solids {
    // Cells of the grid along an axis, at most; the mean number of leaves per cell matters more.
    static constexpr int most_cells = 40;

    std::vector<Solid> solids_;
    std::vector<int> solid_, face_; // by leaf
    int plain_ = 0;                 // plain walls, which have the leaves before

    // By leaf: the plane of a triangle, zero for a body, and the planes that take the place of triangles.
    std::vector<Row> planes_;
    std::vector<int> plane_leaf_; // by leaf of a solid: that of the plane that takes its place, or -1
    int first_plane_wall_ = 0;

    // The grid: leaves within `reach_` of any point of a cell, ascending, or their planes.
    Row origin_{};
    real width_ = 1, reach_ = 0;
    int cells_[3] = {};
    std::vector<int> begin_, listed_;
    std::vector<real> apart_;      // distance of a listed leaf from the middle of the cell; 0 for planes
    std::vector<real> clearance_;  // the smallest of them, by cell; infinite without leaves
    std::vector<char> solid_cell_; // whether the middle of a cell is outside of the space of particles
    bool encloses_ = false;        // whether a surface is the cavity itself

    const Solid& solid_of(int leaf) const { return solids_[static_cast<std::size_t>(solid_[index(leaf)])]; }
    std::size_t index(int leaf) const { return static_cast<std::size_t>(leaf - plain_); }
    int group_of(int leaf) const { return solid_of(leaf).group_of(face_[index(leaf)]); }

    Row middle(int x, int y, int z) const { return origin_ + row(x + 0.5, y + 0.5, z + 0.5) * width_; }
    int cell_index(int x, int y, int z) const { return (z * cells_[1] + y) * cells_[0] + x; }

    // Whether the straight line from the centre of a particle to a contact point is blocked by another leaf.
    bool hides(const LeafPoint& nearer, Row c, const LeafPoint& other, real tolerance) const {
        const Solid &one = solid_of(nearer.leaf), &two = solid_of(other.leaf);
        if (one.form == Solid::mesh) {
            const int f = face_[index(nearer.leaf)];
            if (&one == &two && one.triangles->share_corner(f, face_[index(other.leaf)])) return false;
            return one.triangles->crosses(f, c, other.place);
        }
        // Sphere tracing: a step as long as the distance from the body cannot pass through it.
        const Row along = other.place - c;
        const real whole = length(along);
        real gone = 0;
        for (int step = 0; step < 64 && gone < whole; ++step) {
            const real free = one.nearest_on_body(c + along * (gone / whole)).distance;
            if (free <= tolerance) return true;
            gone += free;
        }
        return one.nearest_on_body(other.place).distance <= tolerance;
    }

    // Among the triangles of one surface that are equally near to a particle, moves the contact to that of
    // the group which does not depend on rounding.
    void choose_group(LeafPoint* points, int count, int contact, real tolerance) const {
        const LeafPoint& p = points[contact];
        const Solid& solid = solid_of(p.leaf);
        const Triangles& t = *solid.triangles;
        const int f = face_[index(p.leaf)];
        const auto along = [&](const LeafPoint& q) { return dot(q.near, t.normal(face_[index(q.leaf)])); };
        int best = contact;
        for (int k = 0; k < count; ++k) {
            const LeafPoint& q = points[k];
            if (q.counts || &solid_of(q.leaf) != &solid || group_of(q.leaf) == group_of(p.leaf)) continue;
            const int g = face_[index(q.leaf)];
            const Row apart = q.place - p.place;
            const bool same_point = dot(apart, apart) < square(tolerance),
                       same_curve = t.share_corner(f, g) && dot(t.plane(f), t.plane(g)) > solid.smooth &&
                                    q.region == Triangles::on_face && p.region == Triangles::on_face;
            if (!(same_point || same_curve) || std::fabs(q.near[3] - p.near[3]) > tolerance) continue;
            const real gain = along(q) - along(points[best]);
            if (gain > 1e-9 || (gain > -1e-9 && group_of(q.leaf) < group_of(points[best].leaf))) best = k;
        }
        std::swap(points[contact].counts, points[best].counts);
    }

public:
    // Adds a solid; walls are added before.
    void add(Solid solid, int plain_walls, bool encloses) {
        plain_ = plain_walls;
        for (int f = 0; f < solid.leaves(); ++f) {
            solid_.push_back(static_cast<int>(solids_.size())), face_.push_back(f);
            planes_.push_back(solid.form == Solid::mesh ? solid.triangles->plane(f) : Row{});
        }
        solids_.push_back(std::move(solid));
        encloses_ |= encloses;
    }

    bool empty() const { return solids_.empty(); }
    int first_plane() const { return plain_ + static_cast<int>(solid_.size()); }
    int leaves() const { return plain_ + static_cast<int>(planes_.size()); }
    int plain_walls() const { return plain_; }
    int wall_of(int leaf) const {
        if (leaf >= first_plane()) return first_plane_wall_ + leaf - first_plane();
        return leaf < plain_ ? leaf : solid_of(leaf).wall + group_of(leaf);
    }
    // Whether one leaf is a triangle and the other one the plane that takes its place elsewhere.
    bool is_in_place_of(int one, int other) const {
        if (one > other) std::swap(one, other);
        return one >= plain_ && one < first_plane() && plane_leaf_[index(one)] == other;
    }
    const std::vector<Solid>& solids() const { return solids_; }
    std::size_t memory() const {
        return (begin_.capacity() + listed_.capacity() + solid_.capacity() + face_.capacity() +
                plane_leaf_.capacity()) *
                   sizeof(int) +
               planes_.capacity() * sizeof(Row) + (apart_.capacity() + clearance_.capacity()) * sizeof(real);
    }

    // Whether a triangle is beyond reach because its plane is, which costs less than its nearest point.
    bool is_beyond(int leaf, Row c, real reach) const {
        const Row plane = planes_[index(leaf)];
        return std::fabs(plane[3] - dot(plane, c)) > reach;
    }

    LeafPoint nearest_on(int leaf, Row c) const {
        const Solid& solid = solid_of(leaf);
        LeafPoint point;
        point.leaf = leaf;
        if (solid.form != Solid::mesh) {
            const WallPoint near = solid.nearest_on_body(c);
            point.near = near.normal * row(1, 1, 1, 0);
            point.near[3] = near.distance;
            point.place = c + near.normal * near.distance;
            return point;
        }
        const int f = face_[index(leaf)];
        const Triangles::Point p = solid.triangles->nearest_on(f, c);
        point.place = p.place, point.region = p.region;
        if (p.region == Triangles::on_face) {
            // As for a plane, so that flat faces have the bits of one.
            const Row plane = solid.triangles->plane(f);
            point.near = row(plane[0], plane[1], plane[2], plane[3] - dot(plane, c));
        } else {
            const Row apart = p.place - c;
            const real distance = length(apart);
            point.near = apart / (distance + 1e-290);
            point.near[3] = distance;
        }
        return point;
    }

    // Distance by which the leaves near a particle are compared.
    real distance(const LeafPoint& p) const {
        return solid_of(p.leaf).form == Solid::mesh ? std::fabs(p.near[3]) : p.near[3];
    }

    // Marks which of the leaves near a particle are its contacts. `points` are all leaves that touch it; they
    // are sorted by their distance.
    void select(Row c, real radius, const std::vector<Wall>& walls, LeafPoint* points, int count) const {
        const auto before = [&](const LeafPoint& a, const LeafPoint& b) {
            const real one = distance(a), other = distance(b);
            return one != other ? one < other : a.leaf < b.leaf;
        };
        if (count > 1) std::sort(points, points + count, before);
        const real tolerance = 1e-9 * radius;
        for (int b = 0; b < count; ++b) {
            LeafPoint& p = points[b];
            const Solid& own = solid_of(p.leaf);
            const int f = face_[index(p.leaf)];
            // A triangle that faces away from the particle is the other side of a thin body.
            bool counts = own.form != Solid::mesh || p.near[3] >= 0;
            for (int a = 0; counts && a < b; ++a) {
                const LeafPoint& nearer = points[a];
                const Solid& other = solid_of(nearer.leaf);
                if (&own == &other && own.form == Solid::mesh) {
                    const int g = face_[index(nearer.leaf)];
                    const Triangles& t = *own.triangles;
                    if (t.has_feature(g, f, p.region)) counts = false;
                    if (t.share_corner(f, g) && dot(t.plane(f), t.plane(g)) > own.smooth) counts = false;
                }
                const Row apart = p.place - nearer.place;
                if (dot(apart, apart) < square(tolerance)) counts = false;
                if (counts) counts = !hides(nearer, c, p, tolerance);
            }
            for (int w = 0; counts && w < plain_; ++w)
                counts =
                    nearest_wall_point(walls[static_cast<std::size_t>(w)], p.place).distance >= -tolerance;
            p.counts = counts;
        }
        for (int b = 0; b < count; ++b)
            if (points[b].counts && !solid_of(points[b].leaf).group.empty())
                choose_group(points, count, b, tolerance);
    }

    // Whether the springs of a contact move to another one: the surface has gone on smoothly.
    bool continues(const LeafPoint& from, const LeafPoint& to) const {
        const Solid &one = solid_of(from.leaf), &other = solid_of(to.leaf);
        if (one.form != Solid::mesh && &one == &other) return false;
        return dot(from.near, to.near) > std::fmin(one.smooth, other.smooth);
    }

    // ---- the grid

    // Builds the grid for particles of these radii, and gaps up to `skin`. Planes are added to the walls.
    void build(real smallest, real largest, real skin, std::vector<Wall>& walls) {
        Row low = row(infinity), high = -low;
        for (const Solid& solid : solids_) {
            const Row l = solid.low(), h = solid.high();
            low = l < low ? l : low, high = h > high ? h : high;
        }
        reach_ = largest + skin;
        low -= row(reach_), high += row(reach_);
        const Row extent = high - low;
        const real longest = std::fmax(extent[0], std::fmax(extent[1], extent[2]));
        width_ = std::fmax(0.5 * smallest, longest / most_cells);
        origin_ = low;
        for (int a = 0; a < 3; ++a) cells_[a] = std::max(1, static_cast<int>(std::ceil(extent[a] / width_)));
        const std::size_t count = static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                                  static_cast<std::size_t>(cells_[2]);
        const real half = 0.5 * std::sqrt(3.0) * width_, within = (reach_ + half) * (1 + 1e-9);
        std::vector<int> number(count + 1, 0);
        struct Pair {
            int cell, leaf;
            real apart;
        };
        std::vector<Pair> pairs;
        for (int leaf = plain_; leaf < first_plane(); ++leaf) {
            const Solid& solid = solid_of(leaf);
            Row l = solid.low(), h = solid.high();
            if (solid.form == Solid::mesh) {
                const int f = face_[index(leaf)];
                l = row(infinity), h = -l;
                for (int k = 0; k < 3; ++k) {
                    const Row v = solid.triangles->corner(f, k);
                    l = v < l ? v : l, h = v > h ? v : h;
                }
            }
            int from[3], until[3];
            for (int a = 0; a < 3; ++a) {
                const auto cell = [&](real x) {
                    const real at = std::floor((x - origin_[a]) / width_);
                    return static_cast<int>(std::fmin(std::fmax(at, 0.0), cells_[a] - 1.0));
                };
                from[a] = cell(l[a] - within), until[a] = cell(h[a] + within);
            }
            for (int z = from[2]; z <= until[2]; ++z)
                for (int y = from[1]; y <= until[1]; ++y)
                    for (int x = from[0]; x <= until[0]; ++x) {
                        const Row m = middle(x, y, z);
                        const real apart = distance(nearest_on(leaf, m));
                        if (apart < within) pairs.push_back({cell_index(x, y, z), leaf, apart});
                    }
        }
        for (const Pair& pair : pairs) ++number[static_cast<std::size_t>(pair.cell) + 1];
        std::partial_sum(number.begin(), number.end(), number.begin());
        begin_ = number;
        listed_.resize(pairs.size()), apart_.resize(pairs.size());
        clearance_.assign(count, infinity);
        for (const Pair& pair : pairs) {
            const auto cell = static_cast<std::size_t>(pair.cell);
            const auto k = static_cast<std::size_t>(number[cell]++);
            listed_[k] = pair.leaf, apart_[k] = pair.apart;
            clearance_[cell] = std::fmin(clearance_[cell], pair.apart);
        }
        replace_by_planes(within, 1e-9 * smallest, walls);
        solid_cell_.assign(count, 0);
        for (int z = 0; z < cells_[2]; ++z)
            for (int y = 0; y < cells_[1]; ++y)
                for (int x = 0; x < cells_[0]; ++x) {
                    const auto cell = static_cast<std::size_t>(cell_index(x, y, z));
                    // No surface is between two cells if one is farther from it than from the other.
                    const bool same = x > 0 && std::fmax(clearance_[cell], clearance_[cell - 1]) > width_;
                    solid_cell_[cell] = same ? solid_cell_[cell - 1] : depth(middle(x, y, z)) < 0;
                }
    }

private:
    // Lists planes in place of triangles in the cells near which the space of the particles is convex. The
    // triangles of a cell are those within a distance of its middle.
    void replace_by_planes(real within, real tolerance, std::vector<Wall>& walls) {
        std::vector<int> flat; // by leaf: that of the largest triangle in its plane
        for (const Solid& solid : solids_) {
            const int first = plain_ + static_cast<int>(flat.size());
            if (solid.form == Solid::mesh)
                for (const int f : solid.triangles->flats(tolerance, [&](int one, int other) {
                         return solid.group_of(one) == solid.group_of(other);
                     }))
                    flat.push_back(first + f);
            else
                flat.push_back(first);
        }
        plane_leaf_.assign(solid_.size(), -1);
        first_plane_wall_ = static_cast<int>(walls.size());
        std::vector<int> begin{0}, listed, found;
        std::vector<real> apart;
        for (int z = 0; z < cells_[2]; ++z)
            for (int y = 0; y < cells_[1]; ++y)
                for (int x = 0; x < cells_[0]; ++x) {
                    const auto cell = static_cast<std::size_t>(cell_index(x, y, z));
                    const int from = begin_[cell], until = begin_[cell + 1];
                    bool convex = find_convex_planes(from, until, flat, tolerance, found);
                    // A contact point beyond a plain wall would not count.
                    for (int w = 0; convex && w < plain_; ++w)
                        convex =
                            nearest_wall_point(walls[static_cast<std::size_t>(w)], middle(x, y, z)).distance >
                            within;
                    if (convex) {
                        for (int& leaf : found) leaf = plane_of(leaf, walls);
                        std::sort(found.begin(), found.end());
                        listed.insert(listed.end(), found.begin(), found.end());
                        apart.resize(listed.size(), 0);
                    } else {
                        listed.insert(listed.end(), listed_.begin() + from, listed_.begin() + until);
                        apart.insert(apart.end(), apart_.begin() + from, apart_.begin() + until);
                    }
                    begin.push_back(static_cast<int>(listed.size()));
                }
        begin_.swap(begin), listed_.swap(listed), apart_.swap(apart);
        for (std::size_t k = 0; k < flat.size(); ++k) plane_leaf_[k] = plane_leaf_[index(flat[k])];
    }

    // Returns the leaf of the plane of a triangle, which becomes a wall when it is first asked for.
    int plane_of(int leaf, std::vector<Wall>& walls) {
        int& plane = plane_leaf_[index(leaf)];
        if (plane < 0) {
            const Solid& solid = solid_of(leaf);
            Wall wall = walls[static_cast<std::size_t>(wall_of(leaf))];
            wall.form = Wall::plane, wall.axis = solid.triangles->plane(face_[index(leaf)]);
            plane = leaves();
            planes_.push_back(wall.axis), walls.push_back(wall);
        }
        return plane;
    }

    // Whether listed leaves are triangles of one surface, each below the planes of all others, and no two
    // planes meet at more than 120 degrees or smoothly. `found` is the largest triangle of each plane.
    bool find_convex_planes(int from, int until, const std::vector<int>& flat, real tolerance,
                            std::vector<int>& found) const {
        found.clear();
        if (from == until) return false;
        const Solid& solid = solid_of(listed_[static_cast<std::size_t>(from)]);
        if (solid.form != Solid::mesh) return false;
        const Triangles& t = *solid.triangles;
        const real most = std::fmin(0.5, solid.smooth) + 1e-9;
        for (int k = from; k < until; ++k) {
            const int leaf = listed_[static_cast<std::size_t>(k)], seed = flat[index(leaf)];
            if (&solid_of(leaf) != &solid) return false;
            if (std::find(found.begin(), found.end(), seed) != found.end()) continue;
            for (const int other : found)
                if (dot(t.plane(face_[index(seed)]), t.plane(face_[index(other)])) > most) return false;
            found.push_back(seed);
        }
        for (int k = from; k < until; ++k)
            for (const int seed : found)
                for (int corner = 0; corner < 3; ++corner)
                    if (t.above(face_[index(seed)],
                                t.corner(face_[index(listed_[static_cast<std::size_t>(k)])], corner)) >
                        tolerance)
                        return false;
        return true;
    }

public:
    // Smallest distance of a point from the surfaces, positive where particles may be.
    real depth(Row c) const {
        real least = infinity;
        for (const Solid& solid : solids_) least = std::fmin(least, solid.signed_distance(c));
        return least;
    }

    // Calls f(leaf, distance) for the leaves within `reach` of a particle, ascending, and returns the wall
    // outside of which its centre is, or -1. `reach` is at most the sum of largest radius and skin of the
    // grid.
    template <class F> int near(Row c, real reach, F&& f) const {
        int cell[3];
        for (int a = 0; a < 3; ++a) {
            const real at = (c[a] - origin_[a]) / width_;
            if (!(at >= 0 && at < cells_[a])) return encloses_ ? solids_[0].wall : -1;
            cell[a] = static_cast<int>(at);
        }
        const auto here = static_cast<std::size_t>(cell_index(cell[0], cell[1], cell[2]));
        const int from = begin_[here], until = begin_[here + 1];
        if (from == until) return solid_cell_[here] ? wall_around(c) : -1;
        if (listed_[static_cast<std::size_t>(from)] >= first_plane()) {
            bool below = true;
            for (int k = from; k < until; ++k) {
                const int leaf = listed_[static_cast<std::size_t>(k)];
                const Row plane = planes_[index(leaf)];
                const real far = plane[3] - dot(plane, c);
                below &= far > 0;
                if (far < reach) f(leaf, far);
            }
            return below ? -1 : wall_around(c);
        }
        const real off = length(c - middle(cell[0], cell[1], cell[2])) * (1 + 1e-9),
                   clearance = clearance_[here];
        // The particle is on the side of the middle of its cell if no surface is as near to that.
        const bool same = clearance > off;
        if (clearance > reach + off) return solid_cell_[here] ? wall_around(c) : -1;
        bool inside = true;          // as far as the leaves within reach show it
        const Solid* mesh = nullptr; // whose triangles are being compared
        LeafPoint nearest;
        real least = infinity;
        const auto finish = [&] {
            if (!mesh || same) return;
            const int face = face_[index(nearest.leaf)];
            inside &= least < reach * reach &&
                      mesh->triangles->signed_distance(c, face, {nearest.place, nearest.region}) > 0;
        };
        for (int k = from; k < until; ++k) {
            if (apart_[static_cast<std::size_t>(k)] > reach + off) continue;
            const int leaf = listed_[static_cast<std::size_t>(k)];
            if (is_beyond(leaf, c, reach)) continue;
            const Solid& solid = solid_of(leaf);
            const LeafPoint p = nearest_on(leaf, c);
            if (solid.form != Solid::mesh) {
                inside &= p.near[3] > 0;
                if (p.near[3] < reach) f(leaf, p.near[3]);
                continue;
            }
            const Row apart = p.place - c;
            const real squared = dot(apart, apart);
            if (squared < reach * reach) f(leaf, std::sqrt(squared));
            if (mesh != &solid) finish(), mesh = &solid, least = infinity;
            if (squared < least) least = squared, nearest = p;
        }
        finish();
        return (same ? !solid_cell_[here] : inside) ? -1 : wall_around(c);
    }

    int wall_around(Row c) const {
        for (const Solid& solid : solids_)
            if (solid.signed_distance(c) < 0) return solid.wall;
        return -1;
    }
};

} // namespace rattlebox::dem
