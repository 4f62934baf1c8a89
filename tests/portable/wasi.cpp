// What the C++ library for WebAssembly lacks. An exception that is thrown ends the program; objects of the
// only thread live until then.
#include <cstdio>
#include <cstdlib>

extern "C" {
void* __cxa_allocate_exception(std::size_t size) { return std::malloc(size); }
[[noreturn]] void __cxa_throw(void*, void*, void (*)(void*)) {
    std::fputs("an exception was thrown\n", stderr);
    std::abort();
}
int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }
}
