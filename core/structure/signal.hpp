// Time signals of loads and base accelerations: half-sine pulse, harmonic, piecewise-linear record, constant.
//
//     half-sine   amplitude sin(pi (t - start) / duration)     start <= t < stop = start + duration
//     harmonic    amplitude sin(frequency t + phase)           start <= t < stop
//     record      straight lines through (times, values)       0 outside
//     constant    amplitude                                    for inputs that change from step to step
//
// Between two knots each signal is the sum of a constant, a slope and a sine, so that flights can be
// integrated exactly.
#pragma once

#include <algorithm>

#include "math/real.hpp"
#include "util/field.hpp"

namespace rattlebox {

// A signal between two knots: constant + slope (t - origin) + amplitude sin(frequency (t - origin) + phase).
struct Piece {
    real origin = 0, constant = 0, slope = 0, amplitude = 0, frequency = 0, phase = 0;

    bool is_zero() const { return constant == 0 && slope == 0 && amplitude == 0; }

    real value(real t) const {
        const real s = t - origin;
        real f = constant + slope * s;
        if (amplitude != 0) f += amplitude * std::sin(frequency * s + phase);
        return f;
    }

    real integral(real from, real to) const {
        real sum = (to - from) * (constant + slope * (0.5 * (from + to) - origin));
        // cos(a) - cos(b) without cancellation
        const real half = 0.5 * frequency * (to - from),
                   middle = frequency * (0.5 * (from + to) - origin) + phase;
        if (amplitude != 0)
            sum += amplitude * std::sin(middle) * (half == 0 ? to - from : 2 * std::sin(half) / frequency);
        return sum;
    }

    // Adds `weight` times the Taylor coefficients about t to c[0..order].
    void add_taylor(real t, real weight, int order, real* c) const {
        const real s = t - origin;
        c[0] += weight * (constant + slope * s);
        if (order > 0) c[1] += weight * slope;
        if (amplitude == 0) return;
        real even = weight * amplitude * std::sin(frequency * s + phase);
        real odd = weight * amplitude * frequency * std::cos(frequency * s + phase);
        const real minus_square = -frequency * frequency;
        for (int n = 0; n <= order; n += 2) {
            c[n] += even;
            if (n + 1 <= order) c[n + 1] += odd;
            even *= minus_square / ((n + 1) * (n + 2));
            odd *= minus_square / ((n + 2) * (n + 3));
        }
    }
};

struct Signal {
    enum class Kind { half_sine, harmonic, record, constant };

    Kind kind = Kind::harmonic;
    real amplitude = 0, frequency = 0, phase = 0; // N or m/s^2, rad/s, rad
    real start = 0, stop = infinity;              // s
    Table times, values;                          // record only

    // Returns the piece that is valid from t to the next knot.
    Piece piece(real t) const {
        Piece p;
        if (kind == Kind::record) {
            const real* last = times.data + times.size;
            const auto after = static_cast<int>(std::upper_bound(times.data, last, t) - times.data);
            if (after == 0 || after == times.size) return p;
            p.origin = times[after - 1];
            p.constant = values[after - 1];
            p.slope = (values[after] - values[after - 1]) / (times[after] - times[after - 1]);
            return p;
        }
        if (kind == Kind::constant) {
            p.constant = amplitude;
            return p;
        }
        if (t < start || t >= stop) return p;
        p.origin = kind == Kind::half_sine ? start : 0;
        p.amplitude = amplitude;
        p.frequency = frequency;
        p.phase = phase;
        return p;
    }

    real value(real t) const { return piece(t).value(t); }

    // Returns the largest magnitude of the values at any time.
    real largest() const {
        real most = std::fabs(amplitude);
        for (int i = 0; kind == Kind::record && i < values.size; ++i)
            most = std::fmax(most, std::fabs(values[i]));
        return most;
    }

    // Returns the mean over an interval.
    real mean(real from, real to) const {
        real sum = 0;
        for (real begin = from, end; begin < to; begin = end) {
            end = std::min(next_knot(begin), to);
            sum += piece(begin).integral(begin, end);
        }
        return sum / (to - from);
    }

    // Returns the value for a time step around t. For a record it is the mean over the step, because its
    // knots may be closer together than the steps and no impulse may be lost.
    real step_value(real t, real dt) const {
        real from = t, to = t;
        if (kind == Kind::record) {
            from = std::max(t - 0.5 * dt, std::max(times[0], real{}));
            to = std::min(t + 0.5 * dt, times[times.size - 1]);
        }
        if (!(from < to)) return piece(t).value(t);
        real sum = 0;
        for (real begin = from, end; begin < to; begin = end) {
            end = std::min(next_knot(begin), to);
            sum += (end - begin) * piece(begin).value(0.5 * (begin + end));
        }
        return sum / (to - from);
    }

    // Returns the first knot after t.
    real next_knot(real t) const {
        if (kind == Kind::record) {
            const real* last = times.data + times.size;
            const real* after = std::upper_bound(times.data, last, t);
            return after == last ? infinity : *after;
        }
        if (kind == Kind::constant) return infinity;
        if (t < start) return start;
        return t < stop ? stop : infinity;
    }
};

} // namespace rattlebox
