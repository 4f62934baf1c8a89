// The derivatives of the state of a run, which the parts of impact/linearisation.hpp share.
#pragma once

#include <utility>

#include "impact/run_state.hpp"
#include "impact/taylor_motion.hpp"

namespace rattlebox {

// Calls f for each number of a problem on which its motion depends, in a fixed order.
template <class F> void each_number(Problem& p, F&& f) {
    const auto all_of = [&](std::vector<real>& values) {
        for (real& value : values) f(value);
    };
    for (Mode& mode : p.modes) f(mode.decay), f(mode.stiffness);
    all_of(p.coupling);
    for (ModeState& start : p.start) f(start.q), f(start.p);
    for (Load& load : p.loads) {
        Signal& s = load.signal;
        for (real* value : {&s.amplitude, &s.frequency, &s.phase, &s.start, &s.stop}) f(*value);
        all_of(load.shape);
    }
    for (Damper& damper : p.dampers) f(damper.clearance), f(damper.gravity), all_of(damper.shape);
    const auto each_field = [&](const auto& laws) {
        laws.visit([&]<class Law>(const Law& law) {
            for (const auto& field : Law::fields) f(const_cast<Law&>(law).*field.member);
        });
    };
    for (Contact& contact : p.contacts)
        f(contact.mass), each_field(contact.normal), each_field(contact.restitution);
    all_of(p.ball_mass), all_of(p.ball_position), all_of(p.ball_velocity);
}

// Why a derivative does not exist, or is not computed.
enum class NotLinear : int {
    none = 0,
    simultaneous = 1, // several hard impacts at one instant, whose order would matter
    grazing = 2,      // a hard contact touched without speed
    kink = 3,         // a law has a kink at the speed of an impact, or at the value of a parameter
    closed = 4,       // the start is within a contact
};

// Where an open contact was closest without touching.
struct NearMiss {
    real time = 0, gap = infinity, curvature = 0;
};

// Derivatives in each direction: the components of the state at the start, then the parameters.
struct Tangents {
    RunState& run;
    const Problem& problem;
    std::vector<Problem> slopes; // d problem / d parameter
    std::size_t modes, balls, size, count;
    std::vector<real> matrix; // size x count, row by row
    NotLinear refused = NotLinear::none;
    real refused_at = 0;
    int refused_contact = -1;
    std::vector<NearMiss> misses; // by contact
    TaylorMotion motion;          // accelerations
    // Of the state, and of an event in each direction: change of its time, of a gap, and of its rate.
    std::vector<real> rates, times, gap_slope, rate_slope;
    std::vector<real> system_y, system_rates;

    // The derivatives start as those of the state at the start in itself; in the parameters, too, if the run
    // starts with the case rather than from a given state.
    Tangents(RunState& of, std::vector<Problem> in, bool from_case)
        : run(of), problem(of.problem), slopes(std::move(in)), modes(problem.modes.size()),
          balls(problem.ball_mass.size()), size(problem.motion_size()), count(size + slopes.size()),
          matrix(size * count), misses(problem.contacts.size()), motion(problem), rates(size), times(count),
          gap_slope(count), rate_slope(count) {
        for (std::size_t i = 0; i < size; ++i) row(i)[i] = 1;
        for (std::size_t p = 0; p < slopes.size() && from_case; ++p) {
            const State start(slopes[p]);
            for (std::size_t i = 0; i < size; ++i) row(i)[size + p] = start.y[i];
        }
    }

    std::size_t parameters() const { return slopes.size(); }
    real* row(std::size_t i) { return matrix.data() + i * count; }
    std::size_t position_row(int ball) const { return 2 * modes + static_cast<std::size_t>(ball); }
    std::size_t velocity_row(int ball) const { return position_row(ball) + balls; }
    const Contact& contact(int c) const { return problem.contacts[static_cast<std::size_t>(c)]; }
    static const Damper& damper_of(const Problem& p, const Contact& c) {
        return p.dampers[static_cast<std::size_t>(c.damper)];
    }
    static const Contact& contact_of(const Problem& p, int c) {
        return p.contacts[static_cast<std::size_t>(c)];
    }

    // The rate of a gap is the sum of sign x rate over both sides, and the force on each is sign x force.
    template <class F> static void each_side(const Contact& c, F&& f) {
        f(-1.0, c.below);
        if (c.above != ground) f(1.0, c.above);
    }

    // Computes the derivatives of a gap and of its rate at state y.
    void differentiate_gap(const Contact& c, const real* y, const real* tangent, real* value,
                           real* rate) const {
        std::fill_n(value, count, 0.0), std::fill_n(rate, count, 0.0);
        each_side(c, [&](real sign, int body) {
            const auto add = [&](real weight, std::size_t position, std::size_t velocity) {
                const real *x = tangent + position * count, *v = tangent + velocity * count;
                for (std::size_t d = 0; d < count; ++d) value[d] += weight * x[d], rate[d] += weight * v[d];
            };
            if (body != wall) return add(sign, position_row(body), velocity_row(body));
            for (std::size_t k = 0; k < modes; ++k) {
                add(sign * damper_of(problem, c).shape[k], 2 * k, 2 * k + 1);
                for (std::size_t p = 0; p < parameters(); ++p) {
                    const real shape = sign * damper_of(slopes[p], c).shape[k];
                    value[size + p] += shape * y[2 * k], rate[size + p] += shape * y[2 * k + 1];
                }
            }
        });
        if (c.below != wall && c.above != wall) return;
        for (std::size_t p = 0; p < parameters(); ++p)
            value[size + p] += 0.5 * damper_of(slopes[p], c).clearance;
    }

    // Second derivative of a gap for given rates of the state.
    real gap_acceleration(const Contact& c, const std::vector<real>& rates) const {
        real sum = 0;
        each_side(c, [&](real sign, int body) {
            if (body != wall) {
                sum += sign * rates[velocity_row(body)];
                return;
            }
            for (std::size_t k = 0; k < modes; ++k)
                sum += sign * damper_of(problem, c).shape[k] * rates[2 * k + 1];
        });
        return sum;
    }

    // Computes the rates of the state without soft contacts; stuck contacts hold.
    void rates_of_flight() { rates_of_flight(run.loads, run.stuck); }
    void rates_of_flight(const Loads& loads, const std::vector<int>& held) {
        motion.expand(run.state, loads, held, 0);
        const real *y = run.state.y.data(), *v = velocities(problem, y);
        for (std::size_t k = 0; k < modes; ++k)
            rates[2 * k] = y[2 * k + 1], rates[2 * k + 1] = 2 * motion.modes()[k].c[2];
        for (std::size_t b = 0; b < balls; ++b) {
            rates[2 * modes + b] = v[b];
            rates[2 * modes + balls + b] = 2 * motion.balls()[b].c[2];
        }
    }

    // The same with the soft contacts that are closed.
    void rates_of_contacts() {
        if (run.system.active.empty()) return rates_of_flight();
        System& system = run.system;
        system.start(run.loads, run.state.t);
        system_y.assign(system.size(), 0.0), system_rates.assign(system.size(), 0.0);
        std::copy(run.state.y.begin(), run.state.y.end(), system_y.begin());
        for (std::size_t j = 0; j < system.active.size(); ++j)
            system_y[system.x_index(j)] = system.active[j].x;
        system(system_y.data(), system_rates.data());
        const real clock = system_rates[system.time_index()];
        for (std::size_t i = 0; i < size; ++i) rates[i] = system_rates[i] / clock;
    }

    // Adds the change of the derivatives by a force on a contact that acts for the times `times` longer.
    void lengthen_force(const Contact& c, real force) {
        each_side(c, [&](real sign, int body) {
            if (body != wall) {
                const real part = sign * force / problem.ball_mass[static_cast<std::size_t>(body)];
                return add_times(row(velocity_row(body)), part);
            }
            for (std::size_t k = 0; k < modes; ++k)
                add_times(row(2 * k + 1), sign * damper_of(problem, c).shape[k] * force);
        });
    }

    void add_times(real* target, real factor) const {
        for (std::size_t d = 0; d < count; ++d) target[d] += factor * times[d];
    }

    // Adds or removes the motion in the changes of the time of an event.
    void shift(real sign) {
        for (std::size_t i = 0; i < size; ++i) add_times(row(i), sign * rates[i]);
    }

    // Only the first reason is kept.
    void refuse(NotLinear why, int c) {
        if (refused != NotLinear::none) return;
        refused = why, refused_at = run.state.t, refused_contact = c;
    }

    void note_miss(int c, const NearMiss& miss) {
        NearMiss& closest = misses[static_cast<std::size_t>(c)];
        if (miss.gap < closest.gap) closest = miss;
    }

    // The derivatives of the signal of a load between knots: constant, slope and waves.
    struct SignalSlope {
        real constant = 0, sine = 0, cosine = 0, cosine_slope = 0; // (cosine + cosine_slope s) cos + sine sin

        bool is_any() const { return constant != 0 || sine != 0 || cosine != 0 || cosine_slope != 0; }
    };
    SignalSlope signal_slope(const Piece& piece, const Signal& signal, const Signal& slope) const {
        SignalSlope s;
        if (signal.kind == Signal::Kind::constant) {
            s.constant = slope.amplitude;
        } else if (signal.kind != Signal::Kind::record && !piece.is_zero()) {
            s.sine = slope.amplitude;
            s.cosine = piece.amplitude * slope.phase;
            if (signal.kind == Signal::Kind::half_sine)
                s.cosine -= piece.amplitude * piece.frequency * slope.start;
            s.cosine_slope = piece.amplitude * slope.frequency;
        }
        return s;
    }

    real signal_slope_at(const Piece& piece, const SignalSlope& s, real t) const {
        const real since = t - piece.origin, angle = piece.frequency * since + piece.phase;
        real sum = s.constant;
        if (s.sine != 0) sum += s.sine * std::sin(angle);
        if (s.cosine != 0 || s.cosine_slope != 0)
            sum += (s.cosine + s.cosine_slope * since) * std::cos(angle);
        return sum;
    }

    static real signal_rate(const Piece& piece, real t) {
        if (piece.amplitude == 0) return piece.slope;
        const real angle = piece.frequency * (t - piece.origin) + piece.phase;
        return piece.slope + piece.amplitude * piece.frequency * std::cos(angle);
    }
};

} // namespace rattlebox
