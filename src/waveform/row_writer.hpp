#pragma once
/// Where the rows of a run go, in whatever format.

#include <span>

namespace pwlsim::waveform {

class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// `values` holds whole rows, one after the other. False from the first failure to write on.
  virtual bool write(std::span<const double> values) = 0;
  /// Completes what stands in the file, which is still to be committed. After a failure to write too: what found room is then a file of its own.
  virtual bool flush() = 0;
};

}  // namespace pwlsim::waveform
