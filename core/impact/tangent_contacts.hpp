// Derivatives through soft contacts, integrated with the steps of the run.
#pragma once

#include "impact/tangent_laws.hpp"
#include "math/dop853.hpp"

namespace rattlebox {

class TangentContacts {
    Tangents& t_;
    TangentLaws& laws_;
    std::vector<real> force_, ball_force_, cavity_force_;
    std::vector<real> extended_, extended_end_, scale_, sizes_, rounding_;
    std::vector<real> slower_; // change of the speed of the last touch
    Dop853 integrator_;

    // dt/dtau / x_j^3, which is finite where x_j is zero.
    real clock_over_cube(const real* y, real clock, std::size_t j) const {
        const System& system = t_.run.system;
        const real x = y[system.x_index(j)];
        if (system.active.size() == 1) return 1;
        if (x != 0) return clock / cube(x);
        real ties = 0;
        for (std::size_t i = 0; i < system.active.size(); ++i) ties += y[system.x_index(i)] == 0;
        return 1 / ties;
    }

    // Computes the rates of the state and of its derivatives in the transformed time.
    void extended_rates(const real* y, real* dy) {
        System& system = t_.run.system;
        system(y, dy);
        const real clock = dy[system.time_index()];
        const real* t = y + system.size();
        real* dt = dy + system.size();
        const auto at = [&](real* matrix, std::size_t i) { return matrix + i * t_.count; };
        const auto of = [&](std::size_t i) { return t + i * t_.count; };
        std::fill_n(dt, t_.size * t_.count, 0.0);
        // Forces on dampers' points and balls, and their derivatives times the clock.
        std::fill(cavity_force_.begin(), cavity_force_.end(), 0.0);
        std::fill(ball_force_.begin(), ball_force_.end(), 0.0);
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            const Active& a = system.active[j];
            const Contact& c = t_.contact(a.contact);
            const TangentLaws::Slopes& law_slopes = laws_.slopes[static_cast<std::size_t>(a.contact)];
            const real x = std::fmax(y[system.x_index(j)], 1e-12), rate = system.approach(y, a.contact);
            t_.differentiate_gap(c, y, t, t_.gap_slope.data(), t_.rate_slope.data());
            const bool unloads = a.state.phase == ContactState::unloading;
            const TangentLaws::Force f =
                c.normal.visit([&](const auto& law) { return laws_.force_of(law, a.state, x, rate); });
            const real steep = 0.25 * f.x * clock_over_cube(y, clock, j);
            for (std::size_t d = 0; d < t_.count; ++d) {
                const real deeper = -t_.gap_slope[d] - (unloads ? law_slopes.origin[d] : 0);
                force_[d] = steep * deeper +
                            clock * (-f.rate * t_.rate_slope[d] + f.stiffness * law_slopes.stiffness[d] +
                                     f.second * law_slopes.second[d] + f.deepest * law_slopes.deepest[d] +
                                     f.unloading * law_slopes.unloading[d] + f.origin * law_slopes.origin[d]);
            }
            for (std::size_t p = 0; p < t_.parameters(); ++p)
                if (laws_.is_in_formula(a.contact, p))
                    force_[t_.size + p] += clock * c.normal.visit([&](const auto& law) {
                        return laws_.formula_slope(law, t_.contact_of(t_.slopes[p], a.contact).normal,
                                                   a.state, x, rate);
                    });
            t_.each_side(c, [&](real sign, int body) {
                if (body != wall) {
                    const auto b = static_cast<std::size_t>(body);
                    ball_force_[b] += sign * f.total;
                    real* v = at(dt, t_.velocity_row(body));
                    for (std::size_t d = 0; d < t_.count; ++d)
                        v[d] += sign * force_[d] / t_.problem.ball_mass[b];
                    return;
                }
                cavity_force_[static_cast<std::size_t>(c.damper)] += sign * f.total;
                for (std::size_t k = 0; k < t_.modes; ++k) {
                    const real shape = sign * t_.damper_of(t_.problem, c).shape[k];
                    real* v = at(dt, 2 * k + 1);
                    for (std::size_t d = 0; d < t_.count; ++d) v[d] += shape * force_[d];
                }
            });
        }
        const auto add = [&](real* target, real weight, const real* source) {
            for (std::size_t d = 0; d < t_.count; ++d) target[d] += weight * source[d];
        };
        for (std::size_t k = 0; k < t_.modes; ++k) {
            add(at(dt, 2 * k), clock, of(2 * k + 1));
            real* v = at(dt, 2 * k + 1);
            add(v, -2 * t_.problem.modes[k].decay * clock, of(2 * k + 1));
            add(v, -t_.problem.modes[k].stiffness * clock, of(2 * k));
            for (std::size_t i = 0; i < t_.modes && !t_.problem.coupling.empty(); ++i)
                add(v, -t_.problem.coupling[k * t_.modes + i] * clock, of(2 * i + 1));
        }
        for (std::size_t b = 0; b < t_.balls; ++b)
            add(at(dt, 2 * t_.modes + b), clock, of(2 * t_.modes + t_.balls + b));
        if (t_.parameters() > 0) add_parameters(y, clock, t_.run.state.t + y[system.time_index()], dt);
    }

    // Adds what the parameters change in the equations of motion at a state.
    void add_parameters(const real* y, real clock, real time, real* dt) {
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const Problem& slope = t_.slopes[p];
            const auto target = [&](std::size_t i) -> real& { return dt[i * t_.count + t_.size + p]; };
            for (std::size_t k = 0; k < t_.modes; ++k) {
                real force = -2 * slope.modes[k].decay * y[2 * k + 1] - slope.modes[k].stiffness * y[2 * k];
                for (std::size_t d = 0; d < t_.problem.dampers.size(); ++d)
                    force += slope.dampers[d].shape[k] * cavity_force_[d];
                for (std::size_t i = 0; i < t_.modes && !slope.coupling.empty(); ++i)
                    force -= slope.coupling[k * t_.modes + i] * y[2 * i + 1];
                target(2 * k + 1) += clock * force;
            }
            for (std::size_t b = 0; b < t_.balls; ++b)
                target(2 * t_.modes + t_.balls + b) +=
                    clock * (slope.dampers[static_cast<std::size_t>(t_.problem.ball_damper[b])].gravity -
                             slope.ball_mass[b] / square(t_.problem.ball_mass[b]) * ball_force_[b]);
            for (std::size_t l = 0; l < t_.run.loads.size(); ++l) {
                const Piece& piece = t_.run.loads.piece(l);
                const Load& load = t_.run.loads.load(l);
                const real change = t_.signal_slope_at(
                    piece, t_.signal_slope(piece, load.signal, slope.loads[l].signal), time);
                const real value = piece.is_zero() ? 0 : piece.value(time);
                for (std::size_t k = 0; k < t_.modes; ++k)
                    target(2 * k + 1) += clock * (load.shape[k] * change + slope.loads[l].shape[k] * value);
                if (load.base)
                    for (std::size_t b = 0; b < t_.balls; ++b)
                        target(2 * t_.modes + t_.balls + b) -= clock * change;
            }
        }
    }

    // Computes the rounding errors of the derivatives of the speeds after a step, which follow from those of
    // overlaps: where bodies move together, the derivatives of the speeds may be much smaller than these.
    void find_rounding() {
        System& system = t_.run.system;
        const real length = extended_end_[system.time_index()] - extended_[system.time_index()];
        rounding_.assign(t_.count, 0.0);
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            real steep = 0;
            for (const std::vector<real>* y : {&extended_, &extended_end_})
                if (const real overlap = square(square((*y)[system.x_index(j)])); overlap > 0)
                    steep = std::fmax(steep, std::fabs(system.force(y->data(), j)) / overlap);
            const Contact& c = t_.contact(system.active[j].contact);
            const real part = 8 * epsilon * steep / c.mass * length;
            const auto add = [&](real weight, std::size_t position) {
                const real* x = extended_.data() + system.size() + position * t_.count;
                for (std::size_t d = 0; d < t_.count; ++d) rounding_[d] += std::fabs(part * weight * x[d]);
            };
            t_.each_side(c, [&](real, int body) {
                if (body != wall) return add(1, t_.position_row(body));
                for (std::size_t k = 0; k < t_.modes; ++k) add(t_.damper_of(t_.problem, c).shape[k], 2 * k);
            });
            for (std::size_t p = 0; p < t_.parameters(); ++p)
                rounding_[t_.size + p] += std::fabs(part * t_.damper_of(t_.slopes[p], c).clearance);
        }
    }

    // Sets the permitted errors of a step: those of the derivatives of velocities, as parts of the largest
    // one in the same direction.
    void set_scales(std::size_t n) {
        constexpr real tolerance = 1e-11;
        find_rounding();
        scale_.assign(extended_.size(), infinity);
        for (std::size_t d = 0; d < t_.count; ++d) {
            real& size = sizes_[d]; // of the largest step so far: a singular derivative begins small
            const auto each_velocity = [&](auto&& f) {
                for (std::size_t k = 0; k < t_.modes; ++k) f(n + (2 * k + 1) * t_.count + d);
                for (std::size_t b = 0; b < t_.balls; ++b)
                    f(n + (2 * t_.modes + t_.balls + b) * t_.count + d);
            };
            each_velocity([&](std::size_t i) {
                size = std::fmax(size, std::fmax(std::fabs(extended_[i]), std::fabs(extended_end_[i])));
            });
            const real permitted = std::fmax(tolerance * size, rounding_[d]);
            each_velocity([&](std::size_t i) { scale_[i] = permitted > 0 ? permitted : infinity; });
        }
    }

public:
    TangentContacts(Tangents& tangents, TangentLaws& laws)
        : t_(tangents), laws_(laws), force_(t_.count), ball_force_(t_.balls),
          cavity_force_(t_.problem.dampers.size()) {}

    const std::vector<real>& slower() const { return slower_; }

    void touch(int c, real speed, real e) {
        std::fill(t_.times.begin(), t_.times.end(), 0.0);
        slower_.assign(t_.count, 0.0);
        const real* y = t_.run.state.y.data();
        if (speed > 0) {
            t_.rates_of_contacts();
            const real turn = t_.gap_acceleration(t_.contact(c), t_.rates);
            t_.differentiate_gap(t_.contact(c), y, t_.matrix.data(), t_.gap_slope.data(),
                                 t_.rate_slope.data());
            for (std::size_t d = 0; d < t_.count; ++d) {
                t_.times[d] = t_.gap_slope[d] / speed;
                slower_[d] = -(t_.rate_slope[d] + turn * t_.times[d]);
            }
        }
        laws_.set_law_slopes(
            c, slower_, speed, [&](const auto& law, real faster, const Contact* change, real h) {
                const real v = speed + faster;
                return initial_state(
                    law, law.needs_restitution() ? laws_.moved_restitution(c, v, change, h) : e, v);
            });
        if (speed <= 0) return;
        const real force = t_.contact(c)
                               .normal
                               .visit([&](const auto& law) {
                                   return contact_force(law, initial_state(law, e, speed), 0, speed);
                               })
                               .total;
        if (force != 0) t_.lengthen_force(t_.contact(c), -force);
    }

    void step(const real* y, real length) {
        const std::size_t n = t_.run.system.size();
        extended_.resize(n + t_.size * t_.count), extended_end_.resize(extended_.size());
        std::copy_n(y, n, extended_.begin());
        std::copy(t_.matrix.begin(), t_.matrix.end(), extended_.begin() + static_cast<std::ptrdiff_t>(n));
        const auto rates = [this](const real* from, real* to) { extended_rates(from, to); };
        integrator_.resize(static_cast<int>(extended_.size()));
        // The derivative of a force may be less smooth than the force. One step is nearly always enough.
        constexpr real shortest = 1e-9; // part of the step of the run
        sizes_.assign(t_.count, 0.0);
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
        std::copy(extended_.begin() + static_cast<std::ptrdiff_t>(n), extended_.end(), t_.matrix.begin());
        const std::size_t clock = t_.run.system.time_index();
        note_misses(y, extended_.data(), t_.run.state.t + y[clock], extended_[clock] - y[clock]);
    }

    // The closest approach within a step beside closed contacts, on the parabola through both ends.
    void note_misses(const real* y, const real* end, real time, real length, int except = -1) {
        if (!(length > 0)) return;
        for (int c = 0; c < t_.problem.contact_count(); ++c) {
            if (c == except || t_.run.phase(c) != RunState::Phase::open) continue;
            const Gap before = gap(t_.problem, t_.contact(c), y), after = gap(t_.problem, t_.contact(c), end);
            if (!(before.rate < 0 && after.rate >= 0)) continue;
            const real curvature = (after.rate - before.rate) / length;
            t_.note_miss(c, {time - before.rate / curvature,
                             before.value - 0.5 * square(before.rate) / curvature, curvature});
        }
    }

    void end_phase(std::size_t j) {
        const Active& a = t_.run.system.active[j];
        const Contact& c = t_.contact(a.contact);
        const real* y = t_.run.state.y.data();
        ContactState next = a.state;
        const PhaseEnd end = c.normal.visit([&](const auto& law) { return next_phase(law, next, a.x); });
        t_.differentiate_gap(c, y, t_.matrix.data(), t_.gap_slope.data(), t_.rate_slope.data());
        if (a.state.phase == ContactState::yielding) {
            // The deepest overlap does not depend on the time at which it is reached.
            std::vector<real> deeper(t_.count);
            for (std::size_t d = 0; d < t_.count; ++d) deeper[d] = -t_.gap_slope[d];
            const TangentLaws::Slopes before = laws_.slopes[static_cast<std::size_t>(a.contact)];
            laws_.set_law_slopes(a.contact, deeper, next.history.deepest,
                                 [&]<class Law>(const Law& law, real more, const Contact*, real) {
                                     ContactState s;
                                     if constexpr (Law::hysteretic)
                                         s.history = law.unloaded_from(next.history.deepest + more);
                                     return s;
                                 });
            laws_.slopes[static_cast<std::size_t>(a.contact)].stiffness = before.stiffness;
            laws_.slopes[static_cast<std::size_t>(a.contact)].second = before.second;
            return;
        }
        if (end == PhaseEnd::stay) return;
        // The force may jump to zero where the overlap above the origin of the phase vanishes; where a
        // contact ends at zero force, it does not.
        const real rate = t_.run.system.approach(y, a.contact), x = a.x;
        const bool ends_at_overlap = end == PhaseEnd::open || c.normal.visit([](const auto& law) {
            return std::decay_t<decltype(law)>::hysteretic;
        });
        const real force =
            c.normal.visit([&](const auto& law) { return contact_force(law, a.state, x, rate).total; });
        if (!ends_at_overlap || force == 0 || rate == 0) return;
        const TangentLaws::Slopes& slopes = laws_.slopes[static_cast<std::size_t>(a.contact)];
        for (std::size_t d = 0; d < t_.count; ++d)
            t_.times[d] =
                (t_.gap_slope[d] + (a.state.phase == ContactState::unloading ? slopes.origin[d] : 0)) / rate;
        t_.lengthen_force(c, force);
    }
};

} // namespace rattlebox
