// Starts each worker on a different core; the scheduler may move it later. Some schedulers leave a new thread
// on the core of its creator for tens of milliseconds. Measured as the first 100 steps of 1000 particles on
// two idle cores: 25 ms without it, 4 ms with it; when other programs use the cores, it costs time (time
// without it over time with it, in windows of 250 steps: 0.78 to 0.98).
#pragma once

#ifdef __linux__
#include <sched.h>
#endif

namespace rattlebox {

#ifdef __linux__
// The cores that the constructing thread may use, and its current core.
class CorePlacement {
    cpu_set_t allowed_;
    int here_, count_;

public:
    CorePlacement() : here_(sched_getcpu()), count_(0) {
        if (here_ < 0 || sched_getaffinity(0, sizeof(allowed_), &allowed_) != 0) return;
        if (CPU_ISSET(here_, &allowed_)) count_ = CPU_COUNT(&allowed_);
    }

    // Moves the calling thread to the core `steps` after the current one, then allows all cores again.
    void place(int steps) const {
        if (steps >= count_) return;
        int core = here_;
        while (steps > 0) {
            core = (core + 1) % CPU_SETSIZE;
            if (CPU_ISSET(core, &allowed_)) --steps;
        }
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(core, &one);
        if (sched_setaffinity(0, sizeof(one), &one) == 0) sched_setaffinity(0, sizeof(allowed_), &allowed_);
    }
};
#else
struct CorePlacement {
    void place(int) const {}
};
#endif

} // namespace rattlebox
