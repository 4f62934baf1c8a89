// Where threads begin. Schedulers may leave a new thread beside its maker for tens of milliseconds, and those
// that wait for each other in each microsecond get nowhere on one core.
#pragma once

#ifdef __linux__
#include <sched.h>
#endif

namespace rattlebox {

#ifdef __linux__
// The cores that the thread which makes this may use, and the one that it is on.
class Cores {
    cpu_set_t allowed_;
    int here_, count_;

public:
    Cores() : here_(sched_getcpu()), count_(0) {
        if (here_ < 0 || sched_getaffinity(0, sizeof(allowed_), &allowed_) != 0) return;
        if (CPU_ISSET(here_, &allowed_)) count_ = CPU_COUNT(&allowed_);
    }

    // Moves the calling thread `places` on among these; from there it may be moved like any other.
    void begin(int places) const {
        if (places >= count_) return;
        int core = here_;
        while (places > 0) {
            core = (core + 1) % CPU_SETSIZE;
            if (CPU_ISSET(core, &allowed_)) --places;
        }
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(core, &one);
        if (sched_setaffinity(0, sizeof(one), &one) == 0) sched_setaffinity(0, sizeof(allowed_), &allowed_);
    }
};
#else
struct Cores {
    void begin(int) const {}
};
#endif

} // namespace rattlebox
