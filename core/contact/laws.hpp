// The table of contact laws. See the documentation, "Add a contact law"; contact/complete.hpp lists the
// required parts.
#pragma once

#include "contact/complete.hpp"
#include "contact/normal/external.hpp"
#include "contact/normal/hertz_tsuji.hpp"
#include "contact/normal/linear_dashpot.hpp"
#include "contact/normal/power_law.hpp"
#include "contact/normal/tabulated.hpp"
#include "contact/normal/thornton.hpp"
#include "contact/restitution/constant.hpp"
#include "contact/restitution/jackson_green.hpp"
#include "contact/restitution/johnson.hpp"
#include "contact/restitution/tabulated.hpp"
#include "contact/restitution/thornton.hpp"
#include "contact/rolling/elastic_plastic.hpp"
#include "contact/tangential/linear_spring.hpp"
#include "contact/tangential/mindlin.hpp"

namespace rattlebox {

// clang-format off
using NormalLaw = NormalLaws<
    HertzTsuji,
    LinearDashpot,
    Thornton,
    PowerLaw,
    TabulatedNormal,
    ExternalLaw
>;

using RestitutionLaw = RestitutionLaws<
    ConstantRestitution,
    TabulatedRestitution,
    JacksonGreenRestitution,
    ThorntonRestitution,
    JohnsonRestitution
>;

using TangentialLaw = TangentialLaws<
    Mindlin,
    LinearSpring
>;
// clang-format on

// Restitution at an approach speed.
struct Rebound {
    real e = 1;
    bool outside = false;      // above the largest valid speed, and must not be used
    bool extrapolated = false; // above the largest valid speed, but extrapolation is allowed
};

inline Rebound rebound(const RestitutionLaw& law, real speed) {
    return law.visit([&](const auto& l) {
        Rebound r;
        const bool above = speed > l.limit();
        r.outside = above && !l.beyond();
        r.extrapolated = above && l.beyond();
        r.e = std::min(std::max(l.value(speed), 0.0), l.maximum);
        return r;
    });
}

// Whether a contact with this law can have this restitution. For zero restitution a dashpot would have to be
// infinite.
inline bool possible(const NormalLaw& law, const Rebound& r) {
    return law.visit([&](const auto& l) { return !l.needs_restitution() || r.e >= 1e-6; });
}

} // namespace rattlebox
