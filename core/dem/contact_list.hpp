// The contact list of a chunk: candidates, which of them touch, and the history of each contact.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dem/contact_start.hpp"
#include "util/at.hpp"

namespace rattlebox::dem {

// History variables of contacts, by slot. Slots of contacts that ended are reused.
struct ContactHistory {
    std::vector<ContactState> state;
    std::vector<RollingState> rolling; // empty without rolling resistance
    std::vector<Row>
        yield_history; // of a law with hysteresis: deepest overlap, stiffness and origin of the unloading
                       // curve, and the deepest overlap for which the curve was computed
    std::vector<int> began_at; // the same: wall whose normal law the contact has, if it is at another one now
    std::vector<real> start_step; // the step in which the contact began
    std::vector<int> free;
    bool rolls = false, yields = false;

    int used() const { return static_cast<int>(state.size() - free.size()); }

    int allocate() {
        if (!free.empty()) {
            const int s = free.back();
            free.pop_back();
            return s;
        }
        if (state.size() == state.capacity()) reserve(state.size() + state.size() / 8 + 4);
        state.emplace_back(), start_step.emplace_back();
        if (rolls) rolling.emplace_back();
        if (yields) yield_history.emplace_back(), began_at.push_back(-1);
        return static_cast<int>(state.size()) - 1;
    }

    void reserve(std::size_t slots) {
        state.reserve(slots), start_step.reserve(slots);
        if (rolls) rolling.reserve(slots);
        if (yields) yield_history.reserve(slots), began_at.reserve(slots);
    }

    int add(const ContactStart& b, real step) {
        const int s = allocate();
        at(state, s) = b.state, at(start_step, s) = step;
        if (rolls) at(rolling, s) = b.rolling;
        if (yields) at(yield_history, s) = b.yield_history, at(began_at, s) = -1;
        return s;
    }

    // Copies a slot of another list; `sign` is -1 if the two partners were exchanged.
    int add(const ContactHistory& old, int slot, real sign) {
        const int s = allocate();
        const Row turn = row(sign, sign, sign, 1);
        at(state, s) = {turn * at(old.state, slot).friction, at(old.state, slot).law};
        at(start_step, s) = at(old.start_step, slot);
        if (rolls) at(rolling, s) = {turn * at(old.rolling, slot).spring, at(old.rolling, slot).law};
        if (yields)
            at(yield_history, s) = at(old.yield_history, slot), at(began_at, s) = at(old.began_at, slot);
        return s;
    }

    std::size_t bytes() const {
        return state.capacity() * sizeof(ContactState) + rolling.capacity() * sizeof(RollingState) +
               yield_history.capacity() * (sizeof(Row) + sizeof(int)) + start_step.capacity() * sizeof(real) +
               free.capacity() * sizeof(int);
    }

    template <class Archive> void serialize(Archive& a) {
        a(state, rolling, yield_history, start_step, free);
        if (yields) a(began_at);
    }
};

// Forces of the touching pairs in one step, in the order of ContactList::touching.
struct ContactForces {
    std::vector<ContactForce> all;
    std::vector<Row> torque; // of rolling resistance, on the first partner

    void swap(ContactForces& other) { all.swap(other.all), torque.swap(other.torque); }
};

struct ContactList {
    static constexpr int none = -1;

    real skin = 0;            // largest gap of candidates at the last scan, m
    real approach = infinity; // bound on the approach of any two particles since the scan, m
    std::int64_t steps_since_scan = 0;
    real approach_per_step = 0; // mean of `approach` between the last two scans
    std::int64_t steps = 0;     // since the start of the run

    // Candidate pairs. The arrays are padded, because the last lanes read past the end.
    std::vector<int> first, second; // particles; at walls the second is a wall
    std::vector<int> origin;        // index in the neighbour list
    std::vector<int> slot;          // of its history, or none
    // Where a candidate is a body or a triangle: outward normal and distance of the wall in this step, and a
    // lower bound on the gap at the last scan; else empty.
    std::vector<Row> near;
    std::vector<real> gap;
    int candidate_count = 0;
    std::vector<int> touching; // candidates that touch, ascending
    int touching_count = 0;
    ContactForces contact_forces;

    ContactHistory history;

    int size() const { return candidate_count; }
    bool is_stale() const { return !(approach < skin); }

    void resize(int candidates) {
        candidate_count = candidates;
        const auto n = static_cast<std::size_t>(candidates);
        if (n > origin.capacity())
            for (auto* numbers : {&first, &second, &slot, &origin, &touching})
                numbers->reserve(n + n / 8 + lane_count);
        for (auto* numbers : {&first, &second}) numbers->resize(n + lane_count);
        slot.resize(n + lane_count, none);
        origin.resize(n), touching.resize(n + lane_count); // writes are in whole lanes
    }

    void set_candidate(int k, int i, int j, int from, int history_slot) {
        at(first, k) = i, at(second, k) = j, at(origin, k) = from, at(slot, k) = history_slot;
    }

    // Fills the padding with particles that are in the caches anyway.
    void pad(int i, int j) {
        std::fill(first.begin() + size(), first.end(), i);
        std::fill(second.begin() + size(), second.end(), j);
    }

    // Adds a contact that has a history, before the first scan.
    void add_contact(int i, int j, int from, int history_slot) {
        const int k = touching_count++;
        resize(touching_count);
        set_candidate(k, i, j, from, history_slot);
        at(touching, k) = k;
    }

    // Empties the list and moves the history of its contacts to `outgoing`.
    void move_history(ContactHistory& outgoing) {
        const bool rolls = history.rolls, yields = history.yields;
        outgoing = std::move(history);
        history = ContactHistory();
        history.rolls = rolls, history.yields = yields;
        history.reserve(static_cast<std::size_t>(outgoing.used()));
        touching_count = 0, approach = infinity;
        contact_forces.all.clear(), contact_forces.torque.clear();
        resize(0);
    }

    std::size_t bytes() const {
        std::size_t sum = history.bytes() + static_cast<std::size_t>(touching_count) *
                                                (sizeof(ContactForce) + (history.rolls ? sizeof(Row) : 0));
        for (const auto* v : {&first, &second, &origin, &slot, &touching}) sum += v->capacity() * sizeof(int);
        return sum;
    }

    template <class Archive> void serialize(Archive& a) {
        a(skin, approach, steps_since_scan, approach_per_step, steps, first, second, origin, slot,
          candidate_count, touching, touching_count, contact_forces.all, contact_forces.torque);
        history.serialize(a);
    }
};

} // namespace rattlebox::dem
