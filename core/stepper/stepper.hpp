// Dampers as a component in the time loop of another program: one exchange of motion and force in each step.
//
// A damper alone is driven by the acceleration of its attachment, which is constant in a step. Its engine
// works in the frame of the attachment. With v and x the velocity and displacement of the attachment, and P
// and S the sums of m v and m x relative to it, a step of length H from state 0 to state 1 has
//
//     mean force on the attachment     F = -(P1 - P0) / H + M (g - a)
//     mean moment on it                -(L1 - L0) / H + (integral of S) x (g - a) / H
//     energy stored                    E + P v + M v^2 / 2 - M g x
//     work of the attachment           W + change of (P v + M v^2 / 2 - M g x)
//
// where E is the energy relative to the attachment and W the work of the inertial force -m a on it. The
// integral of S is that of the cubic polynomial through S and S' = P at both ends. Dampers with their
// structure are driven by loads; forces then follow from the same balance in the frame of the base.
#pragma once

#include <algorithm>
#include <bit>

#include "stepper/energy_audit.hpp"

namespace rattlebox {

struct StepResult {
    std::vector<Components> force, moment; // mean over the step, by damper; N, N m
    real work = 0, loss = 0;               // of the step, J
    real stored = 0;                       // at the end of the step, J
};

inline const std::atomic<bool> never{false};

class Stepper {
    std::unique_ptr<StepEngine> engine_;
    std::uint64_t case_hash_; // of the packed case and the options
    Options options_;
    real time_ = 0;
    Components velocity_{}, displacement_{}; // of the attachment
    StepEnd end_;
    StepResult result_;
    EnergyAudit audit_;
    // To notice an initial velocity that was forgotten: steps so far whose velocity was given, and the first
    // acceleration and change of velocity.
    std::int64_t velocity_steps_ = 0;
    real first_acceleration_ = 0, jump_ = 0;
    Status status_ = Status::finished;
    Stop stop_; // if the status is not `finished`

    std::size_t axes() const { return static_cast<std::size_t>(engine_->axes()); }
    bool alone() const { return engine_->component().alone; }

    static std::uint64_t hash(const std::uint8_t* bytes, std::size_t size, const Options& options) {
        const auto all = std::bit_cast<std::array<std::uint8_t, sizeof options>>(options);
        return pack_hash(bytes, size) ^ pack_hash(all.data(), all.size());
    }

    // Energy of the motion of the attachment, and its part in the work.
    real carried_energy(const StepEnd& e) const {
        if (!alone()) return 0;
        const Components g = engine_->gravity();
        real sum = 0;
        for (const DamperSums& d : e.dampers)
            for (std::size_t a = 0; a < axes(); ++a)
                sum += d.momentum[a] * velocity_[a] +
                       d.mass * (0.5 * square(velocity_[a]) - g[a] * displacement_[a]);
        return sum;
    }

    void evaluate(const StepEnd& before, real carried_before, real length, const std::vector<real>& inputs) {
        const Components g = engine_->gravity();
        Components net = g; // gravity less the acceleration of the frame
        for (int l = 0; l < engine_->inputs(); ++l)
            if (engine_->is_base(l))
                for (std::size_t a = 0; a < axes(); ++a)
                    net[a] -= inputs[static_cast<std::size_t>(l)] * engine_->input_direction(l)[a];
        result_.force.assign(end_.dampers.size(), Components{});
        result_.moment = result_.force;
        for (std::size_t d = 0; d < end_.dampers.size(); ++d) {
            const DamperSums &then = before.dampers[d], &now = end_.dampers[d];
            Components moment{}; // mean of S
            for (std::size_t a = 0; a < 3; ++a) {
                result_.force[d][a] = (then.momentum[a] - now.momentum[a]) / length + now.mass * net[a];
                moment[a] = 0.5 * (then.mass_moment[a] + now.mass_moment[a]) -
                            length / 12 * (now.momentum[a] - then.momentum[a]);
            }
            if (axes() < 3 || !alone()) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
                result_.moment[d][a] = (then.angular_momentum[a] - now.angular_momentum[a]) / length +
                                       moment[b] * net[c] - moment[c] * net[b];
            }
        }
        const real carried = carried_energy(end_);
        result_.work = end_.work - before.work + carried - carried_before;
        result_.loss = end_.loss - before.loss;
        result_.stored = stored_energy();
    }

    template <class Archive> void serialize(Archive& archive) {
        archive(time_, velocity_, displacement_, status_, stop_, result_.force, result_.moment, result_.work,
                result_.loss, result_.stored, end_.dampers, end_.displacement, end_.velocity, end_.kinetic,
                end_.elastic, end_.potential, end_.work, end_.loss, velocity_steps_, first_acceleration_,
                jump_);
        audit_.serialize(archive);
    }

    void watch_start(real length, const real* acceleration) {
        constexpr real jump = 20; // ratio of the accelerations in the first two steps
        const real* start = engine_->component().velocity;
        const real size = std::hypot(acceleration[0], acceleration[1], acceleration[2]);
        if (++velocity_steps_ == 1) {
            first_acceleration_ = size;
            jump_ = start[0] == 0 && start[1] == 0 && start[2] == 0 ? size * length : 0;
        } else if (velocity_steps_ == 2 && !(first_acceleration_ > jump * size)) {
            jump_ = 0;
        }
    }

    void read(Reader& reader) {
        const std::size_t dampers = end_.dampers.size(), modes = end_.displacement.size();
        serialize(reader);
        if (!(time_ >= 0 && time_ < infinity) ||
            !(status_ >= Status::finished && status_ <= Status::false_contact) ||
            result_.force.size() != dampers || result_.moment.size() != dampers ||
            end_.dampers.size() != dampers || end_.displacement.size() != modes ||
            end_.velocity.size() != modes)
            throw std::invalid_argument("the state is damaged");
        if (status_ == Status::finished)
            engine_->restore(reader);
        else if (!reader.at_end())
            throw std::invalid_argument("the state is damaged");
    }

    // The state of an engine that has stopped is not needed, because it cannot continue.

    std::vector<std::uint8_t> content() {
        Sizer size;
        serialize(size);
        Writer writer(size.bytes);
        serialize(writer);
        if (status_ == Status::finished) engine_->save(writer);
        return std::move(writer.bytes);
    }

public:
    Stepper(const std::uint8_t* bytes, std::size_t size, const Options& options = {})
        : case_hash_(hash(bytes, size, options)), options_(options) {
        engine_ = make_engine(bytes, size, options_);
        std::copy_n(engine_->component().velocity, 3, velocity_.begin());
        end_ = engine_->end();
        result_.force.resize(end_.dampers.size()), result_.moment.resize(end_.dampers.size());
        result_.stored = stored_energy();
        audit_ = EnergyAudit(end_);
    }

    bool is_alone() const { return alone(); }
    int components() const { return engine_->axes(); }
    int inputs() const { return engine_->inputs(); }
    int dampers() const { return static_cast<int>(end_.dampers.size()); }
    int outputs() const { return static_cast<int>(engine_->component().rows.size()); }
    const Options& options() const { return options_; } // as they are
    Components gravity() const { return engine_->gravity(); }
    real time() const { return time_; }
    Components velocity() const { return velocity_; }         // of the attachment
    Components displacement() const { return displacement_; } // of the attachment
    Status status() const { return status_; }
    // Where the stepper stopped; the value of an energy error is the imbalance over the energy put in.
    const Stop& stop() const { return stop_; }
    real energy_residual() const { return audit_.worst(); }
    real computing_time(real length) const { return engine_->computing_time(length); }
    const StepResult& result() const { return result_; }
    Extremes extremes() const { return engine_->extremes(); }

    real stored_energy() const { return end_.kinetic + end_.elastic + end_.potential + carried_energy(end_); }

    // Displacement or velocity of an output point at the end of the step.
    real output(int i, bool rate) const {
        const auto& row = engine_->component().rows.at(static_cast<std::size_t>(i));
        const auto& modes = rate ? end_.velocity : end_.displacement;
        real sum = 0;
        for (std::size_t k = 0; k < row.size(); ++k) sum += row[k] * modes[k];
        return sum;
    }

    void set_gravity(Components g) {
        for (const real value : g)
            if (!(std::fabs(value) < infinity)) throw std::invalid_argument("gravity is not finite");
        if (!engine_->set_gravity(g)) return;
        // The stored energy refers to the gravity of the next step.
        real potential = 0;
        for (const DamperSums& damper : end_.dampers)
            for (std::size_t a = 0; a < axes(); ++a) potential -= g[a] * damper.mass_moment[a];
        audit_.shift(potential - end_.potential);
        end_.potential = potential;
        result_.stored = stored_energy();
    }

    // Advances by a step. `inputs` are the accelerations of the attachment (damper alone) or the values of
    // the loads, all constant in the step. If `stop` is set during the step, the status is `interrupted`.
    Status advance(real length, const real* inputs, const std::atomic<bool>& stop = never) {
        if (status_ != Status::finished) return status_;
        if (!(length > 0 && length < infinity))
            throw std::invalid_argument("a step must be longer than zero, and finite");
        const std::vector<real> given(inputs, inputs + engine_->inputs());
        for (const real value : given)
            if (!(std::fabs(value) < infinity)) throw std::invalid_argument("an input is not finite");
        const StepEnd before = end_;
        const real carried = carried_energy(before);
        status_ = engine_->advance(length, given.data(), stop);
        time_ += length;
        stop_ = engine_->stop();
        if (status_ != Status::finished) return status_;
        end_ = engine_->end();
        if (alone())
            for (std::size_t a = 0; a < axes(); ++a) {
                displacement_[a] += length * (velocity_[a] + 0.5 * length * given[a]);
                velocity_[a] += length * given[a];
            }
        evaluate(before, carried, length, given);
        if (!audit_.holds(end_)) {
            status_ = std::isfinite(result_.stored - result_.work + result_.loss) ? Status::energy_error
                                                                                  : Status::not_finite;
            stop_ = {.value = audit_.worst()};
        }
        return status_;
    }

    // Advances by a step at whose end the attachment has the velocity v.
    Status advance_to_velocity(real length, const real* v, const std::atomic<bool>& stop = never) {
        real acceleration[3] = {};
        for (std::size_t a = 0; a < axes(); ++a) acceleration[a] = (v[a] - velocity_[a]) / length;
        const Status status = advance(length, acceleration, stop);
        if (status != Status::finished) return status;
        for (std::size_t a = 0; a < axes(); ++a) velocity_[a] = v[a]; // without rounding
        watch_start(length, acceleration);
        return status;
    }

    // Change of the attachment's velocity in the first step [m/s] if it started from rest and the velocity
    // hardly changed in the second step, as if the initial velocity had been forgotten; else 0.
    real start_jump() const { return velocity_steps_ > 1 ? jump_ : 0; }

    // Returns the state: hash of the packed case, hash of the content, content.
    std::vector<std::uint8_t> save() {
        const std::vector<std::uint8_t> bytes = content();
        Writer whole(bytes.size() + 24);
        whole(case_hash_, pack_hash(bytes.data(), bytes.size()), bytes);
        return std::move(whole.bytes);
    }

    // Continues from a saved state. Throws, without a change, if it is damaged or of another case.
    void restore(const std::uint8_t* bytes, std::size_t size) {
        Reader whole(reinterpret_cast<const char*>(bytes), size);
        std::uint64_t case_hash, content_hash;
        std::vector<std::uint8_t> content;
        whole(case_hash, content_hash, content);
        if (case_hash != case_hash_) throw std::invalid_argument("the state is of another case");
        if (!whole.at_end() || content_hash != pack_hash(content.data(), content.size()))
            throw std::invalid_argument("the state is damaged");
        const std::vector<std::uint8_t> now = this->content();
        const auto reader_of = [](const std::vector<std::uint8_t>& from) {
            return Reader(reinterpret_cast<const char*>(from.data()), from.size());
        };
        Reader reader = reader_of(content);
        try {
            read(reader);
        } catch (...) {
            Reader back = reader_of(now);
            serialize(back);
            if (status_ == Status::finished) engine_->go_back(back);
            throw;
        }
    }
};

} // namespace rattlebox
