// Coulomb friction with a linear tangential spring and dashpot.
//
//     k_t = stiffness + ratio k      |F_t| <= mu N
//
// k = stiffness of the linear normal contact of the pair [N/m]. The history is in
// contact/tangential/spring_slider.hpp.
//
// P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.
#pragma once

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct LinearSpring {
    real friction = 0;         // mu
    real spring_stiffness = 0; // N/m
    real ratio = 0;            // over the stiffness of the normal contact
    real damping = 1;          // damping ratio over that of the normal dashpot

    static constexpr const char* name = "spring";
    static constexpr Field<LinearSpring> fields[] = {{"friction", &LinearSpring::friction},
                                                     {"stiffness", &LinearSpring::spring_stiffness},
                                                     {"ratio", &LinearSpring::ratio},
                                                     {"damping", &LinearSpring::damping}};

    real coefficient(PairSize, real normal_stiffness) const {
        return spring_stiffness + ratio * normal_stiffness;
    }
    template <class T> RATTLEBOX_INLINE static T stiffness(const T& coefficient, const Depth<T>&) {
        return coefficient;
    }
    template <class T> RATTLEBOX_INLINE static T dashpot(const T& coefficient, const Depth<T>&) {
        return coefficient;
    }
};

} // namespace rattlebox
