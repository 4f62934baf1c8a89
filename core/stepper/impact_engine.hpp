// The 1-D engine, advanced in steps.
#pragma once

#include "impact/trajectory.hpp"
#include "stepper/engine.hpp"

namespace rattlebox {

// The problem is a base so that it exists before the trajectory, which refers to it.
class ImpactEngine : PackedCase<Problem>, public StepEngine {
    Trajectory trajectory_;
    RunState& run_;
    Extremes extremes_;

    // Throws unless every index and size in a restored state can be one of this case.
    void check_state() const {
        const std::size_t contacts = problem.contacts.size();
        run_.check();
        const bool holds = extremes_.overlap.size() == contacts && extremes_.speed.size() == contacts &&
                           std::all_of(problem.dampers.begin(), problem.dampers.end(),
                                       [](const Damper& d) { return std::fabs(d.gravity) < infinity; });
        if (!holds) throw std::invalid_argument("the state is damaged");
    }

    // Keeps the impacts in the log that are not complete.
    void forget_impacts() {
        for (const Impact& impact : run_.result.impacts) {
            const auto c = static_cast<std::size_t>(impact.contact);
            extremes_.overlap[c] = std::fmax(extremes_.overlap[c], impact.peak_overlap);
            extremes_.speed[c] = std::fmax(extremes_.speed[c], impact.approach_speed);
        }
        run_.result.impacts = run_.take_open_impacts();
    }

    void sample(real until) {
        problem.sample_times.assign(1, until);
        trajectory_.output().rewind();
        run_.result.samples = Samples{};
    }

public:
    explicit ImpactEngine(PackedCase<Problem>&& packed)
        : PackedCase<Problem>(std::move(packed)), trajectory_(problem), run_(trajectory_.run_state()) {
        extremes_.overlap.assign(problem.contacts.size(), 0), extremes_.speed = extremes_.overlap;
        run_.until = 0;
        sample(0);
        trajectory_.find_touching();
        trajectory_.output().record_now();
    }

    const Component& component() const override { return PackedCase<Problem>::component; }
    int axes() const override { return 1; }
    int inputs() const override { return static_cast<int>(problem.loads.size()); }
    bool is_base(int input) const override { return problem.loads[static_cast<std::size_t>(input)].base; }
    Components input_direction(int) const override { return {1, 0, 0}; }
    Components gravity() const override {
        return {problem.dampers.empty() ? 0 : problem.dampers[0].gravity, 0, 0};
    }
    bool set_gravity(Components g) override {
        bool changed = false;
        for (Damper& damper : problem.dampers) {
            changed |= damper.gravity != g[0];
            damper.gravity = g[0];
        }
        return changed;
    }

    Status advance(real length, const real* inputs, const std::atomic<bool>& stop) override {
        for (std::size_t l = 0; l < problem.loads.size(); ++l) problem.loads[l].signal.amplitude = inputs[l];
        run_.loads.advance(run_.state.t);
        run_.until = run_.state.t + length;
        sample(run_.until);
        run_.result.counts = Counts{};
        run_.stop = &stop;
        trajectory_.advance();
        run_.stop = nullptr;
        forget_impacts();
        if (run_.running() && run_.result.samples.time.empty()) run_.fail(Status::not_finite);
        return run_.result.status;
    }

    real computing_time(real length) const override {
        constexpr real for_one = 2; // for a contact and a second, if it touches often
        return for_one * length * static_cast<real>(problem.contacts.size());
    }

    Stop stop() const override {
        if (run_.result.stopped_contact < 0) return {};
        const int damper = run_.contact(run_.result.stopped_contact).damper;
        return {damper,
                run_.result.stopped_contact - problem.dampers[static_cast<std::size_t>(damper)].first_contact,
                run_.result.stopped_value};
    }

    Extremes extremes() const override { return extremes_; }

    StepEnd end() const override {
        StepEnd e;
        const Samples& s = run_.result.samples;
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
        // A stop pushes with the change of the impulse that it has received, as a damper does by its
        // momentum.
        for (std::size_t d = problem.first_stop(); d < problem.dampers.size(); ++d)
            e.dampers[d].momentum[0] = -y[problem.motion_size() + d - problem.first_stop()];
        e.work = s.load_work.back() + s.base_work.back(), e.loss = s.viscous.back();
        for (std::size_t d = 0; d < problem.dampers.size(); ++d)
            e.elastic += s.stored[d], e.loss += s.normal[d] + s.plastic[d];
        return e;
    }

    template <class Archive> void serialize(Archive& archive) {
        trajectory_.serialize(archive);
        for (Damper& damper : problem.dampers) archive(damper.gravity);
        archive(extremes_.overlap, extremes_.speed);
    }
    void save(Writer& writer) override { serialize(writer); }
    void go_back(Reader& reader) override { serialize(reader); }
    void restore(Reader& reader) override {
        serialize(reader);
        check_state();
        if (!reader.at_end()) throw std::invalid_argument("the state is of another case");
    }
};

} // namespace rattlebox
