// What a run reports to an object beside it, of which it may have one: impact/linearisation.hpp. Without one
// it costs a comparison for each flight and contact.
#pragma once

#include <vector>

#include "impact/state.hpp"

namespace rattlebox {

class Flight;
class IsolatedContact;
class LastingContact;

// The impulses of one instant: contacts that stay closed come first.
struct Impulses {
    const std::vector<int>& contacts;
    std::size_t resting;
    const std::vector<real>& restitution;  // of the contacts behind the resting ones
    const std::vector<real>& change;       // of the approach rates that each must lose
    const std::vector<char>& is_two_sided; // whether the impulse may be attractive
    const std::vector<real>& matrix;       // approach rate that each loses per impulse of each
    const std::vector<real>& impulse;
};

struct RunListener {
    virtual ~RunListener() = default;
    // A flight of this length begins at the current state.
    virtual void flight(const Flight& flight, real length) = 0;
    // The current time is a knot of a load; the loads are still those before it.
    virtual void pass_knot() = 0;
    // Hard impacts: the first contact that closes, or -1 if contacts at rest are pressed together; impulses
    // that act next; and the end of the instant.
    virtual void begin_impact(int contact) = 0;
    virtual void impulses(const Impulses& impulses) = 0;
    virtual void end_impact() = 0;
    // A hard contact touches without speed.
    virtual void graze(int contact) = 0;
    // A soft contact begins.
    virtual void touch(int contact, real speed, real e) = 0;
    // The closed contacts are integrated from y over a length of the transformed time.
    virtual void step(const real* y, real length) = 0;
    // An isolated soft contact was solved as a whole up to a state; returns whether that will do.
    virtual bool isolated(int contact, real speed, real e, const IsolatedContact& solution,
                          const State& end) = 0;
    // The closed contacts make a long step from y to `end` at a time.
    virtual void long_step(const real* y, const real* end, const LastingContact& step, real time) = 0;
    // Nothing moves in y from a time for a length.
    virtual void rest(const real* y, real time, real length) = 0;
    // A phase of a closed contact ends now.
    virtual void end_phase(std::size_t active) = 0;
};

} // namespace rattlebox
