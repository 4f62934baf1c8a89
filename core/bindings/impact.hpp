// Binding of the problems of the 1-D engine and of batches of them.
#pragma once

#include "bindings/laws.hpp"

namespace rattlebox::bindings {

struct SettingsNumbers : Node {
    Method method{};
    Number duration, tolerance, stick, dt_flight, dt_contact;
    long max_events = 0, contact_samples = 0;
    bool adaptive_inner = false, collocation = false, keep_end = false;
};

template <Signal::Kind kind> struct WaveNumbers : Node {
    Number amplitude, frequency, phase, start, stop;
};
using HalfSine = WaveNumbers<Signal::Kind::half_sine>;
using Harmonic = WaveNumbers<Signal::Kind::harmonic>;

struct RecordedSignal : Node {
    Table times, values;
};

using AnySignal = std::variant<HalfSine, Harmonic, RecordedSignal>;

struct LoadNumbers : Node {
    AnySignal signal;
    Vector shape;
    bool base = false;
};

// A damper with its balls, or a stop, which has none.
struct DamperNumbers : Node {
    Number clearance, gravity, base;
    Vector shape, mass, position, velocity;
};

struct ContactNumbers : Node {
    Number mass;
    LawOf<NormalLaw> normal;
    LawOf<RestitutionLaw> restitution;
};

struct ProblemNumbers : Node {
    SettingsNumbers settings;
    Vector mode_decay, mode_stiffness, mode_coupling, mode_displacement, mode_velocity;
    std::vector<LoadNumbers> loads;
    std::vector<DamperNumbers> dampers;
    std::vector<ContactNumbers> contacts;
    Table sample_times;
    std::optional<SavedState> start_state;
    bool changed = false;
};

inline void fill_signal(Filler& fill, Signal& target, const AnySignal& given) {
    std::visit(
        [&]<class S>(const S& signal) {
            if constexpr (std::is_same_v<S, RecordedSignal>) {
                if (signal.times.shape(0) == 0 || signal.times.shape(0) != signal.values.shape(0))
                    throw std::invalid_argument("a record must have as many values as times, at least one");
                target.kind = Signal::Kind::record;
                target.times = view(signal.times);
                target.values = view(signal.values);
            } else {
                target.kind = std::is_same_v<S, HalfSine> ? Signal::Kind::half_sine : Signal::Kind::harmonic;
                fill.number(target.amplitude, signal.amplitude);
                fill.number(target.frequency, signal.frequency);
                fill.number(target.phase, signal.phase);
                fill.number(target.start, signal.start);
                fill.number(target.stop, signal.stop);
            }
        },
        given);
}

// Copies modes and loads, which both engines have; returns the number of modes.
template <class Problem, class Given>
std::size_t fill_structure(Filler& fill, Problem& target, const Given& given) {
    if (given.mode_decay.ndim() == 0) throw std::invalid_argument("the modes must be vectors");
    const std::size_t modes = given.mode_decay.shape(0);
    target.modes.resize(modes);
    target.start.resize(modes);
    for (std::size_t k = 0; k < modes; ++k) {
        fill.component(target.modes[k].decay, given.mode_decay, k, modes);
        fill.component(target.modes[k].stiffness, given.mode_stiffness, k, modes);
        fill.component(target.start[k].q, given.mode_displacement, k, modes);
        fill.component(target.start[k].p, given.mode_velocity, k, modes);
    }
    const bool coupled = given.mode_coupling.ndim() > 0 && given.mode_coupling.shape(0) > 0;
    fill.vector(target.coupling, given.mode_coupling, coupled ? modes * modes : 0);
    target.loads.resize(given.loads.size());
    for (std::size_t l = 0; l < given.loads.size(); ++l) {
        Load& load = target.loads[l];
        fill_signal(fill, load.signal, given.loads[l].signal);
        fill.vector(load.shape, given.loads[l].shape, modes);
        load.base = given.loads[l].base;
    }
    return modes;
}

inline void fill_settings(Filler& fill, Settings& target, const SettingsNumbers& given) {
    target.method = given.method;
    target.max_events = given.max_events;
    target.contact_samples = given.contact_samples;
    target.adaptive_inner = given.adaptive_inner;
    target.collocation = given.collocation;
    target.keep_end = given.keep_end;
    fill.number(target.duration, given.duration);
    fill.number(target.tolerance, given.tolerance);
    fill.number(target.stick, given.stick);
    fill.number(target.dt_flight, given.dt_flight);
    fill.number(target.dt_contact, given.dt_contact);
}

// Tables stay in the arrays of `given`, which must outlive the problem.
inline void fill_problem(rattlebox::Problem& target, const ProblemNumbers& given, Batch* batch = nullptr) {
    Filler fill(batch);
    const std::size_t modes = fill_structure(fill, target, given);
    std::size_t balls = 0;
    int stops = 0;
    target.dampers.resize(given.dampers.size());
    for (std::size_t i = 0; i < given.dampers.size(); ++i) {
        if (given.dampers[i].mass.ndim() == 0) throw std::invalid_argument("masses must be a vector");
        Damper& damper = target.dampers[i];
        damper.first_ball = static_cast<int>(balls);
        damper.first_contact = static_cast<int>(balls + i);
        damper.balls = static_cast<int>(given.dampers[i].mass.shape(0));
        balls += static_cast<std::size_t>(damper.balls);
        if (damper.is_stop())
            ++stops;
        else if (stops > 0)
            throw std::invalid_argument("stops come after all dampers");
        target.ball_damper.resize(balls, static_cast<int>(i));
    }
    target.stop_count = stops;
    target.ball_mass.resize(balls);
    target.ball_position.resize(balls);
    target.ball_velocity.resize(balls);
    target.contacts.resize(given.contacts.size());
    if (given.contacts.size() != balls + given.dampers.size())
        throw std::invalid_argument("a damper of n balls needs n + 1 contacts");
    for (std::size_t i = 0; i < given.dampers.size(); ++i) {
        Damper& damper = target.dampers[i];
        const DamperNumbers& one = given.dampers[i];
        const auto own = static_cast<std::size_t>(damper.balls),
                   first = static_cast<std::size_t>(damper.first_ball);
        fill.number(damper.clearance, one.clearance);
        fill.number(damper.gravity, one.gravity);
        fill.number(damper.base, one.base);
        fill.vector(damper.shape, one.shape, modes);
        for (std::size_t b = 0; b < own; ++b) {
            fill.component(target.ball_mass[first + b], one.mass, b, own);
            fill.component(target.ball_position[first + b], one.position, b, own);
            fill.component(target.ball_velocity[first + b], one.velocity, b, own);
        }
        for (int k = 0; k <= damper.balls; ++k) {
            Contact& contact = target.contacts[static_cast<std::size_t>(damper.first_contact + k)];
            contact.damper = static_cast<int>(i);
            contact.below = k == 0 ? wall : damper.first_ball + k - 1;
            contact.above = k < damper.balls ? damper.first_ball + k : damper.is_stop() ? ground : wall;
        }
    }
    for (std::size_t c = 0; c < given.contacts.size(); ++c) {
        fill.number(target.contacts[c].mass, given.contacts[c].mass);
        fill.choose(target.contacts[c].normal, given.contacts[c].normal);
        fill.choose(target.contacts[c].restitution, given.contacts[c].restitution);
    }
    if (given.sample_times.is_valid())
        target.sample_times.assign(given.sample_times.data(),
                                   given.sample_times.data() + given.sample_times.shape(0));
    if (given.start_state)
        target.start_state.assign(given.start_state->data(),
                                  given.start_state->data() + given.start_state->shape(0));
    target.changed = given.changed;
    fill_settings(fill, target.settings, given.settings);
}

template <class Wave> void define_wave(nb::module_& module, const char* name, const char* doc) {
    define<Wave>(module, name, doc, field("amplitude", &Wave::amplitude),
                 field("frequency", &Wave::frequency), field("phase", &Wave::phase),
                 field("start", &Wave::start), field("stop", &Wave::stop));
}

// Types of a problem that both engines have.
inline void add_structure(nb::module_& module) {
    define_wave<HalfSine>(module, "HalfSine", "A half-sine pulse: N or m/s^2, rad/s, rad, s, s.");
    define_wave<Harmonic>(module, "Harmonic", "A harmonic: N or m/s^2, rad/s, rad, s, s.");
    define<RecordedSignal>(module, "Record", "A piecewise-linear signal through points, zero outside.",
                           field("times", &RecordedSignal::times), field("values", &RecordedSignal::values));
    define<LoadNumbers>(
        module, "Load",
        "A signal and the force on each mode per unit of it; for a base acceleration, minus the "
        "participation factor.",
        field("signal", &LoadNumbers::signal), field("shape", &LoadNumbers::shape),
        field("base", &LoadNumbers::base));
}

inline void add_problem(nb::module_& module) {
    nb::enum_<Method>(module, "Method")
        .value("event_driven", Method::event_driven)
        .value("newton", Method::newton)
        .value("two_step", Method::two_step);
    using S = SettingsNumbers;
    const Settings usual;
    define<S>(module, "Settings", "Settings of a run of the 1-D engine.", field("method", &S::method),
              field("duration", &S::duration), field("tolerance", &S::tolerance, usual.tolerance),
              field("max_events", &S::max_events, usual.max_events), field("stick", &S::stick, usual.stick),
              field("dt_flight", &S::dt_flight, usual.dt_flight),
              field("dt_contact", &S::dt_contact, usual.dt_contact),
              field("adaptive_inner", &S::adaptive_inner, usual.adaptive_inner),
              field("collocation", &S::collocation, usual.collocation),
              field("contact_samples", &S::contact_samples, usual.contact_samples),
              field("keep_end", &S::keep_end, usual.keep_end));
    using D = DamperNumbers;
    define<D>(
        module, "Damper",
        "An impact damper with its balls, whose positions are relative to the closely packed, centred row; "
        "without balls a stop with half of the clearance as its gap.",
        field("clearance", &D::clearance), field("gravity", &D::gravity), field("shape", &D::shape),
        field("mass", &D::mass), field("position", &D::position), field("velocity", &D::velocity),
        field("base", &D::base, 0.0));
    using C = ContactNumbers;
    define<C>(module, "Contact", "The contact of two neighbours: effective mass and laws.",
              field("mass", &C::mass), field("normal", &C::normal), field("restitution", &C::restitution));
    using P = ProblemNumbers;
    define<P>(
        module, "Problem",
        "A problem of the 1-D engine. Arrays that broadcast over a grid in place of numbers make it a batch.",
        field("settings", &P::settings), field("mode_decay", &P::mode_decay),
        field("mode_stiffness", &P::mode_stiffness), field("mode_coupling", &P::mode_coupling),
        field("mode_displacement", &P::mode_displacement), field("mode_velocity", &P::mode_velocity),
        field("loads", &P::loads), field("dampers", &P::dampers), field("contacts", &P::contacts),
        field("sample_times", &P::sample_times),
        field("start_state", &P::start_state, std::optional<SavedState>()),
        field("changed", &P::changed, false));
}

} // namespace rattlebox::bindings
