// A tagged union of trivially copyable types, which holds one of several contact laws.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

namespace rattlebox {

template <class... Types> class Variant {
    static_assert((std::is_trivially_copyable_v<Types> && ...), "laws are plain data");

    static constexpr std::size_t largest() {
        std::size_t size = 0;
        ((size = sizeof(Types) > size ? sizeof(Types) : size), ...);
        return size;
    }

    alignas(Types...) std::byte storage_[largest()]{};
    int index_ = 0;

    template <class T> static constexpr int index_of() {
        int index = -1, position = 0;
        ((std::is_same_v<T, Types> ? void(index = position) : void(), ++position), ...);
        return index;
    }

    template <class T> const T& as() const { return *std::launder(reinterpret_cast<const T*>(storage_)); }

    template <class First, class... Rest, class F> decltype(auto) visit_from(F&& f) const {
        if constexpr (sizeof...(Rest) == 0) {
            return f(as<First>());
        } else {
            if (index_ == index_of<First>()) return f(as<First>());
            return visit_from<Rest...>(f);
        }
    }

public:
    template <class T> T& set(const T& value) {
        static_assert(index_of<T>() >= 0, "not one of the choices");
        index_ = index_of<T>();
        return *new (storage_) T(value);
    }

    template <class F> decltype(auto) visit(F&& f) const { return visit_from<Types...>(f); }

    template <class T> const T* get_if() const { return index_ == index_of<T>() ? &as<T>() : nullptr; }

    // Index of the type in the list of types.
    int index() const { return index_; }

    // Calls f<T>(index) for each type.
    template <class F> __attribute__((always_inline)) static void each(F&& f) {
        int index = 0;
        (f.template operator()<Types>(index++), ...);
    }
};

} // namespace rattlebox
