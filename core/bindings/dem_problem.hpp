// Binding of the problems and results of the 3-D engine.
#pragma once

#include "bindings/impact.hpp"
#include "bindings/solids.hpp"
#include "dem/records.hpp"

namespace rattlebox::bindings {

struct WallShape : Node {
    dem::Wall::Form form{};
    Input<1> axis;
    double offset = 0;
    int material = 0, label = 0;
};

struct RotationNumbers : Node {
    Input<1> axis, arm;
    bool carries_structure = false;
    Table knots;
    Input<2> coefficients;
    double amplitude = 0, frequency = 0, phase = 0;
};

struct CavityContents : Node {
    Input<2> shape;
    std::optional<RotationNumbers> rotation;
    std::vector<WallShape> walls;
    std::vector<SolidShape> solids; // after the walls
    Input<1> period;
    Input<2> position, velocity, spin;
    Input<1> radius, mass, inertia;
    Indices<1> species;
    Indices<2> particle_pair, wall_pair;
};

struct PairLaws : Node {
    LawOf<NormalLaw> normal;
    LawOf<RestitutionLaw> restitution;
    LawOf<TangentialLaw> tangential;
    LawNumbers<RollingResistance> rolling;
    double radius = 0, mass = 0;
};

struct DemNumbers : Node {
    double dt = 0, enduring = 0, origin = 0;
    long steps = 0, every = 0, first_step = 0;
    bool each_wall = false;
    Input<1> gravity;
    Vector mode_decay, mode_stiffness, mode_coupling, mode_displacement, mode_velocity;
    std::vector<LoadNumbers> loads;
    Input<2> load_directions;
    std::vector<CavityContents> cavities;
    std::vector<PairLaws> pairs;
};

inline Row one_row(const Input<1>& v) {
    require(v.shape(0) == 3, "a direction has three components");
    return row(v.data()[0], v.data()[1], v.data()[2]);
}

inline std::vector<Row> rows(const Input<2>& array, std::size_t n, const char* what) {
    require(array.shape(0) == n && (n == 0 || array.shape(1) == 3), what);
    std::vector<Row> result;
    for (std::size_t i = 0; i < n; ++i)
        result.push_back(row(array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]));
    return result;
}

inline std::vector<real> reals(const Input<1>& array, std::size_t n, const char* what) {
    require(array.shape(0) == n, what);
    return {array.data(), array.data() + n};
}

// Checks that indices are from 0 to `count` - 1 and copies them.
template <class Array> std::vector<int> indices(const Array& array, std::size_t count, const char* what) {
    for (std::size_t i = 0; i < array.size(); ++i)
        require(array.data()[i] >= 0 && array.data()[i] < static_cast<std::int64_t>(count), what);
    return {array.data(), array.data() + array.size()};
}

inline dem::Rotation rotation(const RotationNumbers& given) {
    const std::size_t n = given.knots.shape(0);
    require(n > 0 && given.coefficients.shape(0) == n && given.coefficients.shape(1) == 4,
            "each knot of an angle needs four coefficients");
    dem::Rotation r;
    r.axis = one_row(given.axis), r.arm = one_row(given.arm), r.knots = view(given.knots);
    r.carries_structure = given.carries_structure;
    require(std::fabs(dot(r.axis, r.axis) - 1) < 1e-9, "an axis of rotation needs the length 1");
    r.coefficients = {given.coefficients.data(), static_cast<int>(4 * n)};
    r.amplitude = given.amplitude, r.frequency = given.frequency, r.phase = given.phase;
    return r;
}

inline void fill_cavity(dem::Cavity& target, const CavityContents& given, std::size_t modes,
                        std::size_t pairs) {
    require(given.walls.size() <= 32, "a cavity has 32 walls at most");
    const std::size_t n = given.position.shape(0), species_count = given.particle_pair.shape(0);
    const std::size_t wall_material_count = given.wall_pair.shape(1);
    require(given.particle_pair.shape(1) == species_count && given.wall_pair.shape(0) == species_count,
            "the tables of pairs need a row for each species");
    target.shape = rows(given.shape, modes, "a cavity needs three components for each mode");
    for (const WallShape& one : given.walls) {
        require(one.material >= 0 && one.material < static_cast<int>(wall_material_count),
                "a wall has no laws");
        require(one.label >= 0 && one.label < static_cast<int>(given.walls.size()),
                "the label of a wall is less than the number of walls");
        dem::Wall wall{one_row(one.axis), one.form, one.material, one.label};
        wall.axis[3] = one.offset;
        target.walls.push_back(wall);
    }
    const int plain = static_cast<int>(target.walls.size());
    std::size_t walls = given.walls.size();
    for (const SolidShape& one : given.solids) walls += one.materials.shape(0);
    for (const SolidShape& one : given.solids) {
        target.solids.add(solid_of(one, static_cast<int>(target.walls.size())), plain, one.encloses);
        require(one.labels.shape(0) == one.materials.shape(0), "each wall of a body needs a label");
        const auto material = indices(one.materials, wall_material_count, "a body has no laws"),
                   label = indices(one.labels, walls, "the label of a body is less than the number of walls");
        for (std::size_t k = 0; k < material.size(); ++k)
            target.walls.push_back({Row{}, dem::Wall::solid, material[k], label[k]});
    }
    target.period = one_row(given.period);
    for (int a = 0; a < 3; ++a) {
        require(target.period[a] >= 0 && target.period[a] < infinity, "a period is a length, or 0 for none");
        require(target.period[a] == 0 || given.solids.empty(), "a periodic cavity cannot hold bodies");
    }
    if (given.rotation) target.rotation = rotation(*given.rotation);
    target.position = rows(given.position, n, "positions have three components");
    target.velocity = rows(given.velocity, n, "each particle needs a velocity");
    target.spin = rows(given.spin, n, "each particle needs a spin");
    const auto radius = reals(given.radius, n, "each particle needs a radius");
    for (std::size_t i = 0; i < n; ++i) target.position[i][3] = radius[i];
    target.mass = reals(given.mass, n, "each particle needs a mass");
    target.inertia = reals(given.inertia, n, "each particle needs a moment of inertia");
    require(given.species.shape(0) == n, "each particle needs a species");
    target.species = indices(given.species, species_count, "a species has no laws");
    target.particle_pair = indices(given.particle_pair, pairs, "a pair of species has no laws");
    target.wall_pair = indices(given.wall_pair, pairs, "a species and a wall have no laws");
    target.species_count = static_cast<int>(species_count),
    target.wall_material_count = static_cast<int>(wall_material_count);
}

// Tables stay in the arrays of `given`, which must outlive the problem.
inline dem::Problem dem_problem(const DemNumbers& given) {
    Filler fill;
    dem::Problem p;
    p.dt = given.dt, p.enduring = given.enduring, p.steps = given.steps, p.sample_interval = given.every;
    p.origin = given.origin, p.first_step = given.first_step, p.each_wall = given.each_wall;
    p.gravity = one_row(given.gravity);
    const std::size_t modes = fill_structure(fill, p, given);
    p.load_direction = rows(given.load_directions, given.loads.size(), "each load needs a direction");
    for (const PairLaws& pair : given.pairs) {
        dem::PairLaw e;
        fill.choose(e.normal, pair.normal);
        fill.choose(e.restitution, pair.restitution);
        fill.choose(e.tangential, pair.tangential);
        fill.law(e.rolling, pair.rolling);
        e.size = {pair.radius, pair.mass};
        p.pair_laws.push_back(e);
    }
    p.cavities.resize(given.cavities.size());
    for (std::size_t c = 0; c < given.cavities.size(); ++c)
        fill_cavity(p.cavities[c], given.cavities[c], modes, given.pairs.size());
    return p;
}

// ---- results

struct RecordArrays : Node {
    Doubles<1> time;
    Doubles<2> q, p, load_work, base_work, viscous_loss, kinetic, rotation, potential, elastic;
    Doubles<2> angle, speed, drive_work;
    Doubles<3> centre, momentum, force, moment, normal_loss, plastic_loss, sliding_loss, rolling_loss;
    Integers<3> contacts;
    // by sample and name of a wall
    Doubles<3> wall_force, wall_moment, wall_impulse;
    Doubles<2> wall_normal_force, wall_normal_impulse;
    Doubles<2> wall_normal_loss, wall_plastic_loss, wall_sliding_loss, wall_rolling_loss;
    Integers<2> wall_impacts;

    RecordArrays() = default;
    // Moves the records into arrays.
    RecordArrays(dem::Records&& r, std::size_t modes, std::size_t loads, std::size_t cavities,
                 std::size_t walls) {
        const std::size_t s = r.time.size();
        const auto each = [&](std::vector<real>& values, std::size_t n) {
            return owned<Doubles<2>>(std::move(values), {s, n});
        };
        const auto three = [&](std::vector<real>& values, std::size_t n) {
            return owned<Doubles<3>>(std::move(values), {s, cavities, n});
        };
        time = owned<Doubles<1>>(std::move(r.time));
        q = each(r.q, modes), p = each(r.p, modes), viscous_loss = each(r.viscous, modes);
        load_work = each(r.load_work, loads), base_work = each(r.base_work, loads);
        kinetic = each(r.kinetic, cavities), rotation = each(r.rotation, cavities);
        potential = each(r.potential, cavities), elastic = each(r.stored, cavities);
        angle = each(r.angle, cavities), speed = each(r.speed, cavities);
        drive_work = each(r.drive_work, cavities);
        centre = three(r.centre, 3), momentum = three(r.momentum, 3);
        force = three(r.force, 3), moment = three(r.moment, 3);
        normal_loss = three(r.normal, 2), plastic_loss = three(r.plastic, 2);
        sliding_loss = three(r.sliding, 2), rolling_loss = three(r.rolling, 2);
        contacts = owned<Integers<3>>(std::move(r.contacts), {s, cavities, 2});
        const auto of_walls = [&](std::vector<real>& values) {
            return owned<Doubles<3>>(std::move(values), {s, walls, 3});
        };
        wall_force = of_walls(r.wall_force), wall_moment = of_walls(r.wall_moment);
        wall_impulse = of_walls(r.wall_impulse);
        wall_normal_force = each(r.wall_normal_force, walls);
        wall_normal_impulse = each(r.wall_normal_impulse, walls);
        wall_normal_loss = each(r.wall_normal, walls), wall_plastic_loss = each(r.wall_plastic, walls);
        wall_sliding_loss = each(r.wall_sliding, walls), wall_rolling_loss = each(r.wall_rolling, walls);
        wall_impacts = owned<Integers<2>>(std::move(r.wall_impacts), {s, walls});
        r = dem::Records{};
    }
};

struct CavityState : Node {
    Doubles<2> position, velocity, spin;
    Doubles<1> displacement;
};

struct DemState : Node {
    long step = 0;
    double time = 0;
    Doubles<1> q, p;
    std::vector<CavityState> cavities;
};

struct ContactRows : Node {
    Integers<1> first, second;
    Doubles<2> force;
};

struct DemCounts : Node {
    long steps = 0, rebuilds = 0, refreshes = 0;
    std::int64_t extrapolated = 0, candidates = 0;
    std::size_t memory_bytes = 0;
    Integers<2> first_touches;
    Doubles<1> largest_overlap, largest_approach_speed, enduring_loss;
    double seconds = 0;
};

struct StoppedAt : Node {
    int cavity = 0, particle = 0, wall = 0;
    double time = 0, speed = 0;
};

// Returns f(i) of all particles in the order of the case.
template <class F> Doubles<2> in_order(const std::vector<int>& number, F&& f) {
    std::vector<real> values(3 * number.size());
    for (std::size_t i = 0; i < number.size(); ++i) {
        const Row r = f(i);
        for (std::size_t a = 0; a < 3; ++a) values[3 * static_cast<std::size_t>(number[i]) + a] = r[a];
    }
    return owned<Doubles<2>>(std::move(values), {number.size(), 3});
}

inline void add_dem_problem(nb::module_& module) {
    nb::enum_<dem::Partner>(module, "Partner", nb::is_arithmetic(), "Body that a particle touches.")
        .value("particle", dem::Partner::particle)
        .value("wall", dem::Partner::wall);
    add_solids(module);
    nb::enum_<dem::Wall::Form>(module, "WallForm")
        .value("plane", dem::Wall::plane)
        .value("cylinder", dem::Wall::cylinder)
        .value("sphere", dem::Wall::sphere);
    using W = WallShape;
    define<W>(module, "Wall",
              "A wall around the centre of a cavity: outward normal of a plane or axis of a cylinder, and "
              "distance or radius [m]. `label` is the number of its name; walls of one name are summed in "
              "results.",
              field("form", &W::form), field("axis", &W::axis), field("offset", &W::offset),
              field("material", &W::material), field("label", &W::label, 0));
    using Q = RotationNumbers;
    define<Q>(
        module, "Rotation",
        "Rotation of a cavity about an axis at the distance `-arm` from its centre. From each knot on, the "
        "angle is a cubic polynomial with four coefficients, plus a sine.",
        field("axis", &Q::axis), field("arm", &Q::arm), field("carries_structure", &Q::carries_structure),
        field("knots", &Q::knots), field("coefficients", &Q::coefficients), field("amplitude", &Q::amplitude),
        field("frequency", &Q::frequency), field("phase", &Q::phase));
    using C = CavityContents;
    define<C>(
        module, "Cavity",
        "A cavity and its particles. `particle_pair` and `wall_pair` are the indices of the laws of two "
        "species, and of a species and a wall material. `period` is the distance of the images of a particle "
        "along each axis, 0 if it is not periodic.",
        field("shape", &C::shape), field("walls", &C::walls),
        field("solids", &C::solids, std::vector<SolidShape>{}), field("period", &C::period),
        field("position", &C::position), field("velocity", &C::velocity), field("spin", &C::spin),
        field("radius", &C::radius), field("mass", &C::mass), field("inertia", &C::inertia),
        field("species", &C::species), field("particle_pair", &C::particle_pair),
        field("wall_pair", &C::wall_pair), field("rotation", &C::rotation, std::nullopt));
    using L = PairLaws;
    define<L>(
        module, "PairLaws",
        "The laws of two species, or of a species and a wall, with R* [m] and m* [kg] of the pair that they "
        "hold for.",
        field("normal", &L::normal), field("restitution", &L::restitution),
        field("tangential", &L::tangential), field("rolling", &L::rolling), field("radius", &L::radius),
        field("mass", &L::mass));
    using P = DemNumbers;
    define<P>(
        module, "DemProblem",
        "A problem of the 3-D engine. Contacts older than `enduring` [s] count as enduring. Step 0 is at the "
        "time `origin` [s], and samples are taken `every` steps from `first_step` on. `each_wall` is whether "
        "forces and losses are also summed for each wall.",
        field("dt", &P::dt), field("steps", &P::steps), field("every", &P::every),
        field("enduring", &P::enduring, infinity), field("origin", &P::origin, 0.0),
        field("first_step", &P::first_step, 0L), field("each_wall", &P::each_wall, false),
        field("gravity", &P::gravity), field("mode_decay", &P::mode_decay),
        field("mode_stiffness", &P::mode_stiffness), field("mode_coupling", &P::mode_coupling),
        field("mode_displacement", &P::mode_displacement), field("mode_velocity", &P::mode_velocity),
        field("loads", &P::loads), field("load_directions", &P::load_directions),
        field("cavities", &P::cavities), field("pairs", &P::pairs));
    using R = RecordArrays;
    define<R>(
        module, "Records",
        "Samples of a run of the 3-D engine: over samples, then modes, loads or cavities, then components or "
        "partners.",
        field("time", &R::time), field("q", &R::q), field("p", &R::p), field("load_work", &R::load_work),
        field("base_work", &R::base_work), field("viscous_loss", &R::viscous_loss),
        field("kinetic", &R::kinetic), field("rotation", &R::rotation), field("angle", &R::angle),
        field("speed", &R::speed), field("drive_work", &R::drive_work), field("potential", &R::potential),
        field("elastic", &R::elastic), field("centre", &R::centre), field("momentum", &R::momentum),
        field("force", &R::force), field("moment", &R::moment), field("normal_loss", &R::normal_loss),
        field("plastic_loss", &R::plastic_loss), field("sliding_loss", &R::sliding_loss),
        field("rolling_loss", &R::rolling_loss), field("contacts", &R::contacts),
        field("wall_force", &R::wall_force), field("wall_moment", &R::wall_moment),
        field("wall_impulse", &R::wall_impulse), field("wall_normal_force", &R::wall_normal_force),
        field("wall_normal_impulse", &R::wall_normal_impulse),
        field("wall_normal_loss", &R::wall_normal_loss), field("wall_plastic_loss", &R::wall_plastic_loss),
        field("wall_sliding_loss", &R::wall_sliding_loss), field("wall_rolling_loss", &R::wall_rolling_loss),
        field("wall_impacts", &R::wall_impacts));
    using B = CavityState;
    define<B>(module, "CavityState",
              "Particles of a cavity in the order of the case, and the displacement of the cavity.",
              field("position", &B::position), field("velocity", &B::velocity), field("spin", &B::spin),
              field("displacement", &B::displacement));
    using S = DemState;
    define<S>(module, "DemState", "The state at the last step whose forces are known.",
              field("step", &S::step), field("time", &S::time), field("q", &S::q), field("p", &S::p),
              field("cavities", &S::cavities));
    using T = ContactRows;
    define<T>(module, "ContactList",
              "Contacts of a cavity, and the force on the first partner [N]; walls are numbered after the "
              "particles.",
              field("first", &T::first), field("second", &T::second), field("force", &T::force));
    using N = DemCounts;
    define<N>(module, "DemCounts", "Counts and extremes of a run of the 3-D engine; arrays over cavities.",
              field("steps", &N::steps), field("rebuilds", &N::rebuilds), field("refreshes", &N::refreshes),
              field("extrapolated", &N::extrapolated), field("candidates", &N::candidates),
              field("memory_bytes", &N::memory_bytes), field("first_touches", &N::first_touches),
              field("largest_overlap", &N::largest_overlap),
              field("largest_approach_speed", &N::largest_approach_speed),
              field("enduring_loss", &N::enduring_loss), field("seconds", &N::seconds));
    using A = StoppedAt;
    define<A>(module, "StoppedAt",
              "Place at which a run stopped: particle and wall by their numbers in the case, or -1.",
              field("cavity", &A::cavity), field("particle", &A::particle), field("wall", &A::wall),
              field("time", &A::time), field("speed", &A::speed));
}

} // namespace rattlebox::bindings
