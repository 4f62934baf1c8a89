// Derivatives of contact laws: of forces, of the coefficients of a closed contact, and of restitution.
#pragma once

#include "impact/tangents.hpp"
#include "math/dual.hpp"

namespace rattlebox {

class TangentLaws {
    Tangents& t_;
    // Whether the formula of the force depends on the numbers that change in a parameter.
    std::vector<char> in_formula_; // by contact and parameter

    void find_formulas() {
        in_formula_.assign(t_.problem.contacts.size() * t_.parameters(), false);
        for (int c = 0; c < t_.problem.contact_count(); ++c)
            for (std::size_t p = 0; p < t_.parameters(); ++p)
                t_.contact(c).normal.visit([&]<class Law>(const Law& law) {
                    const NormalLaw& change = t_.contact_of(t_.slopes[p], c).normal;
                    const real rate = rate_of(law, change);
                    if (rate == 0) return;
                    const Law moved = moved_law(law, change, 1e-3 / rate);
                    ContactState s;
                    s.coefficients = {1, 1}, s.history = {1, 1, 0.25};
                    for (const auto phase :
                         {ContactState::loading, ContactState::yielding, ContactState::unloading})
                        for (const real x : {0.01, 0.1, 0.7}) {
                            s.phase = phase;
                            const auto at = [&](const Law& one) {
                                return evaluate<Law, real>(one, s, s.coefficients, s.history, x, 1.0);
                            };
                            if (at(law) != at(moved))
                                in_formula_[static_cast<std::size_t>(c) * t_.parameters() + p] = true;
                        }
                });
    }

public:
    // Derivatives of the coefficients and the history of a contact, in each direction.
    struct Slopes {
        std::vector<real> stiffness, second, deepest, unloading, origin;
    };
    std::vector<Slopes> slopes; // by contact

    explicit TangentLaws(Tangents& tangents) : t_(tangents), slopes(t_.problem.contacts.size()) {
        for (Slopes& each : slopes)
            for (auto* column : {&each.stiffness, &each.second, &each.deepest, &each.unloading, &each.origin})
                column->assign(t_.count, 0.0);
        find_formulas();
    }

    // Returns the law moved by h in the direction of a parameter.
    template <class Laws, class Law> static Law moved_law(const Law& law, const Laws& slope, real h) {
        Law moved = law;
        const Law& change = *slope.template get_if<Law>();
        for (const auto& field : Law::fields)
            if (change.*field.member != 0) moved.*field.member += h * change.*field.member;
        return moved;
    }

    // Returns the rate at which a law changes in a parameter: its largest relative change.
    template <class Laws, class Law> static real rate_of(const Law& law, const Laws& slope) {
        const Law& change = *slope.template get_if<Law>();
        real rate = 0;
        for (const auto& field : Law::fields)
            if (const real value = law.*field.member, own = change.*field.member; own != 0)
                rate = std::fmax(rate, value != 0 ? std::fabs(own / value) : 1);
        return rate;
    }

    // Returns the derivative of the restitution of an impact in the speed, or in a parameter at a fixed
    // speed. A law is valid on its own side of its limits 0 and `maximum`.
    real restitution_slope(int c, real speed, const Problem* slope) {
        std::array<real, 1> result{};
        const RestitutionLaw& laws = t_.contact(c).restitution;
        const bool smooth = laws.visit([&]<class Law>(const Law& law) {
            const real e = law.value(speed);
            const bool is_cut = e > law.maximum;
            if (e < 0 || (is_cut && !slope)) return true;
            if (!slope)
                return differentiate<1>([&](real h) { return std::array<real, 1>{law.value(speed + h)}; },
                                        1 / speed, result);
            const RestitutionLaw& change = t_.contact_of(*slope, c).restitution;
            return differentiate<1>(
                [&](real h) {
                    const Law moved = moved_law(law, change, h);
                    return std::array<real, 1>{is_cut ? moved.maximum : moved.value(speed)};
                },
                rate_of(law, change), result);
        });
        if (!smooth) t_.refuse(NotLinear::kink, c);
        return result[0];
    }

    static std::array<real, 5> numbers_of(const ContactState& s) {
        return {s.coefficients.stiffness, s.coefficients.second, s.history.deepest, s.history.stiffness,
                s.history.origin};
    }

    // Sets the derivatives of the numbers of a closed contact in all directions: from those in its argument
    // (speed and restitution, or deepest overlap), and in the parameters. state(law, argument, h) computes it
    // with the argument moved by h.
    template <class State>
    void set_law_slopes(int c, const std::vector<real>& argument_slope, real argument, State&& state) {
        Slopes& own = slopes[static_cast<std::size_t>(c)];
        std::vector<real>* columns[] = {&own.stiffness, &own.second, &own.deepest, &own.unloading,
                                        &own.origin};
        t_.contact(c).normal.visit([&]<class Law>(const Law& law) {
            std::array<real, 5> slope{};
            bool smooth = true;
            const bool moves =
                std::any_of(argument_slope.begin(), argument_slope.end(), [](real v) { return v != 0; });
            const auto at = [&](real h) { return numbers_of(state(law, h, nullptr, 0.0)); };
            const bool is_constant =
                moves && argument > 0 && at(0) == at(0.01 * argument) && at(0) == at(-0.01 * argument);
            if (moves && argument > 0 && !is_constant) smooth = differentiate<5>(at, 1 / argument, slope);
            for (std::size_t i = 0; i < 5; ++i)
                for (std::size_t d = 0; d < t_.count; ++d) (*columns[i])[d] = slope[i] * argument_slope[d];
            for (std::size_t p = 0; p < t_.parameters(); ++p) {
                const Contact& change = t_.contact_of(t_.slopes[p], c);
                const real rate = std::fmax(rate_of(law, change.normal),
                                            t_.contact(c).restitution.visit([&](const auto& r) {
                                                return rate_of(r, change.restitution);
                                            }));
                if (rate == 0) continue;
                smooth = differentiate<5>(
                             [&](real h) {
                                 return numbers_of(state(moved_law(law, change.normal, h), 0.0, &change, h));
                             },
                             rate, slope) &&
                         smooth;
                for (std::size_t i = 0; i < 5; ++i) (*columns[i])[t_.size + p] += slope[i];
            }
            if (!smooth) t_.refuse(NotLinear::kink, c);
        });
    }

    // The restitution of a contact whose law is moved in a parameter, on the side of its limits where it is.
    real moved_restitution(int c, real speed, const Contact* change, real h) const {
        return t_.contact(c).restitution.visit([&](const auto& law) {
            const bool is_cut = law.value(speed) > law.maximum;
            const auto moved = change ? moved_law(law, change->restitution, h) : law;
            return is_cut ? moved.maximum : std::fmax(moved.value(speed), 0.0);
        });
    }

    // Force of a closed contact and its derivatives.
    struct Force {
        real total = 0, x = 0, rate = 0, stiffness = 0, second = 0, deepest = 0, unloading = 0, origin = 0;
    };

    template <class Law, class T>
    static T evaluate(const Law& law, const ContactState& s, const Coefficients<T>& k, const History<T>& h,
                      const T& x, const T& rate) {
        const T square = x * x;
        const Depth<T> d{square * square, square, x};
        if constexpr (Law::hysteretic)
            return s.phase == ContactState::loading    ? law.elastic_force(k, d)
                   : s.phase == ContactState::yielding ? law.yielding_force(k, d)
                                                       : law.unloading_force(h, d);
        else
            return law.force(k, d, rate).total;
    }

    template <class Law> static Force force_of(const Law& law, const ContactState& s, real x, real rate) {
        const std::array<real, 5> n = numbers_of(s);
        if constexpr (requires { Law::is_opaque; }) {
            // A formula that is called through a pointer takes plain numbers only.
            Force f;
            f.total = evaluate<Law, real>(law, s, s.coefficients, s.history, x, rate);
            const auto slope = [&](real size, auto&& moved) {
                std::array<real, 1> result{};
                differentiate<1>([&](real h) { return std::array<real, 1>{moved(h)}; }, 1 / size, result);
                return result[0];
            };
            const auto at = [&](real dx, real dr, real dk, real dc) {
                return evaluate<Law, real>(law, s, {n[0] + dk, n[1] + dc}, s.history, x + dx, rate + dr);
            };
            f.x = slope(x, [&](real h) { return at(h, 0, 0, 0); });
            f.rate = slope(rate != 0 ? std::fabs(rate) : 1, [&](real h) { return at(0, h, 0, 0); });
            f.stiffness = slope(n[0] != 0 ? std::fabs(n[0]) : 1, [&](real h) { return at(0, 0, h, 0); });
            f.second = slope(n[1] != 0 ? std::fabs(n[1]) : 1, [&](real h) { return at(0, 0, 0, h); });
            return f;
        } else {
            using T = Dual<7>;
            const T f = evaluate<Law, T>(law, s, {T(n[0], 2), T(n[1], 3)},
                                         {T(n[2], 4), T(n[3], 5), T(n[4], 6)}, T(x, 0), T(rate, 1));
            return {f.value,    f.slope[0], f.slope[1], f.slope[2],
                    f.slope[3], f.slope[4], f.slope[5], f.slope[6]};
        }
    }

    // The derivative of the force in numbers of the law that its formula takes from the law itself.
    template <class Law>
    static real formula_slope(const Law& law, const NormalLaw& change, const ContactState& s, real x,
                              real rate) {
        const real speed = rate_of(law, change);
        if (speed == 0) return 0;
        std::array<real, 1> slope{};
        differentiate<1>(
            [&](real h) {
                return std::array<real, 1>{
                    evaluate<Law, real>(moved_law(law, change, h), s, s.coefficients, s.history, x, rate)};
            },
            speed, slope);
        return slope[0];
    }

    bool is_in_formula(int c, std::size_t p) const {
        return in_formula_[static_cast<std::size_t>(c) * t_.parameters() + p];
    }
};

} // namespace rattlebox
