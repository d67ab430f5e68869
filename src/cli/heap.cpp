#include "cli/heap.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#endif

namespace pwlsim::cli {

#ifdef __GLIBC__

namespace {

constexpr int mebibyte = 1 << 20;
constexpr int at_first = 64 * mebibyte;  ///< of addresses; memory is mapped where it is used
constexpr int more_at_once = 16 * mebibyte;
constexpr std::uintptr_t large_page = 2 * mebibyte;

/// What the heap has been given so far, from its first whole large page on. Advice only: a system without large pages refuses it, and has lost nothing.
void ask_for_large_pages(const void* first) {
  const auto begin = (reinterpret_cast<std::uintptr_t>(first) + large_page - 1) / large_page * large_page;
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  if (begin < end) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace

void prepare_heap() {
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  mallopt(M_TRIM_THRESHOLD, 256 * mebibyte);
  mallopt(M_TOP_PAD, at_first);
  void* const first = sbrk(0);
  void* volatile block = std::malloc(mebibyte);  // volatile: a compiler may leave out a pair of malloc and free
  std::free(block);
  mallopt(M_TOP_PAD, more_at_once);
  ask_for_large_pages(first);
}

void share_heap() { mallopt(M_ARENA_MAX, 1); }

#else

void prepare_heap() {}
void share_heap() {}

#endif

}  // namespace pwlsim::cli
