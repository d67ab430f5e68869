#include "cli/program.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

/// Memory that a run gives back it wants again at its next event: glibc keeps it, where by default it returns it to the system from 128 KiB on, and each page of it is
/// zeroed anew.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int mebibyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  mallopt(M_TRIM_THRESHOLD, 256 * mebibyte);
  mallopt(M_TOP_PAD, 16 * mebibyte);
#endif
}

}  // namespace

int main(int argument_count, char** arguments) {
  keep_freed_memory();
  return pwlsim::cli::run_program(argument_count, arguments, PWLSIM_VERSION);
}
