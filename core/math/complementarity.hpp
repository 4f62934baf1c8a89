// Small linear complementarity problems with a symmetric matrix without negative eigenvalues. If it is
// definite they have exactly one solution; otherwise unknowns whose exchange leaves the problem the same
// share their sum equally.
//
// Least-index principal pivoting: K. G. Murty, Opsearch 11 (1974) 123; R. W. Cottle,
// J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM 2009, chapter 4,
// doi:10.1137/1.9780898719000, section 5.2 for projected relaxation.
#pragma once

#include <vector>

#include "math/linear_system.hpp"

namespace rattlebox {

// Whether unknowns i and j can be exchanged without a change of the problem.
inline bool are_exchangeable(const std::vector<real>& matrix, const std::vector<real>& need,
                             const std::vector<char>& both_signs, std::size_t i, std::size_t j) {
    const std::size_t n = need.size();
    bool same =
        need[i] == need[j] && both_signs[i] == both_signs[j] && matrix[i * n + i] == matrix[j * n + j];
    for (std::size_t k = 0; k < n && same; ++k)
        same = k == i || k == j || matrix[i * n + k] == matrix[j * n + k];
    return same;
}

// The same as solve_complementary by projected Gauss-Seidel relaxation, which also converges if several
// solutions exist: two stops at one point.
inline void relax_complementary(const std::vector<real>& matrix, const std::vector<real>& need,
                                const std::vector<char>& both_signs, std::vector<real>& p) {
    const std::size_t n = need.size();
    constexpr int most_sweeps = 100'000;
    std::fill(p.begin(), p.end(), 0.0);
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        real change = 0, largest = 0;
        for (std::size_t i = 0; i < n; ++i) {
            real rest = need[i];
            for (std::size_t j = 0; j < n; ++j) rest -= matrix[i * n + j] * p[j];
            const real before = p[i], next = before + rest / matrix[i * n + i];
            p[i] = both_signs[i] ? next : std::fmax(next, 0.0);
            change = std::fmax(change, std::fabs(p[i] - before));
            largest = std::fmax(largest, std::fabs(p[i]));
        }
        if (change <= epsilon * largest) break;
    }
    const std::vector<real> found = p;
    for (std::size_t i = 0; i < n; ++i) {
        real sum = 0, count = 0;
        for (std::size_t j = 0; j < n; ++j)
            if (j == i || are_exchangeable(matrix, need, both_signs, i, j)) sum += found[j], count += 1;
        p[i] = sum / count;
    }
}

// Computes p with w = matrix p - need, p >= 0, w >= 0 and p w = 0 in each row; w = 0 where `both_signs` is
// set, for any p. Unknowns whose exchange leaves the problem the same have the same bits.
inline void solve_complementary(const std::vector<real>& matrix, const std::vector<real>& need,
                                const std::vector<char>& both_signs, std::vector<real>& p) {
    const std::size_t n = need.size(), most_pivots = 1000 * n; // more only if rounding errors decide
    p.resize(n);
    if (n == 1) { // nearly always
        p[0] = both_signs[0] || need[0] > 0 ? need[0] / matrix[0] : 0;
        return;
    }
    std::vector<char> active(n, true);
    std::vector<real> part, right, original;
    real size = 0;
    for (const real value : need) size = std::fmax(size, std::fabs(value));
    for (std::size_t pivot = 0; pivot <= most_pivots; ++pivot) {
        std::vector<std::size_t> rows;
        for (std::size_t i = 0; i < n; ++i)
            if (active[i]) rows.push_back(i);
        part.clear(), right.clear();
        for (const std::size_t i : rows) {
            right.push_back(need[i]);
            for (const std::size_t j : rows) part.push_back(matrix[i * n + j]);
        }
        original = part;
        if (!solve_definite(part, right, original)) return relax_complementary(matrix, need, both_signs, p);
        std::fill(p.begin(), p.end(), 0.0);
        for (std::size_t r = 0; r < rows.size(); ++r) p[rows[r]] = right[r];
        std::size_t wrong = n;
        for (std::size_t i = 0; i < n && wrong == n; ++i) {
            if (both_signs[i]) continue;
            real w = -need[i];
            for (std::size_t j = 0; j < n; ++j) w += matrix[i * n + j] * p[j];
            if (active[i] ? p[i] < 0 : w < -64 * epsilon * size) wrong = i;
        }
        if (wrong == n) break;
        active[wrong] = !active[wrong];
    }
    // Elimination treats the rows in turn, with different rounding errors.
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (!are_exchangeable(matrix, need, both_signs, i, j)) continue;
            p[i] = p[j];
            break;
        }
}

} // namespace rattlebox
