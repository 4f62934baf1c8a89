// One long step of contacts that stay closed, by collocation at sixteen Gauss-Legendre nodes in ordinary
// time.
//
// A ball that lies on a wall follows it for seconds, and an explicit method needs some twenty steps for each
// period of its contact spring, although nothing happens in them. The unknowns here are the contact forces at
// the nodes. The accelerations of modes and balls are linear in them, and so are the overlaps d and their
// rates; Newton's method solves force = law(d, d') for all contacts together. With A the matrix of the
// integrals of the nodes' polynomials and h the length of the step:
//
//     ball    a = (g + loads) - sum of B f / m                 B: part of the body in the approach rate
//     mode    (1 + 2 decay h A + stiffness h^2 A^2) a = loads - forces of q(0), p(0) - B f
//     d' = d'(0) + h A a_rel      d = d(0) + h c d'(0) + h^2 A^2 a_rel
//
// Gauss collocation is symplectic, so that the energy of an undamped contact does not drift. The step is
// accepted only if the last terms of the forces' and accelerations' Legendre series are within the tolerance,
// and if no contact can begin, end or change its phase within it; otherwise the caller steps explicitly.
//
// E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed., Springer 2006, sections II.1 and
// VI.4, doi:10.1007/3-540-30666-8.
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "impact/system.hpp"
#include "math/collocation.hpp"

namespace rattlebox {

class LastingContact {
public:
    static constexpr int n = 16;
    using Rule = Collocation<n>;
    using Row = Rule::Row;

private:
    struct Matrix {
        real at[n][n];
    };
    const Problem& problem_;
    Matrix once_, twice_;            // integral, and integral of the integral, up to each node
    real tail_[2][n];                // weights of the last two Legendre coefficients
    std::vector<real> share_;        // B, by contact and body
    std::vector<real> inverse_mass_; // by body: modes, then balls
    std::vector<Row> free_;          // accelerations without the contact forces, by body
    std::vector<Matrix> response_;   // of a mode's acceleration to forces at the nodes
    std::vector<Row> free_approach_; // by contact
    std::vector<real> coupling_;     // of the approach accelerations to the forces, by pair of contacts
    std::vector<Matrix> by_rate_, by_overlap_; // of rates and overlaps to the forces, by pair of contacts
    std::vector<real> system_, right_;

    std::size_t modes() const { return problem_.modes.size(); }
    std::size_t bodies() const { return modes() + problem_.ball_mass.size(); }

    static Row multiply(const Matrix& a, const Row& x) {
        Row y;
        for (int i = 0; i < n; ++i) {
            real sum = 0;
            for (int k = 0; k < n; ++k) sum += a.at[i][k] * x[k];
            y[i] = sum;
        }
        return y;
    }

    // Computes the parts B of all bodies in the approach rates.
    void find_shares(const System& system) {
        share_.assign(system.active.size() * bodies(), 0.0);
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            const Contact& c = problem_.contacts[static_cast<std::size_t>(system.active[j].contact)];
            const auto& shape = problem_.dampers[static_cast<std::size_t>(c.damper)].shape;
            for (const auto& [ball, sign] : {std::pair(c.below, 1.0), std::pair(c.above, -1.0)}) {
                if (ball == ground) continue;
                if (ball != wall)
                    share_[j * bodies() + modes() + static_cast<std::size_t>(ball)] += sign;
                else
                    for (std::size_t k = 0; k < shape.size(); ++k)
                        share_[j * bodies() + k] += sign * shape[k];
            }
        }
    }

    // Computes the accelerations without contact forces, and the response of each mode to forces.
    void prepare_bodies(const Loads& loads, const real* y, real start) {
        std::vector<Row> signal(loads.size());
        Row base{};
        for (std::size_t l = 0; l < loads.size(); ++l)
            for (int i = 0; i < n; ++i) {
                signal[l][i] = loads.piece(l).value(start + h * rule().node[i]);
                if (loads.load(l).base) base[i] += signal[l][i];
            }
        std::vector<real> a(n * n), x(n * (n + 1));
        for (std::size_t k = 0; k < modes(); ++k) {
            const Mode& mode = problem_.modes[k];
            const real q = y[2 * k], p = y[2 * k + 1];
            for (int i = 0; i < n; ++i) {
                real force = -2 * mode.decay * p - mode.stiffness * (q + h * rule().node[i] * p);
                for (std::size_t l = 0; l < loads.size(); ++l) force += loads.load(l).shape[k] * signal[l][i];
                for (int j = 0; j < n; ++j) {
                    const auto at = static_cast<std::size_t>(i * n + j);
                    a[at] = (i == j) +
                            h * (2 * mode.decay * once_.at[i][j] + mode.stiffness * h * twice_.at[i][j]);
                    x[static_cast<std::size_t>(i * (n + 1) + j)] = i == j;
                }
                x[static_cast<std::size_t>(i * (n + 1) + n)] = force;
            }
            solve(a, x, n, n + 1);
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j)
                    response_[k].at[i][j] = x[static_cast<std::size_t>(i * (n + 1) + j)];
                free_[k][i] = x[static_cast<std::size_t>(i * (n + 1) + n)];
            }
        }
        for (std::size_t b = 0; b < problem_.ball_mass.size(); ++b)
            for (int i = 0; i < n; ++i)
                free_[modes() + b][i] =
                    problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[b])].gravity - base[i];
    }

    // Computes the approach accelerations without forces, and their response to the forces of all contacts.
    void couple_contacts(std::size_t contacts) {
        free_approach_.assign(contacts, Row{});
        coupling_.assign(contacts * contacts * n * n, 0.0);
        for (std::size_t j = 0; j < contacts; ++j)
            for (std::size_t b = 0; b < bodies(); ++b) {
                const real part = share_[j * bodies() + b];
                if (part == 0) continue;
                for (int i = 0; i < n; ++i) free_approach_[j][i] += part * free_[b][i];
                for (std::size_t l = 0; l < contacts; ++l) {
                    const real both = part * share_[l * bodies() + b] * inverse_mass_[b];
                    if (both == 0) continue;
                    real* to = &coupling_[(j * contacts + l) * n * n];
                    for (int i = 0; i < n; ++i)
                        for (int k = 0; k < n; ++k)
                            to[i * n + k] += both * (b < modes() ? response_[b].at[i][k] : real(i == k));
                }
            }
    }

    // Computes the changes of rates and overlaps by the forces.
    void integrate_coupling(std::size_t contacts) {
        by_rate_.assign(contacts * contacts, Matrix{});
        by_overlap_.assign(contacts * contacts, Matrix{});
        for (std::size_t pair = 0; pair < contacts * contacts; ++pair) {
            const real* from = &coupling_[pair * n * n];
            for (int i = 0; i < n; ++i)
                for (int k = 0; k < n; ++k) {
                    const real first = h * once_.at[i][k], second = h * h * twice_.at[i][k];
                    for (int m = 0; m < n; ++m) {
                        by_rate_[pair].at[i][m] += first * from[k * n + m];
                        by_overlap_[pair].at[i][m] += second * from[k * n + m];
                    }
                }
        }
    }

    // Computes overlaps and rates at the nodes from the forces.
    void place(std::size_t j, std::size_t contacts) {
        Row a = free_approach_[j];
        for (std::size_t l = 0; l < contacts; ++l) {
            const real* from = &coupling_[(j * contacts + l) * n * n];
            for (int i = 0; i < n; ++i)
                for (int k = 0; k < n; ++k) a[i] -= from[i * n + k] * force[l][k];
        }
        const Row first = multiply(once_, a), second = multiply(twice_, a);
        for (int i = 0; i < n; ++i) {
            rate[j][i] = rate0_[j] + h * first[i];
            overlap[j][i] = overlap0_[j] + h * (rule().node[i] * rate0_[j] + h * second[i]);
        }
        approach_[j] = a;
    }
    std::vector<real> rate0_, overlap0_;
    std::vector<Row> approach_;

public:
    real h = 0;                                            // length of the step, s
    std::vector<Row> force, overlap, rate, lost;           // by contact; power lost
    std::vector<Row> displacement, velocity, acceleration; // by body
    Row load_power, base_power, viscous_power;

    static const Rule& rule() {
        static const Rule rule;
        return rule;
    }

    explicit LastingContact(const Problem& problem) : problem_(problem) {
        for (int k = 0; k < n; ++k) {
            Row unit{}, first, second;
            unit[k] = 1;
            rule().integrate<1>(&unit, &first);
            rule().integrate<1>(&first, &second);
            for (int i = 0; i < n; ++i) once_.at[i][k] = first[i], twice_.at[i][k] = second[i];
            real p[n + 1];
            Rule::legendre_polynomials(2 * rule().node[k] - 1, p);
            for (int last : {0, 1})
                tail_[last][k] = (2 * (n - 2 + last) + 1) * rule().weight[k] * p[n - 2 + last];
        }
        inverse_mass_.assign(modes(), 1.0);
        for (real mass : problem.ball_mass) inverse_mass_.push_back(1 / mass);
        for (auto* rows : {&free_, &acceleration, &displacement, &velocity}) rows->resize(bodies());
        response_.resize(modes());
    }

    // Largest acceleration that a body would have without the contacts: the size of the terms of its own.
    real free_acceleration(std::size_t body) const {
        real largest = 0;
        for (real a : free_[body].at) largest = std::fmax(largest, std::fabs(a));
        return largest;
    }

    // Returns a gap at the nodes; `state` is overwritten.
    Row gap_of(const Contact& contact, State& state) const {
        Row values;
        for (int i = 0; i < n; ++i) {
            for (std::size_t k = 0; k < modes(); ++k) state.y[2 * k] = displacement[k][i];
            for (std::size_t b = modes(); b < bodies(); ++b)
                positions(problem_, state.y.data())[b - modes()] = displacement[b][i];
            values[i] = gap(problem_, contact, state.y.data()).value;
        }
        return values;
    }

    // Returns the last terms of a Legendre series.
    real tail(const Row& f) const {
        real sums[2] = {0, 0};
        for (int last : {0, 1})
            for (int i = 0; i < n; ++i) sums[last] += tail_[last][i] * f[i];
        return std::fmax(std::fabs(sums[0]), std::fabs(sums[1]));
    }

    // Largest slope of a force over the mass of the pair: the square of the fastest contact frequency.
    real square_of_frequency(const System& system, const real* y) {
        find_shares(system);
        real most = 0;
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            real lightness = 0;
            for (std::size_t b = 0; b < bodies(); ++b) {
                const real part = share_[j * bodies() + b];
                lightness += part * part * inverse_mass_[b];
            }
            const Active& a = system.active[j];
            const real d = a.state.origin() + square(square(y[system.x_index(j)]));
            most = std::fmax(most, slopes(system, j, d, 0).first * lightness);
        }
        return most * static_cast<real>(system.active.size());
    }

    // Derivatives of the force by overlap and rate. The dashpot is linear in the rate.
    std::pair<real, real> slopes(const System& system, std::size_t j, real d, real v) const {
        const Active& a = system.active[j];
        const real above = d - a.state.origin(), change = 1e-5 * above;
        const auto f = [&](real depth, real speed) { return law_at(a, depth, speed).total; };
        return {(f(above + change, v) - f(above - change, v)) / (2 * change), f(above, 1) - f(above, 0)};
    }

    // Solves for the forces in a step of length h from y; returns whether it converged with closed contacts.
    bool solve_step(const System& system, const Loads& loads, const real* y, real start, real length) {
        const std::size_t contacts = system.active.size(), size = contacts * n;
        h = length;
        find_shares(system);
        prepare_bodies(loads, y, start);
        couple_contacts(contacts);
        integrate_coupling(contacts);
        for (auto* rows : {&force, &overlap, &rate, &lost, &approach_}) rows->resize(contacts);
        rate0_.resize(contacts), overlap0_.resize(contacts);
        for (std::size_t j = 0; j < contacts; ++j) {
            const real now = system.force(y, j);
            for (int i = 0; i < n; ++i) force[j][i] = now;
            rate0_[j] = system.approach(y, system.active[j].contact);
            overlap0_[j] = system.active[j].state.origin() + square(square(y[system.x_index(j)]));
        }
        for (int iteration = 0; iteration < 12; ++iteration) {
            system_.resize(size * size);
            right_.resize(size);
            real largest = 0;
            for (std::size_t j = 0; j < contacts; ++j) place(j, contacts);
            for (std::size_t j = 0; j < contacts; ++j) {
                const Active& a = system.active[j];
                // The first iteration takes the law as linear about the start.
                const real force0 = system.force(y, j);
                auto [by_overlap, by_rate] = slopes(system, j, overlap0_[j], rate0_[j]);
                real total = force0;
                for (int i = 0; i < n; ++i) {
                    const real above = overlap[j][i] - a.state.origin(), v = rate[j][i];
                    if (iteration > 0) {
                        if (!(above > 0)) return false;
                        total = law_at(a, above, v).total;
                        std::tie(by_overlap, by_rate) = slopes(system, j, overlap[j][i], v);
                    } else {
                        total =
                            force0 + by_overlap * (overlap[j][i] - overlap0_[j]) + by_rate * (v - rate0_[j]);
                    }
                    const std::size_t row = j * n + static_cast<std::size_t>(i);
                    right_[row] = total - force[j][i];
                    largest = std::fmax(largest, std::fabs(total));
                    for (std::size_t l = 0; l < contacts; ++l) {
                        const real* of_rate = by_rate_[j * contacts + l].at[i];
                        const real* of_overlap = by_overlap_[j * contacts + l].at[i];
                        for (int m = 0; m < n; ++m)
                            system_[row * size + l * n + static_cast<std::size_t>(m)] =
                                by_rate * of_rate[m] + by_overlap * of_overlap[m];
                    }
                    system_[row * size + row] += 1;
                }
            }
            solve(system_, right_, size, 1);
            real change = 0;
            for (std::size_t row = 0; row < size; ++row) {
                force[row / n][static_cast<int>(row % n)] += right_[row];
                change = std::fmax(change, std::fabs(right_[row]));
            }
            if (!(change < infinity)) return false;
            if (iteration > 0 && change <= 1e-8 * largest) { // the next change would be its square
                move_bodies(system, loads, y, start);
                return true;
            }
        }
        return false;
    }

private:
    NormalForce<real> law_at(const Active& a, real above, real speed) const {
        const real x = std::sqrt(std::sqrt(above));
        return problem_.contacts[static_cast<std::size_t>(a.contact)].normal.visit(
            [&](const auto& law) { return contact_force(law, a.state, x, speed); });
    }

    // Computes the motion of all bodies and the powers at the nodes.
    void move_bodies(const System& system, const Loads& loads, const real* y, real start) {
        const std::size_t contacts = system.active.size();
        for (std::size_t j = 0; j < contacts; ++j) {
            place(j, contacts);
            for (int i = 0; i < n; ++i) {
                const real above = overlap[j][i] - system.active[j].state.origin(), v = rate[j][i];
                const NormalForce<real> now = law_at(system.active[j], above, v);
                lost[j][i] = (now.total - now.elastic) * v;
            }
        }
        const std::size_t m = modes();
        const real *s = positions(problem_, y), *v = velocities(problem_, y);
        for (std::size_t b = 0; b < bodies(); ++b) {
            Row pull{};
            for (std::size_t j = 0; j < contacts; ++j) {
                const real part = share_[j * bodies() + b] * inverse_mass_[b];
                if (part != 0)
                    for (int i = 0; i < n; ++i) pull[i] -= part * force[j][i];
            }
            if (b < m) pull = multiply(response_[b], pull);
            Row& a = acceleration[b];
            for (int i = 0; i < n; ++i) a[i] = free_[b][i] + pull[i];
            const Row first = multiply(once_, a), second = multiply(twice_, a);
            const real x0 = b < m ? y[2 * b] : s[b - m], v0 = b < m ? y[2 * b + 1] : v[b - m];
            for (int i = 0; i < n; ++i) {
                velocity[b][i] = v0 + h * first[i];
                displacement[b][i] = x0 + h * (rule().node[i] * v0 + h * second[i]);
            }
        }
        load_power = base_power = viscous_power = Row{};
        for (int i = 0; i < n; ++i) {
            for (std::size_t k = 0; k < m; ++k)
                viscous_power[i] += 2 * problem_.modes[k].decay * square(velocity[k][i]);
            for (std::size_t l = 0; l < loads.size(); ++l) {
                const Load& load = loads.load(l);
                real speed = 0;
                for (std::size_t k = 0; k < m; ++k) speed += load.shape[k] * velocity[k][i];
                for (std::size_t b = m; b < bodies() && load.base; ++b)
                    speed -= velocity[b][i] / inverse_mass_[b];
                (load.base ? base_power : load_power)[i] +=
                    loads.piece(l).value(start + h * rule().node[i]) * speed;
            }
        }
    }

public:
    // Displacement and velocity of a body at the end of the step, and of the overlap in the same way.
    std::pair<real, real> end_of(const Row& a, real x0, real v0) const {
        real first = 0, second = 0;
        for (int i = 0; i < n; ++i) {
            first += rule().weight[i] * a[i];
            second += rule().weight[i] * (1 - rule().node[i]) * a[i];
        }
        return {x0 + h * (v0 + h * second), v0 + h * first};
    }

    // Solves a dense system with partial pivoting; columns of `right` are replaced by the solutions.
    static void solve(std::vector<real>& a, std::vector<real>& right, std::size_t size, std::size_t columns) {
        for (std::size_t i = 0; i < size; ++i) {
            std::size_t pivot = i;
            for (std::size_t r = i + 1; r < size; ++r)
                if (std::fabs(a[r * size + i]) > std::fabs(a[pivot * size + i])) pivot = r;
            if (pivot != i) {
                std::swap_ranges(&a[i * size], &a[i * size] + size, &a[pivot * size]);
                std::swap_ranges(&right[i * columns], &right[i * columns] + columns, &right[pivot * columns]);
            }
            for (std::size_t r = i + 1; r < size; ++r) {
                const real factor = a[r * size + i] / a[i * size + i];
                if (factor == 0) continue;
                for (std::size_t j = i + 1; j < size; ++j) a[r * size + j] -= factor * a[i * size + j];
                for (std::size_t j = 0; j < columns; ++j)
                    right[r * columns + j] -= factor * right[i * columns + j];
            }
        }
        for (std::size_t i = size; i-- > 0;)
            for (std::size_t c = 0; c < columns; ++c) {
                real sum = right[i * columns + c];
                for (std::size_t j = i + 1; j < size; ++j) sum -= a[i * size + j] * right[j * columns + c];
                right[i * columns + c] = sum / a[i * size + i];
            }
    }

    // The linear equations of the last step: part of a body in the rate of an overlap, response of a mode to
    // a force, and changes of rate and overlap of contact j at node i by the force of contact l at node m.
    real share(std::size_t j, std::size_t body) const { return share_[j * bodies() + body]; }
    real inverse_mass(std::size_t body) const { return inverse_mass_[body]; }
    Row respond(std::size_t mode, const Row& f) const { return multiply(response_[mode], f); }
    Row integrate_once(const Row& f) const { return multiply(once_, f); }
    Row integrate_twice(const Row& f) const { return multiply(twice_, f); }
    real rate_by_force(std::size_t j, std::size_t l, std::size_t i, std::size_t m) const {
        return by_rate_[j * force.size() + l].at[i][m];
    }
    real overlap_by_force(std::size_t j, std::size_t l, std::size_t i, std::size_t m) const {
        return by_overlap_[j * force.size() + l].at[i][m];
    }

    // Computes the integrated state at the end of the step (part = 1), or by interpolation within it.
    void state_at(const System& system, const real* y, real part, std::vector<real>& out) const {
        const std::size_t m = modes(), clock = system.time_index();
        const bool at_end = part == 1;
        for (real node : rule().node)
            if (part == node) part = std::nextafter(part, 0.0); // where interpolation would divide by zero
        const auto value = [&](const Row& f) { return rule().interpolate(f, part); };
        const auto sum = [&](const Row& power) {
            if (at_end) return h * rule().integral(power);
            Row total;
            rule().integrate<1>(&power, &total);
            return h * value(total);
        };
        std::copy_n(y, system.size(), out.begin());
        real *s = positions(problem_, out.data()), *v = velocities(problem_, out.data());
        for (std::size_t b = 0; b < bodies(); ++b) {
            real &x = b < m ? out[2 * b] : s[b - m], &speed = b < m ? out[2 * b + 1] : v[b - m];
            const auto [end, end_speed] = at_end ? end_of(acceleration[b], x, speed)
                                                 : std::pair(value(displacement[b]), value(velocity[b]));
            x = end, speed = end_speed;
        }
        out[clock] += part * h;
        out[clock + 1] += sum(load_power);
        out[clock + 2] += sum(base_power);
        out[clock + 3] += sum(viscous_power);
        for (std::size_t j = 0; j < system.active.size(); ++j) {
            const real d = at_end ? end_of(approach_[j], overlap0_[j], rate0_[j]).first : value(overlap[j]);
            out[system.x_index(j)] = std::sqrt(std::sqrt(d - system.active[j].state.origin()));
            out[system.x_index(j) + 1] += sum(lost[j]);
            const Contact& c = problem_.contacts[static_cast<std::size_t>(system.active[j].contact)];
            if (c.above == ground) out[impulse_index(problem_, c)] += sum(force[j]);
        }
    }
};

} // namespace rattlebox
