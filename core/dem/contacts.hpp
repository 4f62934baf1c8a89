// Those of a chunk of particles that touch or may touch soon, others or walls, and what each contact
// remembers.
#pragma once

#include <algorithm>
#include <vector>

#include "dem/touch.hpp"

namespace rattlebox::dem {

template <class T> T& at(std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T> const T& at(const std::vector<T>& v, int i) { return v[static_cast<std::size_t>(i)]; }

// What of it must be carried along when particles change their order.
struct Carried {
    Row friction, law, rolling, rolling_law, dent;
    real mu;
};

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
    std::vector<Kept> kept;
    std::vector<KeptRolling> rolling; // with rolling resistance only
    std::vector<Row> dent; // of a plastic law: deepest overlap, stiffness and origin of the curve that
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

    // Lanes past the end look at a particle that is at hand.
    void pad(int first_at_hand, int second_at_hand) {
        std::fill(first.begin() + size(), first.end(), first_at_hand);
        std::fill(second.begin() + size(), second.end(), second_at_hand);
    }

    int take() {
        if (!free.empty()) {
            const int s = free.back();
            free.pop_back();
            return s;
        }
        const auto one_more = [](auto& memory) {
            if (memory.size() == memory.capacity()) memory.reserve(memory.size() + memory.size() / 8 + 4);
            memory.emplace_back();
        };
        one_more(kept);
        if (rolls) one_more(rolling);
        if (dents) one_more(dent);
        return static_cast<int>(kept.size()) - 1;
    }

    void begin(int s, const Begun& b) {
        at(kept, s) = b.kept;
        if (rolls) at(rolling, s) = b.rolling;
        if (dents) at(dent, s) = b.dent;
    }

    void forget_all() {
        kept.clear(), rolling.clear(), dent.clear(), free.clear();
        actives = 0;
        resize(0);
        for (int& end : tier_end) end = 0;
    }

    Carried carried(int s) const {
        const Kept& k = at(kept, s);
        const KeptRolling r = rolls ? at(rolling, s) : KeptRolling{};
        return {k.friction, k.law, r.spring, r.law, dents ? at(dent, s) : Row{}, k.couple[3]};
    }

    // `sign` is -1 where the partners have changed places.
    int remember(const Carried& old, real sign) {
        const int s = take();
        const Row turn = row(sign, sign, sign, 1);
        at(kept, s) = Kept{Row{}, row(0, 0, 0, old.mu), turn * old.friction, old.law};
        if (rolls) at(rolling, s) = KeptRolling{Row{}, turn * old.rolling, old.rolling_law};
        if (dents) at(dent, s) = old.dent;
        return s;
    }

    std::size_t memory() const {
        std::size_t bytes = kept.capacity() * sizeof(Kept) + rolling.capacity() * sizeof(KeptRolling) +
                            dent.capacity() * sizeof(Row);
        for (const auto* v : {&first, &second, &origin, &slot, &active, &free})
            bytes += v->capacity() * sizeof(int);
        return bytes;
    }

    template <class Archive> void keep(Archive& a) {
        a(first, second, origin, slot, tier_end, active, actives, kept, rolling, dent, free);
    }
};

} // namespace rattlebox::dem
