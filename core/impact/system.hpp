// The equations of motion while contacts are closed.
//
// State y: modes and balls as in impact/state.hpp; time since the start, work of loads, work of the base,
// viscous loss; then for each soft contact x, with overlap = origin + x^4, and the loss in its dashpot. The
// independent variable is a transformed time, dt = dtau / sum(1 / x_j^3), which makes Hertz contacts regular
// at the start and the end for any number of simultaneous contacts. Without soft contacts it is time. The
// transformation is derived here.
#pragma once

#include <vector>

#include "impact/contact_phase.hpp"
#include "impact/state.hpp"

namespace rattlebox {

struct Active {
    int contact = 0;
    ContactState state;
    int impact = -1;  // index in the impact log
    real x = 0;       // overlap = state.origin() + x^4
    real speed = 0;   // largest approach speed so far, the scale of its errors
    long steps = 0;   // of its integration so far
    long wait = 1000; // number of steps after which a long step (impact/lasting_contact.hpp) is tried
};

// A contact whose force became zero before its overlap: the bodies recover their shape in flight, or touch
// again.
struct Released {
    int contact = 0;
    ContactState state;
    int impact = -1;
    real energy = 0; // stored at the release; lost during recovery
};

class System {
    const Problem& problem_;
    const Loads* loads_ = nullptr;
    real start_ = 0;
    std::vector<real> cavity_rate_, cavity_force_, ball_force_, clock_;
    std::vector<real> signal_; // by load

    std::size_t mode_count() const { return problem_.modes.size(); }
    std::size_t ball_count() const { return problem_.ball_mass.size(); }

    const Contact& contact(int c) const { return problem_.contacts[static_cast<std::size_t>(c)]; }

    void cavity_rates(const real* y) {
        for (std::size_t d = 0; d < problem_.dampers.size(); ++d)
            cavity_rate_[d] = cavity(problem_.dampers[d], y).p;
    }

    // Returns the rate at which the two sides approach.
    real approach_rate(const Contact& c, const real* ball_speed, const real* cavity_speed) const {
        const real below = c.below == wall ? cavity_speed[c.damper] : ball_speed[c.below];
        const real above = c.above == wall ? cavity_speed[c.damper] : of_body(ball_speed, c.above);
        return below - above;
    }

    void add_force(const Contact& c, real force) {
        (c.below == wall ? cavity_force_[static_cast<std::size_t>(c.damper)]
                         : ball_force_[static_cast<std::size_t>(c.below)]) -= force;
        if (c.above == ground) return;
        (c.above == wall ? cavity_force_[static_cast<std::size_t>(c.damper)]
                         : ball_force_[static_cast<std::size_t>(c.above)]) += force;
    }

    // Computes the accelerations of modes and balls from the forces added so far.
    void accelerate(const real* y, real* dy) {
        const std::size_t m = mode_count(), b = ball_count();
        real* dv = velocities(problem_, dy);
        for (std::size_t k = 0; k < m; ++k) {
            real a = -2 * problem_.modes[k].decay * y[2 * k + 1] - problem_.modes[k].stiffness * y[2 * k];
            for (std::size_t d = 0; d < problem_.dampers.size(); ++d)
                a += problem_.dampers[d].shape[k] * cavity_force_[d];
            dy[2 * k + 1] = a;
        }
        couple(
            problem_.coupling, m, [&](std::size_t k) { return y[2 * k + 1]; },
            [&](std::size_t k, real force) { dy[2 * k + 1] += force; });
        for (std::size_t i = 0; i < b; ++i)
            dv[i] = ball_force_[i] / problem_.ball_mass[i] +
                    problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
        if (!loads_->active()) return;
        for (std::size_t l = 0; l < loads_->size(); ++l) {
            if (loads_->piece(l).is_zero()) continue;
            const real f = signal_[l];
            for (std::size_t k = 0; k < m; ++k) dy[2 * k + 1] += loads_->load(l).shape[k] * f;
            if (loads_->load(l).base)
                for (std::size_t i = 0; i < b; ++i) dv[i] -= f;
        }
    }

    void clear_forces() {
        for (real& f : cavity_force_) f = 0;
        for (real& f : ball_force_) f = 0;
    }

public:
    std::vector<Active> active;

    explicit System(const Problem& problem)
        : problem_(problem), cavity_rate_(problem.dampers.size()), cavity_force_(problem.dampers.size()),
          ball_force_(problem.ball_mass.size()), signal_(problem.loads.size()) {}

    void start(const Loads& loads, real time) {
        loads_ = &loads;
        start_ = time;
        clock_.resize(active.size());
    }

    std::size_t time_index() const { return problem_.state_size(); }
    std::size_t x_index(std::size_t j) const { return time_index() + 4 + 2 * j; }
    std::size_t size() const { return time_index() + 4 + 2 * active.size(); }

    real approach(const real* y, int c) const { return -gap(problem_, contact(c), y).rate; }

    real force(const real* y, std::size_t j) const {
        const Active& a = active[j];
        const real rate = approach(y, a.contact);
        return contact(a.contact).normal.visit(
            [&](const auto& law) { return contact_force(law, a.state, y[x_index(j)], rate).total; });
    }

    void operator()(const real* y, real* dy) {
        const std::size_t m = mode_count(), b = ball_count(), n = active.size();
        const real* v = velocities(problem_, y);
        cavity_rates(y);
        clear_forces();

        // Clock: with r_j = (x_min / x_j)^3 and R = sum r_j, dt/dtau = x_min^3 / R and x_j' = (approach rate)
        // r_j / (4 R).
        real clock = 1, total = 1;
        if (n == 1) {
            clock = cube(y[x_index(0)]);
            clock_[0] = 1;
        } else if (n > 1) {
            real smallest = y[x_index(0)];
            for (std::size_t j = 1; j < n; ++j)
                if (std::fabs(y[x_index(j)]) < std::fabs(smallest)) smallest = y[x_index(j)];
            total = 0;
            for (std::size_t j = 0; j < n; ++j) {
                const real x = y[x_index(j)];
                clock_[j] = x == smallest ? 1 : cube(smallest / x);
                total += std::fabs(clock_[j]);
            }
            clock = cube(smallest) / total;
        }
        for (std::size_t j = 0; j < n; ++j) {
            const Active& a = active[j];
            const Contact& c = contact(a.contact);
            const std::size_t at = x_index(j);
            const real x = y[at], rate = approach_rate(c, v, cavity_rate_.data());
            real lost = 0;
            const real f = c.normal.visit([&](const auto& law) {
                const NormalForce<real> force = contact_force(law, a.state, x, rate);
                lost = (force.total - force.elastic) * rate;
                return force.total;
            });
            add_force(c, f);
            dy[at] = 0.25 * rate * clock_[j] / total;
            dy[at + 1] = clock * lost;
        }

        if (loads_->active())
            for (std::size_t l = 0; l < loads_->size(); ++l)
                signal_[l] = loads_->piece(l).value(start_ + y[time_index()]);
        real* dv = velocities(problem_, dy);
        accelerate(y, dy);

        real viscous = 0, work[2] = {0, 0};
        for (std::size_t k = 0; k < m; ++k) viscous += 2 * problem_.modes[k].decay * square(y[2 * k + 1]);
        viscous += coupled_power(problem_.coupling, m, [&](std::size_t k) { return y[2 * k + 1]; });
        if (loads_->active()) {
            for (std::size_t l = 0; l < loads_->size(); ++l) {
                if (loads_->piece(l).is_zero()) continue;
                const Load& load = loads_->load(l);
                real speed = 0;
                for (std::size_t k = 0; k < m; ++k) speed += load.shape[k] * y[2 * k + 1];
                if (load.base)
                    for (std::size_t i = 0; i < b; ++i) speed -= problem_.ball_mass[i] * v[i];
                work[load.base] += signal_[l] * speed;
            }
        }
        for (std::size_t k = 0; k < m; ++k) {
            dy[2 * k] = clock * y[2 * k + 1];
            dy[2 * k + 1] *= clock;
        }
        real* ds = positions(problem_, dy);
        for (std::size_t i = 0; i < b; ++i) {
            ds[i] = clock * v[i];
            dv[i] *= clock;
        }
        for (std::size_t d = problem_.first_stop(); d < problem_.dampers.size(); ++d)
            dy[problem_.motion_size() + d - problem_.first_stop()] = -clock * cavity_force_[d];
        const std::size_t at = time_index();
        dy[at] = clock;
        dy[at + 1] = clock * work[0];
        dy[at + 2] = clock * work[1];
        dy[at + 3] = clock * viscous;
    }
};

} // namespace rattlebox
