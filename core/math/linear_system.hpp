// Small dense linear systems with a definite symmetric matrix, by Gaussian elimination without pivoting,
// which is stable for these.
//
// N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, chapters 9 and 10,
// doi:10.1137/1.9780898718027.
#pragma once

#include <vector>

#include "math/real.hpp"

namespace rattlebox {

// Solves matrix x = right in place. The matrix (n x n, row by row) is overwritten; `right` becomes x.
inline void solve_definite(std::vector<real>& matrix, std::vector<real>& right) {
    const std::size_t n = right.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t r = i + 1; r < n; ++r) {
            const real factor = matrix[r * n + i] / matrix[i * n + i];
            for (std::size_t j = i; j < n; ++j) matrix[r * n + j] -= factor * matrix[i * n + j];
            right[r] -= factor * right[i];
        }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t j = i + 1; j < n; ++j) right[i] -= matrix[i * n + j] * right[j];
        right[i] /= matrix[i * n + i];
    }
}

} // namespace rattlebox
