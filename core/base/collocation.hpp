// Spectral integration on Gauss-Legendre nodes of [0, 1]: from values of f at the nodes to its integral up to
// any point.
#pragma once

#include "base/real.hpp"

namespace rattlebox {

template <int n> struct Collocation {
    real node[n], weight[n];
    real legendre[n][n + 1];        // P_k at the nodes (as points of [-1, 1]), k = 0..n
    alignas(64) real columns[n][n]; // columns[j][i]: weight of f(node j) in the integral from 0 to node i

    Collocation() {
        for (int i = 0; i < n; ++i) {
            real x = -std::cos(pi * (i + 0.75) / (n + 0.5)), slope = 1;
            for (int iteration = 0; iteration < 100; ++iteration) {
                fill(x, legendre[i]);
                slope = n * (x * legendre[i][n] - legendre[i][n - 1]) / (x * x - 1);
                const real change = legendre[i][n] / slope;
                x -= change;
                if (std::fabs(change) < epsilon) break;
            }
            fill(x, legendre[i]);
            node[i] = 0.5 * (1 + x);
            weight[i] = 1 / ((1 - x * x) * slope * slope);
        }
        for (int i = 0; i < n; ++i) {
            real part[n];
            row(node[i], part);
            for (int j = 0; j < n; ++j) columns[j][i] = part[j];
        }
    }

    static void fill(real x, real* p) {
        p[0] = 1;
        p[1] = x;
        for (int k = 2; k <= n; ++k) p[k] = ((2 * k - 1) * x * p[k - 1] - (k - 1) * p[k - 2]) / k;
    }

    // Weights of the values at the nodes in the integral from 0 to s.
    void row(real s, real* out) const {
        real p[n + 1], integral[n]; // of P_k from -1 to x, times (2 k + 1)
        const real x = 2 * s - 1;
        fill(x, p);
        integral[0] = x + 1;
        for (int k = 1; k < n; ++k) integral[k] = p[k + 1] - p[k - 1];
        for (int j = 0; j < n; ++j) {
            real sum = 0;
            for (int k = 0; k < n; ++k) sum += legendre[j][k] * integral[k];
            out[j] = 0.5 * weight[j] * sum;
        }
    }

    // out[i] = integral of f from 0 to node i.
    void integrate(const real* f, real* out) const {
        real sum[n] = {};
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) sum[i] += columns[j][i] * f[j];
        for (int i = 0; i < n; ++i) out[i] = sum[i];
    }
};

} // namespace rattlebox
