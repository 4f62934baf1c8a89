// Derivatives of the state of a run with respect to its state at the start and to parameters, beside the run.
//
// The derivatives are those at fixed times. In flights they follow the linear equations of motion, in closed
// form or by the same Taylor series. In closed soft contacts they are integrated with the steps of the run in
// the transformed time, in which the force of a Hertz contact is smooth; its derivatives with respect to
// overlap, rate and coefficients follow from dual numbers. At an event that the state x reaches where
// h(x, p, t) = 0, with the rates f- and f+ of the state before and after,
//
//     dt = -h' / (dh/dt)        x'+ = R (x'- + f- dt) + r_p - f+ dt
//
// R and r_p are the derivatives of the jump of the state, h' those of h in each direction. (M. di Bernardo,
// C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5,
// doi:10.1007/978-1-84628-708-4.) Where neither state nor rates jump, as at the start of a Hertz contact and
// where a resting contact is released, nothing changes.
//
// A parameter is a direction in the numbers of the problem: a second problem holds their derivatives.
#pragma once

#include "impact/run_listener.hpp"
#include "impact/tangent_collocation.hpp"
#include "impact/tangent_contacts.hpp"
#include "impact/tangent_flights.hpp"
#include "impact/tangent_impacts.hpp"
#include "impact/tangent_lasting.hpp"

namespace rattlebox {

class Linearisation final : public RunListener {
    Tangents t_;
    TangentFlights flights_;
    TangentLaws laws_;
    TangentImpacts impacts_;
    TangentContacts contacts_;
    TangentCollocation collocation_;
    TangentLasting lasting_;

public:
    Linearisation(RunState& run, std::vector<Problem> slopes, bool from_case)
        : t_(run, std::move(slopes), from_case), flights_(t_), laws_(t_), impacts_(t_, laws_),
          contacts_(t_, laws_), collocation_(t_, laws_), lasting_(t_, laws_) {}
    Linearisation(const Linearisation&) = delete; // its parts refer to each other
    Linearisation& operator=(const Linearisation&) = delete;

    const Tangents& tangents() const { return t_; }
    void refuse(NotLinear why, int c) { t_.refuse(why, c); }

    // A run may start where a contact begins or ends, but not within one, whose history is unknown.
    void check_start() {
        for (int c = 0; c < t_.problem.contact_count(); ++c)
            if (gap(t_.problem, t_.contact(c), t_.run.state.y.data()).value <
                -touching_margin * epsilon * t_.run.gap_terms(c))
                refuse(NotLinear::closed, c);
    }

    // Returns the rates of the state now.
    const std::vector<real>& rates() {
        t_.rates_of_contacts();
        return t_.rates;
    }

    void flight(const Flight& flight, real length) override { flights_.flight(flight, length); }
    void pass_knot() override { flights_.pass_knot(); }
    void begin_impact(int c) override { impacts_.begin(c); }
    void impulses(const Impulses& one) override { impacts_.impulses(one); }
    void end_impact() override { impacts_.end(); }
    void graze(int c) override { refuse(NotLinear::grazing, c); }
    void touch(int c, real speed, real e) override { contacts_.touch(c, speed, e); }
    void step(const real* y, real length) override { contacts_.step(y, length); }
    bool isolated(int c, real speed, real e, const IsolatedContact& solution, const State& end) override {
        contacts_.touch(c, speed, e);
        const HertzTsuji& law = *t_.contact(c).normal.get_if<HertzTsuji>();
        if (!collocation_.advance(c, law, initial_state(law, e, speed), speed, contacts_.slower(), solution,
                                  end))
            return false;
        const State& start = t_.run.state;
        contacts_.note_misses(start.y.data(), end.y.data(), start.t, end.t - start.t, c);
        return true;
    }
    void long_step(const real* y, const real* end, const LastingContact& step, real time) override {
        lasting_.advance(y, step, time);
        contacts_.note_misses(y, end, time, step.h);
    }
    void rest(const real* y, real time, real length) override { lasting_.rest(y, time, length); }
    void end_phase(std::size_t j) override { contacts_.end_phase(j); }
};

} // namespace rattlebox
