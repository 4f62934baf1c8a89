// Those of a chunk of particles that touch or may touch soon, others or walls, and what each contact
// remembers.
#pragma once

#include <vector>

#include "base/rows.hpp"

namespace rattlebox::dem {

template <class T> T& at(std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T> const T& at(const std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }

struct Contacts {
    static constexpr int tiers = 4; // candidates by distance at the last scan
    static constexpr int none = -1;

    // Candidates, tier by tier; lanes may read a few past the end.
    std::vector<int> first, second; // numbers of particles; of a wall for the second at a wall
    std::vector<int> origin;        // which of the neighbours it is
    std::vector<int> slot;          // where its memory is, or none
    int tier_end[tiers] = {};
    std::vector<int> active; // candidates that touch
    int actives = 0;

    // Memory of those that touch, by slot.
    std::vector<Row> force; // on the first
    std::vector<Row>
        couple; // torque on the first over its radius; of a pair also that on the second over its own
    std::vector<Row> roll;     // rolling torque on the first; with rolling resistance only
    std::vector<Row> friction; // force of the tangential spring on the first, and its stiffness
    std::vector<Row> rolling;  // torque of the rolling spring on the first, and its stiffness
    std::vector<Row> law;      // A, c, B, c_t: see contact_step.hpp
    std::vector<Row> limit;    // mu, mu_r R*, k_r / k_t, c_r
    std::vector<Row> dent;     // of a plastic law: deepest overlap, stiffness and origin of the curve that
                               // unloads, and the deepest overlap that this curve is for
    std::vector<int> free;
    bool rolls = false, dents = false;

    int size() const { return tier_end[tiers - 1]; }

    void resize(int candidates) {
        const auto n = static_cast<std::size_t>(candidates);
        for (auto* numbers : {&first, &second}) numbers->resize(n + lane_count);
        slot.resize(n + lane_count, none);
        for (auto* numbers : {&origin, &active}) numbers->resize(n);
    }

    int take() {
        if (!free.empty()) {
            const int s = free.back();
            free.pop_back();
            return s;
        }
        for (auto* rows : {&force, &couple, &friction, &law, &limit}) rows->push_back(Row{});
        if (rolls)
            for (auto* rows : {&roll, &rolling}) rows->push_back(Row{});
        if (dents) dent.push_back(Row{});
        return static_cast<int>(force.size()) - 1;
    }

    void forget_all() {
        for (auto* rows : {&force, &couple, &roll, &friction, &rolling, &law, &limit, &dent}) rows->clear();
        free.clear();
        actives = 0;
        resize(0);
        for (int& end : tier_end) end = 0;
    }

    // Takes over what another remembers at `from`; `sign` is -1 where the partners have changed places.
    int remember(const Contacts& old, int from, real sign) {
        const int s = take();
        const Row turn = row(sign, sign, sign, 1);
        at(friction, s) = turn * at(old.friction, from);
        at(law, s) = at(old.law, from);
        at(limit, s) = at(old.limit, from);
        if (rolls) at(rolling, s) = turn * at(old.rolling, from);
        if (dents) at(dent, s) = at(old.dent, from);
        return s;
    }

    std::size_t memory() const {
        std::size_t bytes = 0;
        for (const auto* v : {&first, &second, &origin, &slot, &active, &free})
            bytes += v->capacity() * sizeof(int);
        for (const auto* v : {&force, &couple, &roll, &friction, &rolling, &law, &limit, &dent})
            bytes += v->capacity() * sizeof(Row);
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(first, second, origin, slot, tier_end, active, actives, force, friction, rolling, law, limit, dent,
          free);
        if constexpr (Archive::reads) { // what each step computes anew
            couple.resize(friction.size());
            if (rolls) roll.resize(friction.size());
        }
    }
};

} // namespace rattlebox::dem
