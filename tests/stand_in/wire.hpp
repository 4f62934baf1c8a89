// What driver.cpp and card.cpp tell each other, and the card that they play.
#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace wire {

constexpr std::uint64_t base = 0x600000000000; // where the card's memory begins, for the card alone
constexpr std::size_t page = 4096;
constexpr unsigned char poison = 0xFF; // not a number
constexpr int lanes = 32, multiprocessors = 2, threads_of_multiprocessor = 2048, threads_of_block = 1024;
constexpr int shared_usual = 48 << 10, shared_most = 227 << 10, shared_of_multiprocessor = 228 << 10,
              shared_reserved = 1 << 10;
constexpr int registers_of_multiprocessor = 65536, blocks_of_multiprocessor = 32;
constexpr int local = 32 << 10; // bytes of a thread that each kernel takes
constexpr int most_parameters = 16;
constexpr int socket_at = 3, memory_at = 4; // files of the card's process

struct Kernel {
    char name[64];
    int parameters, sizes[most_parameters], threads, blocks, shared;
};

struct Request {
    int load; // else launch
    char path[256];
    int library, kernel;
    unsigned grid, block, shared, resident; // blocks that are there at once
    int live;                               // blocks of memory that follow, begin and size of each
    std::uint64_t given[most_parameters];
};

struct Answer {
    int kernels; // of what was loaded, which follow; -1 when it failed
};

inline bool send_all(int to, const void* data, std::size_t size) {
    for (std::size_t at = 0; at < size;) {
        const ssize_t done = send(to, static_cast<const char*>(data) + at, size - at, MSG_NOSIGNAL);
        if (done <= 0) return false;
        at += static_cast<std::size_t>(done);
    }
    return true;
}
inline bool receive_all(int from, void* data, std::size_t size) {
    for (std::size_t at = 0; at < size;) {
        const ssize_t done = recv(from, static_cast<char*>(data) + at, size - at, 0);
        if (done <= 0) return false;
        at += static_cast<std::size_t>(done);
    }
    return true;
}
inline std::size_t memory() {
    const char* told = std::getenv("STAND_IN_MEMORY");
    return told ? std::strtoull(told, nullptr, 10) : std::size_t{2} << 30;
}

} // namespace wire
