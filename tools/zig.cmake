# Toolchain of tools/wheel.py: Clang of zig, for Linux x86-64 with glibc 2.28. The environment variable ZIG is its path.
set(CMAKE_CXX_COMPILER "$ENV{ZIG}" c++ -target x86_64-linux-gnu.2.28)
set(CMAKE_CXX_ARCHIVE_CREATE "\"$ENV{ZIG}\" ar qc <TARGET> <LINK_FLAGS> <OBJECTS>")
set(CMAKE_CXX_ARCHIVE_FINISH "\"$ENV{ZIG}\" ranlib <TARGET>")
# Python.h leaves <cstdio> out with the stable ABI, and defines macros of the C library again.
set(CMAKE_CXX_FLAGS_INIT "-include cstdio -Wno-macro-redefined")
set(RATTLEBOX_ZIG ON)
