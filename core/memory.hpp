#pragma once
/// Memory that is freed stays with the process. Dense problems of a hundred unknowns allocate and free about a megabyte each; the C library hands
/// that back to the system every time, and fetching it again costs a quarter of a sweep. Programs that solve many call this once; results do not
/// depend on it.
///
///     int main() { whirl::keep_freed_memory(); ... }

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace whirl {

inline void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

}  // namespace whirl
