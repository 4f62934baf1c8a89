// Solution of dense linear equations with several right-hand sides that follow one after the other.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

namespace rattlebox {

// LU decomposition with partial pivoting of a matrix that is stored by columns.
template <int n, class Row> struct Factorised {
    Row column[n];
    int pivot[n];

    void factorise() {
        for (int k = 0; k < n; ++k) {
            Row& own = column[k];
            pivot[k] = k;
            for (int i = k + 1; i < n; ++i)
                if (std::fabs(own[i]) > std::fabs(own[pivot[k]])) pivot[k] = i;
            if (pivot[k] != k)
                for (int j = 0; j < n; ++j) std::swap(column[j][k], column[j][pivot[k]]);
            for (int i = k + 1; i < n; ++i) own[i] /= own[k];
            for (int j = k + 1; j < n; ++j) {
                const auto factor = column[j][k];
                for (int i = k + 1; i < n; ++i) column[j][i] -= factor * own[i];
            }
        }
    }

    // Replaces right-hand sides by the solutions. All at once, so that their steps hide each other's latency.
    void solve(Row* right, std::size_t count) const {
        for (int k = 0; k < n; ++k)
            for (std::size_t r = 0; r < count; ++r) {
                Row& x = right[r];
                std::swap(x[k], x[pivot[k]]);
                for (int i = k + 1; i < n; ++i) x[i] -= x[k] * column[k][i];
            }
        for (int k = n - 1; k >= 0; --k)
            for (std::size_t r = 0; r < count; ++r) {
                Row& x = right[r];
                x[k] /= column[k][k];
                for (int i = 0; i < k; ++i) x[i] -= x[k] * column[k][i];
            }
    }
};

} // namespace rattlebox
