// The contact list of a chunk: candidates, which of them touch, and the history of each contact.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dem/contact_begin.hpp"

namespace rattlebox::dem {

template <class T, class A> T& at(std::vector<T, A>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T, class A> const T& at(const std::vector<T, A>& v, int i) {
    return v[static_cast<std::size_t>(i)];
}

// What contacts remember, by slot.
struct ContactHistory {
    std::vector<ContactState> state;
    std::vector<RollingState> rolling; // with rolling resistance only
    std::vector<Row> yield_history;    // of a plastic law: deepest overlap, stiffness and origin of the curve
                                       // that unloads, and the deepest overlap that this curve is for
    std::vector<real> since;           // the step in which the contact began
    std::vector<int> free;
    bool rolls = false, yields = false;

    int used() const { return static_cast<int>(state.size() - free.size()); }

    int take() {
        if (!free.empty()) {
            const int s = free.back();
            free.pop_back();
            return s;
        }
        if (state.size() == state.capacity()) reserve(state.size() + state.size() / 8 + 4);
        state.emplace_back(), since.emplace_back();
        if (rolls) rolling.emplace_back();
        if (yields) yield_history.emplace_back();
        return static_cast<int>(state.size()) - 1;
    }

    void reserve(std::size_t slots) {
        state.reserve(slots), since.reserve(slots);
        if (rolls) rolling.reserve(slots);
        if (yields) yield_history.reserve(slots);
    }

    int begin(const ContactStart& b, real step) {
        const int s = take();
        at(state, s) = b.state, at(since, s) = step;
        if (rolls) at(rolling, s) = b.rolling;
        if (yields) at(yield_history, s) = b.yield_history;
        return s;
    }

    // `sign` is -1 where the partners have changed places.
    int begin(const ContactHistory& old, int slot, real sign) {
        const int s = take();
        const Row turn = row(sign, sign, sign, 1);
        at(state, s) = {turn * at(old.state, slot).friction, at(old.state, slot).law};
        at(since, s) = at(old.since, slot);
        if (rolls) at(rolling, s) = {turn * at(old.rolling, slot).spring, at(old.rolling, slot).law};
        if (yields) at(yield_history, s) = at(old.yield_history, slot);
        return s;
    }

    std::size_t bytes() const {
        return state.capacity() * sizeof(ContactState) + rolling.capacity() * sizeof(RollingState) +
               yield_history.capacity() * sizeof(Row) + since.capacity() * sizeof(real) +
               free.capacity() * sizeof(int);
    }

    template <class Archive> void keep(Archive& a) { a(state, rolling, yield_history, since, free); }
};

// What those that touch do in a step, in the order in which they are listed.
struct ContactForces {
    std::vector<ContactForce> all;
    std::vector<Row> torque; // of rolling, on the first

    void swap(ContactForces& other) { all.swap(other.all), torque.swap(other.torque); }
};

struct ContactList {
    static constexpr int none = -1;

    real skin = 0;          // candidates were closer than that at the scan,
    real since = infinity;  // and since then no two have come nearer to each other than that
    std::int64_t age = 0;   // in steps
    real rate = 0;          // nearer in a step, between the last two scans
    std::int64_t steps = 0; // since the start of the run

    // Candidates; lanes may read a few past the end.
    std::vector<int> first, second; // numbers of particles; of a wall for the second at a wall
    std::vector<int> origin;        // which of the neighbours it is
    std::vector<int> slot;          // where its memory is, or none
    int listed = 0;                 // candidates
    std::vector<int> touching;      // candidates that touch
    int touching_count = 0;
    ContactForces contact_forces;

    ContactHistory memory;

    int size() const { return listed; }
    bool is_stale() const { return !(since < skin); }

    void resize(int candidates) {
        listed = candidates;
        const auto n = static_cast<std::size_t>(candidates);
        if (n > origin.capacity())
            for (auto* numbers : {&first, &second, &slot, &origin, &touching})
                numbers->reserve(n + n / 8 + lane_count);
        for (auto* numbers : {&first, &second}) numbers->resize(n + lane_count);
        slot.resize(n + lane_count, none);
        origin.resize(n), touching.resize(n + lane_count); // more are written than touch
    }

    void put(int k, int one, int other, int from, int memory) {
        at(first, k) = one, at(second, k) = other, at(origin, k) = from, at(slot, k) = memory;
    }

    // Lanes past the end look at a particle that is at hand.
    void pad(int first_at_hand, int second_at_hand) {
        std::fill(first.begin() + size(), first.end(), first_at_hand);
        std::fill(second.begin() + size(), second.end(), second_at_hand);
    }

    // A contact that comes with its memory, before there are any candidates.
    void arrive(int one, int other, int from, int memory) {
        const int k = touching_count++;
        resize(touching_count);
        put(k, one, other, from, memory);
        at(touching, k) = k;
    }

    // Nobody is a candidate any more; what they remember goes to `leaving`.
    void leave(ContactHistory& outgoing) {
        const bool rolls = memory.rolls, yields = memory.yields;
        outgoing = std::move(memory);
        memory = ContactHistory();
        memory.rolls = rolls, memory.yields = yields;
        memory.reserve(static_cast<std::size_t>(outgoing.used()));
        touching_count = 0, since = infinity;
        contact_forces.all.clear(), contact_forces.torque.clear();
        resize(0);
    }

    std::size_t bytes() const {
        std::size_t sum = memory.bytes() + static_cast<std::size_t>(touching_count) *
                                               (sizeof(ContactForce) + (memory.rolls ? sizeof(Row) : 0));
        for (const auto* v : {&first, &second, &origin, &slot, &touching}) sum += v->capacity() * sizeof(int);
        return sum;
    }

    template <class Archive> void keep(Archive& a) {
        a(skin, since, age, rate, steps, first, second, origin, slot, listed, touching, touching_count,
          contact_forces.all, contact_forces.torque);
        memory.keep(a);
    }
};

} // namespace rattlebox::dem
