// Many problems that differ in some of their numbers: a grid, and for each such number where to find it.
#pragma once

#include <vector>

#include "impact/problem.hpp"

namespace rattlebox {

struct Column {
    real* target;                    // in the problem
    const real* data;                // number of the first member
    std::vector<std::size_t> stride; // by axis of the grid; 0 where the number does not vary
};

struct Batch {
    std::vector<std::size_t> shape; // the last axis runs fastest
    std::vector<Column> columns;

    std::size_t size() const {
        std::size_t product = 1;
        for (std::size_t n : shape) product *= n;
        return product;
    }

    // Where the number of a member stands in a column.
    std::size_t offset(const Column& c, std::size_t member) const {
        std::size_t rest = member, offset = 0;
        for (std::size_t k = shape.size(); k-- > 0; rest /= shape[k]) offset += rest % shape[k] * c.stride[k];
        return offset;
    }

    // Makes the problem that the columns point into this member.
    void apply(std::size_t member) const {
        for (const Column& c : columns) *c.target = c.data[offset(c, member)];
    }
};

// What of a run is looked at: equally spaced samples from `from` to its end, in cycles of `period`.
struct Window {
    real from = 0, period = not_a_number;
    int samples = 2;
    std::vector<real> shape; // mode shapes at the point that is watched

    void place(Problem& problem) const {
        const real to = problem.settings.duration;
        problem.sample_times.resize(static_cast<std::size_t>(samples));
        for (int i = 0; i < samples; ++i)
            problem.sample_times[static_cast<std::size_t>(i)] = from + (to - from) * i / (samples - 1);
        problem.sample_times.back() = to;
    }
};

} // namespace rattlebox
