// A run of the 1-D engine in a window, as util/measures.hpp needs it for measures.
#pragma once

#include <array>
#include <complex>
#include <optional>

#include "impact/batch.hpp"
#include "impact/result.hpp"
#include "structure/coupled_modes.hpp"
#include "util/measures.hpp"

namespace rattlebox {

// Largest number of batches of which the interval of a mean is computed.
inline constexpr std::size_t most_batches = 64;

class Observer {
    const Problem& problem_;
    const Result& run_;
    const Window& window_;
    std::size_t first_, count_; // samples that are evaluated

    const Samples& samples() const { return run_.samples; }
    std::size_t balls() const { return problem_.ball_mass.size(); }

    real sum(const std::vector<real>& by_damper, std::size_t i) const {
        real total = 0;
        const std::size_t d = problem_.dampers.size();
        for (std::size_t k = 0; k < d; ++k) total += by_damper[(first_ + i) * d + k];
        return total;
    }

public:
    static constexpr bool is_even = true; // equally spaced samples

    Observer(const Problem& problem, const Result& run, const Window& window)
        : problem_(problem), run_(run), window_(window), first_(0), count_(run.samples.time.size()) {}

    // The same run between two samples, both included.
    Observer part(std::size_t first, std::size_t last) const {
        Observer result = *this;
        result.first_ = first_ + first, result.count_ = last - first + 1;
        return result;
    }

    std::size_t count() const { return count_; }
    std::size_t last() const { return count() - 1; }
    real time(std::size_t i) const { return samples().time[first_ + i]; }
    const real* state(std::size_t i) const {
        return samples().state.data() + (first_ + i) * problem_.state_size();
    }
    real length() const { return time(last()) - time(0); }
    real cycles() const { return length() / window_.period; }

    // ---- motion of the observed point

    ModeState point(std::size_t i) const { return along(window_.shape, i); }

    ModeState along(const std::vector<real>& shape, std::size_t i) const {
        ModeState z;
        const real* y = state(i);
        for (std::size_t k = 0; k < shape.size(); ++k) {
            z.q += shape[k] * y[2 * k];
            z.p += shape[k] * y[2 * k + 1];
        }
        return z;
    }

    // Acceleration of the base, mean over the interval before sample i.
    real mean_base_acceleration(std::size_t i) const {
        real base = 0;
        for (const Load& load : problem_.loads)
            if (load.base) base += load.signal.mean(time(i - 1), time(i));
        return base;
    }

    // Acceleration of the point at the start and the end of the step before sample i. Springs, dashpots,
    // harmonic loads and the base act with their values at these times. Contacts and other loads, whose
    // pulses may be shorter than the step, act with their mean over the step. A mean of the whole, the
    // difference of the velocities, would lack (pi f dt)^2 / 6 of a motion of frequency f.
    std::array<real, 2> accelerations(std::size_t i, Frame frame) const {
        const std::vector<real>& shape = window_.shape;
        const std::size_t m = shape.size();
        const auto along = [&](const std::vector<real>& other) {
            real sum = 0;
            for (std::size_t k = 0; k < m; ++k) sum += shape[k] * other[k];
            return sum;
        };
        real mean = 0;
        each_contact_force(i, [&](std::size_t damper, real force) {
            mean += force * along(problem_.dampers[damper].shape);
        });
        for (std::size_t stop = 0; stop < static_cast<std::size_t>(problem_.stop_count); ++stop)
            mean -= mean_stop_force(stop, i) * along(problem_.dampers[problem_.first_stop() + stop].shape);
        std::array<real, 2> result{};
        for (std::size_t end = 0; end < 2; ++end) {
            const real* y = state(i - 1 + end);
            const auto speed = [&](std::size_t k) { return y[2 * k + 1]; };
            for (std::size_t k = 0; k < m; ++k)
                result[end] -= shape[k] * (2 * problem_.modes[k].decay * speed(k) +
                                           problem_.modes[k].stiffness * y[2 * k]);
            if (m > 0)
                couple(problem_.coupling, m, speed,
                       [&](std::size_t k, real sum) { result[end] += shape[k] * sum; });
        }
        for (const Load& load : problem_.loads) {
            const real weight =
                along(load.shape) + (load.base && frame == Frame::absolute ? window_.base : 0);
            if (!load.base && load.signal.kind != Signal::Kind::harmonic) {
                mean += weight * load.signal.mean(time(i - 1), time(i));
                continue;
            }
            for (std::size_t end = 0; end < 2; ++end)
                result[end] += weight * load.signal.value(time(i - 1 + end));
        }
        for (real& each : result) each += mean;
        return result;
    }

    // Calls f with the damper and the force of each ball on its cavity, mean over the interval before sample
    // i, from the change of its momentum. Balls that touch each other exchange momentum within one damper.
    template <class F> void each_contact_force(std::size_t i, F&& f) const {
        const real *v0 = velocities(problem_, state(i - 1)), *v1 = velocities(problem_, state(i));
        const real base = mean_base_acceleration(i), step = time(i) - time(i - 1);
        for (std::size_t b = 0; b < balls(); ++b) {
            const auto damper = static_cast<std::size_t>(problem_.ball_damper[b]);
            f(damper,
              -problem_.ball_mass[b] * ((v1[b] - v0[b]) / step + base - problem_.dampers[damper].gravity));
        }
    }

    // Contact force of a stop, mean over the interval before sample i.
    real mean_stop_force(std::size_t stop, std::size_t i) const {
        const std::size_t at = problem_.motion_size() + stop;
        return (state(i)[at] - state(i - 1)[at]) / (time(i) - time(i - 1));
    }

    real mean_damper_force(std::size_t i) const {
        real force = 0;
        each_contact_force(i, [&](std::size_t, real each) { force += each; });
        return force;
    }

    // Force of the structure on the base at sample i, in springs and dashpots and by the residual mass, and
    // at stops, there as mean over the interval before the sample. NaN if the participation is unknown or
    // nothing moves.
    real interface_force(std::size_t i) const {
        const std::size_t m = problem_.modes.size();
        if (window_.participation.empty() || m == 0) return not_a_number;
        const real* y = state(i);
        real force = 0;
        const auto speed = [&](std::size_t k) { return y[2 * k + 1]; };
        for (std::size_t k = 0; k < m; ++k)
            force += window_.participation[k] *
                     (2 * problem_.modes[k].decay * speed(k) + problem_.modes[k].stiffness * y[2 * k]);
        couple(problem_.coupling, m, speed,
               [&](std::size_t k, real sum) { force -= window_.participation[k] * sum; });
        for (const Load& load : problem_.loads) {
            if (!load.base) continue;
            real value[1] = {0};
            load.signal.piece(time(i)).add_taylor(time(i), 1, 0, value);
            force -= window_.residual_mass * value[0];
        }
        for (std::size_t stop = 0; i > 0 && stop < static_cast<std::size_t>(problem_.stop_count); ++stop)
            force += problem_.dampers[problem_.first_stop() + stop].base * mean_stop_force(stop, i);
        return force;
    }

    // ---- energy

    real gravity(std::size_t i) const {
        const real* s = positions(problem_, state(i));
        real total = 0;
        for (std::size_t b = 0; b < balls(); ++b)
            total -= problem_.ball_mass[b] *
                     problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[b])].gravity * s[b];
        return total;
    }
    real motion(std::size_t i) const {
        const real *y = state(i), *v = velocities(problem_, y);
        real total = sum(samples().stored, i);
        for (std::size_t k = 0; k < problem_.modes.size(); ++k)
            total += ModeState{y[2 * k], y[2 * k + 1]}.energy(problem_.modes[k]);
        for (std::size_t b = 0; b < balls(); ++b) total += 0.5 * problem_.ball_mass[b] * square(v[b]);
        return total;
    }
    real since_begin(const std::vector<real>& total, std::size_t i) const {
        return total[first_ + i] - total[first_];
    }
    real load_work(std::size_t i) const { return since_begin(samples().load_work, i); }
    real base_work(std::size_t i) const { return since_begin(samples().base_work, i); }
    real viscous(std::size_t i) const { return since_begin(samples().viscous, i); }
    real impact(std::size_t i) const {
        return sum(samples().normal, i) - sum(samples().normal, 0) + sum(samples().plastic, i) -
               sum(samples().plastic, 0);
    }
    // Sum of all terms of the balance, whose rounding errors the residual contains.
    real handled(std::size_t i, real moving, real potential) const {
        return moving + std::fabs(potential) + samples().viscous[first_ + i] +
               std::fabs(samples().load_work[first_ + i]) + std::fabs(samples().base_work[first_ + i]);
    }

    // Returns the status of a run that reached its end. A residual at rounding level is no error if little
    // energy was supplied.
    Status end(real bound) const {
        const Balance b = balance(*this);
        if (!std::isfinite(b.residual)) return Status::not_finite;
        real floor = run_.rounding(problem_.settings) * b.turnover;
        for (real mass : problem_.ball_mass) floor += mass * square(speed_at_rest);
        for (const Contact& contact : problem_.contacts)
            if (contact.above == ground) floor += contact.mass * square(speed_at_rest);
        // Hard contacts permit no error but the rounding of the work of held stops.
        if (problem_.settings.method == Method::newton) floor += run_.permitted_error;
        const real permitted =
            std::fmin(bound * b.supplied + run_.permitted_error, worst_energy_residual * b.supplied);
        const bool open = b.residual > permitted && b.residual > floor;
        return open ? Status::energy_error : Status::finished;
    }

    // ---- impacts

    ImpactSums impacts() const {
        ImpactSums sums;
        const bool to_the_end = first_ + count_ == samples().time.size();
        const real from = first_ == 0 ? window_.from : time(0);
        for (const Impact& i : run_.impacts)
            if (i.time >= from && (to_the_end || i.time < time(last()))) sums.add(i);
        return sums;
    }

    // ---- apparent mass of the damper: force on the balls over the acceleration of their cavity, at the
    // frequency of the window

    // The last whole number of cycles, from `begin` to the last sample.
    struct Cycles {
        real begin = 0;
        std::size_t first = 0; // last sample up to `begin`
    };
    Cycles whole_cycles() const {
        constexpr real slack = 1e-9;
        const real n = std::floor(cycles() + slack);
        Cycles w{std::fmax(time(last()) - n * window_.period, time(0)), 0};
        while (w.first + 1 < last() && time(w.first + 1) <= w.begin + slack * window_.period) ++w.first;
        return w;
    }

    // Cubic Hermite interpolation between two samples.
    template <class F> ModeState between(F&& f, std::size_t i, real t) const {
        const real h = time(i + 1) - time(i), x = (t - time(i)) / h;
        const ModeState a = f(i), b = f(i + 1);
        const real slope = (b.q - a.q) / h, bend = a.p + b.p - 2 * slope, turn = 3 * slope - 2 * a.p - b.p;
        return {a.q + h * x * (a.p + x * (turn + x * bend)), a.p + x * (2 * turn + x * 3 * bend)};
    }

    // First harmonic of a function with known derivative: 2/T times the integral of f exp(-i w t) over whole
    // cycles, by Hermite (corrected trapezoidal) quadrature.
    template <class F> std::complex<real> first_harmonic(F&& f) const {
        const real w = 2 * pi / window_.period;
        const Cycles cycles = whole_cycles();
        struct Product {
            std::complex<real> value, derivative;
        };
        const auto product = [&](ModeState s, real t) {
            const std::complex<real> turn = std::exp(std::complex<real>(0, -w * t));
            return Product{s.q * turn, (s.p - std::complex<real>(0, w * s.q)) * turn};
        };
        std::complex<real> total = 0;
        real t = cycles.begin;
        Product before = product(between(f, cycles.first, t), t);
        for (std::size_t i = cycles.first + 1; i <= last(); ++i) {
            const real h = time(i) - t;
            t = time(i);
            const Product here = product(f(i), t);
            total +=
                0.5 * h * (before.value + here.value) + h * h / 12 * (before.derivative - here.derivative);
            before = here;
        }
        return 2.0 / (time(last()) - cycles.begin) * total;
    }

    // Complex amplitude of an acceleration, by integration by parts, because positions have no jumps at hard
    // impacts.
    template <class F> std::complex<real> acceleration(F&& f) const {
        const real w = 2 * pi / window_.period;
        const Cycles cycles = whole_cycles();
        const ModeState begin = between(f, cycles.first, cycles.begin), end = f(last());
        const std::complex<real> jump = (end.p - begin.p + std::complex<real>(0, w * (end.q - begin.q))) *
                                        std::exp(std::complex<real>(0, -w * cycles.begin));
        return 2.0 / (time(last()) - cycles.begin) * jump - square(w) * first_harmonic(f);
    }

    std::complex<real> base() const {
        return first_harmonic([&](std::size_t i) {
            ModeState sum;
            for (const Load& load : problem_.loads) {
                if (!load.base) continue;
                real taylor[2] = {0, 0};
                load.signal.piece(time(i)).add_taylor(time(i), 1, 1, taylor);
                sum.q += taylor[0], sum.p += taylor[1];
            }
            return sum;
        });
    }

    std::complex<real> cavity_acceleration(const Damper& damper) const {
        return base() + acceleration([&](std::size_t i) { return along(damper.shape, i); });
    }

    std::complex<real> apparent_mass() const {
        if (!has_dampers()) return 0;
        std::complex<real> power = 0;
        const std::complex<real> base_acceleration = base();
        for (std::size_t b = 0; b < balls(); ++b) {
            const auto ball = [&](std::size_t i) {
                return ModeState{positions(problem_, state(i))[b], velocities(problem_, state(i))[b]};
            };
            const Damper& damper = problem_.dampers[static_cast<std::size_t>(problem_.ball_damper[b])];
            power += problem_.ball_mass[b] * (base_acceleration + acceleration(ball)) *
                     std::conj(cavity_acceleration(damper));
        }
        return power / std::norm(cavity_acceleration(problem_.dampers[0]));
    }

    real mass() const {
        real total = 0;
        for (real m : problem_.ball_mass) total += m;
        return total;
    }

    // Amplitude of the velocity of the first cavity.
    real cavity_speed() const {
        return std::abs(cavity_acceleration(problem_.dampers[0])) * window_.period / (2 * pi);
    }

    bool has_dampers() const { return balls() > 0; }
    real loss_per_cycle() const { return impact(last()) / cycles(); }

    // ---- batches: equal parts of the window, of whole cycles if it has cycles, up to its end

    // Number of batches; 0 if the window holds no whole cycle.
    std::size_t batches() const {
        constexpr real most = most_batches;
        if (std::isnan(window_.period)) return most_batches;
        const real whole = std::floor(cycles() + 1e-9);
        return whole < 1 ? 0 : static_cast<std::size_t>(std::floor(whole / std::ceil(whole / most)));
    }

    // Batch k of n; the samples next to its limits are included. Empty if the samples are too few.
    std::optional<Observer> batch(std::size_t k, std::size_t n) const {
        if (last() < n) return {};
        const real step = length() / static_cast<real>(last());
        const real whole = std::floor(cycles() + 1e-9);
        const real each = std::isnan(window_.period)
                              ? length() / static_cast<real>(n)
                              : std::floor(whole / static_cast<real>(n)) * window_.period;
        const real end = static_cast<real>(last()) - static_cast<real>(n - 1 - k) * each / step;
        const real begin = std::fmax(end - each / step, 0);
        constexpr real slack = 1e-6; // of a sample step
        const auto to = static_cast<std::size_t>(std::ceil(end - slack));
        return part(static_cast<std::size_t>(std::floor(begin + slack)), std::min(to, last()));
    }
};

} // namespace rattlebox
