// The result of a run of the 1-D engine.
#pragma once

#include "bindings/node.hpp"
#include "impact/result.hpp"

namespace rattlebox::bindings {

using Phases = nb::ndarray<nb::numpy, std::int8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<nb::numpy, bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// The impact log, one row for each impact.
struct ImpactColumns : Node {
    Integers<1> damper, contact;
    Doubles<1> time, approach_speed, restitution, separation_speed, duration, peak_overlap, peak_force,
        energy_lost;
    Flags complete;

    ImpactColumns() = default;
    ImpactColumns(const Problem& problem, const std::vector<Impact>& log)
        : time(doubles(log, &Impact::time)), approach_speed(doubles(log, &Impact::approach_speed)),
          restitution(doubles(log, &Impact::restitution)),
          separation_speed(doubles(log, &Impact::separation_speed)),
          duration(doubles(log, &Impact::duration)), peak_overlap(doubles(log, &Impact::peak_overlap)),
          peak_force(doubles(log, &Impact::peak_force)), energy_lost(doubles(log, &Impact::energy_lost)) {
        std::vector<std::int64_t> dampers, contacts;
        std::vector<std::int8_t> completed;
        for (const Impact& impact : log) {
            const int own = problem.contacts[static_cast<std::size_t>(impact.contact)].damper;
            dampers.push_back(own);
            contacts.push_back(impact.contact - problem.dampers[static_cast<std::size_t>(own)].first_contact);
            completed.push_back(impact.complete);
        }
        damper = owned<Integers<1>>(std::move(dampers));
        contact = owned<Integers<1>>(std::move(contacts));
        complete = owned<Flags>(std::move(completed));
    }

private:
    static Doubles<1> doubles(const std::vector<Impact>& log, real Impact::* member) {
        std::vector<real> values;
        values.reserve(log.size());
        for (const Impact& impact : log) values.push_back(impact.*member);
        return owned<Doubles<1>>(std::move(values));
    }
};

struct RunCounts : Node, Counts {};

// States from which another run continues; empty arrays unless the settings ask for them.
struct EndArrays : Node {
    Bytes end, whole;
    Doubles<1> motion;
    Phases phases;

    EndArrays() = default;
    explicit EndArrays(EndStates&& states)
        : end(owned<Bytes>(std::move(states.end))), whole(owned<Bytes>(std::move(states.whole))),
          motion(owned<Doubles<1>>(std::move(states.motion))),
          phases(owned<Phases>(std::move(states.phases))) {}
};

struct RunResult : Node {
    Doubles<1> time;
    Doubles<2> state;
    Flags chosen;
    Doubles<1> load_work, base_work, viscous_loss;
    Doubles<2> normal_loss, plastic_loss, contact_energy, cavity_force;
    ImpactColumns impacts;
    EndArrays states;
    RunCounts counts;
    Status status{};
    double energy_residual_limit = 0, permitted_error = 0, energy_rounding = 0, stopped_at = 0,
           stopped_value = 0;
    int stopped_contact = -1;
    double seconds = 0;

    RunResult() = default;
    RunResult(const Problem& problem, Result&& r, double elapsed)
        : impacts(problem, r.impacts), states(std::move(r.states)), counts{{}, r.counts}, status(r.status),
          energy_residual_limit(problem.settings.energy_residual_limit()), permitted_error(r.permitted_error),
          energy_rounding(r.rounding(problem.settings)), stopped_at(r.stopped_at),
          stopped_value(r.stopped_value), stopped_contact(r.stopped_contact), seconds(elapsed) {
        Samples& s = r.samples;
        const std::size_t n = s.time.size(), d = problem.dampers.size();
        const std::size_t states = problem.state_size();
        time = owned<Doubles<1>>(std::move(s.time));
        state = owned<Doubles<2>>(std::move(s.state), {n, states});
        chosen = owned<Flags>(std::move(s.given));
        load_work = owned<Doubles<1>>(std::move(s.load_work));
        base_work = owned<Doubles<1>>(std::move(s.base_work));
        viscous_loss = owned<Doubles<1>>(std::move(s.viscous));
        normal_loss = owned<Doubles<2>>(std::move(s.normal), {n, d});
        plastic_loss = owned<Doubles<2>>(std::move(s.plastic), {n, d});
        contact_energy = owned<Doubles<2>>(std::move(s.stored), {n, d});
        cavity_force = owned<Doubles<2>>(std::move(s.force), {n, d});
    }
};

inline void add_results(nb::module_& module) {
    nb::enum_<Status>(module, "Status", nb::is_arithmetic(), "How a run ended.")
        .value("finished", Status::finished)
        .value("law_domain", Status::law_domain)
        .value("too_many_events", Status::too_many_events)
        .value("step_too_small", Status::step_too_small)
        .value("interrupted", Status::interrupted)
        .value("not_finite", Status::not_finite)
        .value("energy_error", Status::energy_error)
        .value("escaped", Status::escaped)
        .value("no_rebound", Status::no_rebound)
        .value("refused", Status::refused)
        .value("false_contact", Status::false_contact);
    using I = ImpactColumns;
    define<I>(module, "Impacts", "The impact log, one row for each impact.", field("damper", &I::damper),
              field("contact", &I::contact), field("time", &I::time),
              field("approach_speed", &I::approach_speed), field("restitution", &I::restitution),
              field("separation_speed", &I::separation_speed), field("duration", &I::duration),
              field("peak_overlap", &I::peak_overlap), field("peak_force", &I::peak_force),
              field("energy_lost", &I::energy_lost), field("complete", &I::complete));
    define<RunCounts>(module, "Counts", "Counts of the work of a run.", field("events", &Counts::events),
                      field("flights", &Counts::flights), field("contact_steps", &Counts::contact_steps),
                      field("rejected_steps", &Counts::rejected_steps),
                      field("collocated", &Counts::collocated), field("extrapolated", &Counts::extrapolated),
                      field("sticks", &Counts::sticks), field("simultaneous_impacts", &Counts::simultaneous));
    using E = EndArrays;
    define<E>(
        module, "EndStates",
        "States from which another run continues: at the end, and the last one that a longer run has, too.",
        field("end", &E::end), field("whole", &E::whole), field("motion", &E::motion),
        field("phases", &E::phases));
    using R = RunResult;
    define<R>(
        module, "Result",
        "A run of the 1-D engine. `state` holds displacement and velocity of each mode, then positions and "
        "velocities of all balls; `chosen` is true for samples at times of the problem.",
        field("time", &R::time), field("state", &R::state), field("chosen", &R::chosen),
        field("load_work", &R::load_work), field("base_work", &R::base_work),
        field("viscous_loss", &R::viscous_loss), field("normal_loss", &R::normal_loss),
        field("plastic_loss", &R::plastic_loss), field("contact_energy", &R::contact_energy),
        field("cavity_force", &R::cavity_force), field("impacts", &R::impacts), field("states", &R::states),
        field("counts", &R::counts), field("status", &R::status),
        field("energy_residual_limit", &R::energy_residual_limit),
        field("permitted_error", &R::permitted_error), field("energy_rounding", &R::energy_rounding),
        field("stopped_at", &R::stopped_at), field("stopped_value", &R::stopped_value),
        field("stopped_contact", &R::stopped_contact), field("seconds", &R::seconds));
}

} // namespace rattlebox::bindings
