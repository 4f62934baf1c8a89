// One step of DOP853, the explicit Runge-Kutta method of order 8 with error estimates of orders 5 and 3, for
// autonomous systems.
//
// E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
// section II.10, doi:10.1007/978-3-540-78862-1.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "math/real.hpp"

namespace rattlebox {

namespace dop853 {

inline constexpr int stages = 12;

inline constexpr real a[12][11] = {
    {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.05260015195876773, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.0197250569845379, 0.0591751709536137, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.02958758547680685, 0.0, 0.08876275643042054, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.2413651341592667, 0.0, -0.8845494793282861, 0.924834003261792, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.037037037037037035, 0.0, 0.0, 0.17082860872947386, 0.12546768756682242, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.037109375, 0.0, 0.0, 0.17025221101954405, 0.06021653898045596, -0.017578125, 0.0, 0.0, 0.0, 0.0, 0.0},
    {0.03709200011850479, 0.0, 0.0, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402,
     0.008273789163814023, 0.0, 0.0, 0.0, 0.0},
    {0.6241109587160757, 0.0, 0.0, -3.3608926294469414, -0.868219346841726, 27.59209969944671,
     20.154067550477894, -43.48988418106996, 0.0, 0.0, 0.0},
    {0.47766253643826434, 0.0, 0.0, -2.4881146199716677, -0.590290826836843, 21.230051448181193,
     15.279233632882423, -33.28821096898486, -0.020331201708508627, 0.0, 0.0},
    {-0.9371424300859873, 0.0, 0.0, 5.186372428844064, 1.0914373489967295, -8.149787010746927,
     -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196, 0.0},
    {2.273310147516538, 0.0, 0.0, -10.53449546673725, -2.0008720582248625, -17.9589318631188,
     27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636}};

inline constexpr real b[12] = {0.054293734116568765,
                               0.0,
                               0.0,
                               0.0,
                               0.0,
                               4.450312892752409,
                               1.8915178993145003,
                               -5.801203960010585,
                               0.3111643669578199,
                               -0.1521609496625161,
                               0.20136540080403034,
                               0.04471061572777259};

inline constexpr real error3[12] = {-0.18980075407240762,
                                    0.0,
                                    0.0,
                                    0.0,
                                    0.0,
                                    4.450312892752409,
                                    1.8915178993145003,
                                    -5.801203960010585,
                                    -0.4226823213237919,
                                    -0.1521609496625161,
                                    0.20136540080403034,
                                    0.02265179219836082};

inline constexpr real error5[12] = {0.01312004499419488,
                                    0.0,
                                    0.0,
                                    0.0,
                                    0.0,
                                    -1.2251564463762044,
                                    -0.4957589496572502,
                                    1.6643771824549864,
                                    -0.35032884874997366,
                                    0.3341791187130175,
                                    0.08192320648511571,
                                    -0.022355307863886294};

} // namespace dop853

// Workspace and one step for y' = f(y); `derivative_of(y, dy)` computes the derivative.
class Dop853 {
    int size_ = 0;
    std::vector<real> k_; // the twelve stages, one after the other
    std::vector<real> stage_;

    real* k(int i) { return k_.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(size_); }

    template <const real (&row)[11], int count, std::size_t... j>
    void combine_row(const real* y, real h, std::index_sequence<j...>) {
        const real* base = k_.data();
        const int n = size_;
        real* out = stage_.data();
        for (int i = 0; i < n; ++i) {
            real sum = 0;
            ((row[j] != 0 ? void(sum += row[j] * base[static_cast<int>(j) * n + i]) : void()), ...);
            out[i] = y[i] + h * sum;
        }
    }

    template <const real (&weights)[12], std::size_t... j>
    static real weighted_sum(const real* base, int n, int i, std::index_sequence<j...>) {
        real sum = 0;
        ((weights[j] != 0 ? void(sum += weights[j] * base[static_cast<int>(j) * n + i]) : void()), ...);
        return sum;
    }

    template <int s, class F> void run_stages(F& derivative_of, const real* y, real h) {
        if constexpr (s < dop853::stages) {
            combine_row<dop853::a[s], s>(y, h, std::make_index_sequence<s>{});
            derivative_of(stage_.data(), k(s));
            run_stages<s + 1>(derivative_of, y, h);
        }
    }

public:
    void resize(int size) {
        size_ = size;
        k_.resize(static_cast<std::size_t>(dop853::stages * size));
        stage_.resize(static_cast<std::size_t>(size));
    }

    // Computes the derivative at y. Must be called once for a new y, before any number of steps from it.
    template <class F> void start(F& derivative_of, const real* y) { derivative_of(y, k(0)); }

    const real* derivative() const { return k_.data(); }

    // y_new = y + one step of length h (of either sign).
    template <class F> void step(F& derivative_of, const real* y, real h, real* y_new) {
        run_stages<1>(derivative_of, y, h);
        for (int i = 0; i < size_; ++i)
            y_new[i] = y[i] + h * weighted_sum<dop853::b>(k_.data(), size_, i,
                                                          std::make_index_sequence<dop853::stages>{});
    }

    // Returns the error of the last step relative to the scales. Components with an infinite scale do not
    // count.
    real error(real h, const std::vector<real>& scale) {
        real sum5 = 0, sum3 = 0;
        int counted = 0;
        for (int i = 0; i < size_; ++i) {
            const real inverse = 1 / scale[static_cast<std::size_t>(i)];
            if (inverse == 0) continue;
            constexpr auto all = std::make_index_sequence<dop853::stages>{};
            sum5 += square(weighted_sum<dop853::error5>(k_.data(), size_, i, all) * inverse);
            sum3 += square(weighted_sum<dop853::error3>(k_.data(), size_, i, all) * inverse);
            ++counted;
        }
        if (sum5 == 0 || counted == 0) return 0;
        return std::fabs(h) * sum5 / std::sqrt((sum5 + 0.01 * sum3) * counted);
    }
};

} // namespace rattlebox
