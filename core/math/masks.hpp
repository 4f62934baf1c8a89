// Masks of lanes as bits: bit l belongs to lane l.
#pragma once

#include <bit>

#ifdef __AVX__
#include <immintrin.h>
#endif

#include "math/lanes.hpp"

namespace rattlebox {

inline unsigned positive(const Group& a) {
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask(a.v, _mm512_setzero_pd(), _CMP_GT_OQ);
#elif defined(__AVX__)
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, _mm256_setzero_pd(), _CMP_GT_OQ)));
#else
    unsigned bits = 0;
    for (int l = 0; l < group; ++l) bits |= static_cast<unsigned>(a.v[l] > 0) << l;
    return bits;
#endif
}

// Mask of the negative ones of eight integers.
inline unsigned negative(const int* numbers) {
#if defined(__AVX__)
    __m256 signs;
    __builtin_memcpy(&signs, numbers, sizeof(signs));
    return static_cast<unsigned>(_mm256_movemask_ps(signs));
#else
    unsigned bits = 0;
    for (int l = 0; l < lane_count; ++l) bits |= static_cast<unsigned>(numbers[l] < 0) << l;
    return bits;
#endif
}

// Mask of the first lanes.
inline unsigned first_lanes(int count) { return (1u << count) - 1; }

template <class F> void each_lane(unsigned bits, F&& f) {
    for (; bits != 0; bits &= bits - 1) f(std::countr_zero(bits));
}

// Table of the set bits of each mask of eight lanes, ascending.
struct SetBits {
    unsigned char of[1 << lane_count][lane_count] = {};

    constexpr SetBits() {
        for (unsigned bits = 0; bits < 1 << lane_count; ++bits)
            for (unsigned char l = 0, n = 0; l < lane_count; ++l)
                if (bits >> l & 1) of[bits][n++] = l;
    }
};
inline constexpr SetBits set_bits;

// Writes the indices of the set lanes, counted from `first`, and returns their number. Always writes eight
// values, so that no branch is needed.
inline int list_lanes(unsigned bits, int first, int* to) {
    for (int l = 0; l < lane_count; ++l) to[l] = first + set_bits.of[bits][l];
    return std::popcount(bits);
}

} // namespace rattlebox
