// The instructions that the processor and the operating system offer.
#pragma once

namespace rattlebox {

// Returns the highest x86-64 level (System V ABI, section 3.1.1) among 1, 3 and 4; 0 on other processors.
inline int x86_64_level() {
#if defined(__x86_64__) || defined(_M_X64)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4")) return 4;
    if (__builtin_cpu_supports("x86-64-v3")) return 3;
    return 1;
#else
    return 0;
#endif
}

} // namespace rattlebox
