#include "cli/heap.hpp"

#include <cstdint>
#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace pwlsim::cli {

#ifdef __GLIBC__

namespace {

constexpr int mebibyte = 1 << 20;
constexpr int at_first = 64 * mebibyte;  ///< of addresses; memory is mapped where it is used
constexpr int more_at_once = 16 * mebibyte;
constexpr std::uintptr_t large_page = 2 * mebibyte;

std::uintptr_t address(const void* at) { return reinterpret_cast<std::uintptr_t>(at); }

}  // namespace

/// Advice only: a system without large pages refuses it, and has lost nothing but addresses.
void prepare_heap() {
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  mallopt(M_TRIM_THRESHOLD, 256 * mebibyte);
  mallopt(M_TOP_PAD, at_first);
  void* volatile block = std::malloc(mebibyte);  // volatile: a compiler may leave out a pair of malloc and free
  mallopt(M_TOP_PAD, more_at_once);
  const std::uintptr_t first = address(block), end = address(sbrk(0));
  const std::uintptr_t begin = (first + mebibyte + large_page) / large_page * large_page;  // behind what malloc has written
  std::free(block);
  if (first == 0 || !(begin < end)) return;
  (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  block = std::malloc(begin - first);  // for good: all that comes after it is in large pages
}

void share_heap() { mallopt(M_ARENA_MAX, 1); }

#else

void prepare_heap() {}
void share_heap() {}

#endif

}  // namespace pwlsim::cli
