#pragma once
/// Runs of a sweep in a process of their own: what ends it does not end the rank that asks.
///
/// A supervisor, forked before MPI is there, forks the worker and again another one where it is lost. Numbers of runs go through one pipe, records through another.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pwlsim::mpi {

/// What came of a run, as it goes between processes and into the journal.
struct Record {
  std::uint64_t number = 0;
  std::string id;                    ///< "" where the run is done
  std::vector<double> measurements;  ///< NaN where one failed
};

[[nodiscard]] std::string bytes_of(const Record& record);
[[nodiscard]] Record record_of(const std::string& bytes);

class Worker {
 public:
  using Run = std::function<Record(std::uint64_t number)>;
  /// `prepare` makes, in the worker's process, what does the runs.
  explicit Worker(const std::function<Run()>& prepare);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// A run during which the process is lost is tried once more; then its id is E-worker-lost.
  [[nodiscard]] Record run(std::uint64_t number);

 private:
  int requests_ = -1, records_ = -1;
  int supervisor_ = -1;
};

}  // namespace pwlsim::mpi
