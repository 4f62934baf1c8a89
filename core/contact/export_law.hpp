// Exports a normal law of another package, so that `rattlebox.load_law` adds it to the engines:
//
//     #include "contact/export_law.hpp"
//     struct MyLaw { ... };            // as in core/contact/normal, without history
//     RATTLEBOX_EXPORT_NORMAL_LAW(MyLaw)
//
// The law is checked by the same concepts as those of the core.
#pragma once

#include <iterator>

#include "contact/complete.hpp"
#include "contact/external_table.hpp"

namespace rattlebox {

// Own to each library: laws of the same name in two of them must not be merged.
namespace {

template <class Law>
concept ConstantEnding = requires {
    std::bool_constant<Law::zero_overlap != 0>{};
    std::bool_constant<Law::tangential_share != 0>{};
};

template <class Law> struct ExportedLaw : NormalEntry<Law> {
    static_assert(ConstantEnding<Law>, "zero_overlap and tangential_share must be static constexpr");
    static_assert(!Law::hysteretic,
                  "a law with history must be added to the core: see \"How to add a contact law\"");
    static_assert(std::size(Law::fields) <= RATTLEBOX_NORMAL_LAW_COEFFICIENTS,
                  "a law has at most 8 coefficients");
    static constexpr int count = std::size(Law::fields);
    static constexpr real zero_overlap = Law::zero_overlap, tangential_share = Law::tangential_share;

    // Fields of the law in the order of the table: the stiffness, the effective mass, and then the others.
    struct Order {
        int of[count] = {};
        const char* names[count] = {};
        constexpr Order() {
            int next = 2;
            for (int i = 0; i < count; ++i) {
                const auto member = Law::fields[i].member;
                const int slot = member == &Law::stiffness ? 0 : member == &Law::mass ? 1 : next++;
                of[slot] = i, names[slot] = Law::fields[i].name;
            }
        }
    };
    static constexpr Order order{};

    static Law law(const double* numbers) {
        Law result;
        for (int slot = 0; slot < count; ++slot) result.*Law::fields[order.of[slot]].member = numbers[slot];
        return result;
    }

    static void force(const double* numbers, int n, const double* stiffness, const double* second,
                      const double* overlap, const double* root, const double* fourth_root,
                      const double* rate, double* total, double* elastic) {
        const Law own = law(numbers);
        for (int i = 0; i < n; ++i) {
            const NormalForce<real> f = own.force(Coefficients<real>{stiffness[i], second[i]},
                                                  Depth<real>{overlap[i], root[i], fourth_root[i]}, rate[i]);
            total[i] = f.total, elastic[i] = f.elastic;
        }
    }
    static void stored(const double* numbers, int n, const double* stiffness, const double* second,
                       const double* overlap, const double* root, const double* fourth_root, double* energy) {
        const Law own = law(numbers);
        for (int i = 0; i < n; ++i)
            energy[i] = own.stored(Coefficients<real>{stiffness[i], second[i]},
                                   Depth<real>{overlap[i], root[i], fourth_root[i]});
    }
    static void coefficients(const double* numbers, double damping, double speed, double* stiffness,
                             double* second) {
        const Coefficients<real> k = law(numbers).coefficients(damping, speed);
        *stiffness = k.stiffness, *second = k.second;
    }
    static void resized(const double* numbers, double radius, double mass, double new_radius, double new_mass,
                        double* new_law) {
        const Law other = law(numbers).resized({radius, mass}, {new_radius, new_mass});
        for (int slot = 0; slot < count; ++slot) new_law[slot] = other.*Law::fields[order.of[slot]].member;
    }

    static constexpr RattleboxNormalLaw table = {
        RATTLEBOX_NORMAL_LAW_VERSION,
        count,
        Law::name,
        order.names,
        zero_overlap,
        tangential_share,
        force,
        stored,
        [](const double* c) -> double { return law(c).dashpot_exponent(); },
        [](const double* c) -> int { return law(c).needs_restitution(); },
        [](const double* c, double e) -> double { return law(c).damping(e); },
        [](const double* c, double damping, double speed) -> double {
            return law(c).damping_ratio(damping, speed);
        },
        coefficients,
        resized,
        [](const double* c, double speed) -> double { return law(c).overlap_scale(speed); },
        [](const double* c, double speed) -> double { return law(c).largest_overlap(speed); },
        [](const double* c, double speed) -> double { return law(c).contact_time(speed); },
        [](const double* c, const double* other) -> int { return law(c).same_shape(law(other)); }};
};

} // namespace

} // namespace rattlebox

#ifdef _WIN32
#define RATTLEBOX_VISIBLE __declspec(dllexport)
#else
#define RATTLEBOX_VISIBLE __attribute__((visibility("default")))
#endif

#define RATTLEBOX_EXPORT_NORMAL_LAW(Law)                                                                     \
    extern "C" RATTLEBOX_VISIBLE const RattleboxNormalLaw* rattlebox_normal_law() {                          \
        return &::rattlebox::ExportedLaw<Law>::table;                                                        \
    }
