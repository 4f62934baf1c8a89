// One mode of a linear structure, q'' + 2 decay q' + stiffness q = 0, propagated exactly.
//
//     q(s) = C q0 + S (p0 + a q0)        p(s) = C p0 - S (k q0 + a p0)
//     C = exp(-a s) cos(w s),  S = exp(-a s) sin(w s) / w,  w^2 = k - a^2
//
// with cosh and sinh for w^2 < 0 and their limit for w = 0, so that rigid-body, undamped, critical and
// overdamped modes are all the same formula. Loads are added in structure/cell.hpp.
#pragma once

#include "base/quadrature.hpp"
#include "base/real.hpp"

namespace rattlebox {

struct Mode {
    real decay = 0;     // a, 1/s
    real stiffness = 0; // k = omega^2, 1/s^2

    // A bound on the magnitude of both characteristic roots.
    real rate() const {
        const real discriminant = decay * decay - stiffness;
        return discriminant > 0 ? decay + std::sqrt(discriminant) : std::sqrt(stiffness);
    }
};

struct ModeState {
    real q = 0, p = 0; // displacement, velocity

    real energy(const Mode& mode) const { return 0.5 * (p * p + mode.stiffness * q * q); }
};

class FreeMode {
    Mode mode_;
    ModeState start_;
    real root_ = 0;          // |w|
    real q_slope_, p_slope_; // what S multiplies in q and in p
    enum class Regime { oscillating, confluent, decaying } regime_;

public:
    FreeMode(const Mode& mode, const ModeState& start)
        : mode_(mode), start_(start), q_slope_(start.p + mode.decay * start.q),
          p_slope_(-(mode.stiffness * start.q + mode.decay * start.p)) {
        const real square_of_root = mode.stiffness - mode.decay * mode.decay;
        regime_ = square_of_root > 0   ? Regime::oscillating
                  : square_of_root < 0 ? Regime::decaying
                                       : Regime::confluent;
        root_ = std::sqrt(std::fabs(square_of_root));
    }

    ModeState at(real s) const {
        const real a = mode_.decay;
        real c, sine;
        if (regime_ == Regime::oscillating) {
            const real shrink = a == 0 ? 1.0 : std::exp(-a * s);
            c = shrink * std::cos(root_ * s);
            sine = shrink * std::sin(root_ * s) / root_;
        } else if (regime_ == Regime::confluent) {
            c = std::exp(-a * s);
            sine = c * s;
        } else {
            const real slow = std::exp(-mode_.stiffness / (root_ + a) * s);
            const real lost = -std::expm1(-2 * root_ * s);
            c = slow * (1 - 0.5 * lost);
            sine = slow * lost / (2 * root_);
        }
        return {c * start_.q + sine * q_slope_, c * start_.p + sine * p_slope_};
    }

    // Energy lost to viscous damping, the integral of 2 a p^2 over [0, s].
    real dissipated(real s) const {
        const real a = mode_.decay;
        if (a == 0 || s == 0) return 0;
        if (regime_ == Regime::oscillating && root_ > 0.05 * a) {
            // p = exp(-a s) (B cos + D sin): the mean part and the part at twice the frequency.
            const real b = start_.p, d = p_slope_ / root_;
            const real shrink = std::exp(-2 * a * s);
            const real mean = -std::expm1(-2 * a * s) / (2 * a);
            const real cosine = shrink * std::cos(2 * root_ * s), sine = shrink * std::sin(2 * root_ * s);
            const real norm = 0.5 / (a * a + root_ * root_);
            const real even = norm * (a * (1 - cosine) + root_ * sine);
            const real odd = norm * (root_ * (1 - cosine) - a * sine);
            return a * ((b * b + d * d) * mean + (b * b - d * d) * even + 2 * b * d * odd);
        }
        // Sums of decaying exponentials: intervals that double in length follow them.
        real total = 0, from = 0, length = 1 / mode_.rate();
        while (from < s) {
            const real to = from + length < s ? from + length : s;
            total += integrate(to - from, [&](real r) { return square(at(from + r).p); });
            length = from = to;
        }
        return 2 * a * total;
    }

    // |q''| stays below this: the energy of a free mode never rises.
    real acceleration_bound() const {
        return std::sqrt(2 * start_.energy(mode_)) * (std::sqrt(mode_.stiffness) + 2 * mode_.decay);
    }
};

} // namespace rattlebox
