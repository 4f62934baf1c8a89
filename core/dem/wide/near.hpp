// A small world brought near: as much of it as fits into a small, fast memory, the most used first.
#pragma once

#include "dem/wide/step.hpp"

namespace rattlebox::dem::wide {

// Arrays that every step reads and most steps write: those of a copy, those of the bed at home, their
// lengths.
template <class F> void hot(Bed& b, Bed& home, F&& f) {
    const int n = home.particles;
    f(b.position, home.position, n), f(b.touching, home.touching, n), f(b.used, home.used, n);
    f(b.velocity, home.velocity, n), f(b.partner, home.partner, home.slots * n);
    f(b.incoming_begin, home.incoming_begin, n + 1), f(b.touched, home.touched, n);
    f(b.spin, home.spin, n), f(b.acceleration, home.acceleration, n), f(b.spin_rate, home.spin_rate, n);
}

inline int near_bytes(int count, std::size_t size) { return (count * static_cast<int>(size) + 31) / 32 * 32; }

// What there is to bring near.
inline int near_bytes(const World& w) {
    int bytes = 0;
    for (int b = 0; b < w.beds; ++b)
        hot(w.bed[b], w.bed[b],
            [&](auto*, auto* array, int count) { bytes += near_bytes(count, sizeof(*array)); });
    return bytes;
}

// Runs a world whose beds are copied to `beds` meanwhile, which have room in `memory`.
template <class Team>
void run_near(Team& team, World& home, World& own, Bed* beds, char* memory, int size, long until) {
    const bool alone = team.leads() && team.first();
    if (alone) {
        own = home;
        own.bed = beds;
        for (int b = 0; b < home.beds; ++b) beds[b] = home.bed[b];
    }
    team.sync();
    int used = 0;
    for (int b = 0; b < home.beds; ++b)
        hot(beds[b], home.bed[b], [&](auto*& array, auto* far, int count) {
            const int bytes = near_bytes(count, sizeof(*far));
            if (used + bytes > size) return;
            auto* near = reinterpret_cast<decltype(far)>(memory + used);
            team.each(count, [&](int i) { near[i] = far[i]; });
            if (alone) array = near;
            used += bytes;
        });
    team.sync();
    run(team, own, until);
    team.sync();
    for (int b = 0; b < home.beds; ++b)
        hot(beds[b], home.bed[b], [&](auto* near, auto* far, int count) {
            if (near != far) team.each(count, [&](int i) { far[i] = near[i]; });
        });
    team.sync();
    if (!alone) return;
    for (int b = 0; b < home.beds; ++b) {
        hot(beds[b], home.bed[b], [&](auto*& near, auto* far, int) { near = far; });
        home.bed[b] = beds[b];
    }
    own.bed = home.bed;
    home = own;
}

} // namespace rattlebox::dem::wide
