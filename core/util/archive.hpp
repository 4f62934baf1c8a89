// Binary serialization of plain data: Sizer, Writer and Reader take the same list of values in the same
// order.
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace rattlebox {

// Computes the size, so that a Writer allocates once.
class Sizer {
    template <class T> void item(const T&) { bytes += sizeof(T); }
    template <class T, class A> void item(const std::vector<T, A>& values) {
        bytes += sizeof(std::size_t) + values.size() * sizeof(T);
    }

public:
    static constexpr bool reads = false;
    std::size_t bytes = 0;

    template <class... T> void operator()(const T&... values) { (item(values), ...); }
};

class Writer {
    template <class T> void write(const T* data, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* from = reinterpret_cast<const std::uint8_t*>(data);
        bytes.insert(bytes.end(), from, from + count * sizeof(T));
    }
    template <class T> void item(const T& value) { write(&value, 1); }
    template <class T, class A> void item(const std::vector<T, A>& values) {
        item(values.size());
        write(values.data(), values.size());
    }

public:
    static constexpr bool reads = false;
    std::vector<std::uint8_t> bytes;

    explicit Writer(std::size_t size) { bytes.reserve(size); }
    // Writes into a buffer that has been used before.
    explicit Writer(std::vector<std::uint8_t>&& buffer) : bytes(std::move(buffer)) { bytes.clear(); }

    template <class... T> void operator()(const T&... values) { (item(values), ...); }
};

class Reader {
    const char* next_;
    const char* end_;

    template <class T> void read(T* data, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        if (count > static_cast<std::size_t>(end_ - next_) / sizeof(T))
            throw std::invalid_argument("the state is cut short");
        if (count > 0) std::memcpy(static_cast<void*>(data), next_, count * sizeof(T));
        next_ += count * sizeof(T);
    }
    template <class T> void item(T& value) { read(&value, 1); }
    void item(bool& value) {
        std::uint8_t byte;
        read(&byte, 1);
        if (byte > 1) throw std::invalid_argument("the state is damaged");
        value = byte != 0;
    }
    template <class T, class A> void item(std::vector<T, A>& values) {
        std::size_t count;
        item(count);
        if (count > static_cast<std::size_t>(end_ - next_) / sizeof(T))
            throw std::invalid_argument("the state is cut short");
        values.resize(count);
        read(values.data(), count);
    }

public:
    static constexpr bool reads = true;

    Reader(const char* data, std::size_t size) : next_(data), end_(data + size) {}

    template <class... T> void operator()(T&... values) { (item(values), ...); }
    bool at_end() const { return next_ == end_; }
};

} // namespace rattlebox
