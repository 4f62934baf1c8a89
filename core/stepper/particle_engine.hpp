// The 3-D engine, advanced in steps that are divided into equal time steps of the engine.
#pragma once

#include "dem/simulation.hpp"
#include "stepper/engine.hpp"

namespace rattlebox {

class ParticleEngine : public StepEngine {
    std::deque<std::vector<real>> tables_;
    Component component_;
    dem::Simulation simulation_;
    std::vector<dem::RestartCheck> restart_check_;
    real longest_step_;
    Row gravity_;
    dem::StructureWork work_;
    StepEnd end_;

    static Components components(Row r) { return {r[0], r[1], r[2]}; }

    // Angular momentum about the centre of the cavity, from the state at the last step.
    Components angular_momentum(const dem::Bed& bed) const {
        const real dt = simulation_.problem().dt;
        const Row body = simulation_.output_body_acceleration();
        Row sum{};
        for (int i = 0; i < bed.particles(); ++i) {
            const bool touched = at(bed.touched, i);
            const Row u = at(bed.velocity, i), w = at(bed.spin, i), x = at(bed.position, i);
            const Row a = touched ? at(bed.rates, i).velocity : body;
            const Row v = u - a * row(dt), position = x - (v + a * row(0.5 * dt)) * row(dt);
            sum += cross(position - bed.output_displacement, v) / row(u[3]);
            Row spin = w;
            if (touched) spin -= at(bed.rates, i).spin * row(dt);
            sum += spin * row(x[3] / w[3]); // moment of inertia
        }
        return components(sum);
    }

    void read_end() {
        const dem::Records& r = simulation_.records();
        const dem::Problem& problem = simulation_.problem();
        const std::size_t loads = problem.loads.size(), modes = problem.modes.size(),
                          cavities = simulation_.beds().size();
        const auto last = [](const std::vector<real>& values, std::size_t n) {
            return std::vector<real>(values.end() - static_cast<std::ptrdiff_t>(n), values.end());
        };
        work_ = {last(r.load_work, loads), last(r.base_work, loads), last(r.viscous, modes)};
        end_ = StepEnd{};
        end_.displacement = last(r.q, modes), end_.velocity = last(r.p, modes);
        for (std::size_t m = 0; m < modes; ++m) {
            end_.kinetic += 0.5 * square(end_.velocity[m]);
            end_.elastic += 0.5 * problem.modes[m].stiffness * square(end_.displacement[m]);
            end_.loss += work_.viscous[m];
        }
        for (std::size_t l = 0; l < loads; ++l) end_.work += work_.load[l] + work_.base[l];
        for (const auto* losses : {&r.normal, &r.plastic, &r.sliding, &r.rolling})
            for (const real lost : last(*losses, 2 * cavities)) end_.loss += lost;
        const auto kinetic = last(r.kinetic, cavities), rotation = last(r.rotation, cavities),
                   stored = last(r.stored, cavities), potential = last(r.potential, cavities),
                   centre = last(r.centre, 3 * cavities), momentum = last(r.momentum, 3 * cavities);
        for (std::size_t c = 0; c < cavities; ++c) {
            end_.kinetic += kinetic[c] + rotation[c];
            end_.elastic += stored[c], end_.potential += potential[c];
            const dem::Bed& bed = simulation_.beds()[c];
            DamperSums sums{.mass = bed.mass};
            for (std::size_t a = 0; a < 3; ++a) {
                sums.momentum[a] = momentum[3 * c + a];
                sums.mass_moment[a] = centre[3 * c + a] * bed.mass;
            }
            sums.angular_momentum = angular_momentum(bed);
            end_.dampers.push_back(sums);
        }
        simulation_.records() = dem::Records{};
    }

    Status run(const std::atomic<bool>& stop) {
        const long last = simulation_.problem().steps;
        simulation_.run(last, 1, stop);
        if (simulation_.status() != Status::finished) return simulation_.status();
        if (simulation_.step() <= last) return Status::interrupted;
        read_end();
        return Status::finished;
    }

public:
    explicit ParticleEngine(PackedCase<dem::Problem>&& packed)
        : tables_(std::move(packed.tables)), component_(std::move(packed.component)),
          simulation_(std::move(packed.problem)), restart_check_(simulation_.restart_check()),
          longest_step_(simulation_.problem().dt), gravity_(simulation_.problem().gravity) {
        const Status status = run(std::atomic<bool>{false});
        if (status != Status::finished)
            throw std::invalid_argument(std::string("the case cannot start: ") + stop_reason(status));
    }

    const Component& component() const override { return component_; }
    int axes() const override { return 3; }
    int inputs() const override { return static_cast<int>(simulation_.problem().loads.size()); }
    bool is_base(int input) const override {
        return simulation_.problem().loads[static_cast<std::size_t>(input)].base;
    }
    Components input_direction(int input) const override {
        return components(simulation_.problem().load_direction[static_cast<std::size_t>(input)]);
    }
    Components gravity() const override { return components(gravity_); }
    bool set_gravity(Components g) override {
        const bool changed = g != components(gravity_);
        gravity_ = row(g[0], g[1], g[2]);
        return changed;
    }

    Status advance(real length, const real* inputs, const std::atomic<bool>& stop) override {
        const real parts = std::ceil(length / longest_step_ * (1 - 1e-12));
        if (!(parts < 1e15)) return Status::too_many_events;
        const long steps = std::max(1L, static_cast<long>(parts));
        simulation_.change_inputs(length / static_cast<real>(steps), steps, gravity_,
                                  {inputs, inputs + this->inputs()}, work_);
        return run(stop);
    }

    real computing_time(real length) const override {
        constexpr real for_one = 2e-7; // for a particle and a step; measured
        real particles = 0;
        for (const dem::Bed& bed : simulation_.beds()) particles += bed.particles();
        return for_one * particles * length / longest_step_;
    }

    Stop stop() const override {
        const dem::StopReason& reason = simulation_.stop_reason();
        if (reason.status == Status::finished) return {};
        return {simulation_.stopped_cavity(), reason.particle, reason.value};
    }

    StepEnd end() const override { return end_; }

    Extremes extremes() const override {
        Extremes result;
        for (const dem::Bed& bed : simulation_.beds()) {
            real overlap = 0, speed = 0;
            for (const dem::Chunk& chunk : bed.chunks) {
                overlap = std::fmax(overlap, chunk.diagnostics.largest_overlap.ratio());
                speed = std::fmax(speed, chunk.diagnostics.largest_approach_speed);
            }
            result.overlap.push_back(overlap), result.speed.push_back(speed);
        }
        return result;
    }

    template <class Archive> void serialize(Archive& archive) {
        archive(longest_step_, gravity_, work_.load, work_.base, work_.viscous);
        simulation_.serialize_inputs(archive);
    }
    void save(Writer& writer) override {
        serialize(writer);
        simulation_.serialize(writer);
    }
    void restore(Reader& reader) override {
        serialize(reader);
        if (!(longest_step_ > 0 && longest_step_ < infinity) ||
            work_.load.size() != simulation_.problem().loads.size() ||
            work_.base.size() != work_.load.size() ||
            work_.viscous.size() != simulation_.problem().modes.size())
            throw std::invalid_argument("the state is damaged");
        simulation_.restore(reader, restart_check_);
    }
    void go_back(Reader& reader) override {
        serialize(reader);
        simulation_.go_back(reader);
    }
};

} // namespace rattlebox
