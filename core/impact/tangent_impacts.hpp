// Derivatives through hard impacts and contacts that come to rest.
#pragma once

#include "impact/tangent_laws.hpp"
#include "math/complementarity.hpp"

namespace rattlebox {

class TangentImpacts {
    Tangents& t_;
    TangentLaws& laws_;

    // Derivative of the matrix of a complementarity problem in a parameter (contact_coupling, negative).
    real coupling_slope(const Contact& a, const Contact& b, const Problem& slope) const {
        real sum = 0;
        t_.each_side(a, [&](real sign_a, int body_a) {
            t_.each_side(b, [&](real sign_b, int body_b) {
                if (body_a >= 0 && body_a == body_b) {
                    const auto i = static_cast<std::size_t>(body_a);
                    sum -= sign_a * sign_b * slope.ball_mass[i] / square(t_.problem.ball_mass[i]);
                }
                if (body_a != wall || body_b != wall) return;
                for (std::size_t k = 0; k < t_.modes; ++k)
                    sum += sign_a * sign_b *
                           (t_.damper_of(slope, a).shape[k] * t_.damper_of(t_.problem, b).shape[k] +
                            t_.damper_of(t_.problem, a).shape[k] * t_.damper_of(slope, b).shape[k]);
            });
        });
        return sum;
    }

    // Adds an impulse and its derivatives to those of the velocities.
    void apply(const Contact& c, real impulse, const real* change) {
        t_.each_side(c, [&](real sign, int body) {
            if (body != wall) {
                const real mass = t_.problem.ball_mass[static_cast<std::size_t>(body)];
                real* v = t_.row(t_.velocity_row(body));
                for (std::size_t d = 0; d < t_.count; ++d) v[d] += sign * change[d] / mass;
                for (std::size_t p = 0; p < t_.parameters(); ++p)
                    v[t_.size + p] -= sign * impulse *
                                      t_.slopes[p].ball_mass[static_cast<std::size_t>(body)] / square(mass);
                return;
            }
            for (std::size_t k = 0; k < t_.modes; ++k) {
                real* v = t_.row(2 * k + 1);
                for (std::size_t d = 0; d < t_.count; ++d)
                    v[d] += sign * t_.damper_of(t_.problem, c).shape[k] * change[d];
                for (std::size_t p = 0; p < t_.parameters(); ++p)
                    v[t_.size + p] += sign * impulse * t_.damper_of(t_.slopes[p], c).shape[k];
            }
        });
    }

public:
    TangentImpacts(Tangents& tangents, TangentLaws& laws) : t_(tangents), laws_(laws) {}

    void begin(int c) {
        std::fill(t_.times.begin(), t_.times.end(), 0.0);
        if (c < 0) return;
        t_.rates_of_flight();
        const real* y = t_.run.state.y.data();
        t_.differentiate_gap(t_.contact(c), y, t_.matrix.data(), t_.gap_slope.data(), t_.rate_slope.data());
        const real speed = -gap(t_.problem, t_.contact(c), y).rate;
        for (std::size_t d = 0; d < t_.count; ++d) t_.times[d] = t_.gap_slope[d] / speed;
        t_.shift(1);
    }

    void impulses(const Impulses& one) {
        // The contacts whose equation is an equality.
        std::vector<std::size_t> part;
        for (std::size_t i = 0; i < one.contacts.size(); ++i)
            if (one.impulse[i] != 0 || one.is_two_sided[i]) part.push_back(i);
        const std::size_t n = part.size(), all = one.contacts.size();
        // Contacts that have come to rest, or do not rebound, are constraints of the same instant.
        const auto rebounding = std::count_if(part.begin(), part.end(), [&](std::size_t i) {
            return i >= one.resting && one.restitution[i - one.resting] > 0;
        });
        if (rebounding > 1) t_.refuse(NotLinear::simultaneous, one.contacts[part.back()]);
        std::vector<real> original(n * n), right(n), matrix, changes(n * t_.count);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) original[i * n + j] = one.matrix[part[i] * all + part[j]];
        // Derivatives of the changes of the approach rates.
        for (std::size_t i = 0; i < n; ++i) {
            const int c = one.contacts[part[i]];
            t_.differentiate_gap(t_.contact(c), t_.run.state.y.data(), t_.matrix.data(), t_.gap_slope.data(),
                                 t_.rate_slope.data());
            const real e = part[i] < one.resting ? 0 : one.restitution[part[i] - one.resting];
            const real speed = one.change[part[i]] / (1 + e);
            const real steep = e > 0 ? laws_.restitution_slope(c, speed, nullptr) : 0;
            for (std::size_t d = 0; d < t_.count; ++d)
                changes[i * t_.count + d] = -(1 + e + speed * steep) * t_.rate_slope[d];
            for (std::size_t p = 0; p < t_.parameters() && e > 0; ++p)
                changes[i * t_.count + t_.size + p] +=
                    speed * laws_.restitution_slope(c, speed, &t_.slopes[p]);
            for (std::size_t p = 0; p < t_.parameters(); ++p)
                for (std::size_t j = 0; j < n; ++j)
                    changes[i * t_.count + t_.size + p] -=
                        coupling_slope(t_.contact(c), t_.contact(one.contacts[part[j]]), t_.slopes[p]) *
                        one.impulse[part[j]];
        }
        for (std::size_t d = 0; d < t_.count; ++d) {
            for (std::size_t i = 0; i < n; ++i) right[i] = changes[i * t_.count + d];
            matrix = original;
            solve_definite(matrix, right, original);
            for (std::size_t i = 0; i < n; ++i) changes[i * t_.count + d] = right[i];
        }
        for (std::size_t i = 0; i < n; ++i)
            apply(t_.contact(one.contacts[part[i]]), one.impulse[part[i]], changes.data() + i * t_.count);
    }

    void end() {
        t_.rates_of_flight();
        t_.shift(-1);
    }
};

} // namespace rattlebox
