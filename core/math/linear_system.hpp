// Small dense linear systems with a symmetric matrix whose eigenvalues have one sign or are zero, by Gaussian
// elimination without pivoting, which is stable for these.
//
// N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, chapters 9 and 10,
// doi:10.1137/1.9780898718027.
#pragma once

#include <vector>

#include "math/real.hpp"

namespace rattlebox {

// Part of a diagonal element below which what elimination leaves of it is rounding.
inline constexpr real smallest_pivot = 1e-12;

// Solves matrix x = right in place. The matrix (n x n, row by row), a copy of `original`, is overwritten;
// `right` becomes x. Returns whether the matrix is definite; unknowns whose rows follow from those before
// are zero.
inline bool solve_definite(std::vector<real>& matrix, std::vector<real>& right,
                           const std::vector<real>& original) {
    const std::size_t n = right.size();
    bool is_definite = true;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(std::fabs(matrix[i * n + i]) > smallest_pivot * std::fabs(original[i * n + i]))) {
            is_definite = false;
            for (std::size_t j = 0; j < n; ++j) matrix[i * n + j] = matrix[j * n + i] = 0;
            matrix[i * n + i] = 1, right[i] = 0;
            continue;
        }
        for (std::size_t r = i + 1; r < n; ++r) {
            const real factor = matrix[r * n + i] / matrix[i * n + i];
            for (std::size_t j = i; j < n; ++j) matrix[r * n + j] -= factor * matrix[i * n + j];
            right[r] -= factor * right[i];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t j = i + 1; j < n; ++j) right[i] -= matrix[i * n + j] * right[j];
        right[i] /= matrix[i * n + i];
    }
    return is_definite;
}

} // namespace rattlebox
