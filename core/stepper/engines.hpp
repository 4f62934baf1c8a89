// Makes the engine of a packed case. Defines a function that is not inline, so that a program compiles the
// engines once: include it in one source file.
#pragma once

#include "stepper/impact_engine.hpp"
#include "stepper/particle_engine.hpp"

namespace rattlebox {

namespace {

template <class Engine, class Problem>
std::unique_ptr<StepEngine> engine_of(const std::uint8_t* bytes, std::size_t size, Options& options) {
    PackedCase<Problem> packed;
    read_case(packed, bytes, size);
    options = apply(options, packed);
    return std::make_unique<Engine>(std::move(packed));
}

} // namespace

std::unique_ptr<StepEngine> make_engine(const std::uint8_t* bytes, std::size_t size, Options& options) {
    return packed_engine(bytes, size) == Engine::impact
               ? engine_of<ImpactEngine, Problem>(bytes, size, options)
               : engine_of<ParticleEngine, dem::Problem>(bytes, size, options);
}

} // namespace rattlebox
