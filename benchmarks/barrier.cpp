// For each line of input, prints how long a meeting of two members of a team takes that have nothing else to
// do [us]: what a round trip between their cores takes.
#include <algorithm>
#include <cstdio>

#include "parallel/thread_pool.hpp"

int main() {
    using Clock = std::chrono::steady_clock;
    constexpr int meetings = 64;
    while (std::getchar() != EOF) {
        std::vector<double> took;
        rattlebox::run_parallel(2, [&](auto team) {
            for (int turn = 0; turn < 200; ++turn) {
                const auto begun = Clock::now();
                for (int k = 0; k < meetings; ++k) team.sync();
                const std::chrono::duration<double, std::micro> time = Clock::now() - begun;
                if (team.rank() == 0) took.push_back(time.count() / meetings);
            }
        });
        std::nth_element(took.begin(), took.begin() + took.size() / 2, took.end());
        std::printf("%.4f\n", took[took.size() / 2]);
        std::fflush(stdout);
    }
}
