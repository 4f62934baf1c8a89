// Rolling resistance as an elastic, perfectly plastic spring with a dashpot (type C).
//
//     k_r = ratio R*^2 k_t      |M| <= mu_r R* N
//
// The history is in contact/tangential/spring_slider.hpp, with torques and relative spin in place of forces
// and velocities. Equal and opposite torques act on the two bodies.
//
// J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technology 206 (2011) 269,
// doi:10.1016/j.powtec.2010.09.030.
#pragma once

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct RollingResistance {
    real coefficient = 0; // mu_r
    real stiffness = 0;   // k_r over k_t R*^2
    real damping = 0;     // damping ratio

    static constexpr Field<RollingResistance> fields[] = {{"coefficient", &RollingResistance::coefficient},
                                                          {"stiffness", &RollingResistance::stiffness},
                                                          {"damping", &RollingResistance::damping}};

    // Returns mu_r R*, k_r / k_t and the coefficient of the dashpot of a contact. `inertia` combines the
    // moments of inertia of both bodies about the contact point in series.
    Row coefficients(PairSize size, real inertia, real tangential_coefficient) const {
        const real ratio = stiffness > 0 ? stiffness * square(size.radius) : 1;
        return row(coefficient * size.radius, ratio,
                   2 * damping * std::sqrt(inertia * ratio * tangential_coefficient));
    }
};

} // namespace rattlebox
