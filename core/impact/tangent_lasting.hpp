// Derivatives in long steps of contacts that stay closed (impact/lasting_contact.hpp).
//
// With the forces of all contacts at all nodes as unknowns, Newton's method for the step and the derivatives
// of its solution have the same matrix. A step that does not resolve the derivatives is divided.
#pragma once

#include "impact/lasting_contact.hpp"
#include "impact/tangent_laws.hpp"

namespace rattlebox {

class TangentLasting {
    static constexpr int n = LastingContact::n;
    using Row = LastingContact::Row;
    static constexpr real resolved = 1e-11;    // last Legendre coefficients of the speeds, as part of these
    static constexpr real smallest = 1.0 / 64; // part of a step
    static constexpr real longest = 1000;      // step while the state rests, in 1/frequency

    Tangents& t_;
    TangentLaws& laws_;
    LastingContact part_;
    std::vector<real> y_, end_, next_;
    std::vector<real> matrix_, right_;
    std::vector<real> by_overlap_, by_rate_; // of the forces at the nodes
    std::vector<real> largest_overlap_;      // by contact and direction: the terms of its derivative
    std::vector<Row> free_;                  // by body and direction: accelerations
    std::vector<Row> scratch_, first_, second_;

    std::size_t bodies() const { return t_.modes + t_.balls; }
    std::size_t at(std::size_t body, std::size_t direction) const { return body * t_.count + direction; }
    std::size_t position(std::size_t body) const { return body < t_.modes ? 2 * body : body + t_.modes; }
    std::size_t velocity(std::size_t body) const {
        return body < t_.modes ? 2 * body + 1 : body + t_.modes + t_.balls;
    }
    const Contact& contact(std::size_t j) const { return t_.contact(t_.run.system.active[j].contact); }

    // Derivative of the part of a mode in the rate of an overlap.
    real share_slope(const Contact& c, std::size_t k, std::size_t p) const {
        real shape = 0;
        t_.each_side(c, [&](real sign, int body) {
            if (body == wall) shape -= sign * t_.damper_of(t_.slopes[p], c).shape[k];
        });
        return shape;
    }

    // Computes the accelerations without the derivatives of the contact forces.
    void accelerate(const LastingContact& step, real start) {
        const std::size_t contacts = t_.run.system.active.size();
        free_.assign(bodies() * t_.count, Row{});
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < t_.count; ++d) {
                const Mode& mode = t_.problem.modes[k];
                const real q = t_.row(2 * k)[d], p = t_.row(2 * k + 1)[d];
                for (int i = 0; i < n; ++i)
                    free_[at(k, d)][i] = -2 * mode.decay * p -
                                         mode.stiffness * (q + step.h * LastingContact::rule().node[i] * p);
            }
        for (std::size_t p = 0; p < t_.parameters(); ++p) {
            const Problem& slope = t_.slopes[p];
            const std::size_t d = t_.size + p;
            for (std::size_t l = 0; l < t_.run.loads.size(); ++l) {
                const Piece& piece = t_.run.loads.piece(l);
                const Load& load = t_.run.loads.load(l);
                const Tangents::SignalSlope signal =
                    t_.signal_slope(piece, load.signal, slope.loads[l].signal);
                for (int i = 0; i < n; ++i) {
                    const real time = start + step.h * LastingContact::rule().node[i];
                    const real change = t_.signal_slope_at(piece, signal, time),
                               value = piece.is_zero() ? 0 : piece.value(time);
                    for (std::size_t k = 0; k < t_.modes; ++k)
                        free_[at(k, d)][i] += load.shape[k] * change + slope.loads[l].shape[k] * value;
                    for (std::size_t b = t_.modes; b < bodies() && load.base; ++b)
                        free_[at(b, d)][i] -= change;
                }
            }
            for (std::size_t k = 0; k < t_.modes; ++k) {
                const Mode& mode = slope.modes[k];
                for (int i = 0; i < n; ++i)
                    free_[at(k, d)][i] -=
                        2 * mode.decay * step.velocity[k][i] + mode.stiffness * step.displacement[k][i];
                for (std::size_t j = 0; j < contacts; ++j)
                    if (const real part = share_slope(contact(j), k, p); part != 0)
                        for (int i = 0; i < n; ++i) free_[at(k, d)][i] -= part * step.force[j][i];
            }
            for (std::size_t b = 0; b < t_.balls; ++b) {
                const real g = slope.dampers[static_cast<std::size_t>(t_.problem.ball_damper[b])].gravity;
                const real heavier = slope.ball_mass[b] / square(t_.problem.ball_mass[b]);
                for (int i = 0; i < n; ++i) free_[at(t_.modes + b, d)][i] += g;
                for (std::size_t j = 0; j < contacts; ++j)
                    if (const real part = heavier * step.share(j, t_.modes + b); part != 0)
                        for (int i = 0; i < n; ++i) free_[at(t_.modes + b, d)][i] += part * step.force[j][i];
            }
        }
        for (std::size_t k = 0; k < t_.modes; ++k)
            for (std::size_t d = 0; d < t_.count; ++d) free_[at(k, d)] = step.respond(k, free_[at(k, d)]);
    }

    // Computes the right-hand sides: the forces with the accelerations so far, by node and contact, in all
    // directions.
    void load_contacts(const LastingContact& step) {
        const std::vector<Active>& active = t_.run.system.active;
        const std::size_t contacts = active.size();
        right_.assign(contacts * n * t_.count, 0.0);
        by_overlap_.resize(contacts * n), by_rate_.resize(contacts * n);
        largest_overlap_.assign(contacts * t_.count, 0.0);
        std::vector<Row> overlap(t_.count), rate(t_.count);
        for (std::size_t j = 0; j < contacts; ++j) {
            const Contact& c = contact(j);
            const TangentLaws::Slopes& slopes = laws_.slopes[static_cast<std::size_t>(active[j].contact)];
            std::fill(overlap.begin(), overlap.end(), Row{}), std::fill(rate.begin(), rate.end(), Row{});
            for (std::size_t b = 0; b < bodies(); ++b) {
                const real part = step.share(j, b);
                if (part == 0) continue;
                const real *x = t_.row(position(b)), *v = t_.row(velocity(b));
                for (std::size_t d = 0; d < t_.count; ++d) {
                    const Row first = step.integrate_once(free_[at(b, d)]),
                              second = step.integrate_twice(free_[at(b, d)]);
                    for (int i = 0; i < n; ++i) {
                        rate[d][i] += part * (v[d] + step.h * first[i]);
                        overlap[d][i] +=
                            part *
                            (x[d] + step.h * (LastingContact::rule().node[i] * v[d] + step.h * second[i]));
                    }
                    largest_overlap_[j * t_.count + d] += std::fabs(part * x[d]);
                }
            }
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const std::size_t d = t_.size + p;
                for (std::size_t k = 0; k < t_.modes; ++k)
                    if (const real part = share_slope(c, k, p); part != 0)
                        for (int i = 0; i < n; ++i) {
                            overlap[d][i] += part * step.displacement[k][i];
                            rate[d][i] += part * step.velocity[k][i];
                        }
                if (c.below != wall && c.above != wall) continue;
                const real half = 0.5 * t_.damper_of(t_.slopes[p], c).clearance;
                for (int i = 0; i < n; ++i) overlap[d][i] -= half;
                largest_overlap_[j * t_.count + d] += std::fabs(half);
            }
            const bool unloads = active[j].state.phase == ContactState::unloading;
            for (int i = 0; i < n; ++i) {
                const real x = std::sqrt(std::sqrt(step.overlap[j][i] - active[j].state.origin())),
                           now = step.rate[j][i];
                const TangentLaws::Force f = c.normal.visit(
                    [&](const auto& law) { return TangentLaws::force_of(law, active[j].state, x, now); });
                const std::size_t node = j * n + static_cast<std::size_t>(i);
                by_overlap_[node] = 0.25 * f.x / cube(x), by_rate_[node] = f.rate;
                real* to = right_.data() + node * t_.count;
                for (std::size_t d = 0; d < t_.count; ++d)
                    to[d] = by_overlap_[node] * (overlap[d][i] - (unloads ? slopes.origin[d] : 0)) +
                            f.rate * rate[d][i] + f.stiffness * slopes.stiffness[d] +
                            f.second * slopes.second[d] + f.deepest * slopes.deepest[d] +
                            f.unloading * slopes.unloading[d] + f.origin * slopes.origin[d];
                for (std::size_t p = 0; p < t_.parameters(); ++p)
                    if (laws_.is_in_formula(active[j].contact, p))
                        to[t_.size + p] += c.normal.visit([&](const auto& law) {
                            return laws_.formula_slope(law,
                                                       t_.contact_of(t_.slopes[p], active[j].contact).normal,
                                                       active[j].state, x, now);
                        });
            }
        }
    }

    // Solves for the derivatives of the forces.
    void solve_forces(const LastingContact& step) {
        const std::size_t contacts = t_.run.system.active.size(), size = contacts * n;
        matrix_.assign(size * size, 0.0);
        for (std::size_t row = 0; row < size; ++row) {
            const std::size_t j = row / n, i = row % n;
            for (std::size_t column = 0; column < size; ++column)
                matrix_[row * size + column] =
                    by_rate_[row] * step.rate_by_force(j, column / n, i, column % n) +
                    by_overlap_[row] * step.overlap_by_force(j, column / n, i, column % n);
            matrix_[row * size + row] += 1;
        }
        LastingContact::solve(matrix_, right_, size, t_.count);
    }

    // Moves the derivatives to the end of the step; returns the error over the permitted one.
    real finish(const LastingContact& step, real frequency) {
        const std::size_t contacts = t_.run.system.active.size();
        next_ = t_.matrix;
        real worst = 0;
        const real rounding = epsilon * (8 + square(frequency * step.h));
        for (std::size_t d = 0; d < t_.count; ++d) {
            std::vector<Row> force(contacts);
            for (std::size_t j = 0; j < contacts; ++j)
                for (int i = 0; i < n; ++i)
                    force[j][i] = right_[(j * n + static_cast<std::size_t>(i)) * t_.count + d];
            real size = 0; // of the speeds
            std::vector<real> lightness(contacts, 0.0);
            for (std::size_t b = 0; b < bodies(); ++b) {
                Row pull{};
                for (std::size_t j = 0; j < contacts; ++j) {
                    const real part = step.share(j, b) * step.inverse_mass(b);
                    lightness[j] += part * step.share(j, b);
                    if (part != 0)
                        for (int i = 0; i < n; ++i) pull[i] -= part * force[j][i];
                }
                if (b < t_.modes) pull = step.respond(b, pull);
                Row a = free_[at(b, d)];
                for (int i = 0; i < n; ++i) a[i] += pull[i];
                real &x = next_[position(b) * t_.count + d], &v = next_[velocity(b) * t_.count + d];
                const real x0 = x, v0 = v;
                std::tie(x, v) = step.end_of(a, x0, v0);
                size = std::fmax(size, std::fmax(std::fabs(v0), std::fabs(v)));
            }
            for (std::size_t j = 0; j < contacts; ++j) {
                real largest = 0, stiffness = 0;
                for (int i = 0; i < n; ++i) {
                    largest = std::fmax(largest, std::fabs(force[j][i]));
                    stiffness = std::fmax(stiffness, by_overlap_[j * n + static_cast<std::size_t>(i)]);
                }
                const real noise = rounding * (largest + stiffness * largest_overlap_[j * t_.count + d]);
                const real error = step.h * lightness[j] * std::fmax(step.tail(force[j]) - noise, 0.0);
                if (error > 0) worst = std::fmax(worst, error / (resolved * size));
            }
        }
        return worst;
    }

    // Advances the derivatives by a step; returns its error.
    real advance(const LastingContact& step, real start, real frequency) {
        accelerate(step, start);
        load_contacts(step);
        solve_forces(step);
        return finish(step, frequency);
    }

    // Makes steps, of the length h at first, from the state y_ at a time over a length; where the state
    // `rests`, it stays the same.
    void divide(real time, real length, real h, bool rests) {
        const std::size_t clock = t_.run.system.time_index();
        const real frequency = std::sqrt(part_.square_of_frequency(t_.run.system, y_.data()));
        end_.resize(y_.size());
        for (real done = 0; done < length;) {
            const bool last = !(done + h < length);
            const real step = last ? length - done : h;
            const bool is_least = step <= smallest * std::fmin(length, longest_lasting / frequency);
            const bool solved = part_.solve_step(t_.run.system, t_.run.loads, y_.data(), time + done, step);
            const real error = solved ? advance(part_, time + done, frequency) : infinity;
            if (!(error <= 1) && !(is_least && solved)) {
                if (is_least) return t_.refuse(NotLinear::kink, -1);
                h = 0.5 * step;
                continue;
            }
            t_.matrix.swap(next_);
            part_.state_at(t_.run.system, y_.data(), 1, end_);
            if (!rests) y_.swap(end_);
            y_[clock] = time + done + step - t_.run.state.t;
            done = last ? length : done + step;
            if (error < 0.01) h = std::fmin(2 * step, longest / frequency);
        }
    }

public:
    TangentLasting(Tangents& tangents, TangentLaws& laws)
        : t_(tangents), laws_(laws), part_(tangents.problem) {}

    // The run makes a step from y at a time.
    void advance(const real* y, const LastingContact& step, real time) {
        const real frequency = std::sqrt(part_.square_of_frequency(t_.run.system, y));
        if (advance(step, time, frequency) <= 1) {
            t_.matrix.swap(next_);
            return;
        }
        y_.assign(y, y + t_.run.system.size());
        divide(time, step.h, 0.5 * step.h, false);
    }

    // The state rests in y from a time for a length.
    void rest(const real* y, real time, real length) {
        y_.assign(y, y + t_.run.system.size());
        const real frequency = std::sqrt(part_.square_of_frequency(t_.run.system, y));
        divide(time, length, std::fmin(length, shortest_lasting / frequency), true);
    }
};

} // namespace rattlebox
