// An isolated Hertz-Tsuji contact (contact/normal/hertz_tsuji.hpp), solved as a whole by collocation in its
// phase angle.
//
// With P = (2/sqrt5) b d^(5/4), b^2 = A/m, w = d' and Y = (w + zeta P)/s, s^2 = 1 - zeta^2, the contact
// without other forces is a rotation: P = r sin(psi), Y = r cos(psi). All other forces (spring, load,
// gravity) cause a small closing acceleration a:
//
//     dpsi/dt = s W - a sin(psi) / (s r)        W = (sqrt5/2) b d^(1/4)
//     d ln r/dt = -zeta W + a cos(psi) / (s r)
//
// psi always increases from 0 to pi, so no event must be located: zero overlap is at psi = pi, the deepest
// overlap at tan(psi) = s/zeta, zero force at psi = 2 acos(zeta). With psi = pi I(x), where I is the
// regularised incomplete beta function of (5, 5), d^(1/4) is analytic at both ends.
//
// Without a, r = r1(psi) and x = d^(1/4) = x0(psi). With gain = (r/r1)^(6/5), x r = x0 r1 gain, and the
// equation of gain contains gain itself only in the term a sin(psi). It is solved by fixed-point sweeps over
// all nodes; each sweep computes time, modes and gain, and reduces the error by a factor of about (a t_c /
// V)^2.
//
// The result is accepted only if the energy balance holds, which the sweeps do not use. Otherwise, or if the
// contact is slow, strongly damped or not isolated, impact/contact_solver.hpp integrates it step by step.
//
// The equations are derived here. Fixed-point sweeps over nodes: C. W. Clenshaw, H. J. Norton, Computer J. 6
// (1963) 88, doi:10.1093/comjnl/6.1.88.
#pragma once

#include <array>
#include <vector>

#include "impact/state.hpp"
#include "math/collocation.hpp"

namespace rattlebox {

// psi(x) = psi_end I_x(5, 5) and functions of it at the nodes. Computed again only if psi_end changes.
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

    // Computes psi, sin(psi) and cos(psi) at any x, without cancellation near both ends.
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

    // Returns the x at which psi(x) has the given value.
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

class IsolatedContact {
    static constexpr int n = PhaseGrid::n;
    static constexpr int max_sweeps = 24;
    using Row = PhaseGrid::Rule::Row;
    // Rows that are integrated: time, gain, modal forces, modal forces times time, base acceleration.
    enum : std::size_t { clock, gain, first_mode };

    const Problem& problem_;
    const std::size_t modes_;
    const Loads* loads_ = nullptr;
    const Contact* contact_ = nullptr;
    const Damper* damper_ = nullptr;
    const State* start_ = nullptr;
    HertzTsuji law_;
    real zeta_ = 0, s_ = 1, r0_ = 0, depth0_ = 0, wave_ = 0, damping_ = 0, speed_ = 0, side_ = 0;
    real constant_ = 0; // constant part of the closing acceleration
    bool base_moves_ = false;
    PhaseGrid grid_;
    Row x0_, r1_, w_over_r_; // x and r without closing acceleration; w / r, which does not depend on it
    Row rotation_rate_;      // s^2 W r
    Row x_gain_, rate_;      // gain^(1/6); slope of psi(x) over s r dpsi/dt
    Row a_, base_, x_, w_;
    std::vector<Row> slope_, integral_;
    std::vector<Row> q_, p_, u_, path_, force_, signal_; // by mode or load
    std::vector<Series> load_series_;                    // Taylor series of each load, of this degree
    int degree_ = 0;

    std::size_t moment_row() const { return first_mode + modes_; }
    std::size_t base_row() const { return moment_row() + modes_; }
    real weight(std::size_t k) const {
        return -side_ * damper_->shape[k];
    } // of a mode in the closing acceleration
    // Change of the modal velocity per change of the approach rate.
    real impulse_share(std::size_t k) const { return side_ * damper_->shape[k] * contact_->mass; }

    // Computes the modal forces without contact and the closing acceleration at the nodes.
    void compute_acceleration() {
        for (int i = 0; i < n; ++i) a_[i] = constant_;
        if (loads_->active())
            for (std::size_t l = 0; l < loads_->size(); ++l)
                for (int i = 0; i < n; i += lane_count) {
                    const Lanes t = integral_[clock].read(i);
                    Lanes sum = Lanes::all(load_series_[l].c[degree_]);
                    for (int k = degree_ - 1; k >= 0; --k) sum = sum * t + Lanes::all(load_series_[l].c[k]);
                    signal_[l].lanes_at(i) = sum;
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

    // Expands the loads in Taylor series over the contact; returns false if they would not converge.
    bool expand_loads(real length) {
        const real turn = loads_->frequency() * length;
        if (turn > 1) return false;
        real term = turn;
        for (degree_ = 1; degree_ < Series::order && term > 0.1 * epsilon; ++degree_)
            term *= turn / (degree_ + 1);
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            load_series_[l] = Series{};
            loads_->piece(l).add_taylor(start_->t, 1, degree_, load_series_[l].c);
        }
        return true;
    }

    template <class T> static T fifth_power(T v) {
        const T v2 = v * v;
        return v2 * v2 * v;
    }

    // Taylor series of exp(y) for small |y|.
    template <int order> static Lanes short_exp(const Lanes& y) {
        const Lanes one = Lanes::all(1);
        Lanes sum = one;
        for (int k = order; k >= 1; --k) sum = one + 1.0 / k * y * sum;
        return sum;
    }

    // Taylor series of (1 + z)^(1/6) for small z; the next sweep corrects its error.
    static Lanes sixth_root(const Lanes& z) {
        const Lanes one = Lanes::all(1);
        return one + 1.0 / 6 * z * (one - 5.0 / 12 * z * (one - 11.0 / 18 * z * (one - 17.0 / 24 * z)));
    }

    // Computes x, w and dt/dx for the current gain.
    void rates() {
        const PhaseGrid& g = grid_;
        const Lanes one = Lanes::all(1);
        for (int i = 0; i < n; i += lane_count) {
            const Lanes x_gain = x_gain_.read(i), r = r1_.lanes_at(i) * fifth_power(x_gain);
            const Lanes rate =
                g.slope.lanes_at(i) / (rotation_rate_.lanes_at(i) * (one + integral_[gain].lanes_at(i)) -
                                       a_.lanes_at(i) * g.sine.lanes_at(i));
            x_.lanes_at(i) = x0_.lanes_at(i) * x_gain;
            w_.lanes_at(i) = r * w_over_r_.lanes_at(i);
            rate_.lanes_at(i) = rate;
            slope_[clock].lanes_at(i) = s_ * r * rate;
        }
    }

    // Computes u = p + impulse_share w, which does not depend on the contact force, and its integral (by
    // parts, so that both use the same forces): first with the forces at the start, then with those of the
    // previous sweep.
    void move_modes(bool first) {
        const Row &time = integral_[clock], &slope = slope_[clock];
        if (first) {
            for (std::size_t k = 0; k < modes_; ++k) {
                const real u0 = start_->y[2 * k + 1] + impulse_share(k) * speed_,
                           f = force_[k][0] + impulse_share(k) * a_[0];
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
                slope_[moment_row() + k][i] = (force_[k][i] + impulse_share(k) * a_[i]) * time[i] * slope[i];
            }
        if (base_moves_)
            for (int i = 0; i < n; ++i) slope_[base_row()][i] = base_[i] * slope[i];
        grid_.rule().integrate(&slope_[first_mode], &integral_[first_mode], 2 * modes_ + base_moves_);
        Row drift; // approach speed without the contact force
        for (int i = 0; i < n; ++i) drift[i] = speed_ + constant_ * time[i];
        if (base_moves_)
            for (int i = 0; i < n; ++i) drift[i] += integral_[base_row()][i];
        for (std::size_t k = 0; k < modes_; ++k)
            for (int i = 0; i < n; ++i) drift[i] += weight(k) * integral_[first_mode + k][i];
        for (std::size_t k = 0; k < modes_; ++k) {
            const real share = impulse_share(k), p0 = start_->y[2 * k + 1];
            for (int i = 0; i < n; ++i) {
                u_[k][i] = p0 + integral_[first_mode + k][i] + share * drift[i];
                path_[k][i] = time[i] * u_[k][i] - integral_[moment_row() + k][i];
            }
        }
    }

    // Computes p and q at the nodes.
    void place_modes() {
        for (std::size_t k = 0; k < modes_; ++k) {
            const real q0 = start_->y[2 * k], share = impulse_share(k);
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
        compute_acceleration();
        const Lanes one = Lanes::all(1);
        const real factor = 1.2 / s_;
        for (int i = 0; i < n; i += lane_count)
            slope_[gain].lanes_at(i) = factor * (one + integral_[gain].lanes_at(i)) * a_.lanes_at(i) *
                                       w_over_r_.lanes_at(i) * rate_.lanes_at(i);
        grid_.rule().integrate<1>(&slope_[gain], &integral_[gain]);
        Lanes most = {};
        for (int i = 0; i < n; i += lane_count) {
            const Lanes x_gain = x_gain_.read(i);
            const Lanes change = (one + integral_[gain].lanes_at(i)) / (x_gain * fifth_power(x_gain)) - one;
            x_gain_.lanes_at(i) = x_gain * sixth_root(change);
            most = larger(most, absolute(change));
        }
        return largest(most);
    }

public:
    // State of the contact at one instant.
    struct Instant {
        real time = 0, x = 0, rate = 0, force = 0, lost = 0;
    };

    explicit IsolatedContact(const Problem& problem)
        : problem_(problem), modes_(problem.modes.size()), slope_(first_mode + 2 * modes_ + 1),
          integral_(slope_.size()), q_(modes_), p_(modes_), u_(modes_), path_(modes_), force_(modes_),
          signal_(problem.loads.size()), load_series_(problem.loads.size()) {}

    // Prepares the contact c, which begins in `start` at this speed; returns false if collocation is not
    // applicable.
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
        if (loads.active() && side_ != 0 && c.above != ground)
            for (std::size_t l = 0; l < loads.size(); ++l) base_moves_ = base_moves_ || loads.load(l).base;
        const real natural_end = law.zero_overlap != 0 || zeta == 0 ? pi : 2 * std::acos(zeta);
        grid_.build(psi_end > 0 ? psi_end : natural_end);
        for (int i = 0; i < n; ++i) integral_[clock][i] = 0;
        for (std::size_t k = 0; k < modes_; ++k)
            for (int i = 0; i < n; ++i) {
                q_[k][i] = start.y[2 * k];
                p_[k][i] = start.y[2 * k + 1];
            }
        compute_acceleration();
        return std::fabs(a_[0]) * longest < speed;
    }

    // Returns a bound of the duration: 5/2.94 of the undamped contact.
    real longest_time() const { return 5 * square(square(depth0_)) / speed_; }

    // Sweeps to convergence, starting from the contact without closing acceleration.
    bool solve() {
        const PhaseGrid& g = grid_;
        for (int i = 0; i < n; i += lane_count) {
            const Lanes shrink = short_exp<15>(-0.2 * zeta_ / s_ * g.psi.lanes_at(i));
            x0_.lanes_at(i) = depth0_ * g.root.lanes_at(i) * shrink;
            r1_.lanes_at(i) = r0_ * fifth_power(shrink);
            w_over_r_.lanes_at(i) = s_ * g.cosine.lanes_at(i) - zeta_ * g.sine.lanes_at(i);
            rotation_rate_.lanes_at(i) = s_ * s_ * wave_ * x0_.lanes_at(i) * r1_.lanes_at(i);
            // Initial guess: r^2 = V^2 + 2 a d for constant a and no damping.
            const Lanes x = x0_.read(i), z = 2 * a_[0] / square(speed_) * x * x * (x * x);
            const Lanes x_gain = Lanes::all(1) + 0.1 * z * (Lanes::all(1) - 0.45 * z);
            integral_[gain].lanes_at(i) = x_gain * fifth_power(x_gain) - Lanes::all(1);
            x_gain_.lanes_at(i) = x_gain;
        }
        real before = 1;
        for (int pass = 0; pass < max_sweeps; ++pass) {
            const real change = sweep(pass == 0);
            if (!(change < 1)) return false;
            // Converged if the next change would be below the tolerance, or the change is at rounding level
            // and no longer falls.
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
    // Returns the time since first touch at a position, by interpolation between the nodes.
    real time_at(real position) const { return grid_.rule().interpolate(integral_[clock], position); }

    // Returns the contact at a position x.
    Instant instant_at(real position) const {
        real psi, sine, cosine;
        grid_.phase(position, psi, sine, cosine);
        return instant_at(psi, sine, cosine, grid_.rule().interpolate(integral_[gain], position));
    }

    Instant instant_at(real psi, real sine, real cosine, real gain_minus_one) const {
        Instant now;
        const real log_r = std::log1p(gain_minus_one) / 1.2 - zeta_ / s_ * psi;
        const real x_gain = std::exp(0.2 * log_r), r = r0_ * fifth_power(x_gain);
        now.x = sine > 0 ? depth0_ * std::pow(sine, 0.2) * x_gain : 0;
        now.rate = r * (s_ * cosine - zeta_ * sine);
        now.force = now.x * (law_.stiffness * now.x * square(now.x * now.x) + damping_ * now.rate);
        return now;
    }

    // Returns the end of the contact, or of the part of it that was solved.
    Instant end() const {
        const auto& rule = grid_.rule();
        real psi, sine, cosine;
        grid_.phase(1, psi, sine, cosine);
        Instant now = instant_at(psi, sine, cosine, rule.integral(slope_[gain]));
        now.time = rule.integral(slope_[clock]);
        Row loss;
        for (int i = 0; i < n; ++i) loss[i] = x_[i] * square(w_[i]) * slope_[clock][i];
        now.lost = damping_ * rule.integral(loss);
        return now;
    }

    // Computes the state at that end, and adds to the ledger.
    void store_end(const Instant& now, State& out, Ledger& ledger) const {
        const auto& rule = grid_.rule();
        Row part;
        const auto total = [&](const Row& f) {
            for (int i = 0; i < n; ++i) part[i] = f[i] * slope_[clock][i];
            return rule.integral(part);
        };
        real drift =
            constant_ * now.time - (now.rate - speed_); // impulse of the contact force per effective mass
        if (base_moves_) drift += total(base_);
        for (std::size_t k = 0; k < modes_; ++k) {
            out.y[2 * k] = start_->y[2 * k] + total(p_[k]);
            const real gain = total(force_[k]);
            out.y[2 * k + 1] = start_->y[2 * k + 1] + gain;
            drift += weight(k) * gain;
        }
        for (std::size_t k = 0; k < modes_; ++k) out.y[2 * k + 1] += impulse_share(k) * drift;
        out.t = start_->t + now.time;
        advance_balls(now, drift, out);
        add_to_ledger(now, ledger);
    }

    // Returns the smallest gap of another contact up to the end of this one; between the nodes below that of
    // a convex function. Modes that turn by more than one radian between start and end give minus infinity.
    real smallest_gap(const Contact& other) const {
        const Damper& damper = problem_.dampers[static_cast<std::size_t>(other.damper)];
        const Instant last = end();
        if (other.below == wall || other.above == wall)
            for (std::size_t k = 0; k < modes_; ++k)
                if (damper.shape[k] != 0 && problem_.modes[k].rate() * last.time > 1) return -infinity;
        State probe(problem_);
        Ledger unused(problem_);
        Gap before = gap(problem_, other, start_->y.data());
        real smallest = before.value, since = 0;
        for (int i = 0; i <= n; ++i) {
            if (i < n)
                store_node(i, probe);
            else
                store_end(last, probe, unused);
            const Gap here = gap(problem_, other, probe.y.data());
            const real now = i < n ? integral_[clock][i] : last.time;
            smallest = std::fmin(smallest, here.value);
            if (before.rate < 0 && here.rate > 0) { // where the tangents at both ends meet
                const real turn =
                    (here.value - before.value - here.rate * (now - since)) / (before.rate - here.rate);
                smallest = std::fmin(smallest, before.value + before.rate * turn);
            }
            before = here;
            since = now;
        }
        return smallest;
    }

    // Returns the phase at which the contact opens.
    real last_psi() const { return grid_.end; }

    // Returns the phase at a time after first touch, by interpolation between the nodes.
    real psi_at(real time) const {
        const auto& rule = grid_.rule();
        const Row& at = integral_[clock];
        int i = 0;
        while (i + 1 < n - 1 && at[i + 1] < time) ++i;
        const real part = (time - at[i]) / (at[i + 1] - at[i]);
        real x = rule.node[i] + part * (rule.node[i + 1] - rule.node[i]);
        for (int pass = 0; pass < 4; ++pass) {
            const real error = (time - rule.interpolate(at, x)) / rule.interpolate(slope_[clock], x);
            if (!(x + error > 0 && x + error < 1)) break; // on a node, or near an end
            x += error;
        }
        real psi, sine, cosine;
        grid_.phase(std::fmin(std::fmax(x, 0.0), 1.0), psi, sine, cosine);
        return std::fmin(std::fmax(psi, 1e-3), grid_.end);
    }

    // Returns dpsi/dt at an instant without the small contribution of the closing acceleration.
    real phase_rate(const Instant& now) const { return s_ * wave_ * now.x; }

    // Returns the largest force, by Newton's method in time from its position in a lightly damped contact.
    real peak_force() const {
        const real b2 = law_.stiffness / contact_->mass, c = damping_ / contact_->mass;
        real psi = 0.5 * pi - 8.0 / 3.0 * zeta_, best = 0;
        for (int pass = 0; pass < 6; ++pass) {
            const Instant at = instant_at(grid_.position(psi));
            const real x = at.x, w = at.rate, x3 = cube(x), dx = w / (4 * x3),
                       dw = -at.force / contact_->mass;
            const real slope = 1.5 * b2 * x * x * w + c * (w * dx + x * dw);
            const real curve = 1.5 * b2 * (2 * x * dx * w + x * x * dw) +
                               c * (w * dw / (2 * x3) - 3 * w * w * dx / (4 * x3 * x) + dx * dw - x * slope);
            best = at.force;
            if (!(curve < 0)) break;
            const real shift = -slope / curve; // in time
            best += contact_->mass * 0.5 * slope * shift;
            const real turned = psi + shift * phase_rate(at);
            if (std::fabs(turned - psi) < 1e-4 || turned < 0.2 || turned > grid_.end - 0.2) break;
            psi = turned;
        }
        return best;
    }

    // The solution at the nodes: time since the start, dt/dx, fourth root of the overlap, its rate, modes.
    const Row& time() const { return integral_[clock]; }
    const Row& time_slope() const { return slope_[clock]; }
    const Row& root() const { return x_; }
    const Row& rate() const { return w_; }
    const Row& acceleration() const { return a_; } // closing
    const PhaseGrid& grid() const { return grid_; }
    const Row& force(std::size_t mode) const { return force_[mode]; }
    const Row& displacement(std::size_t mode) const { return q_[mode]; }
    const Row& velocity(std::size_t mode) const { return p_[mode]; }

private:
    // Advances the balls. The positions of the pair in contact follow from momentum and overlap.
    void advance_balls(const Instant& now, real drift, State& out) const {
        const real t = now.time;
        real base_speed = 0, base_shift = 0; // of every ball by the base acceleration
        for (std::size_t l = 0; loads_->active() && l < loads_->size(); ++l) {
            if (!loads_->load(l).base) continue;
            Series acceleration;
            loads_->piece(l).add_taylor(start_->t, -1, Series::order, acceleration.c);
            const Series u = forced_ball(0, 0, acceleration);
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
        for (std::size_t i = problem_.motion_size(); i < out.y.size(); ++i) out.y[i] = start_->y[i];
        const real impulse = contact_->mass * drift, overlap = square(now.x * now.x);
        if (contact_->above == ground) { // the point, not a ball, follows the overlap
            out.y[impulse_index(problem_, *contact_)] += impulse;
            const real miss = gap(problem_, *contact_, out.y.data()).value + overlap;
            for (std::size_t k = 0; k < modes_; ++k)
                out.y[2 * k] += damper_->shape[k] * contact_->mass * miss;
        } else if (side_ != 0) {
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

    void add_to_ledger(const Instant& now, Ledger& ledger) const {
        const auto& rule = grid_.rule();
        ledger.normal[static_cast<std::size_t>(contact_->damper)] += now.lost;
        Row power;
        for (std::size_t k = 0; k < modes_; ++k) {
            if (problem_.modes[k].decay == 0) continue;
            for (int i = 0; i < n; ++i) power[i] = square(p_[k][i]) * slope_[clock][i];
            ledger.viscous += 2 * problem_.modes[k].decay * rule.integral(power);
        }
        if (!loads_->active()) return;
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            const Load& load = loads_->load(l);
            if (loads_->piece(l).is_zero()) continue;
            for (int i = 0; i < n; ++i) power[i] = 0;
            for (std::size_t k = 0; k < modes_; ++k)
                for (int i = 0; i < n; ++i) power[i] += load.shape[k] * p_[k][i];
            if (load.base) subtract_ball_momentum(power);
            for (int i = 0; i < n; ++i) power[i] *= signal_[l][i] * slope_[clock][i];
            (load.base ? ledger.base_work : ledger.load_work) += rule.integral(power);
        }
    }

    // Stores the state at a node.
    void store_node(int i, State& out) const {
        Instant node;
        node.time = integral_[clock][i];
        node.x = x_[i];
        node.rate = w_[i];
        real drift = constant_ * node.time - (w_[i] - speed_);
        if (base_moves_) drift += integral_[base_row()][i];
        for (std::size_t k = 0; k < modes_; ++k) {
            drift += weight(k) * integral_[first_mode + k][i];
            out.y[2 * k] = q_[k][i];
            out.y[2 * k + 1] = p_[k][i];
        }
        advance_balls(node, drift, out);
    }

    // Subtracts the momentum of the balls at the nodes, on which the base does work.
    void subtract_ball_momentum(Row& power) const {
        State probe(problem_);
        for (int i = 0; i < n; ++i) {
            store_node(i, probe);
            const real* v = velocities(problem_, probe.y.data());
            for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
                power[i] -= problem_.ball_mass[b] * v[b];
        }
    }
};

} // namespace rattlebox
