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
// incomplete beta function of (5, 5) makes d^(1/4) analytic at both ends.
//
// Without a, r = r1(psi) and x = d^(1/4) = x0(psi). With gain = (r/r1)^(6/5), x r = x0 r1 gain, and the
// equation of gain is free of gain itself but for the term a sin(psi): fixed-point sweeps over all nodes,
// each with its own clock and modes before its gain, gain a factor (a t_c / V)^2 each.
//
// The energy balance, which the sweeps do not use, decides whether the result is taken; if not, or if the
// contact is slow, strongly damped or has neighbours, impact/closed.hpp integrates it step by step.
#pragma once

#include <array>
#include <vector>

#include "impact/state.hpp"
#include "math/collocation.hpp"

namespace rattlebox {

// psi(x) = psi_end I_x(5, 5) and what follows from it at the nodes. Rebuilt only when psi_end changes.
struct PhaseGrid {
    static constexpr int n = 32;
    using Rule = Collocation<n>;
    real end = 0;
    Rule::Row psi, slope, sine, cosine, root; // slope = dpsi/dx, root = sin(psi)^(1/5)

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
        real x = target > 0.2 ? 0.5 - (0.5 - target) * 256 / 630 : std::pow(target / 126, 0.2);
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
    static constexpr int most_sweeps = 24;
    using Row = PhaseGrid::Rule::Row;
    // Rows that are integrated: forces on the modes from first_mode on, the same times the time, the base.
    enum : std::size_t { clock, gain, first_mode };

    const Problem& problem_;
    const std::size_t modes_;
    const Loads* loads_ = nullptr;
    const Contact* contact_ = nullptr;
    const Damper* damper_ = nullptr;
    const State* start_ = nullptr;
    HertzTsuji law_;
    real zeta_ = 0, s_ = 1, r0_ = 0, depth0_ = 0, wave_ = 0, damping_ = 0, speed_ = 0, side_ = 0;
    real constant_ = 0; // part of the closing acceleration
    bool base_moves_ = false;
    PhaseGrid grid_;
    Row x0_, r1_, turn_; // without closing acceleration: x and r; w = r turn in any case
    Row swing_;          // and s^2 W r
    Row grow_, rate_;    // gain^(1/6); dpsi/dt / (s r) is 1 / rate, but for the grid's slope
    Row a_, base_, x_, w_;
    std::vector<Row> slope_, integral_;
    std::vector<Row> q_, p_, u_, path_, force_, signal_; // by mode or load
    std::vector<Series> pull_;                           // each load about the start, good to this degree
    int degree_ = 0;

    std::size_t late_row() const { return first_mode + modes_; }
    std::size_t base_row() const { return late_row() + modes_; }
    real weight(std::size_t k) const {
        return -side_ * damper_->shape[k];
    } // of a mode in what closes the gap
    // Of the structure's velocity, from that of the gap.
    real kick(std::size_t k) const { return side_ * damper_->shape[k] * contact_->mass; }

    // External closing acceleration at the nodes, with the balls' share constant but for the base.
    void external() {
        for (int i = 0; i < n; ++i) a_[i] = constant_;
        if (loads_->active())
            for (std::size_t l = 0; l < loads_->size(); ++l)
                for (int i = 0; i < n; i += lane_count) {
                    const Lanes t = integral_[clock].read(i);
                    Lanes sum = Lanes::all(pull_[l].c[degree_]);
                    for (int k = degree_ - 1; k >= 0; --k) sum = sum * t + Lanes::all(pull_[l].c[k]);
                    signal_[l].eight(i) = sum;
                }
        for (std::size_t k = 0; k < modes_; ++k) {
            Row& f = force_[k];
            const real two_decay = 2 * problem_.modes[k].decay, stiffness = problem_.modes[k].stiffness;
            for (int i = 0; i < n; ++i) f[i] = -two_decay * p_[k][i] - stiffness * q_[k][i];
            if (loads_->active())
                for (std::size_t l = 0; l < loads_->size(); ++l)
                    for (int i = 0; i < n; ++i) f[i] += loads_->load(l).shape[k] * signal_[l][i];
            const real part = weight(k);
            for (int i = 0; i < n; ++i) a_[i] += part * f[i];
        }
        if (!base_moves_) return;
        for (int i = 0; i < n; ++i) base_[i] = 0;
        for (std::size_t l = 0; l < loads_->size(); ++l)
            if (loads_->load(l).base)
                for (int i = 0; i < n; ++i) base_[i] -= side_ * signal_[l][i];
        for (int i = 0; i < n; ++i) a_[i] += base_[i];
    }

    // Taylor series of the loads over the contact; false where they would not reach that far.
    bool expand_loads(real length) {
        const real turn = loads_->frequency() * length;
        if (turn > 1) return false;
        real term = turn;
        for (degree_ = 1; degree_ < Series::order && term > 0.1 * epsilon; ++degree_)
            term *= turn / (degree_ + 1);
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            pull_[l] = Series{};
            loads_->piece(l).add_taylor(start_->t, 1, degree_, pull_[l].c);
        }
        return true;
    }

    template <class T> static T fifth_power(T v) {
        const T v2 = v * v;
        return v2 * v2 * v;
    }

    // exp(y) for small |y|: Taylor.
    template <int order> static Lanes short_exp(const Lanes& y) {
        const Lanes one = Lanes::all(1);
        Lanes sum = one;
        for (int k = order; k >= 1; --k) sum = one + 1.0 / k * y * sum;
        return sum;
    }

    // (1 + z)^(1/6) for small z; what it leaves the next sweep finds.
    static Lanes sixth_root(const Lanes& z) {
        const Lanes one = Lanes::all(1);
        return one + 1.0 / 6 * z * (one - 5.0 / 12 * z * (one - 11.0 / 18 * z * (one - 17.0 / 24 * z)));
    }

    // x, w and the clock's slope for the present gain.
    void rates() {
        const PhaseGrid& g = grid_;
        const Lanes one = Lanes::all(1);
        for (int i = 0; i < n; i += lane_count) {
            const Lanes grow = grow_.read(i), r = r1_.eight(i) * fifth_power(grow);
            const Lanes rate = g.slope.eight(i) / (swing_.eight(i) * (one + integral_[gain].eight(i)) -
                                                   a_.eight(i) * g.sine.eight(i));
            x_.eight(i) = x0_.eight(i) * grow;
            w_.eight(i) = r * turn_.eight(i);
            rate_.eight(i) = rate;
            slope_[clock].eight(i) = s_ * r * rate;
        }
    }

    // u = p + kick w, which the contact force leaves alone, and its path (by parts, so that both follow from
    // the same forces): at first with the forces as at the start, then with those of the sweep before.
    void move_modes(bool first) {
        const Row &time = integral_[clock], &slope = slope_[clock];
        if (first) {
            for (std::size_t k = 0; k < modes_; ++k) {
                const real u0 = start_->y[2 * k + 1] + kick(k) * speed_, f = force_[k][0] + kick(k) * a_[0];
                for (int i = 0; i < n; ++i) {
                    u_[k][i] = u0 + f * time[i];
                    path_[k][i] = time[i] * (u0 + 0.5 * f * time[i]);
                }
            }
            return;
        }
        for (std::size_t k = 0; k < modes_; ++k)
            for (int i = 0; i < n; ++i) {
                slope_[first_mode + k][i] = force_[k][i] * slope[i];
                slope_[late_row() + k][i] = (force_[k][i] + kick(k) * a_[i]) * time[i] * slope[i];
            }
        if (base_moves_)
            for (int i = 0; i < n; ++i) slope_[base_row()][i] = base_[i] * slope[i];
        grid_.rule().integrate(&slope_[first_mode], &integral_[first_mode], 2 * modes_ + base_moves_);
        Row drift; // what the closing acceleration has made of the speed
        for (int i = 0; i < n; ++i) drift[i] = speed_ + constant_ * time[i];
        if (base_moves_)
            for (int i = 0; i < n; ++i) drift[i] += integral_[base_row()][i];
        for (std::size_t k = 0; k < modes_; ++k)
            for (int i = 0; i < n; ++i) drift[i] += weight(k) * integral_[first_mode + k][i];
        for (std::size_t k = 0; k < modes_; ++k) {
            const real share = kick(k), p0 = start_->y[2 * k + 1];
            for (int i = 0; i < n; ++i) {
                u_[k][i] = p0 + integral_[first_mode + k][i] + share * drift[i];
                path_[k][i] = time[i] * u_[k][i] - integral_[late_row() + k][i];
            }
        }
    }

    // p and q at the nodes.
    void place_modes() {
        for (std::size_t k = 0; k < modes_; ++k) {
            const real q0 = start_->y[2 * k], share = kick(k);
            for (int i = 0; i < n; ++i) {
                p_[k][i] = u_[k][i] - share * w_[i];
                q_[k][i] = q0 + path_[k][i] - share * square(square(x_[i]));
            }
        }
    }

    // One sweep; returns the largest relative change of the gain.
    real sweep(bool first) {
        rates();
        grid_.rule().integrate<1>(&slope_[clock], &integral_[clock]);
        move_modes(first);
        place_modes();
        external();
        const Lanes one = Lanes::all(1);
        const real factor = 1.2 / s_;
        for (int i = 0; i < n; i += lane_count)
            slope_[gain].eight(i) =
                factor * (one + integral_[gain].eight(i)) * a_.eight(i) * turn_.eight(i) * rate_.eight(i);
        grid_.rule().integrate<1>(&slope_[gain], &integral_[gain]);
        Lanes most = {};
        for (int i = 0; i < n; i += lane_count) {
            const Lanes grow = grow_.read(i);
            const Lanes change = (one + integral_[gain].eight(i)) / (grow * fifth_power(grow)) - one;
            grow_.eight(i) = grow * sixth_root(change);
            most = larger(most, absolute(change));
        }
        return largest(most);
    }

public:
    // What the contact is at one instant of it.
    struct Instant {
        real time = 0, x = 0, rate = 0, force = 0, lost = 0;
    };

    explicit LoneContact(const Problem& problem)
        : problem_(problem), modes_(problem.modes.size()), slope_(first_mode + 2 * modes_ + 1),
          integral_(slope_.size()), q_(modes_), p_(modes_), u_(modes_), path_(modes_), force_(modes_),
          signal_(problem.loads.size()), pull_(problem.loads.size()) {}

    // Prepares the contact c that touches in `start` at this speed; false where collocation is not the right
    // tool.
    bool prepare(const Contact& c, const HertzTsuji& law, const Loads& loads, const State& start, real speed,
                 real zeta, real available, real psi_end = 0) {
        if (!(speed > 0) || zeta > 0.4 || !problem_.coupling.empty()) return false;
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
        for (std::size_t k = 0; k < modes_; ++k)
            if (damper_->shape[k] != 0 && problem_.modes[k].rate() * longest > 1) return false;
        if (loads.active() && !expand_loads(longest)) return false;
        constant_ = side_ * damper_->gravity;
        base_moves_ = false;
        if (loads.active() && side_ != 0)
            for (std::size_t l = 0; l < loads.size(); ++l) base_moves_ = base_moves_ || loads.load(l).base;
        const real natural_end = law.zero_overlap != 0 || zeta == 0 ? pi : 2 * std::acos(zeta);
        grid_.build(psi_end > 0 ? psi_end : natural_end);
        for (int i = 0; i < n; ++i) integral_[clock][i] = 0;
        for (std::size_t k = 0; k < modes_; ++k)
            for (int i = 0; i < n; ++i) {
                q_[k][i] = start.y[2 * k];
                p_[k][i] = start.y[2 * k + 1];
            }
        external();
        return std::fabs(a_[0]) * longest < speed;
    }

    // A bound on the duration: 5/2.94 of the undamped contact.
    real longest_time() const { return 5 * square(square(depth0_)) / speed_; }

    // Sweeps to convergence, from the contact on its own.
    bool solve() {
        const PhaseGrid& g = grid_;
        for (int i = 0; i < n; i += lane_count) {
            const Lanes shrink = short_exp<15>(-0.2 * zeta_ / s_ * g.psi.eight(i));
            x0_.eight(i) = depth0_ * g.root.eight(i) * shrink;
            r1_.eight(i) = r0_ * fifth_power(shrink);
            turn_.eight(i) = s_ * g.cosine.eight(i) - zeta_ * g.sine.eight(i);
            swing_.eight(i) = s_ * s_ * wave_ * x0_.eight(i) * r1_.eight(i);
            // r^2 is V^2 + 2 a d for constant a and no damping.
            const Lanes x = x0_.read(i), z = 2 * a_[0] / square(speed_) * x * x * (x * x);
            const Lanes grow = Lanes::all(1) + 0.1 * z * (Lanes::all(1) - 0.45 * z);
            integral_[gain].eight(i) = grow * fifth_power(grow) - Lanes::all(1);
            grow_.eight(i) = grow;
        }
        real before = 1;
        for (int pass = 0; pass < most_sweeps; ++pass) {
            const real change = sweep(pass == 0);
            if (!(change < 1)) return false;
            // The next change would be rounding, or it no longer falls because it is rounding.
            if (pass > 0 && (change * change <= 1e-5 * problem_.settings.tolerance * before ||
                             (change < 64 * epsilon && change > 0.1 * before))) {
                rates();
                return true;
            }
            before = change;
        }
        return false;
    }

    real deepest_position() const { return grid_.position(std::acos(zeta_)); }
    // Time since first touch at a position, as good as the clock between its nodes.
    real time_at(real position) const { return grid_.rule().interpolate(integral_[clock], position); }

    // The contact itself at position x of the phase.
    Instant look(real position) const {
        real psi, sine, cosine;
        grid_.phase(position, psi, sine, cosine);
        return look(psi, sine, cosine, grid_.rule().interpolate(integral_[gain], position));
    }

    Instant look(real psi, real sine, real cosine, real gained) const {
        Instant now;
        const real log_r = std::log1p(gained) / 1.2 - zeta_ / s_ * psi;
        const real grow = std::exp(0.2 * log_r), r = r0_ * fifth_power(grow);
        now.x = sine > 0 ? depth0_ * std::pow(sine, 0.2) * grow : 0;
        now.rate = r * (s_ * cosine - zeta_ * sine);
        now.force = now.x * (law_.stiffness * now.x * square(now.x * now.x) + damping_ * now.rate);
        return now;
    }

    // The end of the contact, or of the part of it that is solved.
    Instant end() const {
        const auto& rule = grid_.rule();
        real psi, sine, cosine;
        grid_.phase(1, psi, sine, cosine);
        Instant now = look(psi, sine, cosine, rule.whole(slope_[gain]));
        now.time = rule.whole(slope_[clock]);
        Row loss;
        for (int i = 0; i < n; ++i) loss[i] = x_[i] * square(w_[i]) * slope_[clock][i];
        now.lost = damping_ * rule.whole(loss);
        return now;
    }

    // State and ledger at that end.
    void finish(const Instant& now, State& out, Ledger& ledger) const {
        const auto& rule = grid_.rule();
        Row part;
        const auto total = [&](const Row& f) {
            for (int i = 0; i < n; ++i) part[i] = f[i] * slope_[clock][i];
            return rule.whole(part);
        };
        real drift = constant_ * now.time - (now.rate - speed_); // impulse per reduced mass
        if (base_moves_) drift += total(base_);
        for (std::size_t k = 0; k < modes_; ++k) {
            out.y[2 * k] = start_->y[2 * k] + total(p_[k]);
            const real gain = total(force_[k]);
            out.y[2 * k + 1] = start_->y[2 * k + 1] + gain;
            drift += weight(k) * gain;
        }
        for (std::size_t k = 0; k < modes_; ++k) out.y[2 * k + 1] += kick(k) * drift;
        out.t = start_->t + now.time;
        balls(now, drift, out);
        account(now, ledger);
    }

    // The phase at which it opens: past it there is no overlap to take a root of.
    real last_psi() const { return grid_.end; }

    // The phase at a time after first touch, as good as the clock between its nodes.
    real psi_at(real time) const {
        const auto& rule = grid_.rule();
        const Row& at = integral_[clock];
        int i = 0;
        while (i + 1 < n - 1 && at[i + 1] < time) ++i;
        const real part = (time - at[i]) / (at[i + 1] - at[i]);
        real x = rule.node[i] + part * (rule.node[i + 1] - rule.node[i]);
        for (int pass = 0; pass < 4; ++pass) {
            const real late = (time - rule.interpolate(at, x)) / rule.interpolate(slope_[clock], x);
            if (!(x + late > 0 && x + late < 1)) break; // on a node, or near an end
            x += late;
        }
        real psi, sine, cosine;
        grid_.phase(std::fmin(std::fmax(x, 0.0), 1.0), psi, sine, cosine);
        return std::fmin(std::fmax(psi, 1e-3), grid_.end);
    }

    // dpsi/dt at an instant, but for the closing acceleration's small part.
    real turning(const Instant& now) const { return s_ * wave_ * now.x; }

    // The largest force: steps of Newton in time, from where it is in a lightly damped contact on its own.
    real peak_force() const {
        const real b2 = law_.stiffness / contact_->mass, c = damping_ / contact_->mass;
        real psi = 0.5 * pi - 8.0 / 3.0 * zeta_, best = 0;
        for (int pass = 0; pass < 6; ++pass) {
            const Instant at = look(grid_.position(psi));
            const real x = at.x, w = at.rate, x3 = cube(x), dx = w / (4 * x3),
                       dw = -at.force / contact_->mass;
            const real slope = 1.5 * b2 * x * x * w + c * (w * dx + x * dw);
            const real curve = 1.5 * b2 * (2 * x * dx * w + x * x * dw) +
                               c * (w * dw / (2 * x3) - 3 * w * w * dx / (4 * x3 * x) + dx * dw - x * slope);
            best = at.force;
            if (!(curve < 0)) break;
            const real shift = -slope / curve; // in time; psi turns at the rate s W
            best += contact_->mass * 0.5 * slope * shift;
            const real turned = psi + shift * turning(at);
            if (std::fabs(turned - psi) < 1e-4 || turned < 0.2 || turned > grid_.end - 0.2) break;
            psi = turned;
        }
        return best;
    }

private:
    // Balls in flight but for the pair in contact; positions of the pair follow from momentum and overlap.
    void balls(const Instant& now, real drift, State& out) const {
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

    void account(const Instant& now, Ledger& ledger) const {
        const auto& rule = grid_.rule();
        ledger.normal[static_cast<std::size_t>(contact_->damper)] += now.lost;
        Row power;
        for (std::size_t k = 0; k < modes_; ++k) {
            if (problem_.modes[k].decay == 0) continue;
            for (int i = 0; i < n; ++i) power[i] = square(p_[k][i]) * slope_[clock][i];
            ledger.viscous += 2 * problem_.modes[k].decay * rule.whole(power);
        }
        if (!loads_->active()) return;
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            const Load& load = loads_->load(l);
            if (loads_->piece(l).silent()) continue;
            for (int i = 0; i < n; ++i) power[i] = 0;
            for (std::size_t k = 0; k < modes_; ++k)
                for (int i = 0; i < n; ++i) power[i] += load.shape[k] * p_[k][i];
            if (load.base) subtract_balls(power);
            for (int i = 0; i < n; ++i) power[i] *= signal_[l][i] * slope_[clock][i];
            (load.base ? ledger.base_work : ledger.load_work) += rule.whole(power);
        }
    }

    // The balls' momentum at the nodes, which the base works on.
    void subtract_balls(Row& power) const {
        State probe(problem_);
        for (int i = 0; i < n; ++i) {
            Instant node;
            node.time = integral_[clock][i];
            node.x = x_[i];
            node.rate = w_[i];
            real drift = constant_ * node.time - (w_[i] - speed_);
            if (base_moves_) drift += integral_[base_row()][i];
            for (std::size_t k = 0; k < modes_; ++k) {
                drift += weight(k) * integral_[first_mode + k][i];
                probe.y[2 * k] = q_[k][i];
                probe.y[2 * k + 1] = p_[k][i];
            }
            balls(node, drift, probe);
            const real* v = velocities(problem_, probe.y.data());
            for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
                power[i] -= problem_.ball_mass[b] * v[b];
        }
    }
};

} // namespace rattlebox
