// Derivatives through an isolated contact that was solved as a whole (impact/isolated_contact.hpp).
//
// The derivatives of a converged solution solve the equations linearised about it, at the same nodes. With
// A the matrix of the integrals up to the nodes, s = dt/dx, f' the derivative of the contact force at a fixed
// time, g' that of the gap, and K and C those of the force in overlap and rate:
//
//     p = s f'      g' = g'(free) + A s A p / m      p = s (e - K g' - C dg'/dt)
//
// e are the derivatives in the coefficients of the law. K is as singular as 1/s where the overlap vanishes,
// so that s K is smooth, and p is resolved by the nodes of the solution. The forces of modes on themselves
// are small within a contact and follow from fixed-point iterations, as in the solution.
//
// One more direction than asked for checks the result, a shift of the time: its derivative at the start is
// the rate of the state at the start, and at the end it must be that at the end.
#pragma once

#include "impact/isolated_contact.hpp"
#include "impact/tangent_laws.hpp"
#include "math/factorised.hpp"

namespace rattlebox {

class TangentCollocation {
    static constexpr int n = PhaseGrid::n;
    using Row = PhaseGrid::Rule::Row;
    static constexpr int max_passes = 24;
    static constexpr real converged = 1e-13; // change of the forces of modes on themselves, as part of speeds
    static constexpr real resolved = 1e-12;  // error of the check, as part of the largest derivative

    Tangents& t_;
    TangentLaws& laws_;
    const std::size_t columns_;     // directions, with that of the time
    std::vector<real> start_, end_; // derivatives at the start and the end, row by row
    Factorised<n, Row> system_;
    Row clock_, force_, stiffness_, damping_;            // s, F, s K and s C at the nodes
    std::vector<Row> constant_, gap_, rate_;             // by direction: s e; the gap without modes, its rate
    std::vector<Row> impulse_, once_, twice_;            // by direction: p, A p, A s A p
    std::vector<Row> own_, outer_, velocity_, position_; // by mode and direction: forces and motion
    std::vector<Row> scratch_, base_, base_once_,
        base_twice_; // by parameter and for the time: base acceleration
    std::vector<real> share_;
    real length_ = 0;

    static const PhaseGrid::Rule& rule() { return PhaseGrid::rule(); }
    // The matrix of the integrals up to each node, by columns.
    static const std::array<Row, n>& integrals() {
        static const std::array<Row, n> matrix = [] {
            std::array<Row, n> columns;
            for (int k = 0; k < n; ++k) {
                Row unit{};
                unit[k] = 1;
                rule().integrate<1>(&unit, &columns[static_cast<std::size_t>(k)]);
            }
            return columns;
        }();
        return matrix;
    }
    const real* row(std::size_t i) const { return start_.data() + i * columns_; }
    std::size_t at(std::size_t mode, std::size_t direction) const { return mode * columns_ + direction; }

    // Integrates s times rows over time, from given values at the start.
    template <class Start>
    void integrate_times_clock(const std::vector<Row>& from, std::vector<Row>& to, Start&& start) {
        scratch_.resize(from.size()), to.resize(from.size());
        for (std::size_t r = 0; r < from.size(); ++r)
            for (int i = 0; i < n; ++i) scratch_[r][i] = from[r][i] * clock_[i];
        rule().integrate(scratch_.data(), to.data(), from.size());
        for (std::size_t r = 0; r < from.size(); ++r) {
            const real first = start(r);
            if (first != 0)
                for (int i = 0; i < n; ++i) to[r][i] += first;
        }
    }

    real integral(const Row& f) const {
        Row part;
        for (int i = 0; i < n; ++i) part[i] = f[i] * clock_[i];
        return rule().integral(part);
    }

    // Computes the force and its derivatives at the nodes.
    void differentiate_force(int c, const HertzTsuji& law, const ContactState& state,
                             const IsolatedContact& solution) {
        const TangentLaws::Slopes& slopes = laws_.slopes[static_cast<std::size_t>(c)];
        clock_ = solution.time_slope();
        Row by_stiffness, by_second;
        for (int i = 0; i < n; ++i) {
            const real x = solution.root()[i];
            const TangentLaws::Force f = TangentLaws::force_of(law, state, x, solution.rate()[i]);
            force_[i] = f.total;
            stiffness_[i] = clock_[i] * 0.25 * f.x / cube(x);
            damping_[i] = clock_[i] * f.rate;
            by_stiffness[i] = clock_[i] * f.stiffness;
            by_second[i] = clock_[i] * f.second;
        }
        constant_.assign(columns_, Row{});
        for (std::size_t d = 0; d < t_.count; ++d)
            for (int i = 0; i < n; ++i)
                constant_[d][i] = by_stiffness[i] * slopes.stiffness[d] + by_second[i] * slopes.second[d];
    }

    // Computes and factorises the matrix 1 + (s C A + s K A s A) / m.
    void factorise(real mass) {
        const Row* once = integrals().data();
        scratch_.resize(n);
        std::vector<Row>& twice = position_; // not in use yet
        twice.resize(std::max<std::size_t>(twice.size(), n));
        for (int k = 0; k < n; ++k)
            for (int i = 0; i < n; ++i) scratch_[static_cast<std::size_t>(k)][i] = clock_[i] * once[k][i];
        rule().integrate(scratch_.data(), twice.data(), n);
        for (int k = 0; k < n; ++k) {
            Row& column = system_.column[k];
            const Row& second = twice[static_cast<std::size_t>(k)];
            for (int i = 0; i < n; ++i)
                column[i] = (damping_[i] * once[k][i] + stiffness_[i] * second[i]) / mass;
            column[k] += 1;
        }
        system_.factorise();
    }

    // Computes what the parameters add to the accelerations: of all balls by the base, and of the modes.
    void force_outside(const Contact& c, const IsolatedContact& solution) {
        const real start = t_.run.state.t;
        const Row& time = solution.time();
        outer_.assign(t_.modes * columns_, Row{});
        base_.assign(t_.parameters() + 1, Row{});
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const Problem& slope = t_.slopes[p];
            for (std::size_t l = 0; l < t_.run.loads.size(); ++l) {
                const Piece& piece = t_.run.loads.piece(l);
                const Load& load = t_.run.loads.load(l);
                const Tangents::SignalSlope signal =
                    t_.signal_slope(piece, load.signal, slope.loads[l].signal);
                const bool moves = signal.is_any();
                for (int i = 0; i < n && moves; ++i) {
                    const real change = t_.signal_slope_at(piece, signal, start + time[i]);
                    for (std::size_t k = 0; k < t_.modes; ++k)
                        outer_[at(k, t_.size + p)][i] += load.shape[k] * change;
                    if (load.base) base_[p][i] -= change;
                }
                for (std::size_t k = 0; k < t_.modes; ++k)
                    if (const real shape = slope.loads[l].shape[k]; shape != 0 && !piece.is_zero())
                        for (int i = 0; i < n; ++i)
                            outer_[at(k, t_.size + p)][i] += shape * piece.value(start + time[i]);
            }
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = slope.modes[k];
                real shape = 0; // of the force on the cavity
                t_.each_side(c, [&](real sign, int body) {
                    if (body == wall) shape += sign * t_.damper_of(slope, c).shape[k];
                });
                if (mode.decay == 0 && mode.stiffness == 0 && shape == 0) continue;
                for (int i = 0; i < n; ++i)
                    outer_[at(k, t_.size + p)][i] += shape * force_[i] -
                                                     2 * mode.decay * solution.velocity(k)[i] -
                                                     mode.stiffness * solution.displacement(k)[i];
            }
        }
        for (std::size_t l = 0; l < t_.run.loads.size(); ++l) {
            const Piece& piece = t_.run.loads.piece(l);
            const Load& load = t_.run.loads.load(l);
            for (int i = 0; i < n && !piece.is_zero(); ++i) {
                const real change = Tangents::signal_rate(piece, start + time[i]);
                for (std::size_t k = 0; k < t_.modes; ++k)
                    outer_[at(k, t_.count)][i] += load.shape[k] * change;
                if (load.base) base_.back()[i] -= change;
            }
        }
        const auto none = [](std::size_t) { return 0.0; };
        integrate_times_clock(base_, base_once_, none);
        integrate_times_clock(base_once_, base_twice_, none);
    }

    // Computes gap and rate without the modes and without the derivative of the contact force.
    void place_balls(const Contact& c, const IsolatedContact& solution) {
        const Row& time = solution.time();
        gap_.assign(columns_, Row{}), rate_.assign(columns_, Row{});
        std::vector<Row> own(2), sums(2);
        own[0] = force_;
        for (int i = 0; i < n; ++i) own[0][i] *= clock_[i];
        rule().integrate<1>(&own[0], &sums[0]);
        for (int i = 0; i < n; ++i) own[1][i] = sums[0][i] * clock_[i];
        rule().integrate<1>(&own[1], &sums[1]);
        t_.each_side(c, [&](real sign, int body) {
            if (body == wall) {
                for (std::size_t p = 0; p < t_.parameters(); ++p)
                    for (std::size_t k = 0; k < t_.modes; ++k)
                        if (const real shape = sign * t_.damper_of(t_.slopes[p], c).shape[k]; shape != 0)
                            for (int i = 0; i < n; ++i) {
                                gap_[t_.size + p][i] += shape * solution.displacement(k)[i];
                                rate_[t_.size + p][i] += shape * solution.velocity(k)[i];
                            }
                return;
            }
            const real *x = row(t_.position_row(body)), *v = row(t_.velocity_row(body));
            for (std::size_t d = 0; d < columns_; ++d)
                for (int i = 0; i < n; ++i) {
                    gap_[d][i] += sign * (x[d] + v[d] * time[i]);
                    rate_[d][i] += sign * v[d];
                }
            for (int i = 0; i < n; ++i) {
                gap_.back()[i] += sign * base_twice_.back()[i];
                rate_.back()[i] += sign * base_once_.back()[i];
            }
            const auto b = static_cast<std::size_t>(body);
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real g = t_.slopes[p].dampers[static_cast<std::size_t>(c.damper)].gravity;
                const real lighter = -sign * t_.slopes[p].ball_mass[b] / square(t_.problem.ball_mass[b]);
                for (int i = 0; i < n; ++i) {
                    gap_[t_.size + p][i] +=
                        sign * (0.5 * g * square(time[i]) + base_twice_[p][i] + lighter * sums[1][i]);
                    rate_[t_.size + p][i] += sign * (g * time[i] + base_once_[p][i] + lighter * sums[0][i]);
                }
            }
        });
        if (c.below != wall && c.above != wall) return;
        for (std::size_t p = 0; p < t_.parameters(); ++p)
            for (int i = 0; i < n; ++i) gap_[t_.size + p][i] += 0.5 * t_.damper_of(t_.slopes[p], c).clearance;
    }

    // Computes the part of the contact force that acts on each mode.
    void find_shares(const Contact& c) {
        share_.assign(t_.modes, 0.0);
        t_.each_side(c, [&](real sign, int body) {
            for (std::size_t k = 0; k < t_.modes && body == wall; ++k)
                share_[k] += sign * t_.damper_of(t_.problem, c).shape[k];
        });
    }

    // Computes the motion of the modes with their last forces on themselves, without the contact force.
    void move_modes() {
        for (std::size_t r = 0; r < own_.size(); ++r)
            for (int i = 0; i < n; ++i) own_[r][i] += outer_[r][i];
        const auto first = [&](std::size_t r, std::size_t odd) {
            return row(2 * (r / columns_) + odd)[r % columns_];
        };
        integrate_times_clock(own_, velocity_, [&](std::size_t r) { return first(r, 1); });
        integrate_times_clock(velocity_, position_, [&](std::size_t r) { return first(r, 0); });
    }

    // Solves for the derivatives of the contact force, and adds them to the motion of the modes.
    void solve() {
        impulse_.resize(columns_), once_.resize(columns_);
        for (std::size_t d = 0; d < columns_; ++d) {
            Row gap = gap_[d], rate = rate_[d];
            for (std::size_t k = 0; k < t_.modes; ++k)
                if (const real part = share_[k]; part != 0)
                    for (int i = 0; i < n; ++i) {
                        gap[i] += part * position_[at(k, d)][i];
                        rate[i] += part * velocity_[at(k, d)][i];
                    }
            for (int i = 0; i < n; ++i)
                impulse_[d][i] = constant_[d][i] - stiffness_[i] * gap[i] - damping_[i] * rate[i];
        }
        system_.solve(impulse_.data(), columns_);
        rule().integrate(impulse_.data(), once_.data(), columns_);
        integrate_times_clock(once_, twice_, [](std::size_t) { return 0.0; });
        for (std::size_t k = 0; k < t_.modes; ++k)
            if (const real part = share_[k]; part != 0)
                for (std::size_t d = 0; d < columns_; ++d)
                    for (int i = 0; i < n; ++i) {
                        velocity_[at(k, d)][i] += part * once_[d][i];
                        position_[at(k, d)][i] += part * twice_[d][i];
                    }
    }

    // Computes the forces of the modes on themselves; returns whether they have converged.
    bool update_forces() {
        bool done = true;
        for (std::size_t d = 0; d < columns_; ++d) {
            Lanes change = {}, size = {};
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const real two_decay = 2 * t_.problem.modes[k].decay,
                           stiffness = t_.problem.modes[k].stiffness;
                Row& own = own_[at(k, d)];
                const Row &q = position_[at(k, d)], &p = velocity_[at(k, d)], &outer = outer_[at(k, d)];
                for (int i = 0; i < n; i += lane_count) {
                    const Lanes speed = p.read(i), force = -two_decay * speed - stiffness * q.read(i);
                    change = larger(change, absolute(force - (own.read(i) - outer.read(i))));
                    size = larger(size, larger(absolute(speed), length_ * absolute(force)));
                    own.lanes_at(i) = force;
                }
            }
            done = done && length_ * largest(change) <= converged * largest(size);
        }
        return done;
    }

    // Computes the derivatives at the end of the contact.
    void finish(const Contact& c) {
        end_ = start_;
        const auto to = [&](std::size_t i) { return end_.data() + i * columns_; };
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < columns_; ++d) {
                to(2 * k)[d] += integral(velocity_[at(k, d)]);
                Row& force = own_[at(k, d)];
                for (int i = 0; i < n; ++i) force[i] += outer_[at(k, d)][i];
                to(2 * k + 1)[d] += integral(force);
            }
        for (std::size_t b = 0; b < t_.balls; ++b) {
            real *x = to(2 * t_.modes + b), *v = to(2 * t_.modes + t_.balls + b);
            for (std::size_t d = 0; d < columns_; ++d) x[d] += length_ * v[d];
            for (std::size_t p = 0; p < base_.size(); ++p) {
                x[t_.size + p] += integral(base_once_[p]), v[t_.size + p] += integral(base_[p]);
                if (p == t_.parameters()) break;
                const real g =
                    t_.slopes[p].dampers[static_cast<std::size_t>(t_.problem.ball_damper[b])].gravity;
                x[t_.size + p] += 0.5 * g * square(length_), v[t_.size + p] += g * length_;
            }
        }
        Row impulse, sum;
        for (int i = 0; i < n; ++i) impulse[i] = force_[i] * clock_[i];
        const real whole = rule().integral(impulse);
        rule().integrate<1>(&impulse, &sum);
        const real way = integral(sum);
        std::vector<real> total(columns_), moved(columns_); // integrals of p, and of s A p
        for (std::size_t d = 0; d < columns_; ++d)
            total[d] = rule().integral(impulse_[d]), moved[d] = integral(once_[d]);
        for (std::size_t k = 0; k < t_.modes; ++k)
            if (const real part = share_[k]; part != 0)
                for (std::size_t d = 0; d < columns_; ++d) to(2 * k + 1)[d] += part * total[d];
        t_.each_side(c, [&](real sign, int body) {
            if (body == wall) return;
            const auto b = static_cast<std::size_t>(body);
            const real mass = t_.problem.ball_mass[b];
            real *x = to(t_.position_row(body)), *v = to(t_.velocity_row(body));
            for (std::size_t d = 0; d < columns_; ++d)
                x[d] += sign * moved[d] / mass, v[d] += sign * total[d] / mass;
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real lighter = -sign * t_.slopes[p].ball_mass[b] / square(mass);
                x[t_.size + p] += lighter * way, v[t_.size + p] += lighter * whole;
            }
        });
    }

    // Whether the derivative in the time is the rate of the state at the end, where there is no contact
    // force.
    bool is_right(const Contact& c, const State& end) const {
        real largest = 0, error = 0;
        for (int i = 0; i < n; ++i)
            largest = std::max(largest, std::fabs(rate_.back()[i]) + std::fabs(once_.back()[i]) / c.mass);
        const auto compare = [&](std::size_t i, real rate, real weight) {
            error = std::max(error, std::fabs(weight * (end_[i * columns_ + t_.count] - rate)));
        };
        std::vector<real> signal;
        for (std::size_t l = 0; l < t_.run.loads.size(); ++l)
            signal.push_back(t_.run.loads.piece(l).value(end.t));
        for (std::size_t k = 0; k < t_.modes; ++k) {
            const Mode& mode = t_.problem.modes[k];
            const real part = std::fabs(share_[k]), p = end.y[2 * k + 1];
            real force = -2 * mode.decay * p - mode.stiffness * end.y[2 * k];
            for (std::size_t l = 0; l < signal.size(); ++l)
                force += t_.run.loads.load(l).shape[k] * signal[l];
            compare(2 * k, p, part / length_), compare(2 * k + 1, force, part);
        }
        for (const int body : {c.below, c.above}) {
            if (body < 0) continue;
            real acceleration = t_.damper_of(t_.problem, c).gravity;
            for (std::size_t l = 0; l < signal.size(); ++l)
                if (t_.run.loads.load(l).base) acceleration -= signal[l];
            compare(t_.position_row(body), velocities(t_.problem, end.y.data())[body], 1 / length_);
            compare(t_.velocity_row(body), acceleration, 1);
        }
        return error <= resolved * largest;
    }

public:
    TangentCollocation(Tangents& tangents, TangentLaws& laws)
        : t_(tangents), laws_(laws), columns_(tangents.count + 1) {}

    // Advances the derivatives through a contact with the rates of the state at its start; returns false, and
    // leaves them, if the nodes do not resolve them.
    bool advance(int c, const HertzTsuji& law, const ContactState& state, const IsolatedContact& solution,
                 const State& end) {
        const Contact& contact = t_.contact(c);
        length_ = end.t - t_.run.state.t;
        start_.resize(t_.size * columns_);
        for (std::size_t i = 0; i < t_.size; ++i) {
            std::copy_n(t_.row(i), t_.count, start_.data() + i * columns_);
            start_[i * columns_ + t_.count] = t_.rates[i];
        }
        differentiate_force(c, law, state, solution);
        find_shares(contact);
        factorise(contact.mass);
        force_outside(contact, solution);
        place_balls(contact, solution);
        own_.resize(t_.modes * columns_);
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < columns_; ++d) {
                const Mode& mode = t_.problem.modes[k];
                const real force = -2 * mode.decay * row(2 * k + 1)[d] - mode.stiffness * row(2 * k)[d];
                for (int i = 0; i < n; ++i) own_[at(k, d)][i] = force;
            }
        for (int pass = 0; pass < max_passes; ++pass) {
            move_modes();
            solve();
            if (!update_forces()) continue;
            finish(contact);
            if (!is_right(contact, end)) return false;
            for (std::size_t i = 0; i < t_.size; ++i)
                std::copy_n(end_.data() + i * columns_, t_.count, t_.row(i));
            return true;
        }
        return false;
    }
};

} // namespace rattlebox
