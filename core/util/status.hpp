// How a run ended. The messages are in rattlebox/engines/status.py.
#pragma once

namespace rattlebox {

enum class Status : int {
    finished = 0,
    law_domain = 1,      // an approach speed exceeds the range of the restitution law
    too_many_events = 2, // the limit of events was reached
    step_too_small = 3,  // the error bound cannot be met
    interrupted = 4,     // stopped by the user
    not_finite = 5,      // the solution became non-finite
    energy_error = 6,    // the run reached its end, but the energy residual exceeds its limit
    escaped = 7,         // a particle has left its cavity
    no_rebound = 8,      // a dashpot cannot have a restitution of zero
    refused = 9,         // a variant of a study that cannot be run; not used by the core
    false_contact = 10,  // a contact began at an open gap; an error of the engine
};

} // namespace rattlebox
