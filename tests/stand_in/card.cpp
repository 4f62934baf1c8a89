// The card of driver.cpp: a process of its own, so that kernels see the card's memory and no other, and die
// alone.
//
// A block is a thread of the system; its threads take turns, each as far as it gets, in an order that
// STAND_IN_ORDER names: "forwards", "backwards", or a number that shuffles them.
#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <poll.h>
#include <setjmp.h>
#include <sys/mman.h>
#include <ucontext.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "wire.hpp"
#include "words.hpp"

extern "C" {
__thread Index threadIdx, blockIdx, blockDim, gridDim;
}

namespace {

constexpr std::size_t stack_size = 256 << 10;

[[noreturn]] void die(const std::string& why) {
    std::fprintf(stderr, "stand-in: %s\n", why.c_str());
    std::fflush(stderr);
    _exit(1);
}

// Memory of the calls of a thread, which keeps to it; kept for the next one.
class Stacks {
    std::mutex mutex_;
    std::vector<char*> free_;

public:
    char* take() {
        std::lock_guard lock(mutex_);
        if (!free_.empty()) {
            char* const stack = free_.back();
            free_.pop_back();
            return stack;
        }
        void* made = mmap(nullptr, stack_size + wire::page, PROT_READ | PROT_WRITE,
                          MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (made == MAP_FAILED || mprotect(made, wire::page, PROT_NONE) != 0) die("no memory for stacks");
        return static_cast<char*>(made) + wire::page;
    }
    void give_back(char* stack) {
        std::lock_guard lock(mutex_);
        free_.push_back(stack);
    }
} stacks;

struct Launch {
    const StandInKernel* kernel;
    std::uint64_t given[wire::most_parameters];
    unsigned grid, block, shared;
};

struct Lanes { // of a warp, that wait for each other
    unsigned mask = 0, arrived = 0, round = 0;
    int bytes = 0;
    double values[2][wire::lanes]; // of this round and of the one before, which some have not read yet
};

class Block {
    enum State { ready, at_barrier, among_lanes, done };
    struct Thread {
        ucontext_t begin;
        jmp_buf here;
        State state;
        bool begun;
        unsigned round; // of its lanes, which it waits for the end of
    };

    std::vector<char*> stacks_;
    std::vector<Thread> threads_;
    std::vector<Lanes> lanes_;
    const Launch& launch_;
    std::mt19937_64 random_;
    std::vector<unsigned> order_;
    bool shuffled_ = false, paused_ = false;
    unsigned at_barrier_ = 0, done_ = 0;
    unsigned next_ = 0, turns_ = 0, now_ = 0; // in the order of this pass; so far in it; at work
    jmp_buf home_;

    static void entry();
    // Goes on with the next thread that can, in this pass.
    [[noreturn]] void pass_on() {
        while (next_ < threads_.size()) {
            now_ = order_[next_++];
            Thread& t = threads_[now_];
            if (t.state == among_lanes && lanes_[now_ / wire::lanes].round != t.round) t.state = ready;
            if (t.state != ready) continue;
            ++turns_;
            threadIdx = {now_, 0, 0};
            if (t.begun) _longjmp(t.here, 1);
            t.begun = true;
            setcontext(&t.begin);
        }
        _longjmp(home_, 1);
    }
    void leave(State state) {
        Thread& t = threads_[now_];
        t.state = state;
        if (_setjmp(t.here) == 0) pass_on();
    }

public:
    inline static thread_local Block* at_work = nullptr;

    Block(const Launch& launch, unsigned seed)
        : stacks_(launch.block), threads_(launch.block),
          lanes_((launch.block + wire::lanes - 1) / wire::lanes), launch_(launch), random_(seed),
          order_(launch.block) {
        std::generate(stacks_.begin(), stacks_.end(), [] { return stacks.take(); });
        std::iota(order_.begin(), order_.end(), 0u);
        const std::string order = std::getenv("STAND_IN_ORDER") ? std::getenv("STAND_IN_ORDER") : "forwards";
        if (order == "backwards")
            std::reverse(order_.begin(), order_.end());
        else if (order != "forwards")
            shuffled_ = true, random_.seed(seed + std::stoul(order));
    }

    ~Block() {
        std::for_each(stacks_.begin(), stacks_.end(), [](char* stack) { stacks.give_back(stack); });
    }

    void run(unsigned index) {
        at_work = this;
        blockIdx = {index, 0, 0}, blockDim = {launch_.block, 1, 1}, gridDim = {launch_.grid, 1, 1};
        at_barrier_ = done_ = 0;
        for (Lanes& lanes : lanes_) lanes = Lanes{};
        for (unsigned i = 0; i < threads_.size(); ++i) {
            Thread& t = threads_[i];
            t.state = ready, t.begun = false;
            getcontext(&t.begin);
            // Their tops are not alike, so that caches hold them all.
            t.begin.uc_stack.ss_sp = stacks_[i], t.begin.uc_stack.ss_size = stack_size - 320 * (i % 64);
            t.begin.uc_link = nullptr;
            makecontext(&t.begin, entry, 0);
        }
        while (done_ < threads_.size()) {
            if (shuffled_) std::shuffle(order_.begin(), order_.end(), random_);
            next_ = turns_ = 0, paused_ = false;
            if (_setjmp(home_) == 0) pass_on();
            if (at_barrier_ == threads_.size()) {
                for (Thread& t : threads_) t.state = ready;
                at_barrier_ = 0;
            } else if (turns_ == 0) {
                stuck();
            } else if (paused_) {
                std::this_thread::yield(); // other blocks may have to come first
            }
        }
    }

    [[noreturn]] void stuck() const {
        die(std::string(launch_.kernel->name) + " waits for ever: of " + std::to_string(threads_.size()) +
            " threads " + std::to_string(at_barrier_) + " are at a barrier, " + std::to_string(done_) +
            " have ended");
    }

    void pause() {
        paused_ = true;
        leave(ready);
    }
    void barrier() {
        ++at_barrier_;
        leave(at_barrier);
    }
    void exchange(unsigned mask, const void* mine, void* other, int bytes, int from) {
        const unsigned lane = now_ % wire::lanes;
        Lanes& lanes = lanes_[now_ / wire::lanes];
        if (!(mask >> lane & 1u)) die("a lane that is not in its mask");
        if (lanes.arrived == 0) lanes.mask = mask, lanes.bytes = bytes;
        if (lanes.mask != mask || lanes.bytes != bytes)
            die("lanes that wait at different places for each other");
        double* values = lanes.values[lanes.round % 2];
        if (bytes > 0) std::memcpy(values + lane, mine, static_cast<std::size_t>(bytes));
        lanes.arrived |= 1u << lane;
        if (lanes.arrived == mask) {
            lanes.arrived = 0, ++lanes.round;
        } else {
            threads_[now_].round = lanes.round;
            leave(among_lanes);
        }
        if (from >= 0 && bytes > 0) std::memcpy(other, values + from, static_cast<std::size_t>(bytes));
    }

    void work() {
        void* given[wire::most_parameters];
        for (int k = 0; k < launch_.kernel->parameters; ++k)
            given[k] = const_cast<std::uint64_t*>(&launch_.given[k]);
        launch_.kernel->call(launch_.kernel->kernel, given);
        ++done_;
        threads_[now_].state = done;
        pass_on();
    }
};

void Block::entry() { at_work->work(); }

// The shared memory of a block: what its library keeps for each thread of the system.
struct Shared {
    char* begin = nullptr;
    std::size_t size = 0;
    char* near = nullptr; // of which the size is told at a launch
};

struct Library {
    const StandInKernel* kernels;
    int count, threads, blocks;
    char* (*near)();
    std::string path;

    Shared shared() const {
        Shared found;
        found.near = near(); // from then on it is there
        std::pair<Shared*, const std::string*> wanted{&found, &path};
        dl_iterate_phdr(
            [](dl_phdr_info* info, std::size_t, void* data) {
                const auto& [shared, path] = *static_cast<std::pair<Shared*, const std::string*>*>(data);
                if (*path != info->dlpi_name) return 0;
                for (int k = 0; k < info->dlpi_phnum; ++k)
                    if (info->dlpi_phdr[k].p_type == PT_TLS)
                        shared->begin = static_cast<char*>(info->dlpi_tls_data),
                        shared->size = info->dlpi_phdr[k].p_memsz;
                return 1;
            },
            &wanted);
        return found;
    }
};

void run_blocks(const Library& library, const Launch& launch, std::atomic<unsigned>& next, unsigned seed) {
    const Shared shared = library.shared();
    Block block(launch, seed);
    for (unsigned k = next++; k < launch.grid; k = next++) {
        std::memset(shared.begin, wire::poison, shared.size);
        block.run(k);
        if (!std::all_of(shared.near + launch.shared, shared.near + wire::shared_most,
                         [](char byte) { return byte == static_cast<char>(wire::poison); }))
            die(std::string(launch.kernel->name) + " wrote beyond its shared memory");
    }
}

void launch(const Library& library, const wire::Request& asked) {
    Launch launch{library.kernels + asked.kernel, {}, asked.grid, asked.block, asked.shared};
    std::copy(std::begin(asked.given), std::end(asked.given), launch.given);
    if (std::getenv("STAND_IN_TELLS"))
        std::fprintf(stderr, "stand-in: %s begins, %u blocks of %u threads\n", launch.kernel->name,
                     launch.grid, launch.block);
    std::atomic<unsigned> next{0};
    std::vector<std::thread> teams;
    for (unsigned k = 0; k < std::min(asked.grid, asked.resident); ++k)
        teams.emplace_back([&, k] { run_blocks(library, launch, next, k); });
    for (std::thread& team : teams) team.join();
}

Library load(const char* path) {
    void* found = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!found) die(dlerror());
    const auto at = [&](const char* name) { return dlsym(found, name); };
    return {static_cast<const StandInKernel*>(at("stand_in_kernels")),
            *static_cast<const int*>(at("stand_in_count")),
            *static_cast<const int*>(at("stand_in_threads")),
            *static_cast<const int*>(at("stand_in_blocks")),
            reinterpret_cast<char* (*)()>(at("stand_in_near")),
            path};
}

void answer(const Library& library) {
    const wire::Answer answer{library.count};
    wire::send_all(wire::socket_at, &answer, sizeof(answer));
    for (int k = 0; k < library.count; ++k) {
        const StandInKernel& kernel = library.kernels[k];
        wire::Kernel told{};
        std::strncpy(told.name, kernel.name, sizeof(told.name) - 1);
        told.parameters = kernel.parameters;
        std::copy_n(kernel.sizes, kernel.parameters, told.sizes);
        told.threads = library.threads, told.blocks = library.blocks;
        told.shared = static_cast<int>(library.shared().size) - wire::shared_most;
        wire::send_all(wire::socket_at, &told, sizeof(told));
    }
}

} // namespace

extern "C" {
void stand_in_barrier() { Block::at_work->barrier(); }
void stand_in_lanes(unsigned mask, const void* own, void* other, int bytes, int from) {
    Block::at_work->exchange(mask, own, other, bytes, from);
}
void stand_in_pause() { Block::at_work->pause(); }
void stand_in_trap() { die("a trap"); }
}

int main() {
    std::signal(SIGINT, SIG_IGN); // of a terminal, for whoever uses it
    const std::size_t size = wire::memory();
    void* wanted = reinterpret_cast<void*>(wire::base);
    if (mmap(wanted, size, PROT_NONE, MAP_SHARED | MAP_FIXED_NOREPLACE, wire::memory_at, 0) != wanted)
        die("no room for the card's memory");
    std::thread([] { // gone with whoever uses it, in the middle of a kernel too
        pollfd look{wire::socket_at, POLLRDHUP, 0};
        while (!(look.revents & (POLLRDHUP | POLLHUP))) poll(&look, 1, -1);
        _exit(0);
    })
        .detach();
    std::vector<Library> libraries;
    for (wire::Request asked; wire::receive_all(wire::socket_at, &asked, sizeof(asked));) {
        if (asked.load) {
            libraries.push_back(load(asked.path));
            answer(libraries.back());
            continue;
        }
        std::vector<std::uint64_t> live(2 * static_cast<std::size_t>(asked.live));
        if (!wire::receive_all(wire::socket_at, live.data(), live.size() * sizeof(live[0]))) break;
        const auto whole_pages = [&](int access) {
            for (std::size_t k = 0; k < live.size(); k += 2) {
                const std::uint64_t begin = live[k] / wire::page * wire::page;
                const std::uint64_t end = (live[k] + live[k + 1] + wire::page - 1) / wire::page * wire::page;
                mprotect(reinterpret_cast<void*>(begin), end - begin, access);
            }
        };
        whole_pages(PROT_READ | PROT_WRITE);
        launch(libraries[static_cast<std::size_t>(asked.library)], asked);
        whole_pages(PROT_NONE);
        const wire::Answer done{0};
        wire::send_all(wire::socket_at, &done, sizeof(done));
    }
    return 0;
}
