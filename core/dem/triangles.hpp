// A closed surface of triangles: nearest points, on which side of it a point is, and the triangles near a
// point, from a hierarchy of bounding boxes that is built once.
//
// The side of a point is the sign of its component along the pseudonormal of the nearest feature: the normal
// of a face, the sum of the two normals at an edge, or the sum of the normals at a corner, weighted by the
// angles of the triangles there. J. A. Bærentzen, H. Aanæs, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243,
// doi:10.1109/TVCG.2005.49. The nearest point of a triangle follows C. Ericson, Real-Time Collision Detection
// (2005), section 5.1.5.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "math/rows.hpp"

namespace rattlebox::dem {

inline real length(Row r) { return std::sqrt(dot(r, r)); }

class Triangles {
    struct Node {
        Row low, high;
        int first = 0, count = 0; // triangles of a leaf, in `order_`
        int right = 0;            // index of the second child; the first follows its parent
    };
    static constexpr int leaf_size = 4;

    std::vector<Row> vertex_;
    std::vector<std::array<int, 3>> face_, edge_; // numbers of the corners, and of the edges behind them
    std::vector<Row> plane_;                      // outward normal, and its component along a corner
    std::vector<Row> edge_normal_, vertex_normal_;
    std::vector<Node> nodes_;
    std::vector<int> order_;

    static Row to_row(const real* v) { return row(v[0], v[1], v[2]); }

    void find_edges() {
        struct Side {
            std::uint64_t ends;
            int face, number;
        };
        std::vector<Side> sides;
        sides.reserve(3 * face_.size());
        for (int f = 0; f < faces(); ++f)
            for (int k = 0; k < 3; ++k) {
                const auto [a, b] = std::minmax({corner_number(f, k), corner_number(f, (k + 1) % 3)});
                sides.push_back({static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b), f, k});
            }
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return a.ends != b.ends ? a.ends < b.ends : a.face < b.face;
        });
        edge_.resize(face_.size());
        std::uint64_t ends = ~std::uint64_t{0};
        for (const Side& side : sides) {
            if (side.ends != ends) edge_normal_.push_back(Row{}), ends = side.ends;
            edge_[static_cast<std::size_t>(side.face)][static_cast<std::size_t>(side.number)] =
                static_cast<int>(edge_normal_.size()) - 1;
            edge_normal_.back() += normal(side.face);
        }
    }

    void find_vertex_normals() {
        vertex_normal_.assign(vertex_.size(), Row{});
        for (int f = 0; f < faces(); ++f)
            for (int k = 0; k < 3; ++k) {
                const Row at = corner(f, k), one = corner(f, (k + 1) % 3) - at,
                          other = corner(f, (k + 2) % 3) - at;
                const real angle = std::atan2(length(cross(one, other)), dot(one, other));
                vertex_normal_[static_cast<std::size_t>(corner_number(f, k))] += normal(f) * angle;
            }
    }

    Row centre(int f) const { return corner(f, 0) + corner(f, 1) + corner(f, 2); }

    int build(int first, int until) {
        const int here = static_cast<int>(nodes_.size());
        nodes_.emplace_back();
        Row low = row(infinity), high = -low, least = low, most = high;
        for (int i = first; i < until; ++i) {
            const int f = order_[static_cast<std::size_t>(i)];
            for (int k = 0; k < 3; ++k) {
                const Row v = corner(f, k);
                low = v < low ? v : low, high = v > high ? v : high;
            }
            const Row c = centre(f);
            least = c < least ? c : least, most = c > most ? c : most;
        }
        int right = 0;
        if (until - first > leaf_size) {
            const Row width = most - least;
            int axis = width[1] > width[0] ? 1 : 0;
            if (width[2] > width[axis]) axis = 2;
            const int middle = (first + until) / 2;
            std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + until,
                             [&](int a, int b) {
                                 const real x = centre(a)[axis], y = centre(b)[axis];
                                 return x != y ? x < y : a < b;
                             });
            build(first, middle);
            right = build(middle, until);
        }
        Node& node = nodes_[static_cast<std::size_t>(here)];
        node.low = low, node.high = high, node.right = right;
        node.first = first, node.count = right ? 0 : until - first;
        return here;
    }

    static real squared_distance(const Node& node, Row c) {
        const Row below = node.low - c, above = c - node.high, zero{};
        const Row outside = below > above ? below : above, apart = outside > zero ? outside : zero;
        return dot(apart, apart);
    }

    // Calls f(triangle) in the boxes whose squared distance is at most `limit`, which f may lower.
    template <class F> void visit(Row c, const real& limit, F&& f) const {
        int stack[64], depth = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
            if (squared_distance(node, c) > limit) continue;
            if (node.right == 0) {
                for (int i = node.first; i < node.first + node.count; ++i)
                    f(order_[static_cast<std::size_t>(i)]);
                continue;
            }
            const int left = static_cast<int>(&node - nodes_.data()) + 1, right = node.right;
            // The nearer box is visited first.
            const bool nearer = squared_distance(nodes_[static_cast<std::size_t>(left)], c) <=
                                squared_distance(nodes_[static_cast<std::size_t>(right)], c);
            stack[depth++] = nearer ? right : left;
            stack[depth++] = nearer ? left : right;
        }
    }

public:
    // The feature on which a nearest point lies: the face, or the edge or corner k of its triangle.
    enum Region : int { on_face = 0, on_edge = 1, on_corner = 4 };
    struct Point {
        Row place{};
        int region = on_face;
    };

    Triangles() = default;

    // Corners in counter-clockwise order as seen from outside, so that normals point out of the space in
    // which particles move. Triangles must have an area.
    Triangles(const real* vertices, std::size_t vertex_count, const std::int64_t* faces,
              std::size_t face_count) {
        for (std::size_t i = 0; i < vertex_count; ++i) vertex_.push_back(to_row(vertices + 3 * i));
        for (std::size_t i = 0; i < face_count; ++i)
            face_.push_back({static_cast<int>(faces[3 * i]), static_cast<int>(faces[3 * i + 1]),
                             static_cast<int>(faces[3 * i + 2])});
        for (int f = 0; f < this->faces(); ++f) {
            Row n = cross(corner(f, 1) - corner(f, 0), corner(f, 2) - corner(f, 0));
            n /= length(n);
            n[3] = dot(n, corner(f, 0));
            plane_.push_back(n);
        }
        find_edges();
        find_vertex_normals();
        order_.resize(face_count);
        std::iota(order_.begin(), order_.end(), 0);
        build(0, static_cast<int>(face_count));
    }

    int faces() const { return static_cast<int>(face_.size()); }
    Row low() const { return nodes_[0].low; }
    Row high() const { return nodes_[0].high; }
    int corner_number(int f, int k) const {
        return face_[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)];
    }
    Row corner(int f, int k) const { return vertex_[static_cast<std::size_t>(corner_number(f, k))]; }
    int edge_number(int f, int k) const {
        return edge_[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)];
    }
    Row plane(int f) const { return plane_[static_cast<std::size_t>(f)]; }
    Row normal(int f) const { return plane(f) * row(1, 1, 1, 0); }

    bool share_corner(int f, int g) const {
        for (int k = 0; k < 3; ++k)
            if (has_corner(g, corner_number(f, k))) return true;
        return false;
    }
    bool has_corner(int f, int vertex) const {
        const auto& c = face_[static_cast<std::size_t>(f)];
        return c[0] == vertex || c[1] == vertex || c[2] == vertex;
    }
    // Whether the feature of triangle f is also one of triangle g.
    bool has_feature(int g, int f, int region) const {
        if (region == on_face) return false;
        if (region >= on_corner) return has_corner(g, corner_number(f, region - on_corner));
        const auto& e = edge_[static_cast<std::size_t>(g)];
        const int number = edge_number(f, region - on_edge);
        return e[0] == number || e[1] == number || e[2] == number;
    }

    // Height of a point over the plane of a triangle, positive outside.
    real above(int f, Row p) const { return dot(plane(f), p) - plane(f)[3]; }

    // Returns for each triangle the largest one of its flat: of the triangles that are connected with it, lie
    // in one plane, to a tolerance, and are alike(one, other).
    template <class Alike> std::vector<int> flats(real tolerance, Alike&& alike) const {
        const auto count = face_.size();
        std::vector<std::array<int, 2>> beside(edge_normal_.size(), {-1, -1});
        std::vector<real> area(count);
        for (int f = 0; f < faces(); ++f) {
            area[static_cast<std::size_t>(f)] =
                length(cross(corner(f, 1) - corner(f, 0), corner(f, 2) - corner(f, 0)));
            for (const int e : edge_[static_cast<std::size_t>(f)]) {
                auto& sides = beside[static_cast<std::size_t>(e)];
                sides[sides[0] < 0 ? 0 : 1] = f;
            }
        }
        // The plane of the largest triangle has the smallest errors of rounding.
        std::vector<int> order(count), flat(count, -1), open;
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
            return area[static_cast<std::size_t>(a)] > area[static_cast<std::size_t>(b)];
        });
        for (const int seed : order) {
            const auto add = [&](int f) { flat[static_cast<std::size_t>(f)] = seed, open.push_back(f); };
            const auto is_part = [&](int f) {
                bool level = dot(plane(f), plane(seed)) > 0 && alike(f, seed);
                for (int k = 0; k < 3; ++k) level &= std::fabs(above(seed, corner(f, k))) <= tolerance;
                return level;
            };
            if (flat[static_cast<std::size_t>(seed)] < 0) add(seed);
            while (!open.empty()) {
                const int f = open.back();
                open.pop_back();
                for (const int e : edge_[static_cast<std::size_t>(f)])
                    for (const int g : beside[static_cast<std::size_t>(e)])
                        if (g >= 0 && flat[static_cast<std::size_t>(g)] < 0 && is_part(g)) add(g);
            }
        }
        return flat;
    }

    Row pseudonormal(int f, int region) const {
        if (region == on_face) return normal(f);
        if (region < on_corner)
            return edge_normal_[static_cast<std::size_t>(edge_number(f, region - on_edge))];
        return vertex_normal_[static_cast<std::size_t>(corner_number(f, region - on_corner))];
    }

    Point nearest_on(int f, Row p) const {
        const Row a = corner(f, 0), b = corner(f, 1), c = corner(f, 2), ab = b - a, ac = c - a, ap = p - a;
        const real d1 = dot(ab, ap), d2 = dot(ac, ap);
        if (d1 <= 0 && d2 <= 0) return {a, on_corner};
        const Row bp = p - b;
        const real d3 = dot(ab, bp), d4 = dot(ac, bp);
        if (d3 >= 0 && d4 <= d3) return {b, on_corner + 1};
        const real vc = d1 * d4 - d3 * d2;
        if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), on_edge};
        const Row cp = p - c;
        const real d5 = dot(ab, cp), d6 = dot(ac, cp);
        if (d6 >= 0 && d5 <= d6) return {c, on_corner + 2};
        const real vb = d5 * d2 - d1 * d6;
        if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), on_edge + 2};
        const real va = d3 * d6 - d5 * d4;
        if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
            return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), on_edge + 1};
        const Row n = plane(f);
        return {p + normal(f) * (n[3] - dot(n, p)), on_face};
    }

    // Calls f(triangle) for at least all triangles within `reach` of a point.
    template <class F> void within(Row c, real reach, F&& f) const {
        const real limit = reach * reach;
        visit(c, limit, std::forward<F>(f));
    }

    // Returns the nearest triangle to a point, and its nearest point.
    std::pair<int, Point> nearest(Row c) const {
        std::pair<int, Point> best{-1, {}};
        real limit = infinity;
        visit(c, limit, [&](int f) {
            const Point p = nearest_on(f, c);
            const real apart = dot(p.place - c, p.place - c);
            // At equal distances the lower number decides, whatever the order of the boxes.
            if (apart < limit || (apart == limit && f < best.first)) limit = apart, best = {f, p};
        });
        return best;
    }

    // Returns the distance of a point with its nearest point: positive on the side of the particles.
    real signed_distance(Row c, int f, const Point& p) const {
        const Row apart = p.place - c;
        const real distance = length(apart);
        return dot(apart, pseudonormal(f, p.region)) < 0 ? -distance : distance;
    }

    // Returns pairs of triangles that cross each other, `most` at most. Triangles that only share a corner or
    // an edge do not cross; neither do those in one plane.
    std::vector<std::array<int, 2>> crossings(std::size_t most) const {
        std::vector<std::array<int, 2>> pairs;
        const auto has_crossing_edge = [&](int f, int g) { // an edge of f, away from the corners of g
            for (int k = 0; k < 3; ++k)
                if (!has_corner(g, corner_number(f, k)) && !has_corner(g, corner_number(f, (k + 1) % 3)) &&
                    crosses(g, corner(f, k), corner(f, (k + 1) % 3)))
                    return true;
            return false;
        };
        for (int f = 0; f < faces() && pairs.size() < most; ++f) {
            const Row middle = centre(f) / 3.0;
            real reach = 0;
            for (int k = 0; k < 3; ++k) reach = std::fmax(reach, length(corner(f, k) - middle));
            within(middle, reach, [&](int g) {
                if (g > f && pairs.size() < most && (has_crossing_edge(f, g) || has_crossing_edge(g, f)))
                    pairs.push_back({f, g});
            });
        }
        return pairs;
    }

    // Whether the straight line from a to b crosses a triangle, its ends not counted (T. Möller,
    // B. Trumbore, J. Graph. Tools 2 (1997) 21, doi:10.1080/10867651.1997.10487468).
    bool crosses(int f, Row a, Row b) const {
        const Row o = corner(f, 0), one = corner(f, 1) - o, other = corner(f, 2) - o, along = b - a;
        const Row h = cross(along, other);
        const real det = dot(one, h);
        // A line in the plane of the triangle does not cross it.
        if (square(det) <= 1e-18 * dot(one, one) * dot(other, other) * dot(along, along)) return false;
        const Row s = a - o, q = cross(s, one);
        const real u = dot(s, h) / det, v = dot(along, q) / det, t = dot(other, q) / det;
        return u >= 0 && v >= 0 && u + v <= 1 && t > 1e-9 && t < 1 - 1e-9;
    }
};

} // namespace rattlebox::dem
