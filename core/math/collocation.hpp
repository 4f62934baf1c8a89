// Spectral integration and barycentric interpolation on Gauss-Legendre nodes of [0, 1].
//
// The integral up to node i uses the Legendre expansion of f and int P_k = (P_(k+1) - P_(k-1)) / (2 k + 1).
// Interpolation: J.-P. Berrut, L. N. Trefethen, SIAM Review 46 (2004) 501, doi:10.1137/S0036144502417715.
#pragma once

#include <algorithm>
#include <cstddef>

#include "math/lanes.hpp"

namespace rattlebox {

template <int n> struct Collocation {
    static_assert(n % 16 == 0, "halves are worked through in blocks of lanes_at");
    static constexpr int half = n / 2, block = lane_count;
    struct alignas(64) Row { // values of a function at the nodes
        real at[n];
        real& operator[](int i) { return at[i]; }
        const real& operator[](int i) const { return at[i]; }
        Lanes& lanes_at(int i) { return lanes(at + i); }
        const Lanes& lanes_at(int i) const { return lanes(at + i); }
        Lanes read(int i) const { return rattlebox::read<lane_count>(at + i); }
    };
    alignas(64) real node[n], weight[n], barycentric[n]; // `barycentric`: weights of interpolation
    // Nodes and weights are symmetric, so f is split into an odd and an even part, which halves the work.
    // Element [j][i] is the weight of f(1 - node j) - f(node j), or of their sum, in the integrals up to node
    // i and its mirror node.
    alignas(64) real odd[half][half], even[half][half];

    Collocation() {
        real p[n + 1], legendre[n][n + 1]; // P_k at the nodes (as points of [-1, 1])
        for (int i = 0; i < n; ++i) {
            real x = -std::cos(pi * (i + 0.75) / (n + 0.5)), slope = 1;
            for (int iteration = 0; iteration < 100; ++iteration) {
                legendre_polynomials(x, p);
                slope = n * (x * p[n] - p[n - 1]) / (x * x - 1);
                const real change = p[n] / slope;
                x -= change;
                if (std::fabs(change) < epsilon) break;
            }
            legendre_polynomials(x, legendre[i]);
            node[i] = 0.5 * (1 + x);
            weight[i] = 1 / ((1 - x * x) * slope * slope);
            barycentric[i] = (i % 2 ? -1 : 1) * std::sqrt((1 - x * x) * weight[i]);
        }
        for (int i = 0; i < half; ++i) {
            real integral[n]; // of P_k from -1 to node i, times (2 k + 1)
            integral[0] = 2 * node[i];
            for (int k = 1; k < n; ++k) integral[k] = legendre[i][k + 1] - legendre[i][k - 1];
            const auto integral_weight = [&](int j) {
                real sum = 0;
                for (int k = 0; k < n; ++k) sum += legendre[j][k] * integral[k];
                return 0.5 * weight[j] * sum;
            };
            for (int j = 0; j < half; ++j) {
                odd[j][i] = 0.5 * (integral_weight(j) - integral_weight(n - 1 - j));
                even[j][i] = 0.5 * (weight[j] - integral_weight(j) - integral_weight(n - 1 - j));
            }
        }
    }

    static void legendre_polynomials(real x, real* p) {
        p[0] = 1;
        p[1] = x;
        for (int k = 2; k <= n; ++k) p[k] = ((2 * k - 1) * x * p[k - 1] - (k - 1) * p[k - 2]) / k;
    }

    // out[r][i] = integral of f[r] from 0 to node i, for several functions at once.
    template <int count> void integrate(const Row* f, Row* out) const {
        alignas(64) real difference[count][half], sum[count][half];
        real whole[count];
        for (int r = 0; r < count; ++r) {
            for (int j = 0; j < half; ++j) {
                difference[r][j] = f[r][j] - f[r][n - 1 - j];
                sum[r][j] = f[r][j] + f[r][n - 1 - j];
            }
            whole[r] = 0.5 * dot<half>(weight, sum[r]);
        }
        // One register for each running sum, with as many sums at a time as stay in registers and hide the
        // latency.
        using Register = Pack<register_width>;
        constexpr int width = register_width, registers = std::min(half / width, std::max(1, 4 / count));
        for (int i0 = 0; i0 < half; i0 += registers * width) {
            Register a[count][registers] = {}, b[count][registers] = {};
            for (int j = 0; j < half; ++j)
                for (int k = 0; k < registers; ++k) {
                    const Register odd_j = pack<width>(&odd[j][i0 + k * width]),
                                   even_j = pack<width>(&even[j][i0 + k * width]);
                    for (int r = 0; r < count; ++r) {
                        a[r][k] = a[r][k] + Register::all(difference[r][j]) * odd_j;
                        b[r][k] = b[r][k] + Register::all(sum[r][j]) * even_j;
                    }
                }
            for (int r = 0; r < count; ++r)
                for (int k = 0; k < registers; ++k) {
                    const Register middle = Register::all(whole[r]) + a[r][k];
                    alignas(64) real mirrored[width];
                    const int at = i0 + k * width;
                    pack<width>(out[r].at + at) = middle - b[r][k];
                    pack<width>(mirrored) = middle + b[r][k];
                    for (int i = 0; i < width; ++i) out[r][n - 1 - at - i] = mirrored[i];
                }
        }
    }

    // Sum of products in eight partial sums, so that the bits do not depend on the instruction set.
    template <int length> static real dot(const real* a, const real* b) {
        static_assert(length % block == 0);
        Lanes sum = {};
        for (int j = 0; j < length; j += block) sum += lanes(a + j) * lanes(b + j);
        return total(sum);
    }

    // Integrates any number of functions.
    void integrate(const Row* f, Row* out, std::size_t count) const {
        for (; count >= 4; f += 4, out += 4, count -= 4) integrate<4>(f, out);
        if (count == 3) integrate<3>(f, out);
        if (count == 2) integrate<2>(f, out);
        if (count == 1) integrate<1>(f, out);
    }

    // Integral of f from 0 to 1.
    real integral(const Row& f) const { return dot<n>(weight, f.at); }

    // Returns f at a point that is not a node.
    real interpolate(const Row& f, real x) const {
        Lanes above = {}, below = {};
        for (int i = 0; i < n; i += block) {
            const Lanes part = lanes(barycentric + i) / (Lanes::all(x) - lanes(node + i));
            above += part * f.lanes_at(i);
            below += part;
        }
        return total(above) / total(below);
    }
};

} // namespace rattlebox
