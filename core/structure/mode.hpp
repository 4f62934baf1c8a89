// One mode of a linear structure, q'' + 2 decay q' + stiffness q = 0, propagated exactly.
//
//     q(s) = C q0 + S (p0 + a q0)        p(s) = C p0 - S (k q0 + a p0)
//     C = exp(-a s) cos(w s),  S = exp(-a s) sin(w s) / w,  w^2 = k - a^2
//
// with cosh and sinh for w^2 < 0 and the limit for w = 0, which covers rigid-body, undamped, critically
// damped and overdamped modes. Loads are added in structure/taylor_series.hpp.
#pragma once

#include "math/quadrature.hpp"
#include "math/real.hpp"

namespace rattlebox {

struct Mode {
    real decay = 0;     // a, 1/s
    real stiffness = 0; // k = omega^2, 1/s^2

    // Returns a bound of the magnitude of both characteristic roots.
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
    real root_ = 0;                  // |w|
    real q_slope_ = 0, p_slope_ = 0; // factors of S in q and in p
    enum class Regime { oscillating, confluent, decaying } regime_;

    // exp(-a s) = 1 - lost, cos(w s) and sin(w s) at the last s that was evaluated.
    struct Factors {
        real s = 0, lost = 0, cosine = 1, sine = 0;
    };
    mutable Factors factors_;

    const Factors& factors(real s) const {
        if (s != factors_.s)
            factors_ = {s, -std::expm1(-mode_.decay * s), std::cos(root_ * s), std::sin(root_ * s)};
        return factors_;
    }

public:
    explicit FreeMode(const Mode& mode) : mode_(mode) {
        const real square_of_root = mode.stiffness - mode.decay * mode.decay;
        regime_ = square_of_root > 0   ? Regime::oscillating
                  : square_of_root < 0 ? Regime::decaying
                                       : Regime::confluent;
        root_ = std::sqrt(std::fabs(square_of_root));
    }

    void start(const ModeState& start) {
        start_ = start;
        q_slope_ = start.p + mode_.decay * start.q;
        p_slope_ = -(mode_.stiffness * start.q + mode_.decay * start.p);
    }

    ModeState at(real s) const {
        const real a = mode_.decay;
        real c, sine;
        if (regime_ == Regime::oscillating) {
            const Factors& f = factors(s);
            c = (1 - f.lost) * f.cosine;
            sine = (1 - f.lost) * f.sine / root_;
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
            const Factors& f = factors(s);
            const real decay_factor = 1 - f.lost, decayed = f.lost * (1 + decay_factor); // 1 - exp(-2 a s)
            const real turned = decayed + 2 * square(decay_factor * f.sine); // 1 - exp(-2 a s) cos(2 w s)
            const real sine = 2 * square(decay_factor) * f.sine * f.cosine;
            const real norm = 0.5 / mode_.stiffness; // = a^2 + w^2
            const real even = norm * (a * turned + root_ * sine);
            const real odd = norm * (root_ * turned - a * sine);
            return 0.5 * (b * b + d * d) * decayed + a * ((b * b - d * d) * even + 2 * b * d * odd);
        }
        // Sums of decaying exponentials: quadrature on intervals that double in length.
        real total = 0, from = 0, length = 1 / mode_.rate();
        while (from < s) {
            const real to = from + length < s ? from + length : s;
            total += integrate(to - from, [&](real r) { return square(at(from + r).p); });
            length = from = to;
        }
        return 2 * a * total;
    }

    // Computes bounds of |q''| and |q'''|. The energy of a free mode never increases.
    void bounds(real& acceleration, real& jerk) const {
        const real speed = std::sqrt(2 * start_.energy(mode_));
        acceleration = speed * (std::sqrt(mode_.stiffness) + 2 * mode_.decay);
        jerk = 2 * mode_.decay * acceleration + mode_.stiffness * speed;
    }
};

} // namespace rattlebox
