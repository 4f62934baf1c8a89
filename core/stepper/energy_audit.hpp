// The energy balance of a stepper, checked at the end of each step: E - E_0 = W - L.
//
// E = kinetic, elastic and potential energy, W = work, L = loss. The imbalance is compared with the energy
// put in, as at the end of a run: the energy of the motion at the start, the largest work so far, and the
// largest change of the potential energy.
#pragma once

#include "impact/problem.hpp"
#include "stepper/engine.hpp"

namespace rattlebox {

class EnergyAudit {
    real origin_ = 0, potential_ = 0;         // E_0, and its potential part
    real put_in_ = 0, work_ = 0, change_ = 0; // energy of the motion at the start, and largest values so far
    real handled_ = 0, mass_ = 0, worst_ = 0;

    static real total(const StepEnd& e) { return e.kinetic + e.elastic + e.potential; }

public:
    static constexpr real limit = worst_energy_residual;

    EnergyAudit() = default;
    explicit EnergyAudit(const StepEnd& start)
        : origin_(total(start)), potential_(start.potential), put_in_(start.kinetic + start.elastic) {
        for (const DamperSums& damper : start.dampers) mass_ += damper.mass;
    }

    // The potential energy has another zero from now on.
    void shift(real potential) { origin_ += potential, potential_ += potential; }

    // Returns whether the balance holds at the end of a step. NaN does not hold.
    bool holds(const StepEnd& e) {
        work_ = std::fmax(work_, std::fabs(e.work));
        change_ = std::fmax(change_, std::fabs(e.potential - potential_));
        handled_ =
            std::fmax(handled_, e.kinetic + e.elastic + std::fabs(e.potential) + std::fabs(e.work) + e.loss);
        const real imbalance = std::fabs(total(e) - origin_ - e.work + e.loss),
                   reference = put_in_ + work_ + change_;
        const real rounding = 1e-10 * handled_ + mass_ * square(speed_at_rest);
        if (imbalance > rounding) worst_ = std::fmax(worst_, imbalance / reference);
        return imbalance <= std::fmax(limit * reference, rounding);
    }

    // The largest imbalance beyond rounding over the energy put in.
    real worst() const { return worst_; }

    template <class Archive> void serialize(Archive& archive) {
        archive(origin_, potential_, put_in_, work_, change_, handled_, mass_, worst_);
    }
};

} // namespace rattlebox
