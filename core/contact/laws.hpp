// The table of laws: one row a law. See docs, "Add a contact law".
#pragma once

#include "base/choice.hpp"
#include "contact/hertz_tsuji.hpp"
#include "contact/linear.hpp"
#include "contact/restitution/constant.hpp"
#include "contact/restitution/jackson_green.hpp"
#include "contact/restitution/johnson.hpp"
#include "contact/restitution/tabulated.hpp"
#include "contact/restitution/thornton.hpp"
#include "contact/thornton.hpp"

namespace rattlebox {

using NormalLaw = Choice<HertzTsuji, LinearDashpot, Thornton>;

using RestitutionLaw = Choice<ConstantRestitution, TabulatedRestitution, JacksonGreenRestitution,
                              ThorntonRestitution, JohnsonRestitution>;

// What a restitution law says of an approach speed.
struct Rebound {
    real e = 1;
    bool outside = false;      // above the law's last valid speed
    bool extrapolated = false; // outside, and used all the same
};

RATTLEBOX_CALL inline Rebound rebound(const RestitutionLaw& law, real speed) {
    return law.visit([&](const auto& l) {
        Rebound r;
        const bool above = speed > l.limit();
        r.outside = above && !l.beyond();
        r.extrapolated = above && l.beyond();
        r.e = std::min(std::max(l.value(speed), 0.0), l.maximum);
        return r;
    });
}

// Can a contact with this law rebound so? To lose all, a dashpot would have to be infinite.
inline bool possible(const NormalLaw& law, const Rebound& r) {
    return law.visit([&](const auto& l) { return !l.needs_restitution() || r.e >= 1e-6; });
}

} // namespace rattlebox
