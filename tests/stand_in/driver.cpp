// A stand-in for NVIDIA's driver, for tests: of its functions those that are called here, as strict as they
// may be.
//
// Memory is a file that the card's process (card.cpp) maps at other addresses than this one does. What is new
// or given back is full of rubbish; what is asked of a stream is done by a thread of its own, in order; a
// copy that the real one may finish later than it returns is finished late.
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

namespace {

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
const std::map<int, const char*> names{{success, "CUDA_SUCCESS"},
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
Result refused(Result result, const char* why, ...) {
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
        char path[] = "/tmp/kernels-XXXXXX";
        const int file = mkstemp(path);
        if (write(file, code, size) != static_cast<ssize_t>(size)) return out_of_memory;
        close(file);
        std::lock_guard lock(wire_);
        wire::Request request{};
        request.load = 1;
        std::strncpy(request.path, path, sizeof(request.path) - 1);
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
        unlink(path);
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

std::atomic<bool> initialized = false;
Card& card() {
    static Card* const made = new Card; // as long as the process
    return *made;
}
thread_local const void* context = nullptr;
const int the_context = 0, the_pool = 0;

template <class F> Result with_context(F&& f) {
    if (!initialized) return not_initialized;
    if (!context) return refused(invalid_context, "a thread without context calls");
    if (card().broken()) return card().broken();
    return f();
}
Result on_stream(void* stream, std::function<void()> what) {
    return with_context([&] {
        auto* own = static_cast<Stream*>(stream);
        const auto& all = card().streams;
        if (std::none_of(all.begin(), all.end(), [&](const auto& s) { return s.get() == own; }))
            return refused(invalid_handle, "a stream that is not there");
        own->ask(std::move(what));
        return success;
    });
}
std::vector<char> copied(const void* from, std::size_t size) {
    const char* begin = static_cast<const char*>(from);
    return {begin, begin + size};
}
Kernel* kernel_of(const void* handle) {
    for (const auto& library : card().libraries)
        for (const auto& kernel : library->kernels)
            if (kernel.get() == handle) return kernel.get();
    return nullptr;
}

// ---- what is called, by name

struct Attribute {
    int id, pad;
    union {
        char room[64];
        int cooperative;
    };
};
struct Config {
    unsigned grid[3], block[3], shared;
    void* stream;
    Attribute* attributes;
    unsigned count;
};

Result init(unsigned) {
    initialized = true;
    card();
    return success;
}
Result version(int* found) { return *found = 13000, success; }
Result error_name(int error, const char** name) {
    const auto found = names.find(error);
    *name = found == names.end() ? nullptr : found->second;
    return *name ? success : invalid_value;
}
Result device_count(int* count) { return *count = 1, success; }
Result device_get(int* device, int ordinal) {
    if (!initialized) return not_initialized;
    return *device = ordinal, ordinal == 0 ? success : invalid_device;
}
Result device_name(char* name, int size, int) {
    std::snprintf(name, static_cast<std::size_t>(size), "stand-in of the tests, no card");
    return success;
}
Result device_attribute(int* value, int which, int) {
    static const std::map<int, int> known{{1, wire::threads_of_block},
                                          {2, 1024},
                                          {3, 1024},
                                          {4, 64},
                                          {5, 2147483647},
                                          {6, 65535},
                                          {7, 65535},
                                          {8, wire::shared_usual},
                                          {10, wire::lanes},
                                          {12, wire::registers_of_multiprocessor},
                                          {16, wire::multiprocessors},
                                          {39, wire::threads_of_multiprocessor},
                                          {75, 9},
                                          {76, 0},
                                          {78, 1},
                                          {81, wire::shared_of_multiprocessor},
                                          {82, wire::registers_of_multiprocessor},
                                          {95, 1},
                                          {97, wire::shared_most},
                                          {106, wire::blocks_of_multiprocessor},
                                          {111, wire::shared_reserved},
                                          {115, 1}};
    const auto found = known.find(which);
    if (found == known.end()) return refused(invalid_value, "attribute %d of a device", which);
    return *value = found->second, success;
}
Result context_retain(const void** found, int) { return *found = &the_context, success; }
Result context_release(int) { return success; }
Result context_get(const void** found) { return *found = context, success; }
Result context_set(const void* wanted) { return context = wanted, success; }
Result context_device(int* device) {
    return with_context([&] { return *device = 0, success; });
}
Result priority_range(int* least, int* greatest) {
    return with_context([&] { return *least = 0, *greatest = -5, success; });
}
Result stream_create(void** stream, unsigned flags, int) {
    return with_context([&] {
        if (flags != 1) return refused(not_supported, "a stream that waits for the default one");
        card().streams.push_back(std::make_unique<Stream>());
        return *stream = card().streams.back().get(), success;
    });
}
Result stream_destroy(void* stream) {
    std::erase_if(card().streams, [&](const auto& s) { return s.get() == stream; });
    return success;
}
Result stream_wait(void* stream) {
    const Result known = on_stream(stream, [] {});
    if (known) return known;
    static_cast<Stream*>(stream)->wait();
    card().trim(card().threshold);
    return card().broken();
}
Result stream_query(void* stream) {
    return with_context([&] { return static_cast<Stream*>(stream)->works() ? not_ready : success; });
}
Result capturing(void*, int* status) { return *status = 0, success; }
Result memory_info(std::size_t* free, std::size_t* total) {
    return with_context([&] { return *free = card().free(), *total = card().total(), success; });
}
Result pool_of(const void** pool, int) { return *pool = &the_pool, success; }
Result pool_set(const void*, int which, void* value) {
    if (which != 4) return refused(invalid_value, "attribute %d of a pool", which);
    return card().threshold = *static_cast<std::uint64_t*>(value), success;
}
Result pool_get(const void*, int which, void* value) {
    auto& found = *static_cast<std::uint64_t*>(value);
    if (which == 4) return found = card().threshold, success;
    if (which == 5) return found = card().reserved(), success;
    if (which == 7) return found = card().used(), success;
    return refused(invalid_value, "attribute %d of a pool", which);
}
Result pool_trim(const void*, std::size_t keep) { return card().trim(keep), success; }
Result allocate(Address* address, std::size_t size, const void*, void* stream) {
    if (size == 0) return invalid_value;
    const Result known = on_stream(stream, [] {});
    return known ? known : card().allocate(*address, size);
}
Result release(Address address, void* stream) {
    return on_stream(stream, [=] {
        if (const Result found = card().release(address)) card().break_down(found);
    });
}
Result set_bytes(Address address, unsigned char byte, std::size_t size, void* stream) {
    char* to = card().bytes(address, size);
    if (!to) return refused(invalid_value, "%zu bytes are set that are not in one block", size);
    return on_stream(stream, [=] { std::memset(to, byte, size); });
}
Result to_card(Address address, const void* from, std::size_t size, void* stream) {
    char* to = card().bytes(address, size);
    if (!to) return refused(invalid_value, "%zu bytes are copied to what is not in one block", size);
    return on_stream(stream, [to, data = copied(from, size)] { std::copy(data.begin(), data.end(), to); });
}
// Of the default stream, for which others do not wait.
Result to_card_late(Address address, const void* from, std::size_t size) {
    return with_context([&] {
        char* to = card().bytes(address, size);
        if (!to) return refused(invalid_value, "%zu bytes are copied to what is not in one block", size);
        std::thread([to, data = copied(from, size)] {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            std::copy(data.begin(), data.end(), to);
        }).detach();
        return success;
    });
}
Result from_card(void* to, Address address, std::size_t size) {
    return with_context([&] {
        const char* from = card().bytes(address, size);
        if (!from) return refused(invalid_value, "%zu bytes are copied from what is not in one block", size);
        return std::memcpy(to, from, size), success;
    });
}
Result from_card_later(void* to, Address address, std::size_t size, void* stream) {
    const char* from = card().bytes(address, size);
    if (!from) return refused(invalid_value, "%zu bytes are copied from what is not in one block", size);
    return on_stream(stream, [=] { std::memcpy(to, from, size); });
}
Result library_load(void** library, const void* code, void*, void*, unsigned, void*, void*, unsigned) {
    return with_context([&] {
        const Result done = card().load(static_cast<const char*>(code));
        if (done == success) *library = card().libraries.back().get();
        return done;
    });
}
Result library_unload(void*) { return success; }
Result library_kernel(void** kernel, void* library, const char* name) {
    for (const auto& own : static_cast<Library*>(library)->kernels)
        if (std::strcmp(own->about.name, name) == 0) return *kernel = own.get(), success;
    return not_found;
}
Result kernel_attribute(int* value, int which, void* handle, int) {
    const Kernel* kernel = kernel_of(handle);
    if (!kernel) return invalid_handle;
    const std::map<int, int> known{{0, kernel->about.threads},
                                   {1, kernel->about.shared},
                                   {3, wire::local},
                                   {4, kernel->registers()},
                                   {8, kernel->shared_allowed}};
    const auto found = known.find(which);
    if (found == known.end()) return refused(invalid_value, "attribute %d of a kernel", which);
    return *value = found->second, success;
}
Result kernel_allow(int which, int value, void* handle, int) {
    Kernel* kernel = kernel_of(handle);
    if (!kernel) return invalid_handle;
    if (which != 8 || value < 0 || value + kernel->about.shared > wire::shared_most)
        return refused(invalid_value, "attribute %d of a kernel becomes %d", which, value);
    return kernel->shared_allowed = value, success;
}
Result kernel_parameter(void* handle, std::size_t which, std::size_t* offset, std::size_t* size) {
    const Kernel* kernel = kernel_of(handle);
    if (!kernel) return invalid_handle;
    if (which >= static_cast<std::size_t>(kernel->about.parameters)) return invalid_value;
    *offset = 0;
    for (std::size_t k = 0; k <= which; ++k) {
        *size = static_cast<std::size_t>(std::abs(kernel->about.sizes[k]));
        if (k < which) *offset += *size;
    }
    return success;
}
Result kernel_function(void** function, void* kernel) { return *function = kernel, success; }
Result occupancy(int* blocks, void* handle, int threads, std::size_t shared) {
    const Kernel* kernel = kernel_of(handle);
    if (!kernel) return invalid_handle;
    if (threads < 1 || threads > wire::threads_of_block) return invalid_value;
    return *blocks = threads > kernel->about.threads ? 0 : kernel->blocks(threads, shared), success;
}
Result launch(const Config* config, void* handle, void** given, void**) {
    const Kernel* kernel = kernel_of(handle);
    if (!kernel) return invalid_handle;
    const wire::Kernel& about = kernel->about;
    const auto [grid, block, shared] = std::tuple(config->grid[0], config->block[0], config->shared);
    if (grid == 0 || block == 0 ||
        config->grid[1] * config->grid[2] * config->block[1] * config->block[2] != 1)
        return refused(invalid_value, "%s: %u blocks of %u threads", about.name, grid, block);
    if (block > static_cast<unsigned>(about.threads))
        return refused(out_of_resources, "%s: %u threads, compiled for %d", about.name, block, about.threads);
    if (shared > static_cast<unsigned>(kernel->shared_allowed))
        return refused(invalid_value, "%s: %u bytes of shared memory, %d are allowed", about.name, shared,
                       kernel->shared_allowed);
    const unsigned resident =
        static_cast<unsigned>(kernel->blocks(static_cast<int>(block), shared)) * wire::multiprocessors;
    for (unsigned k = 0; k < config->count; ++k)
        if (config->attributes[k].id == 2 && config->attributes[k].cooperative && grid > resident)
            return refused(cooperative_too_large, "%s: %u blocks, %u are there at once", about.name, grid,
                           resident);
    if (const Result local = card().set_local_aside()) return local;
    wire::Request request{};
    request.library = kernel->library, request.kernel = kernel->index;
    request.grid = grid, request.block = block, request.shared = shared, request.resident = resident;
    for (int k = 0; k < about.parameters; ++k) {
        std::memcpy(&request.given[k], given[k], static_cast<std::size_t>(std::abs(about.sizes[k])));
        if (about.sizes[k] < 0 && !card().bytes(request.given[k], 1))
            return refused(illegal_address, "%s: argument %d is no place in the card's memory", about.name,
                           k);
    }
    return on_stream(config->stream, [=] { card().run(request); });
}

const std::map<std::string, void*> functions{
#define FUNCTION(name, own) {#name, reinterpret_cast<void*>(own)}
    FUNCTION(cuInit, init),
    FUNCTION(cuDriverGetVersion, version),
    FUNCTION(cuGetErrorName, error_name),
    FUNCTION(cuGetErrorString, error_name),
    FUNCTION(cuDeviceGetCount, device_count),
    FUNCTION(cuDeviceGet, device_get),
    FUNCTION(cuDeviceGetName, device_name),
    FUNCTION(cuDeviceGetAttribute, device_attribute),
    FUNCTION(cuDevicePrimaryCtxRetain, context_retain),
    FUNCTION(cuDevicePrimaryCtxRelease, context_release),
    FUNCTION(cuCtxGetCurrent, context_get),
    FUNCTION(cuCtxSetCurrent, context_set),
    FUNCTION(cuCtxGetDevice, context_device),
    FUNCTION(cuCtxGetStreamPriorityRange, priority_range),
    FUNCTION(cuStreamCreateWithPriority, stream_create),
    FUNCTION(cuStreamDestroy, stream_destroy),
    FUNCTION(cuStreamSynchronize, stream_wait),
    FUNCTION(cuStreamQuery, stream_query),
    FUNCTION(cuStreamIsCapturing, capturing),
    FUNCTION(cuMemGetInfo, memory_info),
    FUNCTION(cuDeviceGetDefaultMemPool, pool_of),
    FUNCTION(cuDeviceGetMemPool, pool_of),
    FUNCTION(cuMemPoolSetAttribute, pool_set),
    FUNCTION(cuMemPoolGetAttribute, pool_get),
    FUNCTION(cuMemPoolTrimTo, pool_trim),
    FUNCTION(cuMemAllocFromPoolAsync, allocate),
    FUNCTION(cuMemFreeAsync, release),
    FUNCTION(cuMemsetD8Async, set_bytes),
    FUNCTION(cuMemcpyHtoD, to_card_late),
    FUNCTION(cuMemcpyHtoDAsync, to_card),
    FUNCTION(cuMemcpyDtoH, from_card),
    FUNCTION(cuMemcpyDtoHAsync, from_card_later),
    FUNCTION(cuLibraryLoadData, library_load),
    FUNCTION(cuLibraryUnload, library_unload),
    FUNCTION(cuLibraryGetKernel, library_kernel),
    FUNCTION(cuKernelGetAttribute, kernel_attribute),
    FUNCTION(cuKernelSetAttribute, kernel_allow),
    FUNCTION(cuKernelGetParamInfo, kernel_parameter),
    FUNCTION(cuKernelGetFunction, kernel_function),
    FUNCTION(cuOccupancyMaxActiveBlocksPerMultiprocessor, occupancy),
    FUNCTION(cuLaunchKernelEx, launch),
};

} // namespace

extern "C" Result cuGetProcAddress_v2(const char* name, void** found, int, std::uint64_t, int* status) {
    const auto own = functions.find(name);
    *found = own == functions.end() ? nullptr : own->second; // which is told with its name when it is called
    if (status) *status = *found ? 0 : 1;
    return *found ? success : not_found;
}
