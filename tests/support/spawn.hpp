#pragma once
/// Runs pwlsim (PWLSIM_PROGRAM) as a user does and collects what comes back.

#include <sys/types.h>
#include <string>
#include <vector>

namespace pwlsim::test {

struct SpawnOptions {
  std::string folder = ".";       ///< working directory of the child
  std::string standard_output{};  ///< a file or device for its standard output; empty: collected in Finished::out
  bool no_streams = false;        ///< its three standard streams are closed
  bool terminal = false;          ///< its standard error is a terminal
  double seconds = 60.0;          ///< it is killed then
  bool limit_memory = true;       ///< 2 GiB of address space (not under AddressSanitizer, which maps terabytes)
  unsigned long file_size = 0;    ///< no file of the child grows beyond this many bytes; 0: no limit
  std::string program{};          ///< empty: PWLSIM_PROGRAM
};

struct Finished {
  int status = -1;  ///< exit status; 1000 + n where signal n ended it
  std::string out, err;
  double seconds = 0.0;
  double cpu_seconds = 0.0;
  double resident_mebibytes = 0.0;  ///< at most
};

/// A running pwlsim; killed by its process id when it leaves scope before finish().
class Spawned {
 public:
  Spawned(const std::vector<std::string>& arguments, const SpawnOptions& options = {});
  Spawned(const Spawned&) = delete;
  Spawned& operator=(const Spawned&) = delete;
  ~Spawned();

  void send(int signal_number) const;
  /// Closes our end of its standard output.
  void close_output();
  /// Reads its output to the end and waits for it.
  Finished finish();

 private:
  pid_t process_ = -1;
  int out_ = -1, err_ = -1;
  double start_ = 0.0, limit_ = 0.0;
};

inline Finished run_program(const std::vector<std::string>& arguments, const SpawnOptions& options = {}) {
  return Spawned(arguments, options).finish();
}

/// Waits until `done()` holds; false after `seconds`.
template <class Done>
bool wait_until(double seconds, const Done& done);

/// Sleeps for so many milliseconds.
void pause(int milliseconds);

template <class Done>
bool wait_until(double seconds, const Done& done) {
  for (int waited = 0; waited < seconds * 1000.0; waited += 5) {
    if (done()) return true;
    pause(5);
  }
  return done();
}

}  // namespace pwlsim::test
