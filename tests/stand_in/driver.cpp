// A stand-in for NVIDIA's driver, for tests: of its functions those that are called here, as strict as they
// may be.
//
// Memory is a file that the card's process (card.cpp) maps at other addresses than this one does. What is new
// or given back is full of rubbish; what is asked of a stream is done by a thread of its own, in order; a
// copy that the real one may finish later than it returns is finished late.
#include "remote.hpp"

using namespace remote;

namespace {

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
