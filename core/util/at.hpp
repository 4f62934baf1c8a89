// Elements of vectors by signed indices, without a cast at each place.
#pragma once

#include <cstddef>
#include <vector>

namespace rattlebox {

template <class T, class A> T& at(std::vector<T, A>& v, int i) { return v[static_cast<std::size_t>(i)]; }
template <class T, class A> const T& at(const std::vector<T, A>& v, int i) {
    return v[static_cast<std::size_t>(i)];
}

} // namespace rattlebox
