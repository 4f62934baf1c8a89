// The frame of a cavity that turns about an axis that is fixed in the machine.
//
// Positions, velocities and spins of the particles are relative to the cavity and have components along its
// axes, so that contacts and their springs turn with it and need no other equations. Free motion is computed
// in the machine frame, where it is a straight line: with the distance r = R + x from the axis and the
// absolute velocity V = x' + W x r in components of the cavity, a step is
//
//     half a kick:  V += dt/2 a      drift:  r = Q^T (r + dt V),  V = Q^T V      half a kick
//
// Q is the rotation in the step, computed from the angle and not from the speed. Centrifugal, Coriolis and
// Euler terms are thus exact for any motion of the axis, and order 2 and the energy balance are those of
// velocity Verlet.
//
// The velocity of the points of the cavity is that of their central difference, sin(angle of a step) / dt
// times r. With the true speed, a particle at rest in the cavity would have a sliding velocity of
// W r (W dt)^2 / 6.
#pragma once

#include <algorithm>

#include "dem/structure.hpp"
#include "util/field.hpp"

namespace rattlebox::dem {

// Angle of a cavity: cubic polynomials of time between knots, and a sine.
//
//     angle = a + b s + c s^2 + d s^3 + amplitude sin(frequency t + phase)      s = t - knot
struct Rotation {
    Row axis{};                     // unit vector; zero if the cavity does not turn
    Row arm{};                      // from the axis to the centre of the cavity, at angle 0
    bool carries_structure = false; // whether mode shapes have components along the axes of the cavity
    Table knots, coefficients;      // times; a, b, c and d of each
    real amplitude = 0, frequency = 0, phase = 0;

    bool turns() const { return dot(axis, axis) > 0; }

    // Returns the number of the polynomial that is valid after time t.
    int piece(real t) const {
        const real* last = knots.data + knots.size;
        return std::max(0, static_cast<int>(std::upper_bound(knots.data, last, t) - knots.data) - 1);
    }
    const real* polynomial(int k) const { return coefficients.data + 4 * k; }

    real angle(real t) const {
        const int k = piece(t);
        const real* c = polynomial(k);
        const real s = t - knots[k];
        return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + amplitude * std::sin(frequency * t + phase);
    }
    real speed(real t) const {
        const int k = piece(t);
        const real* c = polynomial(k);
        const real s = t - knots[k];
        return c[1] + s * (2 * c[2] + s * 3 * c[3]) + amplitude * frequency * std::cos(frequency * t + phase);
    }
    // Returns the change of the angle in a time, without the cancellation of a difference.
    real turned(real from, real duration) const {
        real sum = amplitude * 2 * std::cos(frequency * (from + 0.5 * duration) + phase) *
                   std::sin(0.5 * frequency * duration);
        for (real done = 0; done < duration;) {
            const int k = piece(from + done);
            const real p = from + done - knots[k];
            real length = duration - done;
            if (k + 1 < knots.size)
                length = std::min(length, std::max(knots[k + 1] - knots[k] - p, 1e-9 * duration));
            const real *c = polynomial(k), q = p + length;
            sum += length * (c[1] + c[2] * (p + q) + c[3] * (p * p + p * q + q * q));
            done += length;
        }
        return sum;
    }
};

// Motion of a frame at a step and to the next one.
struct FrameStep {
    real angle = 0, speed = 0;    // at the step
    real rate = 0, next_rate = 0; // of the points of the cavity, at the step and the next one
    real sine = 0, versine = 0;   // of the angle to the next step; 1 - cos
    Row body{};                   // acceleration without contacts, in components of the cavity
};

// Position relative to the centre of the cavity at rest, absolute velocity, and absolute spin.
struct AbsoluteMotion {
    Row position, velocity, spin;
};

class Frame {
    const Rotation* rotation_ = nullptr; // of a cavity that turns; else null
    Row axis_{}, arm_{};
    real offset_ = 0; // of the angle, of a run that continues another one

    // Change of a vector by a rotation; the fourth number is zero.
    Row change(Row v, real sine, real versine) const {
        const Row across = (v - axis_ * dot(axis_, v)) * row(1, 1, 1);
        return cross(axis_, v) * sine - across * versine;
    }
    Row turned(Row v, real angle) const {
        const real half = std::sin(0.5 * angle);
        return v + change(v, std::sin(angle), 2 * half * half);
    }

    static real rate(real back, real on, real dt) { return (std::sin(back) + std::sin(on)) / (2 * dt); }
    void set_next(real t, real dt, real on) {
        const real half = std::sin(0.5 * on);
        now.angle = rotation_->angle(t) + offset_, now.speed = rotation_->speed(t);
        now.next_rate = rate(on, rotation_->turned(t + dt, dt), dt);
        now.sine = std::sin(on), now.versine = 2 * half * half;
        now.body = Row{};
    }

public:
    FrameStep before, now; // the last step whose forces are known, and the next one
    real drive_work = 0;   // J

    void start(const Rotation& rotation) {
        if (rotation.turns()) rotation_ = &rotation, axis_ = rotation.axis, arm_ = rotation.arm;
    }
    bool turns() const { return rotation_; }
    Row axis() const { return axis_; }

    // Sets the motion at the step at time t.
    void set(real t, real dt) {
        const real back = rotation_->turned(t - dt, dt), on = rotation_->turned(t, dt);
        now.rate = rate(back, on, dt);
        set_next(t, dt, on);
    }
    void advance(real t, real dt) {
        before = now;
        // The same bits as before, since velocities have been predicted with them.
        now.rate = before.next_rate;
        set_next(t, dt, rotation_->turned(t, dt));
    }
    // Sets the motion anew at the last step, at time t, which continues at the same angle.
    void restart(real t, real dt) {
        offset_ = before.angle - rotation_->angle(t);
        set(t, dt);
    }

    // ---- the machine frame; a frame that does not turn returns its arguments

    Row to_machine(Row v) const { return turns() ? turned(v, now.angle) : v; }
    Row to_cavity(Row v) const { return turns() ? turned(v, -now.angle) : v; }
    Row to_structure(Row v) const { return turns() && !rotation_->carries_structure ? to_machine(v) : v; }
    // First moment of a mass about the axis, in the machine frame.
    Row moment_about_axis(Row moment, real mass) const { return to_machine(moment + arm_ * mass); }

    Row radius(Row position) const { return position * row(1, 1, 1) + arm_; } // from the axis
    // Velocity of a point of the cavity whose distance from the axis is r.
    Row point_velocity(Row r, real rate) const { return cross(axis_, r) * rate; }

    // Returns the motion of a cavity, given by the structure, in components of the cavity.
    CavityMotion moved(const CavityMotion& m) const {
        if (!turns() || rotation_->carries_structure) return m;
        const Row displacement = to_cavity(m.displacement);
        return {displacement, to_cavity(m.velocity) - point_velocity(displacement, now.rate)};
    }

    // Power of the drive against the force and moment (about the centre) on a cavity that has moved by
    // `displacement`. The structure moves the axis, unless the cavity carries it.
    real drive_power(Row force, Row moment, Row displacement) const {
        const Row arm = radius(rotation_->carries_structure ? displacement : Row{});
        return -now.rate * dot(axis_, moment + cross(arm, force));
    }

    // ---- a step

    // Change of a vector that is fixed in the machine, in components of the cavity, to the next step or back.
    Row ahead(Row v, const FrameStep& step) const { return change(v, -step.sine, step.versine); }
    Row back(Row v, const FrameStep& step) const { return change(v, step.sine, step.versine); }
    Row body_ahead(const FrameStep& step) const { return step.body + ahead(step.body, step); }

    // Returns a particle to the last step from the next one, which was predicted from it. `rates` are the
    // accelerations predicted for the next step, and those of the last one afterwards.
    template <class Rates> AbsoluteMotion undo(Row x, Row u, Row w, Rates& rates, real dt) const {
        const Row xyz = row(1, 1, 1), half = xyz * (0.5 * dt), r = radius(x);
        Row v = xyz * u + point_velocity(r, before.next_rate) - half * rates.velocity,
            spin = xyz * w + axis_ * before.next_rate - half * rates.spin;
        v += back(v, before), spin += back(spin, before);
        rates.velocity += before.body - body_ahead(before);
        return {xyz * x + back(r, before) - 2 * half * v, v - half * rates.velocity,
                spin - half * rates.spin};
    }

    template <class Archive> void serialize(Archive& a) { a(before, now, offset_, drive_work); }
    bool is_finite() const {
        real sum = offset_ + drive_work;
        for (const FrameStep* s : {&before, &now})
            sum +=
                s->angle + s->speed + s->rate + s->next_rate + s->sine + s->versine + dot(s->body, s->body);
        return std::fabs(sum) < infinity;
    }
};

} // namespace rattlebox::dem
