// Coulomb friction with Mindlin's tangential stiffness.
//
//     k_t = 8 G* sqrt(R* d)      c_t = coefficient d^(1/4)      |F_t| <= mu N
//
// G* = effective shear modulus [Pa], 1/G* = (2 - nu_1)/G_1 + (2 - nu_2)/G_2. The coefficient of the dashpot
// is such that its damping ratio is a multiple of that of the normal dashpot. The history is in
// contact/tangential/spring_slider.hpp.
//
// R. D. Mindlin, J. Appl. Mech. 16 (1949) 259, doi:10.1115/1.4009973.
#pragma once

#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

struct Mindlin {
    real friction = 0;      // mu
    real shear_modulus = 0; // 8 G*, Pa
    real damping = 1;       // damping ratio over that of the normal dashpot

    static constexpr const char* name = "mindlin";
    static constexpr Field<Mindlin> fields[] = {{"friction", &Mindlin::friction},
                                                {"shear_modulus", &Mindlin::shear_modulus},
                                                {"damping", &Mindlin::damping}};

    // Returns B of a contact, k_t = B sqrt(d).
    real coefficient(PairSize size, real) const { return shear_modulus * std::sqrt(size.radius); }
    template <class T> RATTLEBOX_INLINE static T stiffness(const T& coefficient, const Depth<T>& d) {
        return coefficient * d.root;
    }
    template <class T> RATTLEBOX_INLINE static T dashpot(const T& coefficient, const Depth<T>& d) {
        return coefficient * d.fourth_root;
    }
};

} // namespace rattlebox
