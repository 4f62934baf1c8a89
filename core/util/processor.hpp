// The instructions that the processor and the operating system offer.
//
// __builtin_cpu_supports is not used: the run-time library of zig 0.17 answers that nothing is supported.
#pragma once

#if defined(__x86_64__) || defined(_M_X64)
#include <cpuid.h>
#endif

namespace rattlebox {

// Returns the highest x86-64 level (System V ABI, section 3.1.1) among 1, 3 and 4; 0 on other processors.
// The bits are those of CPUID, and of the register XCR0, where the operating system states which registers it
// saves (Intel 64 and IA-32 Architectures Software Developer's Manual, volumes 1, chapter 13, and 2A, CPUID).
inline int x86_64_level() {
#if defined(__x86_64__) || defined(_M_X64)
    const auto all_of = [](unsigned word, auto... bits) { return ((word >> bits & 1u) & ...) != 0; };
    unsigned a, b, c, d, features, extended, more;
    if (!__get_cpuid(1, &a, &b, &features, &d) || !__get_cpuid_count(7, 0, &a, &extended, &c, &d) ||
        !__get_cpuid(0x80000001, &a, &b, &more, &d))
        return 1;
    // FMA, MOVBE, OSXSAVE, AVX, F16C; BMI1, AVX2, BMI2; LZCNT
    if (!all_of(features, 12, 22, 27, 28, 29) || !all_of(extended, 3, 5, 8) || !all_of(more, 5)) return 1;
    unsigned saved, upper;
    __asm__ volatile("xgetbv" : "=a"(saved), "=d"(upper) : "c"(0));
    if (!all_of(saved, 1, 2)) return 1; // XMM, YMM
    // AVX512F, DQ, CD, BW, VL; mask registers and both parts of the ZMM registers
    return all_of(extended, 16, 17, 28, 30, 31) && all_of(saved, 5, 6, 7) ? 4 : 3;
#else
    return 0;
#endif
}

} // namespace rattlebox
