// Interface of an engine for a stepper: advance over a step with constant inputs, and the state at its end.
#pragma once

#include <array>
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

class StepEngine {
public:
    virtual ~StepEngine() = default;
    virtual const Component& component() const = 0;
    virtual int axes() const = 0;
    virtual int inputs() const = 0;
    virtual bool is_base(int input) const = 0; // whether the input is an acceleration of the base
    virtual Components input_direction(int input) const = 0;
    virtual Components gravity() const = 0;
    virtual void set_gravity(Components g) = 0;
    // Advances by `length` with constant inputs.
    virtual Status advance(real length, const real* inputs) = 0;
    virtual StepEnd end() const = 0;
    virtual Extremes extremes() const = 0;
    virtual void save(Writer& writer) = 0;
    virtual void restore(Reader& reader) = 0;
};

// Makes the engine of a packed case; `options` are then those that hold. Defined in stepper/engines.hpp.
std::unique_ptr<StepEngine> make_engine(const std::uint8_t* bytes, std::size_t size, Options& options);

} // namespace rattlebox
