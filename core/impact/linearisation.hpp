// Derivatives of the state of a run with respect to its state at the start and to parameters, beside the run.
//
// The derivatives are those at fixed times. In flights they follow the linear equations of motion, in closed
// form or by the same Taylor series. In closed soft contacts they are integrated with the steps of the run in
// the transformed time, in which the force of a Hertz contact is smooth; its derivatives with respect to
// overlap, rate and coefficients follow from dual numbers. At an event that the state x reaches where
// h(x, p, t) = 0, with the rates f- and f+ of the state before and after,
//
//     dt = -h' / (dh/dt)        x'+ = R (x'- + f- dt) + r_p - f+ dt
//
// R and r_p are the derivatives of the jump of the state, h' those of h in each direction. (M. di Bernardo,
// C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5,
// doi:10.1007/978-1-84628-708-4.) Where neither state nor rates jump, as at the start of a Hertz contact and
// where a resting contact is released, nothing changes.
//
// A parameter is a direction in the numbers of the problem: a second problem holds their derivatives.
#pragma once

#include <utility>

#include "impact/flight.hpp"
#include "impact/run_listener.hpp"
#include "impact/run_state.hpp"
#include "math/dop853.hpp"
#include "math/dual.hpp"

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

class Linearisation final : public RunListener {
    RunState& run_;
    const Problem& problem_;
    std::vector<Problem> slopes_; // d problem / d parameter
    std::size_t modes_, balls_, size_, count_;
    std::vector<real> tangent_; // size x count, row by row
    NotLinear refused_ = NotLinear::none;
    real refused_at_ = 0;
    int refused_contact_ = -1;
    std::vector<NearMiss> misses_; // by contact

    // Derivatives of the coefficients and the history of each contact, in each direction.
    struct LawSlopes {
        std::vector<real> stiffness, second, deepest, unloading, origin;
    };
    std::vector<LawSlopes> laws_;

    TaylorMotion motion_; // accelerations
    Problem homogeneous_; // without loads, gravity and clearances
    TaylorMotion free_motion_;
    State state_;
    std::vector<real> rates_, times_, gap_, gap_rate_, force_, ball_force_, cavity_force_, signal_,
        signal_slope_;
    std::vector<real> extended_, extended_end_, scale_, sizes_, system_y_, system_rates_;
    std::vector<real> series_; // derivatives of the Taylor series
    Dop853 integrator_;

    std::size_t states() const { return size_; }
    std::size_t parameters() const { return slopes_.size(); }
    real* row(std::vector<real>& matrix, std::size_t i) const { return matrix.data() + i * count_; }
    const real* row(const std::vector<real>& matrix, std::size_t i) const {
        return matrix.data() + i * count_;
    }
    std::size_t position_row(int ball) const { return 2 * modes_ + static_cast<std::size_t>(ball); }
    std::size_t velocity_row(int ball) const { return position_row(ball) + balls_; }
    const Contact& contact(int c) const { return problem_.contacts[static_cast<std::size_t>(c)]; }
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
        std::fill_n(value, count_, 0.0), std::fill_n(rate, count_, 0.0);
        each_side(c, [&](real sign, int body) {
            const auto add = [&](real weight, std::size_t position, std::size_t velocity) {
                const real *x = tangent + position * count_, *v = tangent + velocity * count_;
                for (std::size_t d = 0; d < count_; ++d) value[d] += weight * x[d], rate[d] += weight * v[d];
            };
            if (body != wall) return add(sign, position_row(body), velocity_row(body));
            for (std::size_t k = 0; k < modes_; ++k) {
                add(sign * damper_of(problem_, c).shape[k], 2 * k, 2 * k + 1);
                for (std::size_t p = 0; p < parameters(); ++p) {
                    const real shape = sign * damper_of(slopes_[p], c).shape[k];
                    value[states() + p] += shape * y[2 * k], rate[states() + p] += shape * y[2 * k + 1];
                }
            }
        });
        if (c.below != wall && c.above != wall) return;
        for (std::size_t p = 0; p < parameters(); ++p)
            value[states() + p] += 0.5 * damper_of(slopes_[p], c).clearance;
    }

    // Second derivative of a gap for given rates of the state.
    real gap_acceleration(const Contact& c, const std::vector<real>& rates) const {
        real sum = 0;
        each_side(c, [&](real sign, int body) {
            if (body != wall) {
                sum += sign * rates[velocity_row(body)];
                return;
            }
            for (std::size_t k = 0; k < modes_; ++k)
                sum += sign * damper_of(problem_, c).shape[k] * rates[2 * k + 1];
        });
        return sum;
    }

    // Computes the rates of the state without soft contacts; stuck contacts hold.
    void rates_of_flight() { rates_of_flight(run_.loads, run_.stuck); }
    void rates_of_flight(const Loads& loads, const std::vector<int>& held) {
        motion_.expand(run_.state, loads, held, 0);
        const real *y = run_.state.y.data(), *v = velocities(problem_, y);
        for (std::size_t k = 0; k < modes_; ++k)
            rates_[2 * k] = y[2 * k + 1], rates_[2 * k + 1] = 2 * motion_.modes()[k].c[2];
        for (std::size_t b = 0; b < balls_; ++b) {
            rates_[2 * modes_ + b] = v[b];
            rates_[2 * modes_ + balls_ + b] = 2 * motion_.balls()[b].c[2];
        }
    }

    // The same with the soft contacts that are closed.
    void rates_of_contacts() {
        if (run_.system.active.empty()) return rates_of_flight();
        System& system = run_.system;
        system.start(run_.loads, run_.state.t);
        system_y_.assign(system.size(), 0.0), system_rates_.assign(system.size(), 0.0);
        std::copy(run_.state.y.begin(), run_.state.y.end(), system_y_.begin());
        for (std::size_t j = 0; j < system.active.size(); ++j)
            system_y_[system.x_index(j)] = system.active[j].x;
        system(system_y_.data(), system_rates_.data());
        const real clock = system_rates_[system.time_index()];
        for (std::size_t i = 0; i < size_; ++i) rates_[i] = system_rates_[i] / clock;
    }

    // Adds the change of the derivatives by a force on a contact that acts for the times `times_` longer.
    void lengthen_force(const Contact& c, real force) {
        each_side(c, [&](real sign, int body) {
            if (body != wall) {
                const real part = sign * force / problem_.ball_mass[static_cast<std::size_t>(body)];
                return add_times(row(tangent_, velocity_row(body)), part);
            }
            for (std::size_t k = 0; k < modes_; ++k)
                add_times(row(tangent_, 2 * k + 1), sign * damper_of(problem_, c).shape[k] * force);
        });
    }

    void add_times(real* target, real factor) const {
        for (std::size_t d = 0; d < count_; ++d) target[d] += factor * times_[d];
    }

    // Adds or removes the motion in the changes of the time of an event.
    void shift(real sign) {
        for (std::size_t i = 0; i < size_; ++i) add_times(row(tangent_, i), sign * rates_[i]);
    }

    // ---- flights

    // The derivatives of the signal of a load between knots: constant, slope and waves.
    struct SignalSlope {
        real constant = 0, sine = 0, cosine = 0, cosine_slope = 0; // (cosine + cosine_slope s) cos + sine sin
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

    // Taylor coefficients of the derivative of the signal of a load in a parameter, about t.
    Series signal_series(std::size_t l, std::size_t p, real t) const {
        const Piece& piece = run_.loads.piece(l);
        const SignalSlope s = signal_slope(piece, run_.loads.load(l).signal, slopes_[p].loads[l].signal);
        Series sum;
        sum.c[0] = s.constant;
        Piece wave{piece.origin, 0, 0, 1, piece.frequency, piece.phase};
        if (s.sine != 0) wave.add_taylor(t, s.sine, Series::order, sum.c);
        if (s.cosine == 0 && s.cosine_slope == 0) return sum;
        wave.phase += 0.5 * pi;
        Series cosine;
        wave.add_taylor(t, 1, Series::order, cosine.c);
        sum.add(s.cosine + s.cosine_slope * (t - piece.origin), cosine);
        for (int n = 0; n < Series::order; ++n) sum.c[n + 1] += s.cosine_slope * cosine.c[n];
        return sum;
    }

    real* coefficient(std::size_t body, int n) {
        return series_.data() + (body * (Series::order + 1) + static_cast<std::size_t>(n)) * count_;
    }

    void sum_series(std::size_t body, real s, real* value, real* slope) {
        constexpr int last = Series::order;
        const real* c = coefficient(body, last);
        for (std::size_t d = 0; d < count_; ++d) value[d] = c[d], slope[d] = last * c[d];
        for (int n = last - 1; n >= 0; --n) {
            c = coefficient(body, n);
            for (std::size_t d = 0; d < count_; ++d) value[d] = value[d] * s + c[d];
            if (n == 0) return;
            for (std::size_t d = 0; d < count_; ++d) slope[d] = slope[d] * s + n * c[d];
        }
    }

    // Advances the derivatives by the Taylor series of the equations of motion.
    void advance_series(const TaylorMotion& motion, real s) {
        const std::size_t loads = run_.loads.size();
        series_.assign((modes_ + 1) * (Series::order + 1) * count_, 0.0);
        for (std::size_t k = 0; k < modes_; ++k) {
            std::copy_n(row(tangent_, 2 * k), count_, coefficient(k, 0));
            std::copy_n(row(tangent_, 2 * k + 1), count_, coefficient(k, 1));
        }
        // The forces in the parameters, in place of the coefficients that they lead to; those of the base
        // last.
        for (std::size_t p = 0; p < parameters(); ++p) {
            const Problem& slope = slopes_[p];
            const std::size_t d = states() + p;
            for (std::size_t l = 0; l < loads; ++l) {
                const Load& load = run_.loads.load(l);
                const Series change = signal_series(l, p, run_.state.t);
                for (int n = 0; n + 2 <= Series::order; ++n) {
                    for (std::size_t k = 0; k < modes_; ++k)
                        coefficient(k, n + 2)[d] +=
                            load.shape[k] * change.c[n] + slope.loads[l].shape[k] * motion.loads()[l].c[n];
                    if (load.base) coefficient(modes_, n + 2)[d] -= change.c[n];
                }
            }
            for (std::size_t k = 0; k < modes_; ++k) {
                const Mode& change = slope.modes[k];
                for (int n = 0; n + 2 <= Series::order; ++n) {
                    real force = 2 * change.decay * (n + 1) * motion.modes()[k].c[n + 1] +
                                 change.stiffness * motion.modes()[k].c[n];
                    for (std::size_t j = 0; j < modes_ && !slope.coupling.empty(); ++j)
                        force += slope.coupling[k * modes_ + j] * (n + 1) * motion.modes()[j].c[n + 1];
                    coefficient(k, n + 2)[d] -= force;
                }
            }
        }
        for (int n = 0; n + 2 <= Series::order; ++n)
            for (std::size_t k = 0; k < modes_; ++k) {
                real* next = coefficient(k, n + 2);
                const auto subtract = [&](real weight, const real* c) {
                    for (std::size_t d = 0; d < count_; ++d) next[d] -= weight * c[d];
                };
                subtract(problem_.modes[k].stiffness, coefficient(k, n));
                subtract(2 * problem_.modes[k].decay * (n + 1), coefficient(k, n + 1));
                for (std::size_t j = 0; j < modes_ && !problem_.coupling.empty(); ++j)
                    subtract(problem_.coupling[k * modes_ + j] * (n + 1), coefficient(j, n + 1));
                const real both = (n + 1) * (n + 2);
                for (std::size_t d = 0; d < count_; ++d) next[d] /= both;
            }
        for (std::size_t k = 0; k < modes_; ++k)
            sum_series(k, s, row(tangent_, 2 * k), row(tangent_, 2 * k + 1));
        // Balls fly free, and all in the same way with the base.
        for (int n = 2; n <= Series::order; ++n)
            for (std::size_t d = 0; d < count_; ++d) coefficient(modes_, n)[d] /= n * (n - 1);
        std::vector<real>&value = gap_, &rate = gap_rate_;
        sum_series(modes_, s, value.data(), rate.data());
        advance_balls(s, value.data(), rate.data());
    }

    void advance_balls(real s, const real* moved, const real* gained) {
        for (std::size_t b = 0; b < balls_; ++b) {
            real *x = row(tangent_, 2 * modes_ + b), *v = row(tangent_, 2 * modes_ + balls_ + b);
            for (std::size_t d = 0; d < count_; ++d) x[d] += s * v[d];
            if (moved)
                for (std::size_t d = 0; d < count_; ++d) x[d] += moved[d], v[d] += gained[d];
            for (std::size_t p = 0; p < parameters(); ++p) {
                const real g = slopes_[p].dampers[static_cast<std::size_t>(problem_.ball_damper[b])].gravity;
                x[states() + p] += 0.5 * g * s * s, v[states() + p] += g * s;
            }
        }
    }

    // Advances the derivatives of free modes and balls in closed form. With w^2 = k - a^2 and the functions C
    // and S of structure/mode.hpp, dC = -s da C - s S w dw and dS = -s da S + w dw (s C - S) / w^2.
    void advance_free(real s) {
        const real* y = run_.state.y.data();
        for (std::size_t k = 0; k < modes_; ++k) {
            const Mode& mode = problem_.modes[k];
            const real a = mode.decay, stiffness = mode.stiffness;
            FreeMode free(mode);
            free.start({0, 1});
            const real sine = free.at(s).q;
            free.start({1, 0});
            const real cosine = free.at(s).q - a * sine;
            const real matrix[4] = {cosine + a * sine, sine, -stiffness * sine, cosine - a * sine};
            real *q = row(tangent_, 2 * k), *v = row(tangent_, 2 * k + 1);
            for (std::size_t d = 0; d < count_; ++d) {
                const real x = q[d];
                q[d] = matrix[0] * x + matrix[1] * v[d];
                v[d] = matrix[2] * x + matrix[3] * v[d];
            }
            const real square_of_root = stiffness - a * a, turned = square_of_root * s * s;
            real bent; // (s C - S) / w^2
            if (std::fabs(turned) > 0.5) {
                bent = (s * cosine - sine) / square_of_root;
            } else {
                real term = cube(s) * std::exp(-a * s) / 2,
                     sum = 0; // of sum (-turned)^n (1/(2n+3)! - 1/(2n+2)!)
                for (int n = 0; n < 12; ++n) {
                    sum += term * (1.0 / (2 * n + 3) - 1);
                    term *= -turned / ((2 * n + 3) * (2 * n + 4));
                }
                bent = sum;
            }
            for (std::size_t p = 0; p < parameters(); ++p) {
                const real da = slopes_[p].modes[k].decay, dk = slopes_[p].modes[k].stiffness;
                if (da == 0 && dk == 0) continue;
                const real root_slope = 0.5 * dk - a * da;
                const real dc = -s * da * cosine - s * sine * root_slope,
                           ds = -s * da * sine + root_slope * bent;
                q[states() + p] += (dc + da * sine + a * ds) * y[2 * k] + ds * y[2 * k + 1];
                v[states() + p] -=
                    (dk * sine + stiffness * ds) * y[2 * k] + (-dc + da * sine + a * ds) * y[2 * k + 1];
            }
        }
        advance_balls(s, nullptr, nullptr);
    }

    // Advances the derivatives where contacts are held closed. The motion is linear in the state: the
    // derivatives are a motion without loads. The parameters change the motion smoothly.
    void advance_held(const std::vector<int>& held, real s) {
        const Loads none(homogeneous_.loads);
        State at(homogeneous_), end(homogeneous_);
        for (std::size_t d = 0; d < count_; ++d) {
            for (std::size_t i = 0; i < size_; ++i) at.y[i] = row(tangent_, i)[d];
            free_motion_.expand(at, none, held);
            free_motion_.at(s, end);
            for (std::size_t i = 0; i < size_; ++i) row(tangent_, i)[d] = end.y[i];
        }
        constexpr real h = 0.01, weights[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
        for (std::size_t p = 0; p < parameters(); ++p)
            for (int k = 1; k <= 4; ++k)
                for (const real side : {-1.0, 1.0}) {
                    const Problem moved = moved_problem(p, side * k * h);
                    Loads loads(moved.loads);
                    loads.advance(run_.state.t);
                    TaylorMotion motion(moved);
                    motion.expand(run_.state, loads, held);
                    motion.at(s, end);
                    for (std::size_t i = 0; i < size_; ++i)
                        row(tangent_, i)[states() + p] += side * weights[k - 1] / h * end.y[i];
                }
    }

    Problem moved_problem(std::size_t p, real h) const {
        Problem moved = problem_, slope = slopes_[p];
        std::vector<real> change;
        each_number(slope, [&](real& value) { change.push_back(value); });
        std::size_t i = 0;
        each_number(moved, [&](real& value) {
            if (change[i] != 0) value += h * change[i];
            ++i;
        });
        return moved;
    }

    // Finds where open contacts come closest within a flight, without a touch.
    void find_misses(const Flight& flight, real length) {
        const real rate = flight.series() ? 0 : fastest_rate(problem_.modes, problem_.coupling);
        const int pieces = std::max(1, static_cast<int>(std::fmin(std::ceil(rate * length), 100'000)));
        std::vector<real> before(problem_.contacts.size(), 0.0);
        const auto rate_at = [&](int c, real s) {
            flight.at(s, state_);
            return gap(problem_, contact(c), state_.y.data()).rate;
        };
        for (int i = 0; i <= pieces; ++i) {
            flight.at(length * i / pieces, state_);
            for (int c = 0; c < problem_.contact_count(); ++c) {
                const auto at = static_cast<std::size_t>(c);
                const real now = gap(problem_, contact(c), state_.y.data()).rate;
                const real last = std::exchange(before[at], now);
                if (i == 0 || !(last < 0 && now >= 0) || run_.phase(c) != RunState::Phase::open) continue;
                real low = length * (i - 1) / pieces, high = length * i / pieces;
                for (int half = 0; half < 50; ++half) {
                    const real middle = 0.5 * (low + high);
                    (rate_at(c, middle) < 0 ? low : high) = middle;
                }
                const real width = 1e-3 * length / pieces;
                const real from = std::fmax(high - width, 0.0), to = std::fmin(high + width, length);
                const real curvature = (rate_at(c, to) - rate_at(c, from)) / (to - from);
                flight.at(high, state_);
                note_miss(c,
                          {run_.state.t + high, gap(problem_, contact(c), state_.y.data()).value, curvature});
                flight.at(length * i / pieces, state_);
            }
        }
    }

    void note_miss(int c, const NearMiss& miss) {
        NearMiss& closest = misses_[static_cast<std::size_t>(c)];
        if (miss.gap < closest.gap) closest = miss;
    }

    // ---- laws

    // Returns the law moved by h in the direction of a parameter.
    template <class Laws, class Law> static Law moved_law(const Law& law, const Laws& slope, real h) {
        Law moved = law;
        const Law& change = *slope.template get_if<Law>();
        for (const auto& field : Law::fields)
            if (change.*field.member != 0) moved.*field.member += h * change.*field.member;
        return moved;
    }

    // Returns the rate at which a law changes in a parameter: its largest relative change.
    template <class Laws, class Law> static real rate_of(const Law& law, const Laws& slope) {
        const Law& change = *slope.template get_if<Law>();
        real rate = 0;
        for (const auto& field : Law::fields)
            if (const real value = law.*field.member, own = change.*field.member; own != 0)
                rate = std::fmax(rate, value != 0 ? std::fabs(own / value) : 1);
        return rate;
    }

    // Returns the derivative of the restitution of an impact in the speed, or in a parameter at a fixed
    // speed. A law is valid on its own side of its limits 0 and `maximum`.
    real restitution_slope(int c, real speed, const Problem* slope) {
        std::array<real, 1> result{};
        const RestitutionLaw& laws = contact(c).restitution;
        const bool smooth = laws.visit([&]<class Law>(const Law& law) {
            const real e = law.value(speed);
            const bool is_cut = e > law.maximum;
            if (e < 0 || (is_cut && !slope)) return true;
            if (!slope)
                return differentiate<1>([&](real h) { return std::array<real, 1>{law.value(speed + h)}; },
                                        1 / speed, result);
            const RestitutionLaw& change = contact_of(*slope, c).restitution;
            return differentiate<1>(
                [&](real h) {
                    const Law moved = moved_law(law, change, h);
                    return std::array<real, 1>{is_cut ? moved.maximum : moved.value(speed)};
                },
                rate_of(law, change), result);
        });
        if (!smooth) refuse(NotLinear::kink, c);
        return result[0];
    }

    static std::array<real, 5> numbers_of(const ContactState& s) {
        return {s.coefficients.stiffness, s.coefficients.second, s.history.deepest, s.history.stiffness,
                s.history.origin};
    }

    // Sets the derivatives of the numbers of a closed contact in all directions: from those in its argument
    // (speed and restitution, or deepest overlap), and in the parameters. state(law, argument, h) computes it
    // with the argument moved by h.
    template <class State>
    void set_law_slopes(int c, const std::vector<real>& argument_slope, real argument, State&& state) {
        LawSlopes& own = laws_[static_cast<std::size_t>(c)];
        std::vector<real>* columns[] = {&own.stiffness, &own.second, &own.deepest, &own.unloading,
                                        &own.origin};
        contact(c).normal.visit([&]<class Law>(const Law& law) {
            std::array<real, 5> slope{};
            bool smooth = true;
            const bool moves =
                std::any_of(argument_slope.begin(), argument_slope.end(), [](real v) { return v != 0; });
            if (moves && argument > 0)
                smooth = differentiate<5>([&](real h) { return numbers_of(state(law, h, nullptr, 0.0)); },
                                          1 / argument, slope);
            for (std::size_t i = 0; i < 5; ++i)
                for (std::size_t d = 0; d < count_; ++d) (*columns[i])[d] = slope[i] * argument_slope[d];
            for (std::size_t p = 0; p < parameters(); ++p) {
                const Contact& change = contact_of(slopes_[p], c);
                const real rate =
                    std::fmax(rate_of(law, change.normal), contact(c).restitution.visit([&](const auto& r) {
                        return rate_of(r, change.restitution);
                    }));
                if (rate == 0) continue;
                smooth = differentiate<5>(
                             [&](real h) {
                                 return numbers_of(state(moved_law(law, change.normal, h), 0.0, &change, h));
                             },
                             rate, slope) &&
                         smooth;
                for (std::size_t i = 0; i < 5; ++i) (*columns[i])[states() + p] += slope[i];
            }
            if (!smooth) refuse(NotLinear::kink, c);
        });
    }

    // The restitution of a contact whose law is moved in a parameter, on the side of its limits where it is.
    real moved_restitution(int c, real speed, const Contact* change, real h) const {
        return contact(c).restitution.visit([&](const auto& law) {
            const bool is_cut = law.value(speed) > law.maximum;
            const auto moved = change ? moved_law(law, change->restitution, h) : law;
            return is_cut ? moved.maximum : std::fmax(moved.value(speed), 0.0);
        });
    }

    // Force of a closed contact and its derivatives.
    struct Force {
        real total = 0, x = 0, rate = 0, stiffness = 0, second = 0, deepest = 0, unloading = 0, origin = 0;
    };

    template <class Law, class T>
    static T evaluate(const Law& law, const ContactState& s, const Coefficients<T>& k, const History<T>& h,
                      const T& x, const T& rate) {
        const T square = x * x;
        const Depth<T> d{square * square, square, x};
        if constexpr (Law::hysteretic)
            return s.phase == ContactState::loading    ? law.elastic_force(k, d)
                   : s.phase == ContactState::yielding ? law.yielding_force(k, d)
                                                       : law.unloading_force(h, d);
        else
            return law.force(k, d, rate).total;
    }

    template <class Law> static Force force_of(const Law& law, const ContactState& s, real x, real rate) {
        const std::array<real, 5> n = numbers_of(s);
        if constexpr (requires { Law::is_opaque; }) {
            // A formula that is called through a pointer takes plain numbers only.
            Force f;
            f.total = evaluate<Law, real>(law, s, s.coefficients, s.history, x, rate);
            const auto slope = [&](real size, auto&& moved) {
                std::array<real, 1> result{};
                differentiate<1>([&](real h) { return std::array<real, 1>{moved(h)}; }, 1 / size, result);
                return result[0];
            };
            const auto at = [&](real dx, real dr, real dk, real dc) {
                return evaluate<Law, real>(law, s, {n[0] + dk, n[1] + dc}, s.history, x + dx, rate + dr);
            };
            f.x = slope(x, [&](real h) { return at(h, 0, 0, 0); });
            f.rate = slope(rate != 0 ? std::fabs(rate) : 1, [&](real h) { return at(0, h, 0, 0); });
            f.stiffness = slope(n[0] != 0 ? std::fabs(n[0]) : 1, [&](real h) { return at(0, 0, h, 0); });
            f.second = slope(n[1] != 0 ? std::fabs(n[1]) : 1, [&](real h) { return at(0, 0, 0, h); });
            return f;
        } else {
            using T = Dual<7>;
            const T f = evaluate<Law, T>(law, s, {T(n[0], 2), T(n[1], 3)},
                                         {T(n[2], 4), T(n[3], 5), T(n[4], 6)}, T(x, 0), T(rate, 1));
            return {f.value,    f.slope[0], f.slope[1], f.slope[2],
                    f.slope[3], f.slope[4], f.slope[5], f.slope[6]};
        }
    }

    // The derivative of the force in numbers of the law that its formula takes from the law itself.
    template <class Law>
    static real formula_slope(const Law& law, const NormalLaw& change, const ContactState& s, real x,
                              real rate) {
        const real speed = rate_of(law, change);
        if (speed == 0) return 0;
        std::array<real, 1> slope{};
        differentiate<1>(
            [&](real h) {
                return std::array<real, 1>{
                    evaluate<Law, real>(moved_law(law, change, h), s, s.coefficients, s.history, x, rate)};
            },
            speed, slope);
        return slope[0];
    }

    // Whether the formula of the force depends on the numbers that change in a parameter.
    std::vector<char> in_formula_; // by contact and parameter
    bool is_in_formula(int c, std::size_t p) const {
        return in_formula_[static_cast<std::size_t>(c) * parameters() + p];
    }

    void find_formulas() {
        in_formula_.assign(problem_.contacts.size() * parameters(), false);
        for (int c = 0; c < problem_.contact_count(); ++c)
            for (std::size_t p = 0; p < parameters(); ++p)
                contact(c).normal.visit([&]<class Law>(const Law& law) {
                    const NormalLaw& change = contact_of(slopes_[p], c).normal;
                    const real rate = rate_of(law, change);
                    if (rate == 0) return;
                    const Law moved = moved_law(law, change, 1e-3 / rate);
                    ContactState s;
                    s.coefficients = {1, 1}, s.history = {1, 1, 0.25};
                    for (const auto phase :
                         {ContactState::loading, ContactState::yielding, ContactState::unloading})
                        for (const real x : {0.01, 0.1, 0.7}) {
                            s.phase = phase;
                            const auto at = [&](const Law& one) {
                                return evaluate<Law, real>(one, s, s.coefficients, s.history, x, 1.0);
                            };
                            if (at(law) != at(moved))
                                in_formula_[static_cast<std::size_t>(c) * parameters() + p] = true;
                        }
                });
    }

    // ---- closed contacts

    // dt/dtau / x_j^3, which is finite where x_j is zero.
    real clock_over_cube(const real* y, real clock, std::size_t j) const {
        const System& system = run_.system;
        const real x = y[system.x_index(j)];
        if (system.active.size() == 1) return 1;
        if (x != 0) return clock / cube(x);
        real ties = 0;
        for (std::size_t i = 0; i < system.active.size(); ++i) ties += y[system.x_index(i)] == 0;
        return 1 / ties;
    }

    // Computes the rates of the state and of its derivatives in the transformed time.
    void extended_rates(const real* y, real* dy) {
        System& system = run_.system;
        system(y, dy);
        const real clock = dy[system.time_index()];
        const real* t = y + system.size();
        real* dt = dy + system.size();
        const auto at = [&](real* matrix, std::size_t i) { return matrix + i * count_; };
        const auto of = [&](std::size_t i) { return t + i * count_; };
        std::fill_n(dt, size_ * count_, 0.0);
        // Forces on dampers' points and balls, and their derivatives times the clock.
        std::fill(cavity_force_.begin(), cavity_force_.end(), 0.0);
        std::fill(ball_force_.begin(), ball_force_.end(), 0.0);
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            const Active& a = system.active[j];
            const Contact& c = contact(a.contact);
            const LawSlopes& law_slopes = laws_[static_cast<std::size_t>(a.contact)];
            const real x = std::fmax(y[system.x_index(j)], 1e-12), rate = system.approach(y, a.contact);
            differentiate_gap(c, y, t, gap_.data(), gap_rate_.data());
            const bool unloads = a.state.phase == ContactState::unloading;
            const Force f = c.normal.visit([&](const auto& law) { return force_of(law, a.state, x, rate); });
            const real steep = 0.25 * f.x * clock_over_cube(y, clock, j);
            for (std::size_t d = 0; d < count_; ++d) {
                const real deeper = -gap_[d] - (unloads ? law_slopes.origin[d] : 0);
                force_[d] = steep * deeper +
                            clock * (-f.rate * gap_rate_[d] + f.stiffness * law_slopes.stiffness[d] +
                                     f.second * law_slopes.second[d] + f.deepest * law_slopes.deepest[d] +
                                     f.unloading * law_slopes.unloading[d] + f.origin * law_slopes.origin[d]);
            }
            for (std::size_t p = 0; p < parameters(); ++p)
                if (is_in_formula(a.contact, p))
                    force_[states() + p] += clock * c.normal.visit([&](const auto& law) {
                        return formula_slope(law, contact_of(slopes_[p], a.contact).normal, a.state, x, rate);
                    });
            each_side(c, [&](real sign, int body) {
                if (body != wall) {
                    const auto b = static_cast<std::size_t>(body);
                    ball_force_[b] += sign * f.total;
                    real* v = at(dt, velocity_row(body));
                    for (std::size_t d = 0; d < count_; ++d) v[d] += sign * force_[d] / problem_.ball_mass[b];
                    return;
                }
                cavity_force_[static_cast<std::size_t>(c.damper)] += sign * f.total;
                for (std::size_t k = 0; k < modes_; ++k) {
                    const real shape = sign * damper_of(problem_, c).shape[k];
                    real* v = at(dt, 2 * k + 1);
                    for (std::size_t d = 0; d < count_; ++d) v[d] += shape * force_[d];
                }
            });
        }
        const auto add = [&](real* target, real weight, const real* source) {
            for (std::size_t d = 0; d < count_; ++d) target[d] += weight * source[d];
        };
        for (std::size_t k = 0; k < modes_; ++k) {
            add(at(dt, 2 * k), clock, of(2 * k + 1));
            real* v = at(dt, 2 * k + 1);
            add(v, -2 * problem_.modes[k].decay * clock, of(2 * k + 1));
            add(v, -problem_.modes[k].stiffness * clock, of(2 * k));
            for (std::size_t i = 0; i < modes_ && !problem_.coupling.empty(); ++i)
                add(v, -problem_.coupling[k * modes_ + i] * clock, of(2 * i + 1));
        }
        for (std::size_t b = 0; b < balls_; ++b)
            add(at(dt, 2 * modes_ + b), clock, of(2 * modes_ + balls_ + b));
        if (parameters() > 0) add_parameters(y, clock, run_.state.t + y[system.time_index()], dt);
    }

    // Adds what the parameters change in the equations of motion at a state.
    void add_parameters(const real* y, real clock, real time, real* dt) {
        for (std::size_t p = 0; p < parameters(); ++p) {
            const Problem& slope = slopes_[p];
            const auto target = [&](std::size_t i) -> real& { return dt[i * count_ + states() + p]; };
            for (std::size_t k = 0; k < modes_; ++k) {
                real force = -2 * slope.modes[k].decay * y[2 * k + 1] - slope.modes[k].stiffness * y[2 * k];
                for (std::size_t d = 0; d < problem_.dampers.size(); ++d)
                    force += slope.dampers[d].shape[k] * cavity_force_[d];
                for (std::size_t i = 0; i < modes_ && !slope.coupling.empty(); ++i)
                    force -= slope.coupling[k * modes_ + i] * y[2 * i + 1];
                target(2 * k + 1) += clock * force;
            }
            for (std::size_t b = 0; b < balls_; ++b)
                target(2 * modes_ + balls_ + b) +=
                    clock * (slope.dampers[static_cast<std::size_t>(problem_.ball_damper[b])].gravity -
                             slope.ball_mass[b] / square(problem_.ball_mass[b]) * ball_force_[b]);
            for (std::size_t l = 0; l < run_.loads.size(); ++l) {
                const Piece& piece = run_.loads.piece(l);
                const Load& load = run_.loads.load(l);
                const real change =
                    signal_slope_at(piece, signal_slope(piece, load.signal, slope.loads[l].signal), time);
                const real value = piece.is_zero() ? 0 : piece.value(time);
                for (std::size_t k = 0; k < modes_; ++k)
                    target(2 * k + 1) += clock * (load.shape[k] * change + slope.loads[l].shape[k] * value);
                if (load.base)
                    for (std::size_t b = 0; b < balls_; ++b)
                        target(2 * modes_ + balls_ + b) -= clock * change;
            }
        }
    }

    // Derivative of the matrix of a complementarity problem in a parameter (contact_coupling, negative).
    real coupling_slope(const Contact& a, const Contact& b, const Problem& slope) const {
        real sum = 0;
        each_side(a, [&](real sign_a, int body_a) {
            each_side(b, [&](real sign_b, int body_b) {
                if (body_a >= 0 && body_a == body_b) {
                    const auto i = static_cast<std::size_t>(body_a);
                    sum -= sign_a * sign_b * slope.ball_mass[i] / square(problem_.ball_mass[i]);
                }
                if (body_a != wall || body_b != wall) return;
                for (std::size_t k = 0; k < modes_; ++k)
                    sum += sign_a * sign_b *
                           (damper_of(slope, a).shape[k] * damper_of(problem_, b).shape[k] +
                            damper_of(problem_, a).shape[k] * damper_of(slope, b).shape[k]);
            });
        });
        return sum;
    }

public:
    // The derivatives start as those of the state at the start in itself; in the parameters, too, if the run
    // starts with the case rather than from a given state.
    Linearisation(RunState& run, std::vector<Problem> slopes, bool from_case)
        : run_(run), problem_(run.problem), slopes_(std::move(slopes)), modes_(problem_.modes.size()),
          balls_(problem_.ball_mass.size()), size_(problem_.motion_size()), count_(size_ + slopes_.size()),
          tangent_(size_ * count_), misses_(problem_.contacts.size()), laws_(problem_.contacts.size()),
          motion_(problem_), homogeneous_(without_forces(problem_)), free_motion_(homogeneous_),
          state_(problem_), rates_(size_), times_(count_), gap_(count_), gap_rate_(count_), force_(count_),
          ball_force_(balls_), cavity_force_(problem_.dampers.size()) {
        for (std::size_t i = 0; i < size_; ++i) row(tangent_, i)[i] = 1;
        for (std::size_t p = 0; p < slopes_.size() && from_case; ++p) {
            const State start(slopes_[p]);
            for (std::size_t i = 0; i < size_; ++i) row(tangent_, i)[size_ + p] = start.y[i];
        }
        for (LawSlopes& each : laws_)
            for (auto* column : {&each.stiffness, &each.second, &each.deepest, &each.unloading, &each.origin})
                column->assign(count_, 0.0);
        find_formulas();
    }

    // Only the first reason is kept.
    void refuse(NotLinear why, int c) {
        if (refused_ != NotLinear::none) return;
        refused_ = why, refused_at_ = run_.state.t, refused_contact_ = c;
    }

    // A run may start where a contact begins or ends, but not within one, whose history is unknown.
    void check_start() {
        for (int c = 0; c < problem_.contact_count(); ++c)
            if (gap(problem_, contact(c), run_.state.y.data()).value <
                -touching_margin * epsilon * run_.gap_terms(c))
                refuse(NotLinear::closed, c);
    }

    static Problem without_forces(const Problem& problem) {
        Problem bare = problem;
        bare.loads.clear();
        for (Damper& damper : bare.dampers) damper.clearance = damper.gravity = 0;
        return bare;
    }

    const std::vector<real>& tangent() const { return tangent_; }
    const std::vector<NearMiss>& misses() const { return misses_; }
    NotLinear refused() const { return refused_; }
    real refused_at() const { return refused_at_; }
    int refused_contact() const { return refused_contact_; }
    std::size_t rows() const { return size_; }
    std::size_t columns() const { return count_; }
    // Returns the rates of the state now.
    const std::vector<real>& rates() {
        rates_of_contacts();
        return rates_;
    }

    void flight(const Flight& flight, real length) override {
        find_misses(flight, length);
        const TaylorMotion* series = flight.series();
        if (!series) return advance_free(length);
        if (series->held().empty()) return advance_series(*series, length);
        advance_held(series->held(), length);
    }

    void pass_knot() override {
        // The rates of the state jump with the loads; contacts at rest that those pull apart open.
        std::fill(times_.begin(), times_.end(), 0.0);
        bool moves = false;
        for (std::size_t p = 0; p < parameters(); ++p)
            for (std::size_t l = 0, first = run_.loads.size(); l < run_.loads.size(); ++l) {
                const Signal &signal = run_.loads.load(l).signal, &slope = slopes_[p].loads[l].signal;
                const real t = run_.state.t;
                if (t != signal.start && t != signal.stop) continue;
                const real late = t == signal.start ? slope.start : slope.stop;
                // Knots of two loads at one time that move apart jump one after the other.
                real& time = times_[states() + p];
                if (first < l && late != time) refuse(NotLinear::kink, -1);
                first = l, time = late;
                moves = moves || late != 0;
            }
        if (!moves) return;
        rates_of_flight();
        shift(1);
        Loads after(problem_.loads);
        after.advance(run_.state.t);
        std::vector<int> held = run_.stuck;
        rates_of_flight(after, held);
        for (std::size_t i = held.size(); i-- > 0;)
            if (motion_.forces()[i].c[0] < 0) {
                held.erase(held.begin() + static_cast<std::ptrdiff_t>(i));
                rates_of_flight(after, held);
                i = held.size();
            }
        shift(-1);
    }

    void begin_impact(int c) override {
        std::fill(times_.begin(), times_.end(), 0.0);
        if (c < 0) return;
        rates_of_flight();
        const real* y = run_.state.y.data();
        differentiate_gap(contact(c), y, tangent_.data(), gap_.data(), gap_rate_.data());
        const real speed = -gap(problem_, contact(c), y).rate;
        for (std::size_t d = 0; d < count_; ++d) times_[d] = gap_[d] / speed;
        shift(1);
    }

    void impulses(const Impulses& one) override {
        // The contacts whose equation is an equality.
        std::vector<std::size_t> part;
        for (std::size_t i = 0; i < one.contacts.size(); ++i)
            if (one.impulse[i] != 0 || one.is_two_sided[i]) part.push_back(i);
        const std::size_t n = part.size(), all = one.contacts.size();
        // Contacts that have come to rest, or do not rebound, are constraints of the same instant.
        const auto rebounding = std::count_if(part.begin(), part.end(), [&](std::size_t i) {
            return i >= one.resting && one.restitution[i - one.resting] > 0;
        });
        if (rebounding > 1) refuse(NotLinear::simultaneous, one.contacts[part.back()]);
        std::vector<real> original(n * n), right(n), matrix, changes(n * count_);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) original[i * n + j] = one.matrix[part[i] * all + part[j]];
        // Derivatives of the changes of the approach rates.
        for (std::size_t i = 0; i < n; ++i) {
            const int c = one.contacts[part[i]];
            differentiate_gap(contact(c), run_.state.y.data(), tangent_.data(), gap_.data(),
                              gap_rate_.data());
            const real e = part[i] < one.resting ? 0 : one.restitution[part[i] - one.resting];
            const real speed = one.change[part[i]] / (1 + e);
            const real steep = e > 0 ? restitution_slope(c, speed, nullptr) : 0;
            for (std::size_t d = 0; d < count_; ++d)
                changes[i * count_ + d] = -(1 + e + speed * steep) * gap_rate_[d];
            for (std::size_t p = 0; p < parameters() && e > 0; ++p)
                changes[i * count_ + states() + p] += speed * restitution_slope(c, speed, &slopes_[p]);
            for (std::size_t p = 0; p < parameters(); ++p)
                for (std::size_t j = 0; j < n; ++j)
                    changes[i * count_ + states() + p] -=
                        coupling_slope(contact(c), contact(one.contacts[part[j]]), slopes_[p]) *
                        one.impulse[part[j]];
        }
        for (std::size_t d = 0; d < count_; ++d) {
            for (std::size_t i = 0; i < n; ++i) right[i] = changes[i * count_ + d];
            matrix = original;
            solve_definite(matrix, right, original);
            for (std::size_t i = 0; i < n; ++i) changes[i * count_ + d] = right[i];
        }
        for (std::size_t i = 0; i < n; ++i)
            apply(contact(one.contacts[part[i]]), one.impulse[part[i]], changes.data() + i * count_);
    }

    void end_impact() override {
        rates_of_flight();
        shift(-1);
    }

    void graze(int c) override { refuse(NotLinear::grazing, c); }

    void touch(int c, real speed, real e) override {
        std::fill(times_.begin(), times_.end(), 0.0);
        std::vector<real> slower(count_, 0.0);
        const real* y = run_.state.y.data();
        if (speed > 0) {
            rates_of_contacts();
            const real turn = gap_acceleration(contact(c), rates_);
            differentiate_gap(contact(c), y, tangent_.data(), gap_.data(), gap_rate_.data());
            for (std::size_t d = 0; d < count_; ++d) {
                times_[d] = gap_[d] / speed;
                slower[d] = -(gap_rate_[d] + turn * times_[d]);
            }
        }
        set_law_slopes(c, slower, speed, [&](const auto& law, real faster, const Contact* change, real h) {
            const real v = speed + faster;
            return initial_state(law, law.needs_restitution() ? moved_restitution(c, v, change, h) : e, v);
        });
        if (speed <= 0) return;
        const real force = contact(c)
                               .normal
                               .visit([&](const auto& law) {
                                   return contact_force(law, initial_state(law, e, speed), 0, speed);
                               })
                               .total;
        if (force != 0) lengthen_force(contact(c), -force);
    }

    void step(const real* y, real length) override {
        const std::size_t n = run_.system.size();
        extended_.resize(n + size_ * count_), extended_end_.resize(extended_.size());
        std::copy_n(y, n, extended_.begin());
        std::copy(tangent_.begin(), tangent_.end(), extended_.begin() + static_cast<std::ptrdiff_t>(n));
        const auto rates = [this](const real* from, real* to) { extended_rates(from, to); };
        integrator_.resize(static_cast<int>(extended_.size()));
        // The derivative of a force may be less smooth than the force. One step is nearly always enough.
        constexpr real shortest = 1e-9; // part of the step of the run
        sizes_.assign(count_, 0.0);
        real done = 0, h = length;
        while (done < length) {
            const bool last = !(done + h < length);
            if (last) h = length - done;
            integrator_.start(rates, extended_.data());
            integrator_.step(rates, extended_.data(), h, extended_end_.data());
            set_scales(n);
            const real error = integrator_.error(h, scale_);
            if (error > 1 && h > shortest * length) {
                h *= std::fmax(smallest_shrink, safety * std::pow(error, error_exponent));
                continue;
            }
            done = last ? length : done + h;
            std::swap(extended_, extended_end_);
            h *= error > 0 ? std::fmin(largest_growth, safety * std::pow(error, error_exponent))
                           : largest_growth;
        }
        std::copy(extended_.begin() + static_cast<std::ptrdiff_t>(n), extended_.end(), tangent_.begin());
        note_misses_of_step(y, extended_.data());
    }

    void end_phase(std::size_t j) override {
        const Active& a = run_.system.active[j];
        const Contact& c = contact(a.contact);
        const real* y = run_.state.y.data();
        ContactState next = a.state;
        const PhaseEnd end = c.normal.visit([&](const auto& law) { return next_phase(law, next, a.x); });
        differentiate_gap(c, y, tangent_.data(), gap_.data(), gap_rate_.data());
        if (a.state.phase == ContactState::yielding) {
            // The deepest overlap does not depend on the time at which it is reached.
            std::vector<real> deeper(count_);
            for (std::size_t d = 0; d < count_; ++d) deeper[d] = -gap_[d];
            const LawSlopes before = laws_[static_cast<std::size_t>(a.contact)];
            set_law_slopes(a.contact, deeper, next.history.deepest,
                           [&]<class Law>(const Law& law, real more, const Contact*, real) {
                               ContactState s;
                               if constexpr (Law::hysteretic)
                                   s.history = law.unloaded_from(next.history.deepest + more);
                               return s;
                           });
            laws_[static_cast<std::size_t>(a.contact)].stiffness = before.stiffness;
            laws_[static_cast<std::size_t>(a.contact)].second = before.second;
            return;
        }
        if (end == PhaseEnd::stay) return;
        // The force may jump to zero where the overlap above the origin of the phase vanishes; where a
        // contact ends at zero force, it does not.
        const real rate = run_.system.approach(y, a.contact), x = a.x;
        const bool ends_at_overlap = end == PhaseEnd::open || c.normal.visit([](const auto& law) {
            return std::decay_t<decltype(law)>::hysteretic;
        });
        const real force =
            c.normal.visit([&](const auto& law) { return contact_force(law, a.state, x, rate).total; });
        if (!ends_at_overlap || force == 0 || rate == 0) return;
        const LawSlopes& slopes = laws_[static_cast<std::size_t>(a.contact)];
        for (std::size_t d = 0; d < count_; ++d)
            times_[d] = (gap_[d] + (a.state.phase == ContactState::unloading ? slopes.origin[d] : 0)) / rate;
        lengthen_force(c, force);
    }

private:
    // Sets the permitted errors of a step: those of the derivatives of velocities, as parts of the largest
    // one in the same direction.
    void set_scales(std::size_t n) {
        constexpr real tolerance = 1e-11;
        scale_.assign(extended_.size(), infinity);
        for (std::size_t d = 0; d < count_; ++d) {
            real& size = sizes_[d]; // of the largest step so far: a singular derivative begins small
            const auto each_velocity = [&](auto&& f) {
                for (std::size_t k = 0; k < modes_; ++k) f(n + (2 * k + 1) * count_ + d);
                for (std::size_t b = 0; b < balls_; ++b) f(n + (2 * modes_ + balls_ + b) * count_ + d);
            };
            each_velocity([&](std::size_t i) {
                size = std::fmax(size, std::fmax(std::fabs(extended_[i]), std::fabs(extended_end_[i])));
            });
            each_velocity([&](std::size_t i) { scale_[i] = size > 0 ? tolerance * size : infinity; });
        }
    }

    // Adds an impulse and its derivatives to those of the velocities.
    void apply(const Contact& c, real impulse, const real* change) {
        each_side(c, [&](real sign, int body) {
            if (body != wall) {
                const real mass = problem_.ball_mass[static_cast<std::size_t>(body)];
                real* v = row(tangent_, velocity_row(body));
                for (std::size_t d = 0; d < count_; ++d) v[d] += sign * change[d] / mass;
                for (std::size_t p = 0; p < parameters(); ++p)
                    v[states() + p] -=
                        sign * impulse * slopes_[p].ball_mass[static_cast<std::size_t>(body)] / square(mass);
                return;
            }
            for (std::size_t k = 0; k < modes_; ++k) {
                real* v = row(tangent_, 2 * k + 1);
                for (std::size_t d = 0; d < count_; ++d)
                    v[d] += sign * damper_of(problem_, c).shape[k] * change[d];
                for (std::size_t p = 0; p < parameters(); ++p)
                    v[states() + p] += sign * impulse * damper_of(slopes_[p], c).shape[k];
            }
        });
    }

    // The closest approach within a step beside closed contacts, on the parabola through both ends.
    void note_misses_of_step(const real* y, const real* end) {
        const real length = end[run_.system.time_index()] - y[run_.system.time_index()];
        if (!(length > 0)) return;
        for (int c = 0; c < problem_.contact_count(); ++c) {
            if (run_.phase(c) != RunState::Phase::open) continue;
            const Gap before = gap(problem_, contact(c), y), after = gap(problem_, contact(c), end);
            if (!(before.rate < 0 && after.rate >= 0)) continue;
            const real curvature = (after.rate - before.rate) / length;
            note_miss(c, {run_.state.t + y[run_.system.time_index()] - before.rate / curvature,
                          before.value - 0.5 * square(before.rate) / curvature, curvature});
        }
    }
};

} // namespace rattlebox
