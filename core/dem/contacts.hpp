// Those that touch or may touch soon, two particles or a particle and a wall, and what each contact
// remembers.
//
// A list belongs to the chunks of particles that own its first partners: chunk k owns start[k] .. start[k+1].
#pragma once

#include <array>
#include <vector>

#include "base/rows.hpp"

namespace rattlebox::dem {

struct ContactList {
    static constexpr int tiers = 4; // by distance at the last scan

    // of each candidate
    std::vector<int> origin;        // of a pair: which of the neighbours it is
    std::vector<int> first, second; // numbers of particles; of a wall for the second of a wall list
    std::vector<char> touching;
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

    std::vector<int> start;           // of each chunk and tier, and the end
    int layers = 1;                   // tiers in this list
    std::vector<int> active, actives; // those that touch, from begin(chunk, 0) on, and how many they are
    bool rolls = false, dents = false;

    int size() const { return count_; }

    int begin(int chunk, int tier) const { return start[static_cast<std::size_t>(chunk * layers + tier)]; }
    int end(int chunk) const { return start[static_cast<std::size_t>((chunk + 1) * layers)]; }

    // `numbers` are how many there are in each tier of each chunk.
    void lay_out(const std::vector<int>& numbers, int tiers_of_chunk) {
        layers = tiers_of_chunk;
        start.assign(numbers.size() + 1, 0);
        for (std::size_t k = 0; k < numbers.size(); ++k) start[k + 1] = start[k] + numbers[k];
        actives.assign(numbers.size() / static_cast<std::size_t>(layers), 0);
        resize(static_cast<std::size_t>(start.back()));
    }

    // Lanes may read a few numbers past the end.
    void resize(std::size_t n) {
        for (auto* numbers : {&first, &second}) numbers->resize(n + lane_count);
        for (auto* numbers : {&active, &origin}) numbers->resize(n);
        count_ = static_cast<int>(n);
        touching.resize(n + lane_count);
        for (auto* rows : {&force, &couple, &friction, &law, &limit}) rows->resize(n);
        if (rolls)
            for (auto* rows : {&roll, &rolling}) rows->resize(n);
        if (dents) dent.resize(n);
    }

    void forget(int k) { touching[static_cast<std::size_t>(k)] = 0; }

    // Takes over what contact `from` of an older list remembers; `sign` is -1 where its partners have changed
    // places.
    void remember(int k, const ContactList& old, int from, real sign) {
        const auto to = static_cast<std::size_t>(k), at = static_cast<std::size_t>(from);
        const Row turn = row(sign, sign, sign, 1);
        touching[to] = old.touching[at];
        friction[to] = turn * old.friction[at];
        law[to] = old.law[at];
        limit[to] = old.limit[at];
        if (rolls) rolling[to] = turn * old.rolling[at];
        if (dents) dent[to] = old.dent[at];
    }

    std::size_t memory() const {
        std::size_t bytes = touching.capacity();
        for (const auto* v : {&origin, &first, &second, &start, &active, &actives})
            bytes += v->capacity() * sizeof(int);
        for (const auto* v : {&force, &couple, &roll, &friction, &rolling, &law, &limit, &dent})
            bytes += v->capacity() * sizeof(Row);
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(count_, layers, origin, first, second, touching, friction, rolling, law, limit, dent, start, active,
          actives);
        if (a.reads) { // what each step computes anew
            force.resize(friction.size()), couple.resize(friction.size());
            if (rolls) roll.resize(friction.size());
        }
    }

private:
    int count_ = 0;
};

} // namespace rattlebox::dem
