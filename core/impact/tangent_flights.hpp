// Derivatives in flights: in closed form, by Taylor series, and where contacts are held closed.
#pragma once

#include "impact/flight.hpp"
#include "impact/tangents.hpp"

namespace rattlebox {

class TangentFlights {
    Tangents& t_;
    Problem homogeneous_; // without loads, gravity and clearances
    TaylorMotion free_motion_;
    State state_;
    std::vector<real> series_; // derivatives of the Taylor series

    // Taylor coefficients of the derivative of the signal of a load in a parameter, about t.
    Series signal_series(std::size_t l, std::size_t p, real t) const {
        const Piece& piece = t_.run.loads.piece(l);
        const Tangents::SignalSlope s =
            t_.signal_slope(piece, t_.run.loads.load(l).signal, t_.slopes[p].loads[l].signal);
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
        return series_.data() + (body * (Series::order + 1) + static_cast<std::size_t>(n)) * t_.count;
    }

    void sum_series(std::size_t body, real s, real* value, real* slope) {
        constexpr int last = Series::order;
        const real* c = coefficient(body, last);
        for (std::size_t d = 0; d < t_.count; ++d) value[d] = c[d], slope[d] = last * c[d];
        for (int n = last - 1; n >= 0; --n) {
            c = coefficient(body, n);
            for (std::size_t d = 0; d < t_.count; ++d) value[d] = value[d] * s + c[d];
            if (n == 0) return;
            for (std::size_t d = 0; d < t_.count; ++d) slope[d] = slope[d] * s + n * c[d];
        }
    }

    // Advances the derivatives by the Taylor series of the equations of motion.
    void advance_series(const TaylorMotion& motion, real s) {
        const std::size_t loads = t_.run.loads.size();
        series_.assign((t_.modes + 1) * (Series::order + 1) * t_.count, 0.0);
        for (std::size_t k = 0; k < t_.modes; ++k) {
            std::copy_n(t_.row(2 * k), t_.count, coefficient(k, 0));
            std::copy_n(t_.row(2 * k + 1), t_.count, coefficient(k, 1));
        }
        // The forces in the parameters, in place of the coefficients that they lead to; those of the base
        // last.
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const Problem& slope = t_.slopes[p];
            const std::size_t d = t_.size + p;
            for (std::size_t l = 0; l < loads; ++l) {
                const Load& load = t_.run.loads.load(l);
                const Series change = signal_series(l, p, t_.run.state.t);
                for (int n = 0; n + 2 <= Series::order; ++n) {
                    for (std::size_t k = 0; k < t_.modes; ++k)
                        coefficient(k, n + 2)[d] +=
                            load.shape[k] * change.c[n] + slope.loads[l].shape[k] * motion.loads()[l].c[n];
                    if (load.base) coefficient(t_.modes, n + 2)[d] -= change.c[n];
                }
            }
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& change = slope.modes[k];
                for (int n = 0; n + 2 <= Series::order; ++n) {
                    real force = 2 * change.decay * (n + 1) * motion.modes()[k].c[n + 1] +
                                 change.stiffness * motion.modes()[k].c[n];
                    for (std::size_t j = 0; j < t_.modes && !slope.coupling.empty(); ++j)
                        force += slope.coupling[k * t_.modes + j] * (n + 1) * motion.modes()[j].c[n + 1];
                    coefficient(k, n + 2)[d] -= force;
                }
            }
        }
        for (int n = 0; n + 2 <= Series::order; ++n)
            for (std::size_t k = 0; k < t_.modes; ++k) {
                real* next = coefficient(k, n + 2);
                const auto subtract = [&](real weight, const real* c) {
                    for (std::size_t d = 0; d < t_.count; ++d) next[d] -= weight * c[d];
                };
                subtract(t_.problem.modes[k].stiffness, coefficient(k, n));
                subtract(2 * t_.problem.modes[k].decay * (n + 1), coefficient(k, n + 1));
                for (std::size_t j = 0; j < t_.modes && !t_.problem.coupling.empty(); ++j)
                    subtract(t_.problem.coupling[k * t_.modes + j] * (n + 1), coefficient(j, n + 1));
                const real both = (n + 1) * (n + 2);
                for (std::size_t d = 0; d < t_.count; ++d) next[d] /= both;
            }
        for (std::size_t k = 0; k < t_.modes; ++k) sum_series(k, s, t_.row(2 * k), t_.row(2 * k + 1));
        // Balls fly free, and all in the same way with the base.
        for (int n = 2; n <= Series::order; ++n)
            for (std::size_t d = 0; d < t_.count; ++d) coefficient(t_.modes, n)[d] /= n * (n - 1);
        std::vector<real>&value = t_.gap_slope, &rate = t_.rate_slope;
        sum_series(t_.modes, s, value.data(), rate.data());
        advance_balls(s, value.data(), rate.data());
    }

    void advance_balls(real s, const real* moved, const real* gained) {
        for (std::size_t b = 0; b < t_.balls; ++b) {
            real *x = t_.row(2 * t_.modes + b), *v = t_.row(2 * t_.modes + t_.balls + b);
            for (std::size_t d = 0; d < t_.count; ++d) x[d] += s * v[d];
            if (moved)
                for (std::size_t d = 0; d < t_.count; ++d) x[d] += moved[d], v[d] += gained[d];
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real g =
                    t_.slopes[p].dampers[static_cast<std::size_t>(t_.problem.ball_damper[b])].gravity;
                x[t_.size + p] += 0.5 * g * s * s, v[t_.size + p] += g * s;
            }
        }
    }

    // Advances the derivatives of free modes and balls in closed form. With w^2 = k - a^2 and the functions C
    // and S of structure/mode.hpp, dC = -s da C - s S w dw and dS = -s da S + w dw (s C - S) / w^2.
    void advance_free(real s) {
        const real* y = t_.run.state.y.data();
        for (std::size_t k = 0; k < t_.modes; ++k) {
            const Mode& mode = t_.problem.modes[k];
            const real a = mode.decay, stiffness = mode.stiffness;
            FreeMode free(mode);
            free.start({0, 1});
            const real sine = free.at(s).q;
            free.start({1, 0});
            const real cosine = free.at(s).q - a * sine;
            const real matrix[4] = {cosine + a * sine, sine, -stiffness * sine, cosine - a * sine};
            real *q = t_.row(2 * k), *v = t_.row(2 * k + 1);
            for (std::size_t d = 0; d < t_.count; ++d) {
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
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real da = t_.slopes[p].modes[k].decay, dk = t_.slopes[p].modes[k].stiffness;
                if (da == 0 && dk == 0) continue;
                const real root_slope = 0.5 * dk - a * da;
                const real dc = -s * da * cosine - s * sine * root_slope,
                           ds = -s * da * sine + root_slope * bent;
                q[t_.size + p] += (dc + da * sine + a * ds) * y[2 * k] + ds * y[2 * k + 1];
                v[t_.size + p] -=
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
        for (std::size_t d = 0; d < t_.count; ++d) {
            for (std::size_t i = 0; i < t_.size; ++i) at.y[i] = t_.row(i)[d];
            free_motion_.expand(at, none, held);
            free_motion_.at(s, end);
            for (std::size_t i = 0; i < t_.size; ++i) t_.row(i)[d] = end.y[i];
        }
        constexpr real h = 0.01, weights[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
        for (std::size_t p = 0; p < t_.parameters(); ++p)
            for (int k = 1; k <= 4; ++k)
                for (const real side : {-1.0, 1.0}) {
                    const Problem moved = moved_problem(p, side * k * h);
                    Loads loads(moved.loads);
                    loads.advance(t_.run.state.t);
                    TaylorMotion motion(moved);
                    motion.expand(t_.run.state, loads, held);
                    motion.at(s, end);
                    for (std::size_t i = 0; i < t_.size; ++i)
                        t_.row(i)[t_.size + p] += side * weights[k - 1] / h * end.y[i];
                }
    }

    Problem moved_problem(std::size_t p, real h) const {
        Problem moved = t_.problem, slope = t_.slopes[p];
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
        const real rate = flight.series() ? 0 : fastest_rate(t_.problem.modes, t_.problem.coupling);
        const int pieces = std::max(1, static_cast<int>(std::fmin(std::ceil(rate * length), 100'000)));
        std::vector<real> before(t_.problem.contacts.size(), 0.0);
        const auto rate_at = [&](int c, real s) {
            flight.at(s, state_);
            return gap(t_.problem, t_.contact(c), state_.y.data()).rate;
        };
        for (int i = 0; i <= pieces; ++i) {
            flight.at(length * i / pieces, state_);
            for (int c = 0; c < t_.problem.contact_count(); ++c) {
                const auto at = static_cast<std::size_t>(c);
                const real now = gap(t_.problem, t_.contact(c), state_.y.data()).rate;
                const real last = std::exchange(before[at], now);
                if (i == 0 || !(last < 0 && now >= 0) || t_.run.phase(c) != RunState::Phase::open) continue;
                // By the Illinois algorithm, as in impact/closed_motion.hpp; the gap is flat there.
                real low = length * (i - 1) / pieces, high = length * i / pieces, below = last, above = now;
                int side = 0;
                for (int pass = 0; pass < 40 && above > 0 && high - low > 1e-9 * length; ++pass) {
                    const real between = low - (high - low) * below / (above - below);
                    const real rate = rate_at(c, between);
                    (rate < 0 ? low : high) = between;
                    (rate < 0 ? below : above) = rate;
                    if (const int moved = rate < 0 ? 1 : -1; std::exchange(side, moved) == moved)
                        (rate < 0 ? above : below) *= 0.5;
                }
                const real width = 1e-3 * length / pieces;
                const real from = std::fmax(high - width, 0.0), to = std::fmin(high + width, length);
                const real curvature = (rate_at(c, to) - rate_at(c, from)) / (to - from);
                flight.at(high, state_);
                t_.note_miss(c, {t_.run.state.t + high, gap(t_.problem, t_.contact(c), state_.y.data()).value,
                                 curvature});
                flight.at(length * i / pieces, state_);
            }
        }
    }

    static Problem without_forces(const Problem& problem) {
        Problem bare = problem;
        bare.loads.clear();
        for (Damper& damper : bare.dampers) damper.clearance = damper.gravity = 0;
        return bare;
    }

public:
    explicit TangentFlights(Tangents& tangents)
        : t_(tangents), homogeneous_(without_forces(t_.problem)), free_motion_(homogeneous_),
          state_(t_.problem) {}

    void flight(const Flight& flight, real length) {
        find_misses(flight, length);
        const TaylorMotion* series = flight.series();
        if (!series) return advance_free(length);
        if (series->held().empty()) return advance_series(*series, length);
        advance_held(series->held(), length);
    }

    void pass_knot() {
        // The rates of the state jump with the loads; contacts at rest that those pull apart open.
        std::fill(t_.times.begin(), t_.times.end(), 0.0);
        bool moves = false;
        for (std::size_t p = 0; p < t_.parameters(); ++p)
            for (std::size_t l = 0, first = t_.run.loads.size(); l < t_.run.loads.size(); ++l) {
                const Signal &signal = t_.run.loads.load(l).signal, &slope = t_.slopes[p].loads[l].signal;
                const real t = t_.run.state.t;
                if (t != signal.start && t != signal.stop) continue;
                const real late = t == signal.start ? slope.start : slope.stop;
                // Knots of two loads at one time that move apart jump one after the other.
                real& time = t_.times[t_.size + p];
                if (first < l && late != time) t_.refuse(NotLinear::kink, -1);
                first = l, time = late;
                moves = moves || late != 0;
            }
        if (!moves) return;
        t_.rates_of_flight();
        t_.shift(1);
        Loads after(t_.problem.loads);
        after.advance(t_.run.state.t);
        std::vector<int> held = t_.run.stuck;
        t_.rates_of_flight(after, held);
        for (std::size_t i = held.size(); i-- > 0;)
            if (t_.motion.forces()[i].c[0] < 0) {
                held.erase(held.begin() + static_cast<std::ptrdiff_t>(i));
                t_.rates_of_flight(after, held);
                i = held.size();
            }
        t_.shift(-1);
    }
};

} // namespace rattlebox
