// A normal law without history in a library of another package (contact/export_law.hpp is its side).
//
// The formula is called through a pointer, for one contact in the 1-D engine and for a SIMD register of them
// in the 3-D engine. It is therefore not inlined, which costs about as much as the formula itself.
#pragma once

#include <array>
#include <vector>

#include "contact/external_table.hpp"
#include "contact/normal/normal_force.hpp"
#include "util/field.hpp"

namespace rattlebox {

// The laws that were loaded, by their number. They stay until the process ends.
inline std::vector<const RattleboxNormalLaw*>& external_laws() {
    static std::vector<const RattleboxNormalLaw*> laws;
    return laws;
}

struct ExternalLaw {
    static constexpr int most = RATTLEBOX_NORMAL_LAW_COEFFICIENTS;
    using Numbers = std::array<real, most>;

    real stiffness = 0;                                  // in the unit of the law
    real mass = 0;                                       // effective mass, kg
    real c2 = 0, c3 = 0, c4 = 0, c5 = 0, c6 = 0, c7 = 0; // its other coefficients, in its order
    real number = 0;                                     // of the law in external_laws()
    real zero_overlap = 0, tangential_share = 1;         // constants of the law

    static constexpr const char* name = "external";
    static constexpr Field<ExternalLaw> fields[] = {{"stiffness", &ExternalLaw::stiffness},
                                                    {"mass", &ExternalLaw::mass},
                                                    {"c2", &ExternalLaw::c2},
                                                    {"c3", &ExternalLaw::c3},
                                                    {"c4", &ExternalLaw::c4},
                                                    {"c5", &ExternalLaw::c5},
                                                    {"c6", &ExternalLaw::c6},
                                                    {"c7", &ExternalLaw::c7},
                                                    {"number", &ExternalLaw::number},
                                                    {"zero_overlap", &ExternalLaw::zero_overlap},
                                                    {"tangential_share", &ExternalLaw::tangential_share}};
    static constexpr bool hysteretic = false;
    static constexpr bool is_opaque = true; // the formula takes plain numbers only

    bool is_possible() const {
        return number == std::floor(number) && number < static_cast<real>(external_laws().size());
    }
    const RattleboxNormalLaw& table() const { return *external_laws()[static_cast<std::size_t>(number)]; }
    Numbers numbers() const { return {stiffness, mass, c2, c3, c4, c5, c6, c7}; }

    // ---- the formula

    template <class T>
    RATTLEBOX_INLINE NormalForce<T> force(const Coefficients<T>& k, const Depth<T>& d, const T& rate) const {
        constexpr int n = sizeof(T) / sizeof(real); // a register holds nothing but its numbers
        // Copies in memory, to which pointers can be passed.
        const Coefficients<T> own = k;
        const Depth<T> depth = d;
        const T speed = rate;
        NormalForce<T> f{};
        table().force(numbers().data(), n, at(own.stiffness), at(own.second), at(depth.overlap),
                      at(depth.root), at(depth.fourth_root), at(speed), at(f.total), at(f.elastic));
        return f;
    }
    template <class T> RATTLEBOX_INLINE T stored(const Coefficients<T>& k, const Depth<T>& d) const {
        constexpr int n = sizeof(T) / sizeof(real);
        const Coefficients<T> own = k;
        const Depth<T> depth = d;
        T energy{};
        table().stored(numbers().data(), n, at(own.stiffness), at(own.second), at(depth.overlap),
                       at(depth.root), at(depth.fourth_root), at(energy));
        return energy;
    }

private:
    template <class T> static real* at(T& value) { return reinterpret_cast<real*>(&value); }
    template <class T> static const real* at(const T& value) { return reinterpret_cast<const real*>(&value); }

public:
    // ---- one impact

    real dashpot_exponent() const { return table().dashpot_exponent(numbers().data()); }
    bool needs_restitution() const { return table().needs_restitution(numbers().data()) != 0; }
    real damping(real e) const { return table().damping(numbers().data(), e); }
    real damping_ratio(real damping, real speed) const {
        return table().damping_ratio(numbers().data(), damping, speed);
    }
    Coefficients<real> coefficients(real damping, real speed) const {
        Coefficients<real> k;
        table().coefficients(numbers().data(), damping, speed, &k.stiffness, &k.second);
        return k;
    }

    // ---- scales

    ExternalLaw resized(PairSize from, PairSize to) const {
        Numbers c = numbers();
        table().resized(numbers().data(), from.radius, from.mass, to.radius, to.mass, c.data());
        return {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], number, zero_overlap, tangential_share};
    }
    real overlap_scale(real speed) const { return table().overlap_scale(numbers().data(), speed); }
    real largest_overlap(real speed) const { return table().largest_overlap(numbers().data(), speed); }
    real contact_time(real speed) const { return table().contact_time(numbers().data(), speed); }
    bool same_shape(const ExternalLaw& other) const {
        return number == other.number && table().same_shape(numbers().data(), other.numbers().data()) != 0;
    }
};

} // namespace rattlebox
