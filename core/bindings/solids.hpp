// Binding of bodies and triangle surfaces in cavities, and of distances from them.
#pragma once

#include "bindings/impact.hpp"
#include "dem/solids.hpp"

namespace rattlebox::bindings {

template <int axes>
using Input = nb::ndarray<nb::numpy, const double, nb::ndim<axes>, nb::c_contig, nb::device::cpu>;
template <int axes>
using Indices = nb::ndarray<nb::numpy, const std::int64_t, nb::ndim<axes>, nb::c_contig, nb::device::cpu>;

struct SolidShape : Node {
    dem::Solid::Form form{};
    Indices<1> materials, labels; // of its walls
    Indices<1> groups;            // number of the wall of each triangle; empty if there is one
    bool encloses = false;
    double smooth = 0;
    Input<1> centre, size;
    Input<2> axes, vertices;
    Indices<2> faces;
};

struct SurfaceContacts : Node {
    Integers<1> point, solid;
    Doubles<2> normal;
    Doubles<1> distance;
};

inline void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
}

inline std::shared_ptr<const dem::Triangles> triangles_of(const Input<2>& vertices, const Indices<2>& faces) {
    const std::size_t n = vertices.shape(0), m = faces.shape(0);
    require(m > 0 && vertices.shape(1) == 3 && faces.shape(1) == 3,
            "a surface needs rows of three coordinates and of three corners");
    for (std::size_t i = 0; i < 3 * m; ++i)
        require(faces.data()[i] >= 0 && faces.data()[i] < static_cast<std::int64_t>(n),
                "a triangle has a corner that does not exist");
    return std::make_shared<const dem::Triangles>(vertices.data(), n, faces.data(), m);
}

// `wall` is the number of its first wall.
inline dem::Solid solid_of(const SolidShape& given, int wall) {
    dem::Solid solid;
    solid.form = given.form, solid.wall = wall, solid.smooth = given.smooth;
    if (given.form == dem::Solid::mesh) {
        solid.triangles = triangles_of(given.vertices, given.faces);
        const std::size_t walls = given.materials.shape(0);
        require(given.groups.shape(0) == given.faces.shape(0) || (given.groups.shape(0) == 0 && walls == 1),
                "each triangle of a surface of several walls needs a group");
        for (std::size_t i = 0; i < given.groups.shape(0); ++i) {
            const std::int64_t group = given.groups.data()[i];
            require(group >= 0 && group < static_cast<std::int64_t>(walls), "a group has no wall");
            solid.group.push_back(static_cast<int>(group));
        }
        return solid;
    }
    require(given.materials.shape(0) == 1, "a body is one wall");
    require(given.centre.shape(0) == 3 && given.size.shape(0) == 3 && given.axes.shape(0) == 3 &&
                given.axes.shape(1) == 3,
            "a body needs a centre, three axes and three sizes");
    solid.centre = row(given.centre.data()), solid.size = row(given.size.data());
    for (std::size_t a = 0; a < 3; ++a) solid.axis[a] = row(given.axes.data() + 3 * a);
    return solid;
}

// Distances of points from the solids of one cavity, for the preparation of runs.
class Surfaces {
    dem::Solids solids_;
    std::vector<int> first_leaf_;
    std::size_t walls_ = 0;

public:
    explicit Surfaces(const std::vector<SolidShape>& shapes) {
        int leaf = 0;
        for (std::size_t s = 0; s < shapes.size(); ++s) {
            first_leaf_.push_back(leaf);
            const dem::Solid solid = solid_of(shapes[s], static_cast<int>(walls_));
            leaf += solid.leaves(), walls_ += shapes[s].materials.shape(0);
            solids_.add(solid, 0, shapes[s].encloses);
        }
    }

    Doubles<2> distances(const Input<2>& points) const {
        const std::size_t n = points.shape(0);
        require(n == 0 || points.shape(1) == 3, "points have three components");
        std::vector<real> values(n * walls_, infinity);
        for (std::size_t i = 0; i < n; ++i)
            for (const dem::Solid& solid : solids_.solids()) {
                const auto [distance, group] = solid.nearest_group(row(points.data() + 3 * i));
                values[i * walls_ + static_cast<std::size_t>(solid.wall + group)] = distance;
            }
        return owned<Doubles<2>>(std::move(values), {n, walls_});
    }

    SurfaceContacts contacts(const Input<2>& points, const Input<1>& radii) const {
        const std::size_t n = points.shape(0);
        require((n == 0 || points.shape(1) == 3) && radii.shape(0) == n, "each point needs a radius");
        std::vector<std::int64_t> point, solid;
        std::vector<real> normal, distance;
        std::vector<dem::LeafPoint> near;
        for (std::size_t i = 0; i < n; ++i) {
            const Row c = row(points.data() + 3 * i);
            const real radius = radii.data()[i];
            near.clear();
            const auto add = [&](int leaf) {
                const dem::LeafPoint p = solids_.nearest_on(leaf, c);
                if (solids_.distance(p) < radius) near.push_back(p);
            };
            for (std::size_t s = 0; s < solids_.solids().size(); ++s) {
                const dem::Solid& one = solids_.solids()[s];
                const int first = first_leaf_[s];
                if (one.form != dem::Solid::mesh)
                    add(first);
                else
                    one.triangles->within(c, radius, [&](int f) { add(first + f); });
            }
            solids_.select(c, radius, {}, near.data(), static_cast<int>(near.size()));
            for (const dem::LeafPoint& p : near) {
                if (!p.counts) continue;
                point.push_back(static_cast<std::int64_t>(i)), solid.push_back(solids_.wall_of(p.leaf));
                for (int a = 0; a < 3; ++a) normal.push_back(p.near[a]);
                distance.push_back(p.near[3]);
            }
        }
        const std::size_t count = point.size();
        SurfaceContacts all;
        all.point = owned<Integers<1>>(std::move(point)), all.solid = owned<Integers<1>>(std::move(solid));
        all.normal = owned<Doubles<2>>(std::move(normal), {count, 3});
        all.distance = owned<Doubles<1>>(std::move(distance));
        return all;
    }
};

// Returns pairs of triangles that cross each other, at most a hundred.
inline Integers<2> crossing_triangles(const Input<2>& vertices, const Indices<2>& faces) {
    std::vector<std::int64_t> pairs;
    for (const auto& [f, g] : triangles_of(vertices, faces)->crossings(100))
        pairs.push_back(f), pairs.push_back(g);
    const std::size_t count = pairs.size() / 2;
    return owned<Integers<2>>(std::move(pairs), {count, 2});
}

inline void add_solids(nb::module_& module) {
    nb::enum_<dem::Solid::Form>(module, "SolidForm")
        .value("rod", dem::Solid::rod)
        .value("plate", dem::Solid::plate)
        .value("ball", dem::Solid::ball)
        .value("mesh", dem::Solid::mesh);
    using S = SolidShape;
    define<S>(
        module, "Solid",
        "A body in a cavity, which is one wall, or a closed surface of triangles with normals out of the "
        "space of the particles, with a wall for each group of triangles. "
        "`size` is half of the edges of a plate, radius and half of the length of a rod, or the radius "
        "of a "
        "ball [m]; the third of the axes is along a rod.",
        field("form", &S::form), field("materials", &S::materials), field("labels", &S::labels),
        field("groups", &S::groups), field("encloses", &S::encloses), field("smooth", &S::smooth),
        field("centre", &S::centre), field("size", &S::size), field("axes", &S::axes),
        field("vertices", &S::vertices), field("faces", &S::faces));
    using C = SurfaceContacts;
    define<C>(module, "SurfaceContacts",
              "Contacts of spheres with solids: number of the sphere and of the wall, outward normal, and "
              "distance of "
              "the centre [m].",
              field("point", &C::point), field("solid", &C::solid), field("normal", &C::normal),
              field("distance", &C::distance));
    module.def("crossing_triangles", &crossing_triangles, nb::arg("vertices"), nb::arg("faces"),
               "Return pairs of triangles that cross each other, a hundred at most.");
    nb::class_<Surfaces>(module, "Surfaces", "The solids of a cavity.")
        .def(nb::init<const std::vector<SolidShape>&>(), nb::arg("solids"))
        .def("distances", &Surfaces::distances, nb::arg("points"),
             "Return the distance of each point from the walls of the solids, positive where particles may "
             "be; "
             "infinity for walls of a surface of which another one is nearer.")
        .def("contacts", &Surfaces::contacts, nb::arg("points"), nb::arg("radii"),
             "Return the contacts of spheres, as a run has them.");
}

} // namespace rattlebox::bindings
