// How a trajectory ended. The messages, with advice, are in rattlebox/engines/status.py.
#pragma once

namespace rattlebox {

enum class Status : int {
    finished = 0,
    law_domain = 1,      // a restitution law was asked for a speed beyond its validity
    too_many_events = 2, // the budget of events is spent
    step_too_small = 3,  // the error bound cannot be met
    interrupted = 4,     // the user asked to stop
    not_finite = 5,      // a state became infinite or not a number
    energy_error = 6,    // the end was reached, but the energy residual exceeds its bound
    escaped = 7,         // a particle has left its cavity
    no_rebound = 8,      // a dashpot was asked for a restitution of zero
    refused = 9,         // a study's variant that cannot be run; no run of the core ends so
};

} // namespace rattlebox
