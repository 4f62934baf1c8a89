// Motion of modes and balls without soft contacts, as Taylor series (structure/taylor_series.hpp), with hard
// contacts that are held closed.
//
// A held contact is a constraint: the approach rate of its sides is zero. With the accelerations a of modes
// and balls without it, the part B of each body in the approach rates and the response W = B M^-1 B^T, the
// coefficients of its force are those of
//
//     W f_n = B a_n        a_n - M^-1 B^T f_n = (n + 1) (n + 2) x_(n+2)
//
// order by order. The balls have no series of their own: their positions and velocities are those of the wall
// or ball that they rest on, so that they cannot drift from it, however long it lasts.
#pragma once

#include <vector>

#include "impact/state.hpp"
#include "math/linear_system.hpp"

namespace rattlebox {

// d(approach rate of a)/dt per unit of force in b, which is -W.
inline real contact_coupling(const Problem& problem, const Contact& a, const Contact& b) {
    real sum = 0;
    const auto side = [](const Contact& c, int ball) {
        return (c.above == ball ? 1.0 : 0.0) - (c.below == ball ? 1.0 : 0.0);
    };
    for (int ball : {a.below, a.above})
        if (ball >= 0)
            sum -= side(a, ball) * side(b, ball) / problem.ball_mass[static_cast<std::size_t>(ball)];
    const real wall_a = side(a, wall), wall_b = side(b, wall);
    if (wall_a != 0 && wall_b != 0) {
        const auto& shape_a = problem.dampers[static_cast<std::size_t>(a.damper)].shape;
        const auto& shape_b = problem.dampers[static_cast<std::size_t>(b.damper)].shape;
        for (std::size_t k = 0; k < problem.modes.size(); ++k)
            sum -= wall_a * wall_b * shape_a[k] * shape_b[k];
    }
    return sum;
}

class TaylorMotion {
    const Problem& problem_;
    std::vector<Series> loads_, mode_forces_, accelerations_, modes_, balls_; // accelerations of the balls

    // Of held contacts: a ball rests on its leader, a ball or the wall.
    struct Follower {
        int ball, leader;
        const Contact* contact;
    };
    std::vector<int> held_;
    std::vector<Follower> followers_;
    std::vector<Series> forces_; // by held contact
    // By held contact: the first one that acts on the motion alike, how strongly over that one, and for a
    // first one the sum of the squares. Several stops at one point, or at points that move in proportion,
    // share a force.
    std::vector<std::size_t> first_alike_;
    std::vector<real> part_, squares_;
    std::vector<real> response_, matrix_, right_, cavity_force_, ball_force_;
    std::vector<real> impulses_; // of the stops, at the start

    const Contact& contact(int c) const { return problem_.contacts[static_cast<std::size_t>(c)]; }
    const Damper& damper_of(const Contact& c) const {
        return problem_.dampers[static_cast<std::size_t>(c.damper)];
    }

    // Orders the held contacts so that each ball has a leader: first the wall, then the balls next to it. A
    // row that touches no wall follows its first ball.
    void find_followers() {
        followers_.clear();
        std::vector<char> is_placed(problem_.ball_mass.size(), false), is_done(held_.size(), false);
        const auto placed = [&](int body) { return body < 0 || is_placed[static_cast<std::size_t>(body)]; };
        for (std::size_t done = 0; done < held_.size();) {
            std::size_t next = held_.size(), first = held_.size();
            for (std::size_t i = 0; i < held_.size() && next == held_.size(); ++i) {
                if (is_done[i]) continue;
                if (first == held_.size() || held_[i] < held_[first]) first = i;
                if (placed(contact(held_[i]).below) || placed(contact(held_[i]).above)) next = i;
            }
            if (next == held_.size()) {
                is_placed[static_cast<std::size_t>(contact(held_[first]).below)] = true;
                continue;
            }
            const Contact& c = contact(held_[next]);
            is_done[next] = true, ++done;
            const bool upwards = placed(c.below);
            const int ball = upwards ? c.above : c.below;
            if (placed(ball)) continue;
            followers_.push_back({ball, upwards ? c.below : c.above, &c});
            is_placed[static_cast<std::size_t>(ball)] = true;
        }
        const std::size_t n = held_.size();
        response_.resize(n * n);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
                response_[i * n + j] = contact_coupling(problem_, contact(held_[i]), contact(held_[j]));
        find_alike();
    }

    void find_alike() {
        const std::size_t n = held_.size();
        first_alike_.resize(n), part_.assign(n, 1.0), squares_.assign(n, 1.0);
        for (std::size_t i = 0; i < n; ++i) {
            std::size_t first = 0;
            for (; first < i; ++first) {
                const real both = response_[i * n + first], own = response_[first * n + first];
                if (first_alike_[first] == first && both * own > 0 &&
                    std::fabs(both * both - own * response_[i * n + i]) <= smallest_pivot * both * both)
                    break;
            }
            first_alike_[i] = first;
            if (first == i) continue;
            part_[i] = response_[i * n + first] / response_[first * n + first];
            squares_[first] += square(part_[i]);
        }
    }

    // Of all solutions the one with the smallest sum of squares within each group: elimination gives all of
    // the force to the first one.
    void share_forces(int n) {
        for (std::size_t i = 0; i < held_.size(); ++i) {
            const std::size_t first = first_alike_[i];
            forces_[i].c[n] = right_[first] / squares_[first] * part_[i];
        }
    }

    // Half of the clearance, with the sign of the wall that a contact is at.
    real wall_offset(const Contact& c) const {
        return (c.above == wall ? 0.5 : -0.5) * damper_of(c).clearance;
    }

    void lead_balls() {
        for (const Follower& f : followers_) {
            Series& s = balls_[static_cast<std::size_t>(f.ball)];
            if (f.leader != wall) {
                s = balls_[static_cast<std::size_t>(f.leader)];
                continue;
            }
            s = Series{};
            const Damper& damper = damper_of(*f.contact);
            for (std::size_t k = 0; k < damper.shape.size(); ++k) s.add(damper.shape[k], modes_[k]);
            s.c[0] += wall_offset(*f.contact);
        }
    }

    // Computes all series up to order + 2, with the forces of the held contacts.
    void expand_held(const State& start, int order) {
        const std::size_t m = problem_.modes.size(), held = held_.size(), balls = balls_.size();
        modes_.assign(m, Series{});
        for (std::size_t k = 0; k < m; ++k)
            modes_[k].c[0] = start.y[2 * k], modes_[k].c[1] = start.y[2 * k + 1];
        for (std::size_t b = 0; b < balls; ++b) {
            balls_[b] = Series{};
            balls_[b].c[0] = positions(problem_, start.y.data())[b];
            balls_[b].c[1] = velocities(problem_, start.y.data())[b];
        }
        forces_.assign(held, Series{});
        cavity_force_.resize(problem_.dampers.size()), ball_force_.resize(balls);
        right_.resize(held);
        for (int n = 0; n <= order; ++n) {
            const real both = (n + 1) * (n + 2);
            // Accelerations of this order as if no contact were held.
            for (std::size_t k = 0; k < m; ++k) {
                const Mode& mode = problem_.modes[k];
                real a = mode_forces_[k].c[n] - 2 * mode.decay * (n + 1) * modes_[k].c[n + 1] -
                         mode.stiffness * modes_[k].c[n];
                if (!problem_.coupling.empty())
                    for (std::size_t j = 0; j < m; ++j)
                        a -= problem_.coupling[k * m + j] * (n + 1) * modes_[j].c[n + 1];
                modes_[k].c[n + 2] = a;
            }
            for (std::size_t b = 0; b < balls; ++b) balls_[b].c[n + 2] = accelerations_[b].c[n];
            // The forces that make the approach accelerations zero.
            for (std::size_t i = 0; i < held; ++i) {
                const Contact& c = contact(held_[i]);
                const Damper& damper = damper_of(c);
                real cavity = 0;
                for (std::size_t k = 0; k < m; ++k) cavity += damper.shape[k] * modes_[k].c[n + 2];
                const auto of = [&](int body) {
                    if (body == ground) return 0.0;
                    return body == wall ? cavity : balls_[static_cast<std::size_t>(body)].c[n + 2];
                };
                right_[i] = of(c.above) - of(c.below);
            }
            matrix_ = response_;
            solve_definite(matrix_, right_, response_);
            std::fill(cavity_force_.begin(), cavity_force_.end(), 0.0);
            std::fill(ball_force_.begin(), ball_force_.end(), 0.0);
            for (std::size_t i = 0; i < held; ++i) {
                const Contact& c = contact(held_[i]);
                const auto on = [&](int body) -> real& {
                    return body == wall ? cavity_force_[static_cast<std::size_t>(c.damper)]
                                        : ball_force_[static_cast<std::size_t>(body)];
                };
                on(c.below) -= right_[i];
                if (c.above != ground) on(c.above) += right_[i];
            }
            share_forces(n);
            // What they add, and the next coefficients of the motion.
            for (std::size_t k = 0; k < m; ++k) {
                real force = 0;
                for (std::size_t d = 0; d < problem_.dampers.size(); ++d)
                    force += problem_.dampers[d].shape[k] * cavity_force_[d];
                modes_[k].c[n + 2] = (modes_[k].c[n + 2] + force) / both;
            }
            for (std::size_t b = 0; b < balls; ++b)
                balls_[b].c[n + 2] = (balls_[b].c[n + 2] + ball_force_[b] / problem_.ball_mass[b]) / both;
        }
        keep_at_stops();
        lead_balls();
    }

    // Removes the part of the motion that opens or closes held stops: no ball follows the wall there, and the
    // rounding errors of each flight would add up.
    void keep_at_stops() {
        for (const int held : held_) {
            const Contact& c = contact(held);
            if (c.above != ground) continue;
            const std::vector<real>& shape = damper_of(c).shape;
            for (int n = 0; n <= Series::order; ++n) {
                real miss = n == 0 ? 0.5 * damper_of(c).clearance : 0;
                for (std::size_t k = 0; k < shape.size(); ++k) miss -= shape[k] * modes_[k].c[n];
                for (std::size_t k = 0; k < shape.size(); ++k) modes_[k].c[n] += shape[k] * c.mass * miss;
            }
        }
    }

    void add_impulses(real s, State& out) const {
        std::copy(impulses_.begin(), impulses_.end(),
                  out.y.begin() + static_cast<std::ptrdiff_t>(problem_.motion_size()));
        for (std::size_t i = 0; i < held_.size(); ++i) {
            const Contact& c = contact(held_[i]);
            if (c.above == ground) out.y[impulse_index(problem_, c)] += forces_[i].integral(s);
        }
    }

public:
    explicit TaylorMotion(const Problem& problem) : problem_(problem), loads_(problem.loads.size()) {
        modes_.reserve(problem.modes.size());
        balls_.reserve(problem.ball_mass.size());
    }

    const std::vector<Series>& loads() const { return loads_; }
    const std::vector<Series>& modes() const { return modes_; }
    const std::vector<Series>& balls() const { return balls_; }
    const std::vector<Series>& forces() const { return forces_; }
    const std::vector<int>& held() const { return held_; }

    // Sets the contacts that stay closed.
    void hold(const std::vector<int>& held) {
        if (held == held_) return;
        held_ = held;
        find_followers();
    }

    // Expands the motion from `start` with the contacts `held`. Forces are expanded up to `order`, and
    // motions to the order that follows from them.
    void expand(const State& start, const Loads& loads, const std::vector<int>& held,
                int order = Series::order - 2) {
        Series base;
        for (std::size_t l = 0; l < loads.size(); ++l) {
            loads_[l] = Series{};
            loads.piece(l).add_taylor(start.t, 1, order + 2, loads_[l].c);
            if (loads.load(l).base) base.add(-1, loads_[l]);
        }
        mode_forces_.assign(problem_.modes.size(), Series{});
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            for (std::size_t l = 0; l < loads.size(); ++l)
                mode_forces_[k].add(loads.load(l).shape[k], loads_[l]);
        impulses_.assign(start.y.begin() + static_cast<std::ptrdiff_t>(problem_.motion_size()),
                         start.y.end());
        const std::size_t balls = problem_.ball_mass.size();
        balls_.resize(balls);
        accelerations_.assign(balls, base);
        for (std::size_t i = 0; i < balls; ++i)
            accelerations_[i].c[0] +=
                problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[i])].gravity;
        hold(held);
        if (!held_.empty() || order + 2 < Series::order) return expand_held(start, order);
        forces_.clear();
        modes_.clear();
        if (problem_.coupling.empty())
            for (std::size_t k = 0; k < problem_.modes.size(); ++k)
                modes_.push_back(
                    forced_mode(problem_.modes[k], {start.y[2 * k], start.y[2 * k + 1]}, mode_forces_[k]));
        else
            coupled_series(problem_.modes, problem_.coupling, start.y.data(), mode_forces_, modes_);
        for (std::size_t i = 0; i < balls; ++i)
            balls_[i] = forced_ball(positions(problem_, start.y.data())[i],
                                    velocities(problem_, start.y.data())[i], accelerations_[i]);
    }

    // Returns the second derivative of a gap at the start.
    real gap_acceleration(const Contact& c) const {
        real cavity = 0;
        for (std::size_t k = 0; k < modes_.size(); ++k) cavity += damper_of(c).shape[k] * modes_[k].c[2];
        const auto of = [&](int body) {
            if (body == ground) return 0.0;
            return body == wall ? cavity : balls_[static_cast<std::size_t>(body)].c[2];
        };
        return 2 * (of(c.above) - of(c.below));
    }

    // Computes the state after time s.
    void at(real s, State& out) const {
        for (std::size_t k = 0; k < modes_.size(); ++k) {
            out.y[2 * k] = modes_[k].value(s);
            out.y[2 * k + 1] = modes_[k].slope(s);
        }
        add_impulses(s, out);
        real *x = positions(problem_, out.y.data()), *v = velocities(problem_, out.y.data());
        for (std::size_t i = 0; i < balls_.size(); ++i) {
            x[i] = balls_[i].value(s);
            v[i] = balls_[i].slope(s);
        }
        for (const Follower& f : followers_) {
            if (f.leader != wall) {
                x[f.ball] = x[f.leader], v[f.ball] = v[f.leader];
                continue;
            }
            const ModeState z = cavity(damper_of(*f.contact), out.y.data());
            x[f.ball] = z.q + wall_offset(*f.contact), v[f.ball] = z.p;
        }
    }
};

} // namespace rattlebox
