// Gauss-Legendre quadrature on [0, 1] (NIST Digital Library of Mathematical Functions, 3.5(v)).
#pragma once

#include "math/real.hpp"

namespace rattlebox {

inline constexpr int gauss_count = 10;

// Nodes and weights to rounding error, by Newton's method on the Legendre recurrence.
struct GaussRule {
    real node[gauss_count];
    real weight[gauss_count];

    GaussRule() {
        for (int i = 0; i < gauss_count; ++i) {
            real x = std::cos(pi * (i + 0.75) / (gauss_count + 0.5)), slope = 1;
            for (int iteration = 0; iteration < 100; ++iteration) {
                real before = 1, value = x;
                for (int n = 2; n <= gauss_count; ++n) {
                    const real next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
                    before = value;
                    value = next;
                }
                slope = gauss_count * (x * value - before) / (x * x - 1);
                const real change = value / slope;
                x -= change;
                if (std::fabs(change) < epsilon) break;
            }
            node[i] = 0.5 * (1 - x);
            weight[i] = 1 / ((1 - x * x) * slope * slope);
        }
    }
};

// Integral of f over [0, length].
template <class F> real integrate(real length, F&& f) {
    static const GaussRule rule;
    real sum = 0;
    for (int i = 0; i < gauss_count; ++i) sum += rule.weight[i] * f(length * rule.node[i]);
    return length * sum;
}

} // namespace rattlebox
