// Surfaces of a cavity that are no plain walls: rods, plates and balls inside, and closed surfaces of
// triangles, which are cavities or bodies. Each is one wall with a name; its leaves, the body or each of its
// triangles, are what a particle can touch.
//
// A particle has one contact for each distinct point at which its distance from the surfaces has a local
// minimum:
//  - of the triangles that share an edge or a corner, only the nearest counts where the nearest point lies on
//    that edge or corner; so edges and corners that stick out are touched once, and coplanar edges not at
//    all;
//  - where two triangles meet at a smooth edge, only the nearest of them counts: facets of a curved surface
//    act as one surface. The potential of a contact is then continuous across the edge;
//  - a contact point behind a nearer surface does not count.
//
// Leaves near a point are found in a grid of cells in the frame of the cavity, which is built once.
#pragma once

#include <memory>

#include "dem/triangles.hpp"
#include "dem/walls.hpp"

namespace rattlebox::dem {

// A body or a surface, in coordinates relative to the centre of its cavity.
struct Solid {
    enum Form : int { rod = 0, plate = 1, ball = 2, mesh = 3 };
    Form form = ball;
    int wall = 0;  // index in Cavity::walls
    Row centre{};  // of a body
    Row axis[3]{}; // unit vectors; the third is along a rod
    Row size{};    // half of the edges of a plate; radius and half of the length of a rod; radius of a ball
    real smooth = 0.9; // cosine of the largest angle between the normals at a smooth edge
    std::shared_ptr<const Triangles> triangles;

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

    // Distance of a position from the surface, positive on the side of the particles.
    real signed_distance(Row p) const {
        if (form != mesh) return nearest_on_body(p).distance;
        const auto [face, point] = triangles->nearest(p);
        return triangles->signed_distance(p, face, point);
    }

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
    int leaf = 0;
    Row near{}; // outward normal, and the distance
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

    // The grid: leaves within `reach_` of any point of a cell, ascending.
    Row origin_{};
    real width_ = 1, reach_ = 0;
    int cells_[3] = {};
    std::vector<int> begin_, listed_;
    std::vector<real> apart_;      // distance of a listed leaf from the middle of the cell
    std::vector<real> clearance_;  // the smallest of them, by cell; infinite without leaves
    std::vector<char> solid_cell_; // whether the middle of a cell is outside of the space of particles
    bool encloses_ = false;        // whether a surface is the cavity itself

    const Solid& solid_of(int leaf) const { return solids_[static_cast<std::size_t>(solid_[index(leaf)])]; }
    std::size_t index(int leaf) const { return static_cast<std::size_t>(leaf - plain_); }

    // Distance by which the leaves near a particle are compared.
    real distance(const LeafPoint& p) const {
        return solid_of(p.leaf).form == Solid::mesh ? std::fabs(p.near[3]) : p.near[3];
    }

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

public:
    // Adds a solid; walls are added before.
    void add(Solid solid, int plain_walls, bool encloses) {
        plain_ = plain_walls;
        for (int f = 0; f < solid.leaves(); ++f)
            solid_.push_back(static_cast<int>(solids_.size())), face_.push_back(f);
        solids_.push_back(std::move(solid));
        encloses_ |= encloses;
    }

    bool empty() const { return solids_.empty(); }
    int leaves() const { return plain_ + static_cast<int>(solid_.size()); }
    int plain_walls() const { return plain_; }
    int wall_of(int leaf) const { return leaf < plain_ ? leaf : solid_of(leaf).wall; }
    const std::vector<Solid>& solids() const { return solids_; }
    std::size_t memory() const {
        return (begin_.capacity() + listed_.capacity() + solid_.capacity() + face_.capacity()) * sizeof(int) +
               (apart_.capacity() + clearance_.capacity()) * sizeof(real);
    }

    // Whether a triangle is beyond reach because its plane is, which costs less than its nearest point.
    bool is_beyond(int leaf, Row c, real reach) const {
        const Solid& solid = solid_of(leaf);
        if (solid.form != Solid::mesh) return false;
        const Row plane = solid.triangles->plane(face_[index(leaf)]);
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

    // Marks which of the leaves near a particle are its contacts. `points` are all leaves that may touch it.
    void select(Row c, real radius, const std::vector<Wall>& walls, LeafPoint* points, int count) const {
        thread_local std::vector<int> order;
        order.clear();
        for (int k = 0; k < count; ++k) {
            points[k].counts = false;
            if (distance(points[k]) < radius) order.push_back(k);
        }
        if (order.empty()) return;
        const auto before = [&](int a, int b) {
            const real one = distance(points[a]), other = distance(points[b]);
            return one != other ? one < other : points[a].leaf < points[b].leaf;
        };
        if (order.size() > 1) std::sort(order.begin(), order.end(), before);
        const real tolerance = 1e-9 * radius;
        for (std::size_t b = 0; b < order.size(); ++b) {
            LeafPoint& p = points[order[b]];
            const Solid& own = solid_of(p.leaf);
            const int f = face_[index(p.leaf)];
            // A triangle that faces away from the particle is the other side of a thin body.
            bool counts = own.form != Solid::mesh || p.near[3] >= 0;
            for (std::size_t a = 0; counts && a < b; ++a) {
                const LeafPoint& nearer = points[order[a]];
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
    }

    // Whether the springs of a contact move to another one: the surface has gone on smoothly.
    bool continues(const LeafPoint& from, const LeafPoint& to) const {
        const Solid &one = solid_of(from.leaf), &other = solid_of(to.leaf);
        if (one.form != Solid::mesh && &one == &other) return false;
        return dot(from.near, to.near) > std::fmin(one.smooth, other.smooth);
    }

    // ---- the grid

    // Builds the grid for particles of these radii, and gaps up to `skin`.
    void build(real smallest, real largest, real skin) {
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
        for (int leaf = plain_; leaf < leaves(); ++leaf) {
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

    // Smallest distance of a point from the surfaces, positive where particles may be.
    real depth(Row c) const {
        real least = infinity;
        for (const Solid& solid : solids_) least = std::fmin(least, solid.signed_distance(c));
        return least;
    }

    // Calls f(leaf) for the leaves within `reach` of a particle, ascending, and returns the wall outside of
    // which its centre is, or -1. `reach` is at most the sum of largest radius and skin of the grid.
    template <class F> int near(Row c, real reach, F&& f) const {
        int cell[3];
        for (int a = 0; a < 3; ++a) {
            const real at = (c[a] - origin_[a]) / width_;
            if (!(at >= 0 && at < cells_[a])) return encloses_ ? solids_[0].wall : -1;
            cell[a] = static_cast<int>(at);
        }
        const auto here = static_cast<std::size_t>(cell_index(cell[0], cell[1], cell[2]));
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
        for (int k = begin_[here]; k < begin_[here + 1]; ++k) {
            if (apart_[static_cast<std::size_t>(k)] > reach + off) continue;
            const int leaf = listed_[static_cast<std::size_t>(k)];
            if (is_beyond(leaf, c, reach)) continue;
            const Solid& solid = solid_of(leaf);
            const LeafPoint p = nearest_on(leaf, c);
            if (solid.form != Solid::mesh) {
                inside &= p.near[3] > 0;
                if (p.near[3] < reach) f(leaf);
                continue;
            }
            const Row apart = p.place - c;
            const real squared = dot(apart, apart);
            if (squared < reach * reach) f(leaf);
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
