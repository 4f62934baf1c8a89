// A normal law in a library of another package: a table of functions in the layout of C, which does not
// depend on the compiler, its options or the instruction set of either side.
#pragma once

// `law` are the coefficients of one pair, in the order of `names`.
struct RattleboxNormalLaw {
    int version;              // of this layout
    int count;                // of coefficients
    const char* name;         // of the law
    const char* const* names; // of its coefficients; the stiffness and the effective mass [kg] are the first
    double zero_overlap;      // 1: the contact ends at zero overlap; 0: at zero force
    double tangential_share;  // damping ratio of a tangential dashpot over that of the law

    // n contacts at once, each with its coefficients [the first two arguments], the overlap d [m], d^(1/2),
    // d^(1/4) and the approach rate [m/s]
    void (*force)(const double* law, int n, const double* stiffness, const double* second,
                  const double* overlap, const double* root, const double* fourth_root, const double* rate,
                  double* total, double* elastic);
    void (*stored)(const double* law, int n, const double* stiffness, const double* second,
                   const double* overlap, const double* root, const double* fourth_root, double* energy);

    // The functions of the same names in contact/complete.hpp.
    double (*dashpot_exponent)(const double* law);
    int (*needs_restitution)(const double* law);
    double (*damping)(const double* law, double restitution);
    double (*damping_ratio)(const double* law, double damping, double speed);
    void (*coefficients)(const double* law, double damping, double speed, double* stiffness, double* second);
    void (*resized)(const double* law, double radius, double mass, double new_radius, double new_mass,
                    double* new_law);
    double (*overlap_scale)(const double* law, double speed);
    double (*largest_overlap)(const double* law, double speed);
    double (*contact_time)(const double* law, double speed);
    int (*same_shape)(const double* law, const double* other);
};

#define RATTLEBOX_NORMAL_LAW_VERSION 1
#define RATTLEBOX_NORMAL_LAW_COEFFICIENTS 8 // most of them
