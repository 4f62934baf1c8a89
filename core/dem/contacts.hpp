// Those of a chunk of particles that touch or may touch soon, others or walls, and what each contact
// remembers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dem/touch.hpp"

namespace rattlebox::dem {

template <class T, class A> T& at(std::vector<T, A>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T, class A> const T& at(const std::vector<T, A>& v, int i) {
    return v[static_cast<std::size_t>(i)];
}

// What contacts remember, by slot.
struct Memory {
    std::vector<Kept> kept;
    std::vector<KeptRolling> rolling; // with rolling resistance only
    std::vector<Row> dent;   // of a plastic law: deepest overlap, stiffness and origin of the curve that
                             // unloads, and the deepest overlap that this curve is for
    std::vector<real> since; // the step in which the contact began
    std::vector<int> free;
    bool rolls = false, dents = false;

    int used() const { return static_cast<int>(kept.size() - free.size()); }

    int take() {
        if (!free.empty()) {
            const int s = free.back();
            free.pop_back();
            return s;
        }
        if (kept.size() == kept.capacity()) reserve(kept.size() + kept.size() / 8 + 4);
        kept.emplace_back(), since.emplace_back();
        if (rolls) rolling.emplace_back();
        if (dents) dent.emplace_back();
        return static_cast<int>(kept.size()) - 1;
    }

    void reserve(std::size_t slots) {
        kept.reserve(slots), since.reserve(slots);
        if (rolls) rolling.reserve(slots);
        if (dents) dent.reserve(slots);
    }

    int begin(const Begun& b, real step) {
        const int s = take();
        at(kept, s) = b.kept, at(since, s) = step;
        if (rolls) at(rolling, s) = b.rolling;
        if (dents) at(dent, s) = b.dent;
        return s;
    }

    // `sign` is -1 where the partners have changed places.
    int begin(const Memory& old, int slot, real sign) {
        const int s = take();
        const Row turn = row(sign, sign, sign, 1);
        at(kept, s) = {turn * at(old.kept, slot).friction, at(old.kept, slot).law};
        at(since, s) = at(old.since, slot);
        if (rolls) at(rolling, s) = {turn * at(old.rolling, slot).spring, at(old.rolling, slot).law};
        if (dents) at(dent, s) = at(old.dent, slot);
        return s;
    }

    std::size_t bytes() const {
        return kept.capacity() * sizeof(Kept) + rolling.capacity() * sizeof(KeptRolling) +
               dent.capacity() * sizeof(Row) + since.capacity() * sizeof(real) +
               free.capacity() * sizeof(int);
    }

    template <class Archive> void keep(Archive& a) { a(kept, rolling, dent, since, free); }
};

// What those that touch do in a step, in the order in which they are listed.
struct Actions {
    std::vector<Action> all;
    std::vector<Row> torque; // of rolling, on the first

    void swap(Actions& other) { all.swap(other.all), torque.swap(other.torque); }
};

struct Contacts {
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
    std::vector<int> active;        // candidates that touch
    int actives = 0;
    Actions actions;

    Memory memory;

    int size() const { return listed; }
    bool is_stale() const { return !(since < skin); }

    void resize(int candidates) {
        listed = candidates;
        const auto n = static_cast<std::size_t>(candidates);
        if (n > origin.capacity())
            for (auto* numbers : {&first, &second, &slot, &origin, &active})
                numbers->reserve(n + n / 8 + lane_count);
        for (auto* numbers : {&first, &second}) numbers->resize(n + lane_count);
        slot.resize(n + lane_count, none);
        origin.resize(n), active.resize(n + lane_count); // more are written than touch
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
        const int k = actives++;
        resize(actives);
        put(k, one, other, from, memory);
        at(active, k) = k;
    }

    // Nobody is a candidate any more; what they remember goes to `leaving`.
    void leave(Memory& leaving) {
        const bool rolls = memory.rolls, dents = memory.dents;
        leaving = std::move(memory);
        memory = Memory();
        memory.rolls = rolls, memory.dents = dents;
        memory.reserve(static_cast<std::size_t>(leaving.used()));
        actives = 0, since = infinity;
        actions.all.clear(), actions.torque.clear();
        resize(0);
    }

    std::size_t bytes() const {
        std::size_t sum = memory.bytes() + static_cast<std::size_t>(actives) *
                                               (sizeof(Action) + (memory.rolls ? sizeof(Row) : 0));
        for (const auto* v : {&first, &second, &origin, &slot, &active}) sum += v->capacity() * sizeof(int);
        return sum;
    }

    template <class Archive> void keep(Archive& a) {
        a(skin, since, age, rate, steps, first, second, origin, slot, listed, active, actives, actions.all,
          actions.torque);
        memory.keep(a);
    }
};

} // namespace rattlebox::dem
