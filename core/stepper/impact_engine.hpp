// The 1-D engine, advanced in steps.
#pragma once

#include "impact/trajectory.hpp"
#include "stepper/engine.hpp"

namespace rattlebox {

// The problem is a base so that it exists before the trajectory, which refers to it.
class ImpactEngine : PackedCase<Problem>, Trajectory, public StepEngine {
    Extremes extremes_;

    // Keeps the impacts in the log that are not complete.
    void forget_impacts() {
        for (const Impact& impact : result_.impacts) {
            const auto c = static_cast<std::size_t>(impact.contact);
            extremes_.overlap[c] = std::fmax(extremes_.overlap[c], impact.peak_overlap);
            extremes_.speed[c] = std::fmax(extremes_.speed[c], impact.approach_speed);
        }
        std::vector<Impact> kept;
        const auto keep = [&](int& index) {
            if (index < 0) return;
            kept.push_back(result_.impacts[static_cast<std::size_t>(index)]);
            index = static_cast<int>(kept.size()) - 1;
        };
        for (Active& a : system_.active) keep(a.impact);
        for (Released& r : released_) keep(r.impact);
        result_.impacts = std::move(kept);
    }

    void sample(real until) {
        problem.sample_times.assign(1, until);
        next_sample_ = 0;
        result_.samples = Samples{};
    }

public:
    explicit ImpactEngine(PackedCase<Problem>&& packed)
        : PackedCase<Problem>(std::move(packed)), Trajectory(problem) {
        extremes_.overlap.assign(problem.contacts.size(), 0), extremes_.speed = extremes_.overlap;
        until_ = 0;
        sample(0);
        find_touching();
        clear_contact_samples();
        record(0, state_, sampled_);
    }

    const Component& component() const override { return PackedCase<Problem>::component; }
    int axes() const override { return 1; }
    int inputs() const override { return static_cast<int>(problem.loads.size()); }
    bool is_base(int input) const override { return problem.loads[static_cast<std::size_t>(input)].base; }
    Components input_direction(int) const override { return {1, 0, 0}; }
    Components gravity() const override {
        return {problem.dampers.empty() ? 0 : problem.dampers[0].gravity, 0, 0};
    }
    void set_gravity(Components g) override {
        for (Damper& damper : problem.dampers) damper.gravity = g[0];
    }

    Status advance(real length, const real* inputs) override {
        for (std::size_t l = 0; l < problem.loads.size(); ++l) problem.loads[l].signal.amplitude = inputs[l];
        loads_.advance(state_.t);
        until_ = state_.t + length;
        sample(until_);
        result_.counts = Counts{};
        Trajectory::advance();
        forget_impacts();
        if (running() && result_.samples.time.empty()) fail(Status::not_finite);
        return result_.status;
    }

    Extremes extremes() const override { return extremes_; }

    StepEnd end() const override {
        StepEnd e;
        const Samples& s = result_.samples;
        const real* y = s.state.data();
        for (std::size_t k = 0; k < problem.modes.size(); ++k) {
            const ModeState mode{y[2 * k], y[2 * k + 1]};
            e.displacement.push_back(mode.q), e.velocity.push_back(mode.p);
            e.kinetic += 0.5 * mode.p * mode.p;
            e.elastic += 0.5 * problem.modes[k].stiffness * mode.q * mode.q;
        }
        e.dampers.resize(problem.dampers.size());
        const real *x = positions(problem, y), *v = velocities(problem, y);
        for (std::size_t i = 0; i < problem.ball_mass.size(); ++i) {
            const auto d = static_cast<std::size_t>(problem.ball_damper[i]);
            const real m = problem.ball_mass[i];
            DamperSums& sums = e.dampers[d];
            sums.mass += m, sums.momentum[0] += m * v[i], sums.mass_moment[0] += m * x[i];
            e.kinetic += 0.5 * m * v[i] * v[i];
            e.potential -= problem.dampers[d].gravity * m * x[i];
        }
        e.work = s.load_work.back() + s.base_work.back(), e.loss = s.viscous.back();
        for (std::size_t d = 0; d < problem.dampers.size(); ++d)
            e.elastic += s.stored[d], e.loss += s.normal[d] + s.plastic[d];
        return e;
    }

    template <class Archive> void serialize(Archive& archive) {
        Trajectory::serialize(archive);
        Samples& s = result_.samples;
        archive(s.time, s.given, s.state, s.load_work, s.base_work, s.viscous, s.normal, s.plastic, s.stored,
                s.force);
        for (Damper& damper : problem.dampers) archive(damper.gravity);
        archive(extremes_.overlap, extremes_.speed);
    }
    void save(Writer& writer) override { serialize(writer); }
    void restore(Reader& reader) override { serialize(reader); }
};

} // namespace rattlebox
