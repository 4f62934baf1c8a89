// Interface of an engine for a stepper: advance over a step with constant inputs, and the state at its end.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "stepper/options.hpp"
#include "util/archive.hpp"
#include "util/status.hpp"

namespace rattlebox {

using Components = std::array<real, 3>; // a damper of the 1-D engine uses the first one

// Sums over the balls or particles of a damper, relative to the base (damper alone: to the attachment).
struct DamperSums {
    real mass = 0;
    Components momentum{}, mass_moment{}; // sum of m v, sum of m x
    Components angular_momentum{};        // about the centre of the cavity
};

// State at the end of a step.
struct StepEnd {
    std::vector<DamperSums> dampers;
    std::vector<real> displacement, velocity; // of the modes
    // Energies: of motion, of contacts and structure, of weight; sums since the start: work of loads and
    // base, and loss.
    real kinetic = 0, elastic = 0, potential = 0, work = 0, loss = 0;
};

// The extremes since the start, by which validity limits are checked: of each contact, the overlap [m] (1-D),
// or of each damper, the overlap over the radius (3-D); and the speed of approach [m/s].
struct Extremes {
    std::vector<real> overlap, speed;
};

inline const char* stop_reason(Status status) {
    switch (status) {
    case Status::law_domain:
        return "an approach speed exceeds the range of the restitution law";
    case Status::too_many_events:
        return "too many events in one step";
    case Status::step_too_small:
        return "the error bound of a contact cannot be met";
    case Status::not_finite:
        return "the motion is not finite";
    case Status::escaped:
        return "a particle has left its cavity; shorten the time step or lower the softening";
    case Status::no_rebound:
        return "a dashpot cannot have a restitution of zero";
    case Status::energy_error:
        return "the energy balance has an error of more than 1 % of the energy put in; shorten the time step";
    case Status::interrupted:
        return "the step was interrupted";
    case Status::false_contact:
        return "a contact began at an open gap, which is an error of the engine; shorten the step";
    default:
        return "the engine stopped";
    }
}

// Where an engine stopped.
struct Stop {
    int damper = -1, member = -1; // its contact (1-D) or particle (3-D), or -1
    real value = not_a_number;    // approach speed, or speed of a particle that has left its cavity, m/s
};

class StepEngine {
public:
    virtual ~StepEngine() = default;
    virtual const Component& component() const = 0;
    virtual int axes() const = 0;
    virtual int inputs() const = 0;
    virtual bool is_base(int input) const = 0; // whether the input is an acceleration of the base
    virtual Components input_direction(int input) const = 0;
    virtual Components gravity() const = 0;
    // Returns whether this is a change.
    virtual bool set_gravity(Components g) = 0;
    // Advances by `length` with constant inputs; the status is `interrupted` if `stop` is set before the end.
    virtual Status advance(real length, const real* inputs, const std::atomic<bool>& stop) = 0;
    // Estimated time that advance() takes, s.
    virtual real computing_time(real length) const = 0;
    // State at the end of the last step, which must not have stopped.
    virtual StepEnd end() const = 0;
    virtual Stop stop() const = 0;
    virtual Extremes extremes() const = 0;
    virtual void save(Writer& writer) = 0;
    // Throws if it cannot be a state of this case; go_back() must then follow.
    virtual void restore(Reader& reader) = 0;
    // Reads a state that this engine has saved, without a check.
    virtual void go_back(Reader& reader) = 0;
};

// Makes the engine of a packed case; `options` are then those that hold. Defined in stepper/engines.hpp.
std::unique_ptr<StepEngine> make_engine(const std::uint8_t* bytes, std::size_t size, Options& options);

} // namespace rattlebox
