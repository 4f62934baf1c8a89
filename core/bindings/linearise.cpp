// Binding of runs of the 1-D engine with derivatives (impact/linearisation.hpp).
#include "bindings/linearise.hpp"

#include "bindings/impact.hpp"
#include "bindings/jobs.hpp"
#include "bindings/results.hpp"
#include "impact/linearisation.hpp"
#include "impact/trajectory.hpp"

namespace rattlebox::bindings {

namespace {

// The end of a run, or times within it: state, derivatives and rates, one row for each time.
struct Linearised : Node {
    Doubles<1> time;
    Doubles<2> state, rate, miss; // miss: time, gap and curvature by contact
    Doubles<3> derivative;        // time, component of the state, direction
    ImpactColumns impacts;
    Phases phases;
    RunCounts counts;
    Status status{};
    NotLinear refused{};
    double stopped_at = 0, stopped_value = 0, refused_at = 0;
    int stopped_contact = -1, refused_contact = -1;
};

// Returns the derivatives of a problem: weighted sums of the variants of a batch. `smooth` becomes false if
// those with the weights of a lower order differ by more than rounding.
std::vector<Problem> derivatives_of(Problem& problem, const Batch& batch, const Doubles<2>& weights,
                                    const Doubles<2>& coarse, bool& smooth) {
    std::vector<std::vector<real>> variants(batch.size());
    for (std::size_t v = batch.size(); v-- > 0;) { // the first one remains in the problem
        batch.apply(v);
        each_number(problem, [&](real& value) { variants[v].push_back(value); });
    }
    std::vector<Problem> slopes;
    for (std::size_t p = 0; p < weights.shape(0); ++p) {
        Problem& slope = slopes.emplace_back(problem);
        std::size_t i = 0;
        each_number(slope, [&](real& value) {
            const real now = value;
            real other = 0, largest = 0;
            value = 0;
            for (std::size_t v = 0; v < variants.size(); ++v) {
                if (weights(p, v) == 0 || variants[v][i] == now) continue; // also not a number, or infinite
                value += weights(p, v) * (variants[v][i] - now);
                other += coarse(p, v) * (variants[v][i] - now);
                largest = std::fmax(largest, std::fabs(weights(p, v) * now));
            }
            if (std::isnan(value)) value = other = 0;
            // The numbers may be those of eigenvectors, which are less accurate than the rounding.
            if (std::fabs(value - other) > 1e-8 * std::fabs(value) + 1e4 * epsilon * largest) smooth = false;
            ++i;
        });
    }
    return slopes;
}

Linearised linearise(const ProblemNumbers& packed, const std::optional<Doubles<1>>& start, double from,
                     const Doubles<1>& times, const Doubles<2>& weights, const Doubles<2>& coarse,
                     bool derivatives) {
    Batch batch;
    batch.shape = {weights.shape(1)};
    Problem problem;
    fill_problem(problem, packed, &batch);
    std::vector<Problem> slopes;
    bool smooth = true;
    if (derivatives)
        slopes = derivatives_of(problem, batch, weights, coarse, smooth);
    else
        batch.apply(0);
    // A load whose amplitude is a parameter acts also where it is zero.
    constexpr real barely = 1e-300;
    for (const Problem& slope : slopes)
        for (std::size_t l = 0; l < problem.loads.size(); ++l)
            if (real& amplitude = problem.loads[l].signal.amplitude;
                amplitude == 0 && slope.loads[l].signal.amplitude != 0)
                amplitude = barely;
    problem.settings.peaks = false;
    problem.settings.duration = times(times.shape(0) - 1);
    Trajectory trajectory(problem);
    RunState& run = trajectory.run_state();
    if (start) {
        if (start->shape(0) != problem.motion_size())
            throw std::invalid_argument("the state has the wrong number of components");
        std::copy_n(start->data(), problem.motion_size(), run.state.y.begin());
    }
    run.state.t = run.last_jump = from;
    run.loads.advance(from);
    trajectory.find_touching();
    Linearisation linearisation(run, std::move(slopes), !start);
    if (derivatives) run.listener = &linearisation;
    if (!smooth) linearisation.refuse(NotLinear::kink, -1);
    linearisation.check_start();
    const std::size_t n = problem.motion_size(), count = linearisation.tangents().count;
    std::vector<real> reached, states, rates, slopes_out, misses;
    run_jobs(
        1, 1, 1,
        [&](std::size_t, int, const std::atomic<bool>& stop) {
            run.stop = &stop;
            for (std::size_t i = 0; i < times.shape(0) && run.running(); ++i) {
                run.until = times(i);
                trajectory.advance();
                reached.push_back(run.state.t);
                states.insert(states.end(), run.state.y.begin(),
                              run.state.y.begin() + static_cast<std::ptrdiff_t>(n));
                const std::vector<real>& rate = linearisation.rates();
                rates.insert(rates.end(), rate.begin(), rate.end());
                const std::vector<real>& slope = linearisation.tangents().matrix;
                if (derivatives) slopes_out.insert(slopes_out.end(), slope.begin(), slope.end());
            }
        },
        [](std::size_t) { return true; });
    for (const NearMiss& miss : linearisation.tangents().misses)
        misses.insert(misses.end(), {miss.time, miss.gap, miss.curvature});
    Linearised result;
    const std::size_t rows = reached.size();
    result.time = owned<Doubles<1>>(std::move(reached));
    result.state = owned<Doubles<2>>(std::move(states), {rows, n});
    result.rate = owned<Doubles<2>>(std::move(rates), {rows, n});
    result.derivative = owned<Doubles<3>>(std::move(slopes_out), {derivatives ? rows : 0, n, count});
    result.miss = owned<Doubles<2>>(std::move(misses), {problem.contacts.size(), 3});
    result.impacts = ImpactColumns(problem, run.result.impacts);
    std::vector<std::int8_t> phases;
    for (const RunState::Phase phase : run.phases) phases.push_back(static_cast<std::int8_t>(phase));
    result.phases = owned<Phases>(std::move(phases));
    result.counts = RunCounts{{}, run.result.counts};
    result.status = run.result.status;
    result.stopped_at = run.result.stopped_at;
    result.stopped_contact = run.result.stopped_contact;
    result.stopped_value = run.result.stopped_value;
    result.refused = linearisation.tangents().refused;
    result.refused_at = linearisation.tangents().refused_at;
    result.refused_contact = linearisation.tangents().refused_contact;
    return result;
}

} // namespace

void add_linearise(nb::module_& module) {
    nb::enum_<NotLinear>(module, "NotLinear", nb::is_arithmetic(), "Why a derivative does not exist.")
        .value("none", NotLinear::none)
        .value("simultaneous", NotLinear::simultaneous)
        .value("grazing", NotLinear::grazing)
        .value("kink", NotLinear::kink)
        .value("closed", NotLinear::closed);
    using L = Linearised;
    define<L>(
        module, "Linearised",
        "A run with derivatives of its state in the state at the start and in parameters, at fixed times.",
        field("time", &L::time), field("state", &L::state), field("rate", &L::rate), field("miss", &L::miss),
        field("derivative", &L::derivative), field("impacts", &L::impacts), field("phases", &L::phases),
        field("counts", &L::counts), field("status", &L::status), field("refused", &L::refused),
        field("stopped_at", &L::stopped_at), field("stopped_value", &L::stopped_value),
        field("refused_at", &L::refused_at), field("stopped_contact", &L::stopped_contact),
        field("refused_contact", &L::refused_contact));
    module.def(
        "linearise", &linearise, nb::arg("problem"), nb::arg("start").none(), nb::arg("from_time"),
        nb::arg("times"), nb::arg("weights"), nb::arg("coarse"), nb::arg("derivatives") = true,
        "Run a problem of the 1-D engine from a state (None: that of the problem) at a time up to the last "
        "of "
        "`times`, with derivatives in the state at the start and in parameters. The problem is a batch of "
        "variants along one axis, of which the first runs; each row of `weights` is the derivative in one "
        "parameter as a sum over the variants, and each row of `coarse` is another one of lower order.");
}

} // namespace rattlebox::bindings
