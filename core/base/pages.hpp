// Memory of large models, in large pages: lists and rows that lie on thousands of small ones spend much of
// their time on finding out where these are. All of it goes when the store goes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace rattlebox {

class Pages {
    static constexpr std::size_t line = 64, page = std::size_t{1} << 21;
    static constexpr std::align_val_t on_page{page};

    struct Free {
        void operator()(char* p) const { ::operator delete(p, on_page); }
    };

    std::mutex lock_;
    std::vector<std::unique_ptr<char, Free>> regions_;
    std::multimap<std::size_t, char*> free_; // blocks by size
    std::size_t mapped_ = 0, lent_ = 0;

    static std::size_t up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

    // A little more than is needed now, for what comes next.
    void map(std::size_t bytes) {
        bytes = up(std::max(bytes, mapped_ / 16), page);
        char* const begin = static_cast<char*>(::operator new(bytes, on_page));
        regions_.emplace_back(begin);
#ifdef __linux__
        madvise(begin, bytes, MADV_HUGEPAGE); // where there are none, small ones do
#endif
        free_.emplace(bytes, begin);
        mapped_ += bytes;
    }

    // Free blocks that lie side by side become one.
    void merge() {
        std::map<char*, std::size_t> by_place;
        for (const auto& [bytes, block] : free_) by_place.emplace(block, bytes);
        free_.clear();
        for (auto from = by_place.begin(); from != by_place.end();) {
            auto [block, bytes] = *from;
            while (++from != by_place.end() && from->first == block + bytes) bytes += from->second;
            free_.emplace(bytes, block);
        }
    }

public:
    Pages() = default;
    Pages(const Pages&) = delete;
    Pages& operator=(const Pages&) = delete;

    void* take(std::size_t bytes) {
        const std::lock_guard guard(lock_);
        bytes = up(bytes, line);
        auto found = free_.lower_bound(bytes);
        if (found == free_.end()) merge(), found = free_.lower_bound(bytes);
        if (found == free_.end()) map(bytes), found = free_.lower_bound(bytes);
        const auto [room, block] = *found;
        free_.erase(found);
        if (room > bytes) free_.emplace(room - bytes, block + bytes);
        lent_ += bytes;
        return block;
    }

    void give_back(void* block, std::size_t bytes) {
        const std::lock_guard guard(lock_);
        bytes = up(bytes, line);
        free_.emplace(bytes, static_cast<char*>(block));
        lent_ -= bytes;
    }

    // Bytes that nobody uses.
    std::size_t idle() const { return mapped_ - lent_; }
};

// Takes from a store, or from the heap where there is none.
template <class T> struct FromPages {
    using value_type = T;
    using propagate_on_container_move_assignment = std::true_type;
    using propagate_on_container_swap = std::true_type;

    Pages* pages = nullptr;

    FromPages() = default;
    FromPages(Pages* pages) : pages(pages) {}
    template <class U> FromPages(const FromPages<U>& other) : pages(other.pages) {}

    T* allocate(std::size_t n) const {
        return pages ? static_cast<T*>(pages->take(n * sizeof(T))) : std::allocator<T>().allocate(n);
    }
    void deallocate(T* block, std::size_t n) const {
        pages ? pages->give_back(block, n * sizeof(T)) : std::allocator<T>().deallocate(block, n);
    }
    template <class U> bool operator==(const FromPages<U>& other) const { return pages == other.pages; }
};

template <class T> using Paged = std::vector<T, FromPages<T>>;

} // namespace rattlebox
