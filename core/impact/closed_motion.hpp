// Motion of the closed soft contacts: the integrated state at the start and at the end of a step of DOP853
// (math/dop853.hpp), the scales of its errors, and events within a step.
//
// Events: M. Dowell, P. Jarratt, BIT 11 (1971) 168, doi:10.1007/BF01934364 (the Illinois algorithm).
#pragma once

#include "impact/run_state.hpp"
#include "math/dop853.hpp"

namespace rattlebox {

struct ClosedMotion {
    RunState& run;
    const Problem& problem;
    Dop853 integrator;
    std::vector<real> y, trial, partial, scale; // start, end, a point within the step; permitted errors
    real deepest = 0;                           // scale of the overlaps
    real permitted_error = 0;                   // energy error that counts as permitted in one step [J]

    explicit ClosedMotion(RunState& run_state) : run(run_state), problem(run_state.problem) {}

    std::size_t clock() const { return run.system.time_index(); }

    // Collects the integrated state from bodies and contacts.
    void load() {
        run.system.start(run.loads, run.state.t);
        const std::size_t n = run.system.size();
        y.assign(n, 0.0);
        std::copy(run.state.y.begin(), run.state.y.end(), y.begin());
        for (std::size_t j = 0; j < run.system.active.size(); ++j)
            y[run.system.x_index(j)] = run.system.active[j].x;
        trial.resize(n);
        partial.resize(n);
        integrator.resize(static_cast<int>(n));
    }

    // Makes a step of this length from y. Each evaluation within a step is a step, so that nothing is
    // interpolated.
    void step(real length, std::vector<real>& out) {
        integrator.step(run.system, y.data(), length, out.data());
    }

    // Copies the integrated state y; adds the losses in dashpots to the ledger and the log.
    void unload() {
        std::copy_n(y.begin(), run.state.y.size(), run.state.y.begin());
        const std::size_t at = run.system.time_index();
        run.state.t += y[at];
        run.ledger.load_work += y[at + 1];
        run.ledger.base_work += y[at + 2];
        run.ledger.viscous += y[at + 3];
        for (std::size_t j = 0; j < run.system.active.size(); ++j) {
            Active& a = run.system.active[j];
            a.x = y[run.system.x_index(j)];
            const real lost = y[run.system.x_index(j) + 1];
            run.ledger.normal[run.damper_of(a.contact)] += lost;
            run.result.impacts[static_cast<std::size_t>(a.impact)].energy_lost += lost;
        }
    }

    // Returns the rounding error of a gap.
    real gap_rounding(int c, const real* y) const {
        const Contact& k = run.contact(c);
        if (k.above == ground)
            return contact_gap_rounding * std::fmax(stop_terms(problem, k, y, run.state.t), deepest);
        const Damper& damper = problem.dampers[run.damper_of(c)];
        const real* at = positions(problem, y);
        real size = damper.clearance + std::fabs(gap(problem, k, y).value);
        for (int ball : {k.below, k.above}) size += std::fabs(ball == wall ? cavity(damper, y).q : at[ball]);
        return contact_gap_rounding * std::fmax(size, deepest);
    }

    // Returns x at the largest overlap that follows from the approach speed.
    real expected_x(const Active& a) const {
        return run.contact(a.contact).normal.visit(
            [&](const auto& law) { return std::sqrt(std::sqrt(law.overlap_scale(a.speed))); });
    }

    real contact_speed() const {
        real speed = 0;
        for (const Active& a : run.system.active) speed = std::max(speed, a.speed);
        return speed;
    }

    // Sets the scales of errors to the speeds and overlaps of the contacts, at least to rounding errors.
    void set_scales() {
        const real tolerance = problem.settings.tolerance;
        scale.assign(run.system.size(), infinity);
        real speed = 0, largest = 0;
        const auto depth = [&](const Active& a) { return std::max(expected_x(a), std::fabs(a.x)); };
        for (const Active& a : run.system.active) {
            speed = std::max(speed, a.speed);
            largest = std::max(largest, depth(a));
        }
        deepest = square(square(largest));
        run.largest_overlap = std::fmax(run.largest_overlap, deepest);
        permitted_error = 0;
        for (std::size_t j = 0; j < run.system.active.size(); ++j) {
            const Active& a = run.system.active[j];
            // A contact that starts from rest has no scale of its own.
            const real size = std::max(depth(a), scale_from_rest * largest);
            scale[run.system.x_index(j)] = std::fmax(tolerance * size, x_rounding(a, depth(a)));
            permitted_error += error_of(a, depth(a));
        }
        if (run.system.active.empty())
            for (std::size_t i = 0; i < problem.motion_size(); ++i)
                speed = std::max(speed, std::fabs(run.state.y[i]));
        if (speed == 0) speed = 1;
        const auto bound = [&](real size, real v) {
            return std::fmax(tolerance * size, epsilon * std::fabs(v));
        };
        const real* v = velocities(problem, y.data());
        real* ball = scale.data() + 2 * problem.modes.size() + problem.ball_mass.size();
        for (std::size_t i = 0; i < problem.ball_mass.size(); ++i) ball[i] = bound(speed, v[i]);
        for (std::size_t k = 0; k < problem.modes.size(); ++k) {
            real shape = 0;
            for (const Damper& damper : problem.dampers) shape = std::max(shape, std::fabs(damper.shape[k]));
            scale[2 * k + 1] = bound(shape > 0 ? speed / shape : speed, y[2 * k + 1]);
        }
    }

    // Returns where, in a step of length h from y, a function changes from `before` (>= 0) to <= 0: the far
    // end of a bracket of size `part` x h, by default rounding, by regula falsi with the Illinois
    // modification. Each evaluation is a step of the integrator, so that nothing is interpolated.
    template <class F> real locate(real h, real before, real after, F&& f, real part = event_part) {
        real low = 0, high = h, f_low = before, f_high = after;
        int side = 0;
        for (int iteration = 0; iteration < 80 && f_high != 0; ++iteration) {
            real next = (low * f_high - high * f_low) / (f_high - f_low);
            const real width = high - low,
                       edge = 1e-3 * width * std::fabs(f_high) / (std::fabs(f_high) + std::fabs(f_low));
            if (iteration % 3 == 2)
                next += edge; // beyond the root, so that the bracket shrinks from both ends
            if (!(next > low && next < high) || iteration > 20) next = low + 0.5 * width;
            if (width <= part * h) break;
            step(next, partial);
            const real value = f(partial.data());
            if (value > 0) {
                low = next;
                f_low = value;
                if (side == 1) f_high *= 0.5;
                side = 1;
            } else {
                high = next;
                f_high = value;
                if (side == -1) f_low *= 0.5;
                side = -1;
            }
        }
        return high;
    }

    real phase_margin(const real* y, std::size_t j) const {
        const Active& a = run.system.active[j];
        const real rate = run.system.approach(y, a.contact);
        return run.contact(a.contact).normal.visit(
            [&](const auto& law) { return phase_end(law, a.state, y[run.system.x_index(j)], rate); });
    }

    real overlap_of(const real* y, std::size_t j) const {
        return run.system.active[j].state.origin() + square(square(y[run.system.x_index(j)]));
    }

    Span smooth_span_at(std::size_t j, real overlap) const {
        const Active& a = run.system.active[j];
        return run.contact(a.contact).normal.visit(
            [&](const auto& law) { return smooth_span(law, a.state, overlap); });
    }

    // Whether the phase of the contact ends at some overlap.
    bool has_end(std::size_t j) const {
        const Active& a = run.system.active[j];
        return run.contact(a.contact).normal.visit([&](const auto& law) {
            return std::decay_t<decltype(law)>::hysteretic && a.state.phase != ContactState::yielding;
        });
    }

    // Positive while the force of a released contact is not certain to be repulsive. Without the margin for
    // rounding, contacts could close and be released again at the same time.
    real release_margin(const real* y, const Released& r) const {
        const Gap g = gap(problem, run.contact(r.contact), y);
        const real overlap = -g.value - r.state.origin() - gap_rounding(r.contact, y);
        if (overlap <= 0) return 1;
        const real x = std::sqrt(std::sqrt(overlap));
        return -run.contact(r.contact).normal.visit(
            [&](const auto& law) { return contact_force(law, r.state, x, -g.rate).total; });
    }

private:
    // Returns the error of x that the rounding errors of the velocities cause during the contact.
    real x_rounding(const Active& a, real depth) const {
        if (a.speed == 0 || depth == 0) return 0;
        const Contact& k = run.contact(a.contact);
        real size = 0;
        for (int side : {k.below, k.above})
            size = std::fmax(
                size, std::fabs(side == wall ? cavity(problem.dampers[run.damper_of(a.contact)], y.data()).p
                                             : of_body(velocities(problem, y.data()), side)));
        const real x = expected_x(a);
        return 0.25 * epsilon * size / a.speed * x * cube(x / depth);
    }

    // Returns the energy error of a step whose speed and overlap are wrong by the tolerance: in m V^2 / 2,
    // and in the stored energy, which grows at most with the power 10 of x.
    real error_of(const Active& a, real depth) const {
        const Contact& k = run.contact(a.contact);
        const real stored = k.normal.visit([&](const auto& law) {
            const real deepest = std::sqrt(std::sqrt(last_overlap(law, a.state) - a.state.origin()));
            return stored_energy(law, a.state, std::fmin(depth, deepest));
        });
        return run.resolution() * (k.mass * square(a.speed) + 10 * stored);
    }
};

} // namespace rattlebox
