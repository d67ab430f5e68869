#pragma once
/// The journal of runs that are done, and the table that it becomes.

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "worker.hpp"

namespace pwlsim::mpi {

/// One line a run: its number, its error or "-", its measurements to the last bit, and a mark that the line is whole.
class Journal {
 public:
  /// `head`: what the runs are of. With `resume` the records of a journal with that head are read first; one of other runs is refused.
  /// Throws std::runtime_error.
  Journal(std::string path, const std::string& head, bool resume, std::vector<std::optional<Record>>& records);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The record is with the operating system when this returns. Throws std::runtime_error where it cannot be.
  void add(const Record& record);
  /// Nothing is left to be resumed.
  void remove();

 private:
  std::string path_;
  std::FILE* file_ = nullptr;
};

/// The shortest decimal text that reads back to the number; "" for NaN.
[[nodiscard]] std::string number_text(double value);

}  // namespace pwlsim::mpi
