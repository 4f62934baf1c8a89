// Derivatives through an isolated contact that was solved as a whole (impact/isolated_contact.hpp).
//
// The derivatives of the converged solution solve its equations, linearised about it, at the same nodes x in
// the phase angle. There they are as smooth as the solution itself; at fixed times the derivative of the
// force is singular where the overlap vanishes. With R = ln r, the closing acceleration a, dt/dx = s(R, a)
// and dR/dx = n(R, a), the derivatives at fixed x are
//
//     dR' = n_R dR + n_a da + ...      dt' = ds = s_R dR + s_a da + ...
//     du_k' = (df_k + B_k da) s + (f_k + B_k a) ds
//
// with derivatives of n and s from dual numbers, forces f_k of the modes, and p_k = u_k - B_k w. The sweeps
// are those of the solution, and converge as fast. The contact begins and ends at events, and its force
// vanishes at both: the derivatives at fixed times follow from those of the times of both events. The phase
// at which the force vanishes depends on zeta alone; what that adds follows from the rates at the end, so
// that the nodes resolve any zeta.
#pragma once

#include "impact/isolated_contact.hpp"
#include "impact/tangent_laws.hpp"

namespace rattlebox {

class TangentCollocation {
    static constexpr int n = PhaseGrid::n;
    using Row = PhaseGrid::Rule::Row;
    static constexpr int max_sweeps = 24;
    // Change of a sweep, as part of the largest terms: what is permitted, and what may be rounding if it no
    // longer falls.
    static constexpr real converged = 1e-14, rounding = 1e-11;
    // Nodes resolve the end of a contact with less damping to 1e-12 only, which a stricter tolerance than
    // this does not permit.
    static constexpr real least_zeta = 4e-3, least_tolerance = 1e-13;
    enum Variable { by_r, by_a, by_zeta, by_b, variables };
    using Number = Dual<variables>;

    Tangents& t_;
    TangentLaws& laws_;
    const Contact* contact_ = nullptr;
    const IsolatedContact* solution_ = nullptr;
    real side_ = 0, zeta_ = 0, s_ = 1, speed_ = 0, length_ = 0;
    // By mode, and with direction: change by an approach rate, part in the closing acceleration.
    std::vector<real> share_, weight_, share_slope_, weight_slope_;
    // By direction: changes of coefficients, of the speed and time of the touch, and of ln r there.
    std::vector<real> zeta_slope_, b_slope_, mass_slope_, speed_slope_, touch_, r_slope_;
    // Derivatives at fixed x of dt/dx, dR/dx and the overlap, and of its rate.
    Row rate_[variables], growth_[variables], root_[variables], speed_by_zeta_;
    std::vector<Row> own_;                        // by load: rate of its signal
    std::vector<Row> r_, time_, clock_, closing_; // by direction: dR, dt, ds, da
    std::vector<Row> outer_, outside_;            // of modes and closing acceleration by the parameters alone
    std::vector<Row> force_, u_, path_;           // by mode and direction
    std::vector<Row> slope_, scratch_, base_, base_once_, base_twice_;
    // Of the last sweep: slopes of dR and of the speed that the closing acceleration adds.
    std::vector<Row> growth_rows_, closing_rows_, speeds_;
    std::vector<real> end_; // derivatives of the modes

    static const PhaseGrid::Rule& rule() { return PhaseGrid::rule(); }
    std::size_t at(std::size_t mode, std::size_t direction) const { return mode * t_.count + direction; }
    real start(std::size_t i, std::size_t d) const { // at the touch
        return t_.matrix[i * t_.count + d] + t_.rates[i] * touch_[d];
    }

    real integral(const Row& f) const { // over time
        Row part;
        for (int i = 0; i < n; ++i) part[i] = f[i] * solution_->time_slope()[i];
        return rule().integral(part);
    }

    void integrate_over_time(const std::vector<Row>& from, std::vector<Row>& to) {
        scratch_.resize(from.size()), to.resize(from.size());
        for (std::size_t r = 0; r < from.size(); ++r)
            for (int i = 0; i < n; ++i) scratch_[r][i] = from[r][i] * solution_->time_slope()[i];
        rule().integrate(scratch_.data(), to.data(), from.size());
    }

    // Computes the changes of the numbers of the contact and of its touch.
    void differentiate_contact(int c, const HertzTsuji& law, const ContactState& state,
                               const std::vector<real>& slower) {
        const TangentLaws::Slopes& slopes = laws_.slopes[static_cast<std::size_t>(c)];
        const real root = std::sqrt(5 * contact_->mass * law.stiffness);
        zeta_ = state.coefficients.second / root;
        s_ = std::sqrt((1 - zeta_) * (1 + zeta_));
        for (auto* column : {&zeta_slope_, &b_slope_, &mass_slope_, &r_slope_}) column->assign(t_.count, 0.0);
        touch_ = t_.times, speed_slope_ = slower;
        share_slope_.assign(t_.modes * t_.count, 0.0), weight_slope_.assign(t_.modes * t_.count, 0.0);
        share_.resize(t_.modes), weight_.resize(t_.modes);
        const std::vector<real>& shape = t_.damper_of(t_.problem, *contact_).shape;
        for (std::size_t k = 0; k < t_.modes; ++k)
            weight_[k] = -side_ * shape[k], share_[k] = side_ * shape[k] * contact_->mass;
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const std::size_t d = t_.size + p;
            mass_slope_[d] = t_.contact_of(t_.slopes[p], c).mass / contact_->mass;
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const real change = side_ * t_.damper_of(t_.slopes[p], *contact_).shape[k];
                weight_slope_[at(k, d)] = -change;
                share_slope_[at(k, d)] = change * contact_->mass + share_[k] * mass_slope_[d];
            }
        }
        for (std::size_t d = 0; d < t_.count; ++d) {
            const real stiffer = slopes.stiffness[d] / law.stiffness;
            zeta_slope_[d] = slopes.second[d] / root - 0.5 * zeta_ * (stiffer + mass_slope_[d]);
            b_slope_[d] = 0.5 * (stiffer - mass_slope_[d]); // of ln b
            r_slope_[d] = slower[d] / speed_ + zeta_ * zeta_slope_[d] / square(s_);
        }
    }

    // Derivative of the phase at the end in zeta.
    real end_slope(const HertzTsuji& law) const { return law.zero_overlap != 0 || zeta_ == 0 ? 0 : -2 / s_; }

    // Computes the derivatives of dt/dx, dR/dx and the overlap at the nodes, at fixed x.
    void differentiate_rates(const HertzTsuji& law) {
        const PhaseGrid& grid = solution_->grid();
        const real b = std::sqrt(law.stiffness / contact_->mass), half_root = 0.5 * std::sqrt(5.0);
        const Number zeta(zeta_, by_zeta), s = root(Number(1) - zeta * zeta);
        Number wave(half_root * b);
        wave.slope[by_b] = wave.value; // of ln b
        for (int i = 0; i < n; ++i) {
            const Number slope(grid.slope[i]), sine(grid.sine[i]), cosine(grid.cosine[i]);
            const real x = solution_->root()[i], size = b * x * square(x * x) / (half_root * sine.value);
            Number r(size);
            r.slope[by_r] = size;    // of ln r
            Number fifth = r * sine; // b x^5, apart from a factor
            fifth.slope[by_b] -= fifth.value;
            const Number depth = fifth.through(x, 0.2 * x / fifth.value);
            const Number w = wave * depth, a = Number(solution_->acceleration()[i], by_a) / (s * r);
            const Number clock = slope / (s * w - a * sine), growth = (a * cosine - zeta * w) * clock;
            for (int v = 0; v < variables; ++v) {
                const auto at_v = static_cast<std::size_t>(v);
                rate_[v][i] = clock.slope[at_v];
                growth_[v][i] = growth.slope[at_v];
                root_[v][i] = 4 * cube(x) * depth.slope[at_v];
            }
            const Number speed = r * (s * cosine - zeta * sine);
            speed_by_zeta_[i] = speed.slope[by_zeta];
        }
    }

    // Computes what the parameters add to the closing acceleration and to the forces of the modes at fixed
    // times, and the accelerations of the base.
    void force_outside() {
        const std::size_t loads = t_.run.loads.size();
        const real from = t_.run.state.t;
        const Row& time = solution_->time();
        outer_.assign(t_.modes * t_.count, Row{}), outside_.assign(t_.count, Row{});
        base_.assign(t_.parameters(), Row{}), own_.assign(loads, Row{});
        for (std::size_t l = 0; l < loads; ++l)
            for (int i = 0; i < n && t_.run.loads.active(); ++i)
                own_[l][i] = Tangents::signal_rate(t_.run.loads.piece(l), from + time[i]);
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const Problem& change = t_.slopes[p];
            const std::size_t d = t_.size + p;
            for (std::size_t l = 0; l < loads; ++l) {
                const Piece& piece = t_.run.loads.piece(l);
                const Load& load = t_.run.loads.load(l);
                const Tangents::SignalSlope signal =
                    t_.signal_slope(piece, load.signal, change.loads[l].signal);
                for (int i = 0; i < n && signal.is_any(); ++i) {
                    const real value = t_.signal_slope_at(piece, signal, from + time[i]);
                    for (std::size_t k = 0; k < t_.modes; ++k) outer_[at(k, d)][i] += load.shape[k] * value;
                    if (load.base) base_[p][i] -= value;
                }
                for (std::size_t k = 0; k < t_.modes; ++k)
                    if (const real shape = change.loads[l].shape[k]; shape != 0 && !piece.is_zero())
                        for (int i = 0; i < n; ++i)
                            outer_[at(k, d)][i] += shape * piece.value(from + time[i]);
            }
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = change.modes[k];
                if (mode.decay == 0 && mode.stiffness == 0) continue;
                for (int i = 0; i < n; ++i)
                    outer_[at(k, d)][i] -= 2 * mode.decay * solution_->velocity(k)[i] +
                                           mode.stiffness * solution_->displacement(k)[i];
            }
            for (int i = 0; i < n; ++i) {
                outside_[d][i] = side_ * t_.damper_of(change, *contact_).gravity;
                if (contact_->above != ground) outside_[d][i] += side_ * base_[p][i];
                for (std::size_t k = 0; k < t_.modes; ++k)
                    outside_[d][i] += weight_slope_[at(k, d)] * solution_->force(k)[i];
            }
        }
        integrate_over_time(base_, base_once_);
        integrate_over_time(base_once_, base_twice_);
    }

    // Computes the change of the closing acceleration in a direction.
    void close(std::size_t d) {
        Row& a = closing_[d];
        a = outside_[d];
        for (std::size_t k = 0; k < t_.modes; ++k)
            if (weight_[k] != 0)
                for (int i = 0; i < n; ++i) a[i] += weight_[k] * force_[at(k, d)][i];
        if (contact_->above == ground) return;
        for (std::size_t l = 0; l < own_.size(); ++l)
            if (t_.run.loads.load(l).base)
                for (int i = 0; i < n; ++i) a[i] -= side_ * own_[l][i] * (touch_[d] + time_[d][i]);
    }

    static real largest_of(const Row& f) {
        Lanes most = {};
        for (int i = 0; i < n; i += lane_count) most = larger(most, absolute(f.read(i)));
        return largest(most);
    }

    // One sweep; returns its largest change.
    real sweep() {
        real worst = 0;
        slope_.resize(std::max(t_.count, 2 * t_.modes * t_.count));
        for (std::size_t d = 0; d < t_.count; ++d) {
            close(d);
            const real zeta = zeta_slope_[d], b = b_slope_[d];
            for (int i = 0; i < n; ++i)
                slope_[d][i] = growth_[by_r][i] * r_[d][i] + growth_[by_a][i] * closing_[d][i] +
                               growth_[by_zeta][i] * zeta + growth_[by_b][i] * b;
        }
        std::vector<Row>& before = clock_; // not in use
        before.swap(r_);
        r_.resize(t_.count);
        growth_rows_.assign(slope_.begin(), slope_.begin() + static_cast<std::ptrdiff_t>(t_.count));
        rule().integrate(slope_.data(), r_.data(), t_.count);
        for (std::size_t d = 0; d < t_.count; ++d) {
            real change = 0, size = 0;
            for (int i = 0; i < n; ++i) {
                r_[d][i] += r_slope_[d];
                change = std::max(change, std::fabs(r_[d][i] - before[d][i]));
                size = std::max(size, std::fabs(r_[d][i]));
            }
            if (change > 0) worst = std::max(worst, change / size);
        }
        for (std::size_t d = 0; d < t_.count; ++d) {
            const real zeta = zeta_slope_[d], b = b_slope_[d];
            for (int i = 0; i < n; ++i)
                clock_[d][i] = rate_[by_r][i] * r_[d][i] + rate_[by_a][i] * closing_[d][i] +
                               rate_[by_zeta][i] * zeta + rate_[by_b][i] * b;
        }
        rule().integrate(clock_.data(), time_.data(), t_.count);
        return std::max(worst, move_modes());
    }

    real moved(std::size_t d, int i) const { // change of the overlap at a node
        return root_[by_r][i] * r_[d][i] + root_[by_zeta][i] * zeta_slope_[d] + root_[by_b][i] * b_slope_[d];
    }

    real move_modes() {
        real worst = 0;
        const Row &clock = solution_->time_slope(), &a = solution_->acceleration(), &w = solution_->rate();
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < t_.count; ++d) {
                const Row& f = solution_->force(k);
                const real by_share = share_slope_[at(k, d)];
                for (int i = 0; i < n; ++i)
                    slope_[at(k, d)][i] =
                        (force_[at(k, d)][i] + share_[k] * closing_[d][i] + by_share * a[i]) * clock[i] +
                        (f[i] + share_[k] * a[i]) * clock_[d][i];
            }
        rule().integrate(slope_.data(), u_.data(), u_.size());
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < t_.count; ++d) {
                Row& u = u_[at(k, d)];
                const real first =
                    start(2 * k + 1, d) + share_[k] * speed_slope_[d] + share_slope_[at(k, d)] * speed_;
                for (int i = 0; i < n; ++i) {
                    u[i] += first;
                    slope_[u_.size() + at(k, d)][i] =
                        u[i] * clock[i] + (solution_->velocity(k)[i] + share_[k] * w[i]) * clock_[d][i];
                }
            }
        rule().integrate(slope_.data() + u_.size(), path_.data(), path_.size());
        for (std::size_t d = 0; d < t_.count; ++d) {
            real change = 0, size = 0;
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = t_.problem.modes[k];
                const real q0 = start(2 * k, d), by_share = share_slope_[at(k, d)];
                Row& force = force_[at(k, d)];
                Row next = outer_[at(k, d)];
                for (std::size_t l = 0; l < own_.size(); ++l)
                    if (const real shape = t_.run.loads.load(l).shape[k]; shape != 0)
                        for (int i = 0; i < n; ++i) next[i] += shape * own_[l][i] * (touch_[d] + time_[d][i]);
                for (int i = 0; i < n; ++i) {
                    const real faster = w[i] * r_[d][i] + speed_by_zeta_[i] * zeta_slope_[d];
                    const real p = u_[at(k, d)][i] - share_[k] * faster - by_share * w[i];
                    const real q = q0 + path_[at(k, d)][i] - share_[k] * moved(d, i) -
                                   by_share * square(square(solution_->root()[i]));
                    next[i] -= 2 * mode.decay * p + mode.stiffness * q;
                    change = std::max(change, std::fabs(next[i] - force[i]) * length_);
                    size = std::max(size, std::fabs(u_[at(k, d)][i]) + std::fabs(share_[k] * faster));
                    size = std::max(size, (std::fabs(outer_[at(k, d)][i]) + mode.stiffness * std::fabs(q)) *
                                              length_);
                }
                force = next;
            }
            if (change > 0) worst = std::max(worst, change / size);
        }
        return worst;
    }

    // Moves the derivatives to the end of the contact, at fixed times.
    void finish(const HertzTsuji& law, const State& end) {
        const Row &clock = solution_->time_slope(), &a = solution_->acceleration();
        const real m = contact_->mass, b = std::sqrt(law.stiffness / m);
        const real w =
            t_.run.system.approach(end.y.data(), static_cast<int>(contact_ - t_.problem.contacts.data()));
        const real r = -w / s_; // at both kinds of end
        const bool overlaps = end_slope(law) != 0;
        const real sine = 2 * zeta_ * s_;
        const real depth = overlaps ? std::pow(0.5 * std::sqrt(5.0) * r * sine / b, 0.8) : 0;
        // Rates at the end by the phase there, and how that turns with zeta.
        const real turn = end_slope(law), a_end = rule().interpolate(a, 1.0);
        const real fast = 0.5 * std::sqrt(5.0) * b * std::pow(depth, 0.25), slow = a_end / (s_ * r);
        const real when_per_phase = turn == 0 ? 0 : 1 / (s_ * fast - slow * sine);
        const real growth_per_phase = (slow * (2 * square(zeta_) - 1) - zeta_ * fast) * when_per_phase;
        // The closing acceleration, its changes, and the integrals of both over time.
        std::vector<Row> rows(1), once(1);
        rows[0] = a;
        integrate_over_time(rows, once);
        const Row speed = once[0];
        const real gained = integral(a), way = integral(speed);
        const real impulse = m * (gained - w + speed_), moment = m * (speed_ * length_ + way - depth);
        closing_rows_.resize(t_.count);
        for (std::size_t d = 0; d < t_.count; ++d)
            for (int i = 0; i < n; ++i) closing_rows_[d][i] = closing_[d][i] * clock[i] + a[i] * clock_[d][i];
        speeds_.resize(t_.count);
        rule().integrate(closing_rows_.data(), speeds_.data(), t_.count);
        std::vector<real> pushed(t_.count), shifted(t_.count);
        for (std::size_t d = 0; d < t_.count; ++d) {
            const real zeta = zeta_slope_[d];
            const real ended = when_per_phase * turn * zeta; // change of the time by that of the last phase
            const real r_end =
                r_slope_[d] + rule().integral(growth_rows_[d]) + growth_per_phase * turn * zeta; // of ln r
            const real late = rule().integral(clock_[d]) + ended, when = touch_[d] + late;
            const real faster = w * (r_end - zeta_ * zeta / square(s_));
            const real deeper =
                overlaps ? 0.8 * depth * (r_end + zeta * 2 * (s_ - square(zeta_) / s_) / sine - b_slope_[d])
                         : 0;
            Row inner;
            for (int i = 0; i < n; ++i) inner[i] = speeds_[d][i] * clock[i] + speed[i] * clock_[d][i];
            const real more = rule().integral(closing_rows_[d]) + a_end * ended,
                       further = rule().integral(inner) + gained * ended;
            pushed[d] = impulse * mass_slope_[d] + m * (more - faster + speed_slope_[d]);
            shifted[d] = moment * mass_slope_[d] +
                         m * (speed_slope_[d] * length_ + speed_ * late + further - deeper) - impulse * when;
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = t_.problem.modes[k];
                const real by_share = share_slope_[at(k, d)], p = end.y[2 * k + 1];
                real force = -2 * mode.decay * p - mode.stiffness * end.y[2 * k];
                for (std::size_t l = 0; l < own_.size(); ++l)
                    force += t_.run.loads.load(l).shape[k] * t_.run.loads.piece(l).value(end.t);
                const real q0 = start(2 * k, d), p0 = start(2 * k + 1, d);
                end_[at(2 * k, d)] = q0 + rule().integral(slope_[u_.size() + at(k, d)]) +
                                     (p + share_[k] * w) * ended - share_[k] * deeper - by_share * depth -
                                     p * when;
                end_[at(2 * k + 1, d)] =
                    p0 + share_[k] * speed_slope_[d] + by_share * speed_ + rule().integral(slope_[at(k, d)]) +
                    (force + share_[k] * a_end) * ended - share_[k] * faster - by_share * w - force * when;
            }
        }
        std::copy_n(end_.begin(), 2 * t_.modes * t_.count, t_.matrix.begin());
        move_balls(impulse, moment, pushed, shifted);
    }

    void move_balls(real impulse, real moment, const std::vector<real>& pushed,
                    const std::vector<real>& shifted) {
        for (std::size_t b = 0; b < t_.balls; ++b) {
            real *x = t_.row(2 * t_.modes + b), *v = t_.row(2 * t_.modes + t_.balls + b);
            for (std::size_t d = 0; d < t_.count; ++d) x[d] += length_ * v[d];
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real g =
                    t_.slopes[p].dampers[static_cast<std::size_t>(t_.problem.ball_damper[b])].gravity;
                x[t_.size + p] += 0.5 * g * square(length_) + integral(base_once_[p]);
                v[t_.size + p] += g * length_ + integral(base_[p]);
            }
        }
        t_.each_side(*contact_, [&](real sign, int body) {
            if (body == wall) return;
            const auto b = static_cast<std::size_t>(body);
            const real mass = t_.problem.ball_mass[b];
            real *x = t_.row(t_.position_row(body)), *v = t_.row(t_.velocity_row(body));
            for (std::size_t d = 0; d < t_.count; ++d)
                x[d] += sign * shifted[d] / mass, v[d] += sign * pushed[d] / mass;
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const real lighter = -sign * t_.slopes[p].ball_mass[b] / square(mass);
                x[t_.size + p] += lighter * moment, v[t_.size + p] += lighter * impulse;
            }
        });
    }

public:
    TangentCollocation(Tangents& tangents, TangentLaws& laws) : t_(tangents), laws_(laws) {}

    // Advances the derivatives through a contact; returns false, and leaves them, if the equations do
    // not resolve them. Tangents::rates are those at the touch, Tangents::times the changes of its time, and
    // `slower` those of its speed.
    bool advance(int c, const HertzTsuji& law, const ContactState& state, real speed,
                 const std::vector<real>& slower, const IsolatedContact& solution, const State& end) {
        contact_ = &t_.contact(c), solution_ = &solution;
        side_ = contact_->above == wall ? 1 : contact_->below == wall ? -1 : 0;
        speed_ = speed, length_ = end.t - t_.run.state.t;
        differentiate_contact(c, law, state, slower);
        if (end_slope(law) != 0 && zeta_ < least_zeta && t_.problem.settings.tolerance < least_tolerance)
            return false;
        differentiate_rates(law);
        force_outside();
        for (auto* rows : {&r_, &time_, &clock_, &closing_}) rows->assign(t_.count, Row{});
        for (auto* rows : {&force_, &u_, &path_}) rows->resize(t_.modes * t_.count);
        end_.resize(2 * t_.modes * t_.count);
        for (std::size_t d = 0; d < t_.count; ++d) {
            for (int i = 0; i < n; ++i) r_[d][i] = r_slope_[d];
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = t_.problem.modes[k];
                const real force = -2 * mode.decay * start(2 * k + 1, d) - mode.stiffness * start(2 * k, d);
                for (int i = 0; i < n; ++i) force_[at(k, d)][i] = force + outer_[at(k, d)][i];
            }
        }
        real before = infinity;
        for (int pass = 0; pass < max_sweeps; ++pass) {
            const real change = sweep();
            if (change <= converged || (change <= rounding && change > 0.1 * before)) {
                finish(law, end);
                return true;
            }
            before = change;
        }
        return false;
    }
};

} // namespace rattlebox
