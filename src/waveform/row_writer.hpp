#pragma once
/// Writes the rows of a run in some format.

#include <span>

namespace pwlsim::waveform {

class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// `values` contains whole rows, one after the other. False from the first failed write on.
  virtual bool write(std::span<const double> values) = 0;
  /// Completes the content of the file, which is committed later. Also after a failed write: the rows that were written then form a valid file.
  virtual bool flush() = 0;
};

}  // namespace pwlsim::waveform
