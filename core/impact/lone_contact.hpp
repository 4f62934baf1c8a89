// One Hertz-Tsuji contact on its own, solved whole by collocation in its phase angle.
//
// With P = (2/sqrt5) b d^(5/4), b^2 = A/m, w = d' and Y = (w + zeta P)/s, s^2 = 1 - zeta^2, the contact alone
// is a uniform rotation: P = r sin(psi), Y = r cos(psi). Everything else (spring, load, gravity) is a small
// closing acceleration a:
//
//     dpsi/dt = s W - a sin(psi) / (s r)        W = (sqrt5/2) b d^(1/4)
//     d ln r/dt = -zeta W + a cos(psi) / (s r)
//
// psi runs from 0 to pi whatever happens, so there is no event to look for: zero overlap is psi = pi, the
// deepest overlap is tan(psi) = s/zeta, zero force psi = 2 acos(zeta). psi = pi I(x) with I the regularised
// incomplete beta function of (5, 5) makes d^(1/4) analytic at both ends. Fixed-point sweeps over all nodes
// gain a factor a t_c / V each.
//
// The energy balance, which the sweeps do not use, decides whether the result is taken; if not, or if the
// contact is slow, strongly damped or has neighbours, impact/closed.hpp integrates it step by step.
#pragma once

#include <array>
#include <vector>

#include "base/collocation.hpp"
#include "impact/state.hpp"

namespace rattlebox {

// psi(x) = psi_end I_x(5, 5) and what follows from it at the nodes. Rebuilt only when psi_end changes.
struct PhaseGrid {
    static constexpr int n = 32;
    using Rule = Collocation<n>;
    real end = 0;
    alignas(64) real psi[n], slope[n], sine[n], cosine[n], root[n]; // slope = dpsi/dx, root = sin(psi)^(1/5)

    static const Rule& rule() {
        static const Rule rule;
        return rule;
    }

    static real beta(real x) { // I_x(5, 5) for x <= 1/2
        return cube(x) * x * x * (126 + x * (-420 + x * (540 + x * (-315 + x * 70))));
    }

    // psi, sin and cos at any x, exact near both ends.
    void phase(real x, real& angle, real& sin_angle, real& cos_angle) const {
        const bool late = x > 0.5;
        const real part = end * beta(late ? 1 - x : x);
        const real other = (pi - end) + part; // pi - psi, when late
        angle = late ? end - part : part;
        sin_angle = std::sin(late ? other : part);
        cos_angle = late ? -std::cos(other) : std::cos(part);
    }

    void build(real psi_end) {
        if (end == psi_end) return;
        end = psi_end;
        for (int i = 0; i < n; ++i) {
            const real x = rule().node[i];
            phase(x, psi[i], sine[i], cosine[i]);
            slope[i] = 630 * end * square(square(x * (1 - x)));
            root[i] = std::pow(sine[i], 0.2);
        }
    }

    // The x at which psi(x) has the given value.
    real position(real value) const {
        const bool late = value > 0.5 * end;
        const real target = (late ? end - value : value) / end;
        real x = std::fmin(std::pow(target / 126, 0.2), 0.45);
        for (int iteration = 0; iteration < 50; ++iteration) {
            const real change = (target - beta(x)) / (630 * square(square(x * (1 - x))));
            x += change;
            if (std::fabs(change) < 2 * epsilon) break;
        }
        return late ? 1 - x : x;
    }
};

class LoneContact {
    static constexpr int n = PhaseGrid::n;
    static constexpr int most_sweeps = 16;
    using Values = real[n];

    const Problem& problem_;
    const Loads* loads_ = nullptr;
    const Contact* contact_ = nullptr;
    const Damper* damper_ = nullptr;
    const State* start_ = nullptr;
    HertzTsuji law_;
    real zeta_ = 0, s_ = 1, r0_ = 0, depth0_ = 0, wave_ = 0, damping_ = 0, speed_ = 0, side_ = 0;
    PhaseGrid grid_;
    alignas(64) Values time_slope_, log_r_, time_, a_, w_, x_, drift_, log_slope_, a_slope_;
    std::vector<real> q_, p_, force_, p_slope_, q_slope_, signals_; // by mode or load, then node
    real row_[n];

    real* mode(std::vector<real>& v, std::size_t k) { return v.data() + k * n; }

    // External closing acceleration at the nodes, with the balls' share constant but for the base.
    void external() {
        const std::size_t m = problem_.modes.size();
        const bool both_balls = side_ == 0;
        for (std::size_t l = 0; loads_->active() && l < loads_->size(); ++l)
            for (int i = 0; i < n; ++i)
                signals_[l * n + static_cast<std::size_t>(i)] = loads_->piece(l).value(start_->t + time_[i]);
        real constant = 0;
        if (!both_balls) constant = side_ * damper_->gravity;
        for (int i = 0; i < n; ++i) a_[i] = constant;
        for (std::size_t k = 0; k < m; ++k) {
            real* f = mode(force_, k);
            const real* q = mode(q_, k);
            const real* p = mode(p_, k);
            const real two_decay = 2 * problem_.modes[k].decay, stiffness = problem_.modes[k].stiffness;
            for (int i = 0; i < n; ++i) f[i] = -two_decay * p[i] - stiffness * q[i];
            for (std::size_t l = 0; loads_->active() && l < loads_->size(); ++l)
                for (int i = 0; i < n; ++i)
                    f[i] += loads_->load(l).shape[k] * signals_[l * n + static_cast<std::size_t>(i)];
            if (both_balls) continue;
            const real weight = -side_ * damper_->shape[k];
            for (int i = 0; i < n; ++i) a_[i] += weight * f[i];
        }
        if (!both_balls && loads_->active())
            for (std::size_t l = 0; l < loads_->size(); ++l)
                if (loads_->load(l).base)
                    for (int i = 0; i < n; ++i)
                        a_[i] -= side_ * signals_[l * n + static_cast<std::size_t>(i)];
    }

    // exp(y) for |y| < 0.7: Taylor, so that the loop over nodes vectorises.
    static real short_exp(real y) {
        constexpr int order = 15;
        static constexpr auto inverse_factorial = [] {
            std::array<real, order + 1> c{1};
            for (int k = 1; k <= order; ++k)
                c[static_cast<std::size_t>(k)] = c[static_cast<std::size_t>(k - 1)] / k;
            return c;
        }();
        real sum = inverse_factorial[order];
        for (int k = order - 1; k >= 0; --k) sum = inverse_factorial[static_cast<std::size_t>(k)] + y * sum;
        return sum;
    }

    // Rates at the nodes for the present guess.
    void rates() {
        const PhaseGrid& g = grid_;
        for (int i = 0; i < n; ++i) {
            const real grow = short_exp(0.2 * log_r_[i]);
            const real r = r0_ * square(square(grow)) * grow;
            x_[i] = depth0_ * g.root[i] * grow;
            w_[i] = r * (s_ * g.cosine[i] - zeta_ * g.sine[i]);
            const real pull = a_[i] / (s_ * r);
            time_slope_[i] = g.slope[i] / (s_ * wave_ * x_[i] - pull * g.sine[i]);
            log_slope_[i] = pull * (g.cosine[i] - zeta_ / s_ * g.sine[i]) * time_slope_[i];
            a_slope_[i] = a_[i] * time_slope_[i];
        }
    }

    // One sweep; returns the largest relative change.
    real sweep() {
        const PhaseGrid& g = grid_;
        rates();
        Values next;
        real change = 0;
        g.rule().integrate(log_slope_, next);
        for (int i = 0; i < n; ++i) {
            const real value = next[i] - zeta_ / s_ * g.psi[i];
            change = std::fmax(change, std::fabs(value - log_r_[i]));
            log_r_[i] = value;
        }
        g.rule().integrate(time_slope_, time_);
        g.rule().integrate(a_slope_, drift_);
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real *f = mode(force_, k), *ps = mode(p_slope_, k), *qs = mode(q_slope_, k), *q = mode(q_, k),
                 *p = mode(p_, k);
            for (int i = 0; i < n; ++i) {
                ps[i] = f[i] * time_slope_[i];
                qs[i] = p[i] * time_slope_[i];
            }
            g.rule().integrate(ps, p);
            g.rule().integrate(qs, q);
            const real kick = side_ * damper_->shape[k] * contact_->mass;
            const real q0 = start_->y[2 * k], p0 = start_->y[2 * k + 1];
            for (int i = 0; i < n; ++i) {
                q[i] += q0;
                p[i] += p0 + kick * (drift_[i] - (w_[i] - speed_));
            }
        }
        return change;
    }

    real dot(const real* row, const real* f) const {
        real sum = 0;
        for (int i = 0; i < n; ++i) sum += row[i] * f[i];
        return sum;
    }

public:
    // What the contact is at one instant of it.
    struct Instant {
        real time = 0, x = 0, rate = 0, force = 0, lost = 0;
    };

    explicit LoneContact(const Problem& problem)
        : problem_(problem), q_(problem.modes.size() * n), p_(q_.size()), force_(q_.size()),
          p_slope_(q_.size()), q_slope_(q_.size()), signals_(problem.loads.size() * n) {}

    // Prepares the contact c that touches in `start` at this speed; false where collocation is not the right
    // tool.
    bool prepare(const Contact& c, const HertzTsuji& law, const Loads& loads, const State& start, real speed,
                 real zeta, real available, real psi_end = 0) {
        if (!(speed > 0) || zeta > 0.4) return false;
        law_ = law;
        contact_ = &c;
        loads_ = &loads;
        start_ = &start;
        damper_ = &problem_.dampers[static_cast<std::size_t>(c.damper)];
        side_ = c.above == wall ? 1 : c.below == wall ? -1 : 0;
        zeta_ = zeta;
        s_ = std::sqrt((1 - zeta) * (1 + zeta));
        speed_ = speed;
        const real b = std::sqrt(law.stiffness / c.mass);
        wave_ = 0.5 * std::sqrt(5.0) * b;
        damping_ = std::sqrt(5.0) * zeta * std::sqrt(c.mass * law.stiffness);
        r0_ = speed / s_;
        depth0_ = std::pow(r0_ * 0.5 * std::sqrt(5.0) / b, 0.2);
        const real longest = longest_time();
        if (longest > available) return false;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            if (damper_->shape[k] != 0 && problem_.modes[k].rate() * longest > 1) return false;
        if (loads.active() && loads.frequency() * longest > 1) return false;
        const real natural_end = law.zero_overlap != 0 || zeta == 0 ? pi : 2 * std::acos(zeta);
        grid_.build(psi_end > 0 ? psi_end : natural_end);
        const PhaseGrid& g = grid_;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            for (int i = 0; i < n; ++i) {
                mode(q_, k)[i] = start.y[2 * k];
                mode(p_, k)[i] = start.y[2 * k + 1];
            }
        for (int i = 0; i < n; ++i) {
            time_[i] = 0;
            log_r_[i] = -zeta_ / s_ * g.psi[i];
        }
        external();
        return std::fabs(a_[0]) * longest < 0.25 * speed;
    }

    // A bound on the duration: 5/2.94 of the undamped contact.
    real longest_time() const { return 5 * square(square(depth0_)) / speed_; }

    // Sweeps to convergence.
    bool solve() {
        real before = 1;
        for (int pass = 0; pass < most_sweeps; ++pass) {
            const real change = sweep();
            external();
            // The next change would be below rounding, or it no longer falls because it is rounding.
            if (change * change < 0.25 * epsilon * before ||
                (change < 64 * epsilon && change > 0.1 * before)) {
                rates();
                return true;
            }
            before = change;
        }
        return false;
    }

    real deepest_position() const { return grid_.position(std::acos(zeta_)); }

    // State and ledger at position x of the phase; `ledger` and `out` may be null.
    Instant at(real position, State* out, Ledger* ledger) {
        const PhaseGrid& g = grid_;
        real psi, sine, cosine;
        g.phase(position, psi, sine, cosine);
        if (position < 1)
            g.rule().row(position, row_);
        else
            std::copy_n(g.rule().weight, n, row_);
        Instant now;
        now.time = dot(row_, time_slope_);
        const real grow = std::exp(0.2 * (dot(row_, log_slope_) - zeta_ / s_ * psi)),
                   r = r0_ * square(square(grow)) * grow;
        now.x = depth0_ * std::pow(std::fmax(sine, 0.0), 0.2) * grow;
        now.rate = r * (s_ * cosine - zeta_ * sine);
        now.force = now.x * (law_.stiffness * now.x * square(now.x * now.x) + damping_ * now.rate);
        Values loss;
        for (int i = 0; i < n; ++i) loss[i] = damping_ * x_[i] * square(w_[i]) * time_slope_[i];
        now.lost = dot(row_, loss);
        if (!out) return now;

        const real drift = dot(row_, a_slope_) - (now.rate - speed_); // impulse per reduced mass
        out->t = start_->t + now.time;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            real *f = mode(force_, k), *p = mode(p_, k);
            real dp = 0, dq = 0;
            for (int i = 0; i < n; ++i) {
                dp += row_[i] * f[i] * time_slope_[i];
                dq += row_[i] * p[i] * time_slope_[i];
            }
            out->y[2 * k] = start_->y[2 * k] + dq;
            out->y[2 * k + 1] =
                start_->y[2 * k + 1] + dp + side_ * damper_->shape[k] * contact_->mass * drift;
        }
        balls(now, drift, *out);
        if (ledger) account(*ledger, now);
        return now;
    }

    // The phase at a time after first touch, roughly: between nodes.
    real psi_at(real time) const {
        const PhaseGrid& g = grid_;
        int i = 0;
        while (i + 1 < n - 1 && time_[i + 1] < time) ++i;
        const real part = (time - time_[i]) / (time_[i + 1] - time_[i]);
        return std::fmin(std::fmax(g.psi[i] + part * (g.psi[i + 1] - g.psi[i]), 1e-3), g.end);
    }

    // dpsi/dt at an instant, but for the closing acceleration's small part.
    real turning(const Instant& now) const { return s_ * wave_ * now.x; }

    // The largest force: a step of Newton in time from where it would be without the closing acceleration's
    // help.
    real peak_force() {
        const real b2 = law_.stiffness / contact_->mass, c = damping_ / contact_->mass;
        real position = deepest_position(), best = 0;
        for (int pass = 0; pass < 6; ++pass) {
            const Instant i = at(position, nullptr, nullptr);
            const real x = i.x, w = i.rate, x3 = cube(x), dx = w / (4 * x3), dw = -i.force / contact_->mass;
            const real slope = 1.5 * b2 * x * x * w + c * (w * dx + x * dw);
            const real curve = 1.5 * b2 * (2 * x * dx * w + x * x * dw) +
                               c * (w * dw / (2 * x3) - 3 * w * w * dx / (4 * x3 * x) + dx * dw - x * slope);
            best = i.force;
            if (!(curve < 0) || damping_ == 0) break;
            const real shift = -slope / curve; // in time; psi turns at the rate s W
            best += contact_->mass * 0.5 * slope * shift;
            real psi, sine, cosine;
            grid_.phase(position, psi, sine, cosine);
            const real turned = psi + shift * s_ * wave_ * x;
            if (std::fabs(turned - psi) < 1e-6 || turned < 0.2 || turned > grid_.end - 0.2) break;
            position = grid_.position(turned);
        }
        return best;
    }

private:
    // Balls in flight but for the pair in contact; positions of the pair follow from momentum and overlap.
    void balls(const Instant& now, real drift, State& out) {
        const real t = now.time;
        real base_speed = 0, base_shift = 0; // what a base acceleration does to every ball
        for (std::size_t l = 0; loads_->active() && l < loads_->size(); ++l) {
            if (!loads_->load(l).base) continue;
            Series pull;
            loads_->piece(l).add_taylor(start_->t, -1, Series::order, pull.c);
            const Series u = forced_ball(0, 0, pull);
            base_speed += u.slope(t);
            base_shift += u.value(t);
        }
        const real *s0 = positions(problem_, start_->y.data()), *v0 = velocities(problem_, start_->y.data());
        real *s1 = positions(problem_, out.y.data()), *v1 = velocities(problem_, out.y.data());
        for (std::size_t i = 0; i < problem_.ball_mass.size(); ++i) {
            const real gravity = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
            s1[i] = s0[i] + t * (v0[i] + 0.5 * gravity * t) + base_shift;
            v1[i] = v0[i] + gravity * t + base_speed;
        }
        const real impulse = contact_->mass * drift, overlap = square(now.x * now.x);
        if (side_ != 0) {
            const std::size_t i = static_cast<std::size_t>(side_ > 0 ? contact_->below : contact_->above);
            const ModeState z = cavity(*damper_, out.y.data());
            const real half = 0.5 * damper_->clearance;
            s1[i] = side_ > 0 ? z.q + half + overlap : z.q - half - overlap;
            v1[i] -= side_ * impulse / problem_.ball_mass[i];
        } else {
            const auto i = static_cast<std::size_t>(contact_->below),
                       j = static_cast<std::size_t>(contact_->above);
            const real mi = problem_.ball_mass[i], mj = problem_.ball_mass[j];
            const real centre = (mi * s1[i] + mj * s1[j]) / (mi + mj);
            s1[i] = centre + overlap * mj / (mi + mj);
            s1[j] = centre - overlap * mi / (mi + mj);
            v1[i] -= impulse / mi;
            v1[j] += impulse / mj;
        }
    }

    void account(Ledger& ledger, const Instant& now) {
        ledger.normal[static_cast<std::size_t>(contact_->damper)] += now.lost;
        for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
            if (problem_.modes[k].decay == 0) continue;
            const real* p = mode(p_, k);
            real sum = 0;
            for (int i = 0; i < n; ++i) sum += row_[i] * square(p[i]) * time_slope_[i];
            ledger.viscous += 2 * problem_.modes[k].decay * sum;
        }
        if (!loads_->active()) return;
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            const Load& load = loads_->load(l);
            if (loads_->piece(l).silent()) continue;
            Values power = {};
            for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                for (int i = 0; i < n; ++i) power[i] += load.shape[k] * mode(p_, k)[i];
            if (load.base) {
                State probe(problem_);
                for (int i = 0; i < n; ++i) {
                    Instant node{time_[i], x_[i], w_[i], 0, 0};
                    for (std::size_t k = 0; k < problem_.modes.size(); ++k) {
                        probe.y[2 * k] = mode(q_, k)[i];
                        probe.y[2 * k + 1] = mode(p_, k)[i];
                    }
                    balls(node, drift_[i] - (w_[i] - speed_), probe);
                    const real* v = velocities(problem_, probe.y.data());
                    for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
                        power[i] -= problem_.ball_mass[b] * v[b];
                }
            }
            real sum = 0;
            for (int i = 0; i < n; ++i)
                sum += row_[i] * power[i] * signals_[l * n + static_cast<std::size_t>(i)] * time_slope_[i];
            (load.base ? ledger.base_work : ledger.load_work) += sum;
        }
    }
};

} // namespace rattlebox
