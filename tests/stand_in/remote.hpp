// The card as the driver sees it: results, streams, kernels that are loaded, and the card's memory and
// process.
#pragma once

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "wire.hpp"

extern char** environ;

namespace remote {

using Address = std::uint64_t;

enum Result : int {
    success = 0,
    invalid_value = 1,
    out_of_memory = 2,
    not_initialized = 3,
    invalid_device = 101,
    invalid_image = 200,
    invalid_context = 201,
    invalid_handle = 400,
    not_found = 500,
    not_ready = 600,
    illegal_address = 700,
    out_of_resources = 701,
    launch_failed = 719,
    cooperative_too_large = 720,
    not_supported = 801,
};
inline const std::map<int, const char*> names{
    {success, "CUDA_SUCCESS"},
    {invalid_value, "CUDA_ERROR_INVALID_VALUE"},
    {out_of_memory, "CUDA_ERROR_OUT_OF_MEMORY"},
    {not_initialized, "CUDA_ERROR_NOT_INITIALIZED"},
    {100, "CUDA_ERROR_NO_DEVICE"},
    {invalid_device, "CUDA_ERROR_INVALID_DEVICE"},
    {invalid_image, "CUDA_ERROR_INVALID_IMAGE"},
    {invalid_context, "CUDA_ERROR_INVALID_CONTEXT"},
    {invalid_handle, "CUDA_ERROR_INVALID_HANDLE"},
    {not_found, "CUDA_ERROR_NOT_FOUND"},
    {not_ready, "CUDA_ERROR_NOT_READY"},
    {illegal_address, "CUDA_ERROR_ILLEGAL_ADDRESS"},
    {out_of_resources, "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES"},
    {launch_failed, "CUDA_ERROR_LAUNCH_FAILED"},
    {cooperative_too_large, "CUDA_ERROR_COOPERATIVE_LAUNCH_TOO_LARGE"},
    {not_supported, "CUDA_ERROR_NOT_SUPPORTED"}};

// An error that the real driver may pass over, or tell of later, says here what it is.
inline Result refused(Result result, const char* why, ...) {
    std::va_list rest;
    va_start(rest, why);
    std::fprintf(stderr, "stand-in: ");
    std::vfprintf(stderr, why, rest);
    std::fprintf(stderr, "\n");
    va_end(rest);
    return result;
}

// What the card does, one after the other, beside whoever asks for it.
struct Stream {
    std::mutex mutex;
    std::condition_variable change;
    std::deque<std::function<void()>> asked;
    bool busy = false, over = false;
    std::thread worker{[this] { work(); }};

    void work() {
        std::unique_lock lock(mutex);
        for (;;) {
            change.wait(lock, [this] { return over || !asked.empty(); });
            if (asked.empty()) return;
            const auto next = std::move(asked.front());
            asked.pop_front();
            busy = true;
            lock.unlock();
            next();
            lock.lock();
            busy = false;
            change.notify_all();
        }
    }
    void ask(std::function<void()> what) {
        std::lock_guard lock(mutex);
        asked.push_back(std::move(what));
        change.notify_all();
    }
    bool works() {
        std::lock_guard lock(mutex);
        return busy || !asked.empty();
    }
    void wait() {
        std::unique_lock lock(mutex);
        change.wait(lock, [this] { return !busy && asked.empty(); });
    }
    ~Stream() {
        {
            std::lock_guard lock(mutex);
            over = true;
            change.notify_all();
        }
        worker.join();
    }
};

struct Kernel {
    wire::Kernel about;
    int library, index, shared_allowed = wire::shared_usual;

    int registers() const {
        return std::min(255, wire::registers_of_multiprocessor / (about.threads * about.blocks) / 8 * 8);
    }
    int blocks(int threads, std::size_t shared) const {
        const int taken = about.shared + static_cast<int>(shared) + wire::shared_reserved;
        return std::min({wire::threads_of_multiprocessor / threads, wire::blocks_of_multiprocessor,
                         wire::registers_of_multiprocessor / (registers() * threads),
                         wire::shared_of_multiprocessor / taken});
    }
};
struct Library {
    std::vector<std::unique_ptr<Kernel>> kernels;
};

class Card {
    std::mutex memory_;
    std::map<Address, std::size_t> live_;
    std::size_t size_ = wire::memory(), used_ = 0, reserved_ = 0;
    std::atomic<std::size_t> local_ = 0;
    char* mapped_;
    int file_, socket_ = -1;
    std::mutex wire_;
    std::atomic<int> broken_ = success;

    static constexpr std::size_t margin = wire::page, grain = 256, system = 32 << 20;
    static std::size_t room_of(std::size_t size) {
        return (size + wire::page - 1) / wire::page * wire::page + margin;
    }

public:
    std::vector<std::unique_ptr<Library>> libraries;
    std::vector<std::unique_ptr<Stream>> streams;
    std::uint64_t threshold = 0; // the pool keeps so many bytes when nobody asks for them

    Card() {
        file_ = memfd_create("card", MFD_CLOEXEC);
        if (ftruncate(file_, static_cast<off_t>(size_)) != 0) std::abort();
        mapped_ = static_cast<char*>(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0));
        Dl_info own;
        dladdr(reinterpret_cast<void*>(refused), &own);
        const std::string program = std::filesystem::path(own.dli_fname).parent_path() / "card";
        int ends[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
        // Above those that they become, so that none is in the other's way.
        const int far = fcntl(ends[1], F_DUPFD_CLOEXEC, 100), memory = fcntl(file_, F_DUPFD_CLOEXEC, 100);
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        posix_spawn_file_actions_adddup2(&files, far, wire::socket_at);
        posix_spawn_file_actions_adddup2(&files, memory, wire::memory_at);
        std::string name = program;
        char* arguments[] = {name.data(), nullptr};
        pid_t process;
        if (posix_spawn(&process, program.c_str(), &files, nullptr, arguments, environ) != 0) std::abort();
        close(ends[1]), close(far), close(memory);
        socket_ = ends[0];
    }

    void break_down(Result why) { broken_ = why; }
    Result broken() const { return static_cast<Result>(broken_.load()); }

    std::size_t total() const { return size_; }
    std::size_t reserved() {
        std::lock_guard lock(memory_);
        return reserved_;
    }
    std::size_t used() {
        std::lock_guard lock(memory_);
        return used_;
    }
    std::size_t free() {
        std::lock_guard lock(memory_);
        const std::size_t taken = system + reserved_ + local_;
        return size_ > taken ? size_ - taken : 0;
    }
    void trim(std::size_t keep) {
        std::lock_guard lock(memory_);
        reserved_ = std::max(used_, std::min<std::size_t>(reserved_, keep));
    }

    Result allocate(Address& address, std::size_t size) {
        std::lock_guard lock(memory_);
        const std::size_t room = room_of(size);
        Address begin = 0; // pages that nobody has
        for (const auto& [at, bytes] : live_) {
            const Address first = (at - wire::base) / wire::page * wire::page;
            if (first >= begin + room) break;
            begin = (at - wire::base + bytes + wire::page - 1) / wire::page * wire::page + margin;
        }
        if (begin + room > size_ || system + local_ + std::max(reserved_, used_ + room) > size_)
            return out_of_memory;
        std::memset(mapped_ + begin, wire::poison, room);
        // To the end of its last page, as far as the grain of addresses lets it.
        address = wire::base + begin + (room - margin - (size + grain - 1) / grain * grain);
        live_[address] = size;
        used_ += room, reserved_ = std::max(reserved_, used_);
        return success;
    }
    Result release(Address address) {
        std::lock_guard lock(memory_);
        const auto found = live_.find(address);
        if (found == live_.end()) return refused(invalid_value, "memory is given back that nobody has");
        const std::size_t size = found->second, rounded = (size + grain - 1) / grain * grain;
        char* begin = mapped_ + (address - wire::base);
        if (std::any_of(begin + size, begin + rounded,
                        [](char b) { return b != static_cast<char>(wire::poison); }))
            return refused(illegal_address, "something was written beyond the end of %zu bytes", size);
        std::memset(begin, wire::poison, size);
        used_ -= room_of(size);
        live_.erase(found);
        return success;
    }
    // Where bytes of one block are for this process; null where they are not all in one.
    char* bytes(Address address, std::size_t size) {
        std::lock_guard lock(memory_);
        auto after = live_.upper_bound(address);
        if (after == live_.begin()) return nullptr;
        const auto& [begin, room] = *--after;
        return address + size <= begin + room ? mapped_ + (address - wire::base) : nullptr;
    }

    Result load(const char* code) {
        const auto* head = reinterpret_cast<const Elf64_Ehdr*>(code);
        if (std::memcmp(code, ELFMAG, SELFMAG) != 0) return invalid_image;
        const std::size_t size = head->e_shoff + std::size_t{head->e_shnum} * head->e_shentsize;
        std::string path = std::filesystem::temp_directory_path() / "kernels-XXXXXX";
        const int file = mkstemp(path.data());
        if (write(file, code, size) != static_cast<ssize_t>(size)) return out_of_memory;
        close(file);
        std::lock_guard lock(wire_);
        wire::Request request{};
        request.load = 1;
        std::strncpy(request.path, path.c_str(), sizeof(request.path) - 1);
        wire::Answer answer{};
        if (!wire::send_all(socket_, &request, sizeof(request)) ||
            !wire::receive_all(socket_, &answer, sizeof(answer)))
            return invalid_image;
        auto library = std::make_unique<Library>();
        for (int k = 0; k < answer.kernels; ++k) {
            auto kernel = std::make_unique<Kernel>();
            kernel->library = static_cast<int>(libraries.size()), kernel->index = k;
            wire::receive_all(socket_, &kernel->about, sizeof(kernel->about));
            library->kernels.push_back(std::move(kernel));
        }
        unlink(path.c_str());
        libraries.push_back(std::move(library));
        return success;
    }

    // Local memory of all threads that the card can hold, from the first launch on.
    Result set_local_aside() {
        const std::size_t wanted =
            std::size_t{wire::local} * wire::threads_of_multiprocessor * wire::multiprocessors;
        std::lock_guard lock(memory_);
        if (system + wanted + reserved_ > size_) return out_of_memory;
        local_ = wanted;
        return success;
    }

    void run(wire::Request request) {
        if (broken_) return;
        std::vector<std::uint64_t> live;
        {
            std::lock_guard lock(memory_);
            for (const auto& [begin, size] : live_) live.push_back(begin), live.push_back(size);
        }
        request.live = static_cast<int>(live.size() / 2);
        std::lock_guard lock(wire_);
        wire::Answer answer{};
        if (!wire::send_all(socket_, &request, sizeof(request)) ||
            !wire::send_all(socket_, live.data(), live.size() * sizeof(live[0])) ||
            !wire::receive_all(socket_, &answer, sizeof(answer)))
            broken_ =
                illegal_address; // the card's process has died: it looked where nothing of the card's is
    }
};

} // namespace remote
