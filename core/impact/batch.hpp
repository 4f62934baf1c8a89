// A batch: many variants of a problem on a grid, which differ in the values of some numbers.
#pragma once

#include <vector>

#include "impact/problem.hpp"

namespace rattlebox {

struct Column {
    real* target;                    // number in the problem
    const real* data;                // value of the first variant
    std::vector<std::size_t> stride; // by axis of the grid; 0 if the value does not depend on it
};

struct Batch {
    std::vector<std::size_t> shape; // the last axis runs fastest
    std::vector<Column> columns;

    std::size_t size() const {
        std::size_t product = 1;
        for (std::size_t n : shape) product *= n;
        return product;
    }

    // Returns the index of the value of a variant in a column.
    std::size_t offset(const Column& c, std::size_t variant) const {
        std::size_t rest = variant, offset = 0;
        for (std::size_t k = shape.size(); k-- > 0; rest /= shape[k]) offset += rest % shape[k] * c.stride[k];
        return offset;
    }

    // Writes the values of a variant into the problem.
    void apply(std::size_t variant) const {
        for (const Column& c : columns) *c.target = c.data[offset(c, variant)];
    }
};

// The window in which measures are evaluated: equally spaced samples from `from` to the end, in cycles of
// `period`.
struct Window {
    real from = 0, period = not_a_number;
    int samples = 2;
    std::vector<real> shape; // mode shapes at the observed point, or their difference between two points
    real base = 1;           // 1 if the point moves with the base, 0 for a difference and for a mode
    std::vector<real> participation; // of the modes in the motion of the base; empty if unknown
    real residual_mass = 0;          // of the truncated modes, which follow the base

    void place(Problem& problem) const {
        const real to = problem.settings.duration;
        problem.sample_times.resize(static_cast<std::size_t>(samples));
        for (int i = 0; i < samples; ++i)
            problem.sample_times[static_cast<std::size_t>(i)] = from + (to - from) * i / (samples - 1);
        problem.sample_times.back() = to;
    }
};

} // namespace rattlebox
