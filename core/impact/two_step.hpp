// The fixed-step scheme of the discrete-element literature, for comparison: a long step without contacts and
// a short step with contacts. Each step is one classical Runge-Kutta step, or an adaptive Dormand-Prince
// solution with relative tolerance 1e-3, absolute tolerance 1e-6 and at least ten substeps, like MATLAB's
// ode45 with default options.
//
// The scheme misses contacts that begin and end within one long step. The time of first touch, and with it
// the speed at which restitution is evaluated, is known to one step only. Samples between steps are cubic
// Hermite interpolants.
//
// J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19, RK5(4)7M,
// doi:10.1016/0771-050X(80)90013-3; L. F. Shampine, M. W. Reichelt, SIAM J. Sci. Comput. 18 (1997) 1,
// doi:10.1137/S1064827594276424 (ode45).
#pragma once

#include <array>
#include <atomic>

#include "impact/contact_phase.hpp"
#include "impact/result.hpp"
#include "impact/state.hpp"

namespace rattlebox {

class TwoStep {
    struct Slot {
        ContactState state;
        bool closed = false;
        real rate = 0; // approach rate one step before
        int impact = -1;
    };

    const Problem& problem_;
    const std::atomic<bool>* stop_;
    Loads loads_;
    State state_;
    Ledger ledger_;
    std::vector<Slot> slots_;
    std::vector<real> ball_force_, cavity_force_, y_, next_, dy_, dnext_, work_;
    std::array<std::vector<real>, 7> k_;
    std::size_t next_sample_ = 0, n_ = 0;
    bool phase_changed_ = false; // whether a contact began, reached its deepest overlap or ended in this step
    Result result_;

    std::size_t extra_index() const {
        return state_.y.size();
    } // of load work, base work, viscous loss and the loss of each contact

    struct ForceAndLoss {
        real force = 0, lost = 0;
    };

    ForceAndLoss force_of(std::size_t c, const real* y) const {
        const Gap g = gap(problem_, problem_.contacts[c], y);
        const Slot& slot = slots_[c];
        const real overlap = -g.value - slot.state.origin();
        if (overlap <= 0) return {};
        const real x = std::sqrt(std::sqrt(overlap)), rate = -g.rate;
        return problem_.contacts[c].normal.visit([&](const auto& law) -> ForceAndLoss {
            const NormalForce<real> f = contact_force(law, slot.state, x, rate);
            if constexpr (requires { law.zero_overlap; })
                if (law.zero_overlap == 0 && f.total < 0) return {0, -f.elastic * rate};
            return {f.total, (f.total - f.elastic) * rate};
        });
    }

    void derivative(real t, const real* y, real* dy) {
        const std::size_t m = problem_.modes.size(), b = problem_.ball_mass.size();
        std::fill(ball_force_.begin(), ball_force_.end(), 0.0);
        std::fill(cavity_force_.begin(), cavity_force_.end(), 0.0);
        real* extra_rate = dy + extra_index();
        extra_rate[0] = extra_rate[1] = extra_rate[2] = 0;
        for (std::size_t c = 0; c < problem_.contacts.size(); ++c) {
            const Contact& k = problem_.contacts[c];
            const ForceAndLoss p = force_of(c, y);
            extra_rate[3 + c] = p.lost;
            (k.below == wall ? cavity_force_[static_cast<std::size_t>(k.damper)]
                             : ball_force_[static_cast<std::size_t>(k.below)]) -= p.force;
            if (k.above == ground) {
                dy[impulse_index(problem_, k)] = p.force;
                continue;
            }
            (k.above == wall ? cavity_force_[static_cast<std::size_t>(k.damper)]
                             : ball_force_[static_cast<std::size_t>(k.above)]) += p.force;
        }
        const real* v = velocities(problem_, y);
        real* ds = positions(problem_, dy);
        real* dv = velocities(problem_, dy);
        for (std::size_t k = 0; k < m; ++k) {
            const Mode& mode = problem_.modes[k];
            dy[2 * k] = y[2 * k + 1];
            dy[2 * k + 1] = -2 * mode.decay * y[2 * k + 1] - mode.stiffness * y[2 * k];
            for (std::size_t d = 0; d < problem_.dampers.size(); ++d)
                dy[2 * k + 1] += problem_.dampers[d].shape[k] * cavity_force_[d];
            extra_rate[2] += 2 * mode.decay * square(y[2 * k + 1]);
        }
        const auto speed = [&](std::size_t k) { return y[2 * k + 1]; };
        couple(problem_.coupling, m, speed, [&](std::size_t k, real force) { dy[2 * k + 1] += force; });
        extra_rate[2] += coupled_power(problem_.coupling, m, speed);
        for (std::size_t i = 0; i < b; ++i) {
            ds[i] = v[i];
            dv[i] = ball_force_[i] / problem_.ball_mass[i] +
                    problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
        }
        for (std::size_t l = 0; l < loads_.size(); ++l) {
            if (loads_.piece(l).is_zero()) continue;
            const Load& load = loads_.load(l);
            const real f = loads_.piece(l).value(t);
            real speed = 0;
            for (std::size_t k = 0; k < m; ++k) {
                dy[2 * k + 1] += load.shape[k] * f;
                speed += load.shape[k] * y[2 * k + 1];
            }
            if (load.base)
                for (std::size_t i = 0; i < b; ++i) {
                    dv[i] -= f;
                    speed -= problem_.ball_mass[i] * v[i];
                }
            extra_rate[load.base] += f * speed;
        }
    }

    void rk4(real t, real h) {
        derivative(t, y_.data(), k_[0].data());
        static constexpr real node[3] = {0.5, 0.5, 1};
        for (int s = 0; s < 3; ++s) {
            for (std::size_t i = 0; i < n_; ++i) work_[i] = y_[i] + h * node[s] * k_[s][i];
            derivative(t + h * node[s], work_.data(), k_[s + 1].data());
        }
        for (std::size_t i = 0; i < n_; ++i)
            next_[i] = y_[i] + h / 6 * (k_[0][i] + 2 * k_[1][i] + 2 * k_[2][i] + k_[3][i]);
    }

    // RK5(4)7M; the result has order 5.
    void dopri5(real t, real length) {
        static constexpr real c[7] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
        static constexpr real a[7][6] = {
            {},
            {0.2},
            {3.0 / 40, 9.0 / 40},
            {44.0 / 45, -56.0 / 15, 32.0 / 9},
            {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
            {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
            {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
        static constexpr real e[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                      -17253.0 / 339200, 22.0 / 525, -0.025};
        const real from = t, longest = 0.1 * length;
        real h = longest;
        std::vector<real> start = y_;
        while (t < from + length) {
            const bool last = t + h >= from + length * (1 - 1e-12);
            if (last) h = from + length - t;
            for (int s = 0; s < 7; ++s) {
                for (std::size_t i = 0; i < n_; ++i) {
                    real sum = 0;
                    for (int j = 0; j < s; ++j) sum += a[s][j] * k_[static_cast<std::size_t>(j)][i];
                    work_[i] = y_[i] + h * sum;
                }
                derivative(t + c[s] * h, work_.data(), k_[static_cast<std::size_t>(s)].data());
            }
            real error = 0;
            for (std::size_t i = 0; i < n_; ++i) {
                real sum = 0;
                for (int s = 0; s < 7; ++s) sum += e[s] * k_[static_cast<std::size_t>(s)][i];
                const real size = std::max(std::fabs(y_[i]), std::fabs(work_[i]));
                error = std::max(error, std::fabs(h * sum) / std::max(size, 1e-3) / 1e-3);
            }
            if (error > 1) {
                h *= std::max(0.1, 0.8 * std::pow(error, -0.2));
                continue;
            }
            std::swap(y_, work_);
            if (last) break;
            t += h;
            h = std::min(longest, h * std::min(5.0, error > 0 ? 0.8 * std::pow(error, -0.2) : 5.0));
        }
        next_ = y_;
        y_ = start;
    }

    // Opens and closes contacts at the end of a step; returns false if a law left its range of validity.
    bool update(real t) {
        for (std::size_t c = 0; c < slots_.size(); ++c) {
            Slot& slot = slots_[c];
            const Contact& contact = problem_.contacts[c];
            const Gap g = gap(problem_, contact, y_.data());
            const real rate = -g.rate;
            phase_changed_ = phase_changed_ || (slot.closed && slot.rate > 0 && rate <= 0);
            slot.rate = rate;
            if (!slot.closed) {
                // Restitution of a touch within the next step. The last value before the overlap is used.
                if (g.value > problem_.settings.dt_flight * std::fmax(2 * rate, 0.0) && g.value > 0) continue;
                const Rebound r = rebound(contact.restitution, std::fmax(rate, 0.0));
                if (r.outside || !possible(contact.normal, r)) {
                    result_.status = r.outside ? Status::law_domain : Status::no_rebound;
                    result_.stopped_contact = static_cast<int>(c);
                    result_.stopped_value = rate;
                    return false;
                }
                bool has_restitution = false;
                contact.normal.visit([&](const auto& law) {
                    slot.state = initial_state(law, r.e, std::fmax(rate, 0.0));
                    has_restitution = law.needs_restitution();
                });
                if (g.value >= 0) continue;
                result_.counts.extrapolated += r.extrapolated;
                slot.closed = phase_changed_ = true;
                Impact impact;
                impact.contact = static_cast<int>(c);
                impact.time = t;
                impact.approach_speed = rate;
                if (has_restitution) impact.restitution = r.e;
                impact.energy_lost = -y_[extra_index() + 3 + c];
                slot.impact = -1;
                slot.impact = result_.add_impact(impact);
            }
            Impact& impact = result_.impacts[static_cast<std::size_t>(slot.impact)];
            const real overlap = -g.value;
            impact.peak_overlap = std::max(impact.peak_overlap, overlap);
            impact.peak_force = std::max(impact.peak_force, force_of(c, y_.data()).force);
            // Laws with hysteresis change their phase at its end.
            contact.normal.visit([&](const auto& law) {
                if constexpr (std::decay_t<decltype(law)>::hysteretic) {
                    const real x = std::sqrt(std::sqrt(std::fmax(overlap - slot.state.origin(), 0.0)));
                    if (overlap > slot.state.origin() && phase_end(law, slot.state, x, rate) <= 0)
                        next_phase(law, slot.state, x);
                }
            });
            if (overlap > 0) continue;
            const std::size_t d = static_cast<std::size_t>(contact.damper);
            const real plastic =
                contact.normal.visit([&](const auto& law) { return plastic_loss(law, slot.state, 0); });
            ledger_.plastic[d] += plastic;
            impact.energy_lost += y_[extra_index() + 3 + c] + plastic;
            impact.duration = t - impact.time;
            impact.separation_speed = -rate;
            impact.complete = true;
            slot = Slot{};
            phase_changed_ = true;
        }
        return true;
    }

    void sample(real from, real to) {
        if (next_sample_ >= problem_.sample_times.size() || problem_.sample_times[next_sample_] > to) return;
        derivative(from, y_.data(), dy_.data());
        derivative(to, next_.data(), dnext_.data());
        const real h = to - from;
        while (next_sample_ < problem_.sample_times.size() && problem_.sample_times[next_sample_] <= to) {
            const real t = problem_.sample_times[next_sample_++], s = (t - from) / h;
            const real w0 = (1 + 2 * s) * square(1 - s), w1 = s * square(1 - s), w2 = s * s * (3 - 2 * s),
                       w3 = s * s * (s - 1);
            for (std::size_t i = 0; i < n_; ++i)
                work_[i] = w0 * y_[i] + w2 * next_[i] + h * (w1 * dy_[i] + w3 * dnext_[i]);
            add_sample(t, work_.data());
        }
    }

    void add_sample(real t, const real* y, bool given = true) {
        State state = state_;
        std::copy_n(y, state.y.size(), state.y.begin());
        Ledger ledger = ledger_;
        ledger.load_work = y[extra_index()];
        ledger.base_work = y[extra_index() + 1];
        ledger.viscous = y[extra_index() + 2];
        std::vector<real> stored(problem_.dampers.size()), force(problem_.dampers.size());
        for (std::size_t c = 0; c < slots_.size(); ++c) {
            const Contact& contact = problem_.contacts[c];
            const std::size_t d = static_cast<std::size_t>(contact.damper);
            ledger.normal[d] += y[extra_index() + 3 + c];
            const real overlap = -gap(problem_, contact, y).value - slots_[c].state.origin();
            const real x = overlap > 0 ? std::sqrt(std::sqrt(overlap)) : 0;
            contact.normal.visit([&](const auto& law) {
                if (slots_[c].closed) ledger.plastic[d] += plastic_loss(law, slots_[c].state, x);
                stored[d] += stored_energy(law, slots_[c].state, x);
            });
            const real push = force_of(c, y).force;
            if (contact.above == wall) force[d] += push;
            if (contact.below == wall) force[d] -= push;
        }
        result_.record(t, state, ledger, stored, force, given);
    }

public:
    TwoStep(const Problem& problem, const std::atomic<bool>* stop = nullptr)
        : problem_(problem), stop_(stop), loads_(problem.loads), state_(problem), ledger_(problem),
          slots_(problem.contacts.size()), ball_force_(problem.ball_mass.size()),
          cavity_force_(problem.dampers.size()), n_(state_.y.size() + 3 + problem.contacts.size()),
          result_(problem) {
        y_.assign(n_, 0);
        std::copy(state_.y.begin(), state_.y.end(), y_.begin());
        next_ = dy_ = dnext_ = work_ = y_;
        for (auto& k : k_) k.resize(n_);
    }

    Result run() {
        const Settings& s = problem_.settings;
        real t = 0;
        if (!problem_.sample_times.empty() && problem_.sample_times[0] <= 0) {
            ++next_sample_;
            add_sample(0, y_.data());
        }
        bool ok = update(0);
        while (ok && t < s.duration) {
            if (t >= loads_.next_knot()) loads_.advance(t);
            bool closed = false;
            for (const Slot& slot : slots_) closed = closed || slot.closed;
            const real stop = std::min(s.duration, loads_.next_knot());
            real h = closed ? s.dt_contact : s.dt_flight, end = t + h;
            if (end > stop - 1e-9 * h) {
                end = stop;
                h = stop - t;
            }
            if (s.adaptive_inner)
                dopri5(t, h);
            else
                rk4(t, h);
            sample(t, end);
            std::swap(y_, next_);
            t = end;
            ++(closed ? result_.counts.contact_steps : result_.counts.flights);
            if (!std::all_of(y_.begin(), y_.end(), [](real v) { return std::isfinite(v); })) {
                result_.status = Status::not_finite;
                break;
            }
            if (stop_ && stop_->load(std::memory_order_relaxed)) {
                result_.status = Status::interrupted;
                break;
            }
            phase_changed_ = false;
            ok = update(t);
            if (phase_changed_ && static_cast<long>(result_.impacts.size()) <= s.contact_samples)
                add_sample(t, y_.data(), false);
        }
        result_.stopped_at = t;
        return std::move(result_);
    }
};

} // namespace rattlebox
