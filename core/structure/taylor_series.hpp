// Motion of modes and balls under loads on a short interval, as Taylor series about its start.
//
// Between knots all loads are constants, slopes and sines, so the series of the load is known to any order
// and that of the mode follows from q'' = f - 2 a q' - k q, also in resonance. With (rate x length) <= 1 the
// first omitted term is below 1/19! = 8e-18 of the leading one, so the result is exact to rounding.
//
// E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
// section I.8, doi:10.1007/978-3-540-78862-1.
#pragma once

#include "math/real.hpp"
#include "structure/mode.hpp"

namespace rattlebox {

struct Series {
    static constexpr int order = 18;
    real c[order + 1] = {};

    real value(real s) const {
        real sum = c[order];
        for (int n = order - 1; n >= 0; --n) sum = sum * s + c[n];
        return sum;
    }

    real slope(real s) const {
        real sum = order * c[order];
        for (int n = order - 1; n >= 1; --n) sum = sum * s + n * c[n];
        return sum;
    }

    // Integral over [0, s].
    real integral(real s) const {
        real sum = c[order] / (order + 1);
        for (int n = order - 1; n >= 0; --n) sum = sum * s + c[n] / (n + 1);
        return sum * s;
    }

    void add(real weight, const Series& other) {
        for (int n = 0; n <= order; ++n) c[n] += weight * other.c[n];
    }

    // Returns a lower bound of the second derivative over [0, length].
    real min_curvature(real length) const {
        real sum = 0;
        for (int n = order; n >= 3; --n) sum = (sum + n * (n - 1) * std::fmin(c[n], 0.0)) * length;
        return 2 * c[2] + sum;
    }
};

// Solves q'' + 2 a q' + k q = f(s) from the given start.
inline Series forced_mode(const Mode& mode, const ModeState& start, const Series& load) {
    Series q;
    q.c[0] = start.q;
    q.c[1] = start.p;
    for (int n = 0; n + 2 <= Series::order; ++n)
        q.c[n + 2] = (load.c[n] - 2 * mode.decay * (n + 1) * q.c[n + 1] - mode.stiffness * q.c[n]) /
                     ((n + 1) * (n + 2));
    return q;
}

// Solves u'' = f(s), a ball in flight.
inline Series forced_ball(real position, real velocity, const Series& acceleration) {
    return forced_mode(Mode{}, ModeState{position, velocity}, acceleration);
}

} // namespace rattlebox
