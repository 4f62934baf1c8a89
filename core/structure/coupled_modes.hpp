// Modes coupled by damping: dampers between points, tuned masses, non-proportional damping.
//
//     q_k'' + 2 a_k q_k' + k_k q_k = f_k - sum_j c_kj q_j'
//
// c is the modal damping matrix without its diagonal 2 a: symmetric, zero on the diagonal, row by row. An
// empty c stands for proportional damping; its modes are propagated one by one in closed form
// (structure/mode.hpp).
#pragma once

#include <algorithm>
#include <vector>

#include "structure/taylor_series.hpp"

namespace rattlebox {

// Calls add(k, force) with the force of the other modes on each mode; `speed(k)` is the velocity of mode k.
template <class Speed, class Add>
void couple(const std::vector<real>& coupling, std::size_t modes, Speed&& speed, Add&& add) {
    if (coupling.empty()) return;
    for (std::size_t k = 0; k < modes; ++k) {
        real sum = 0;
        for (std::size_t j = 0; j < modes; ++j) sum -= coupling[k * modes + j] * speed(j);
        add(k, sum);
    }
}

// Power lost by the coupling, p^T c p.
template <class Speed>
real coupled_power(const std::vector<real>& coupling, std::size_t modes, Speed&& speed) {
    real power = 0;
    couple(coupling, modes, speed, [&](std::size_t k, real force) { power -= force * speed(k); });
    return power;
}

// Returns a bound of the rates of the motion: |x'| <= rate |x| for x = (sqrt(k) q, p), so that the terms of
// its Taylor series decrease at least like those of exp(rate s). Without coupling it is the magnitude of the
// largest root.
inline real fastest_rate(const std::vector<Mode>& modes, const std::vector<real>& coupling) {
    real rate = 0;
    if (coupling.empty()) {
        for (const Mode& mode : modes) rate = std::max(rate, mode.rate());
        return rate;
    }
    real damping = 0;
    for (std::size_t k = 0; k < modes.size(); ++k) {
        real row = 2 * modes[k].decay;
        for (std::size_t j = 0; j < modes.size(); ++j) row += std::fabs(coupling[k * modes.size() + j]);
        damping = std::max(damping, row);
        rate = std::max(rate, std::sqrt(modes[k].stiffness));
    }
    return rate + damping;
}

// Computes the Taylor series of all modes from a state (q, p of each mode) and the loads on them; valid for
// (rate x length) <= 1.
inline void coupled_series(const std::vector<Mode>& modes, const std::vector<real>& coupling, const real* y,
                           const std::vector<Series>& load, std::vector<Series>& q) {
    const std::size_t m = modes.size();
    q.assign(m, Series{});
    for (std::size_t k = 0; k < m; ++k) {
        q[k].c[0] = y[2 * k];
        q[k].c[1] = y[2 * k + 1];
    }
    for (int n = 0; n + 2 <= Series::order; ++n)
        for (std::size_t k = 0; k < m; ++k) {
            real force = load[k].c[n] - modes[k].stiffness * q[k].c[n];
            force -= 2 * modes[k].decay * (n + 1) * q[k].c[n + 1];
            for (std::size_t j = 0; j < m; ++j) force -= coupling[k * m + j] * (n + 1) * q[j].c[n + 1];
            q[k].c[n + 2] = force / ((n + 1) * (n + 2));
        }
}

// Returns the matrix that advances the state (q, p of each mode) by one step, row by row, (2 m)^2: the matrix
// exponential by scaling and squaring. C. Moler, C. Van Loan, SIAM Review 45 (2003) 3,
// doi:10.1137/S00361445024180.
inline std::vector<real> transition(const std::vector<Mode>& modes, const std::vector<real>& coupling,
                                    real step) {
    const std::size_t m = modes.size(), n = 2 * m;
    int halvings = 0;
    for (real part = fastest_rate(modes, coupling) * step; part > 1; part *= 0.5) ++halvings;
    const real part = std::ldexp(step, -halvings);
    std::vector<real> matrix(n * n), state(n), square(n * n);
    std::vector<Series> q;
    const std::vector<Series> load(m);
    for (std::size_t column = 0; column < n; ++column) {
        std::fill(state.begin(), state.end(), real{});
        state[column] = 1;
        coupled_series(modes, coupling, state.data(), load, q);
        for (std::size_t k = 0; k < m; ++k) {
            matrix[2 * k * n + column] = q[k].value(part);
            matrix[(2 * k + 1) * n + column] = q[k].slope(part);
        }
    }
    for (; halvings > 0; --halvings) {
        std::fill(square.begin(), square.end(), real{});
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t l = 0; l < n; ++l)
                for (std::size_t j = 0; j < n; ++j)
                    square[i * n + j] += matrix[i * n + l] * matrix[l * n + j];
        matrix.swap(square);
    }
    return matrix;
}

} // namespace rattlebox
