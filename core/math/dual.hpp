// Numbers with their derivatives in n directions, for the formulas of the contact laws.
#pragma once

#include <array>
#include <cmath>

#include "math/rows.hpp"

namespace rattlebox {

template <int n> struct Dual {
    real value = 0;
    std::array<real, n> slope{};

    Dual() = default;
    Dual(real number) : value(number) {}
    // A variable: its derivative in direction i is 1.
    Dual(real number, int i) : value(number) { slope[static_cast<std::size_t>(i)] = 1; }
    explicit operator real() const { return value; }

    // The number f of this one, whose derivative at it is `rate`.
    Dual through(real f, real rate) const {
        Dual r(f);
        for (std::size_t i = 0; i < n; ++i) r.slope[i] = rate * slope[i];
        return r;
    }

    friend Dual operator+(Dual a, const Dual& b) {
        a.value += b.value;
        for (std::size_t i = 0; i < n; ++i) a.slope[i] += b.slope[i];
        return a;
    }
    friend Dual operator-(Dual a, const Dual& b) {
        a.value -= b.value;
        for (std::size_t i = 0; i < n; ++i) a.slope[i] -= b.slope[i];
        return a;
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        Dual r(a.value * b.value);
        for (std::size_t i = 0; i < n; ++i) r.slope[i] = a.slope[i] * b.value + a.value * b.slope[i];
        return r;
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        Dual r(a.value / b.value);
        for (std::size_t i = 0; i < n; ++i) r.slope[i] = (a.slope[i] - r.value * b.slope[i]) / b.value;
        return r;
    }
    friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
};

template <int n> Dual<n> all(const Dual<n>&, real v) { return v; }
template <int n> Dual<n> root(const Dual<n>& a) {
    const real r = std::sqrt(a.value);
    return a.through(r, 0.5 / r);
}
template <int n> Dual<n> larger(const Dual<n>& a, const Dual<n>& b) { return a > b ? a : b; }
template <int n> Dual<n> power(const Dual<n>& a, real exponent) {
    return a.through(std::pow(a.value, exponent), exponent * std::pow(a.value, exponent - 1));
}
template <int n, class F> Dual<n> each(const Dual<n>& a, F&& f) { return f(a); }

// Computes the derivatives at 0 of n smooth functions, f(h), which change appreciably over 1 / rate: central
// differences of orders 8 and 6, with a step that is made smaller until both agree, because a function may
// be smooth only close to 0. Returns whether they do.
template <std::size_t n, class F> bool differentiate(F&& f, real rate, std::array<real, n>& slopes) {
    constexpr real first = 0.02, last = 1e-6; // steps; those of the functions that are differences of rounded
    constexpr real eighth[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280},
                   sixth[] = {3.0 / 4, -3.0 / 20, 1.0 / 60, 0};
    slopes.fill(0);
    if (rate == 0) return true;
    const std::array<real, n> now = f(0);
    for (real step = first; step > last; step *= 0.25) {
        const real h = step / rate;
        std::array<real, n> fine{}, coarse{};
        for (int k = 1; k <= 4; ++k) {
            const std::array<real, n> after = f(k * h), before = f(-k * h);
            for (std::size_t i = 0; i < n; ++i) {
                const real difference = (after[i] - before[i]) / h;
                fine[i] += eighth[k - 1] * difference;
                coarse[i] += sixth[k - 1] * difference;
            }
        }
        bool agree = true;
        for (std::size_t i = 0; i < n; ++i) {
            const real rounding = 16 * epsilon * std::fabs(now[i]) / h;
            agree = agree && std::fabs(fine[i] - coarse[i]) <= 1e-9 * std::fabs(fine[i]) + rounding;
        }
        slopes = fine;
        if (agree) return true;
    }
    return false;
}

} // namespace rattlebox
