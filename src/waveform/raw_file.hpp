#pragma once
/// SPICE's binary raw file of real numbers: a text head with the names of the vectors, then one row of doubles per point (ngspice manual, "Binary
/// rawfile format"; byte order of the machine).

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "waveform/row_writer.hpp"

namespace pwlsim::waveform {

struct RawFile {
  std::vector<std::string> names;  ///< lower case; the first is the scale ("time")
  std::vector<double> values;      ///< row by row

  [[nodiscard]] std::size_t rows() const { return names.empty() ? 0 : values.size() / names.size(); }
  /// Index of a vector; empty if there is none.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  [[nodiscard]] double at(std::size_t row, std::size_t vector) const { return values[row * names.size() + vector]; }
};

/// Whole rows only: the file of an unfinished run is read up to its last whole row. Empty if `bytes` is not such a file.
[[nodiscard]] std::optional<RawFile> read_raw(std::string_view bytes);

class OutputFile;

struct RawVector {
  std::string name;
  std::string type;  ///< "time", "voltage", "current", "notype"
};

/// Writes rows as they come, and their number, which the head contains, at the end: a pipe receives nothing before. The date in
/// the head is always the start of 1970, so that equal runs write equal files. `file` must outlive the writer; it is neither opened nor committed here.
class RawWriter : public RowWriter {
 public:
  /// `stepped`: the rows are those of several runs, one after the other, as LTspice writes the runs of .step.
  RawWriter(OutputFile& file, const std::string& title, std::span<const RawVector> vectors, bool stepped = false);

  bool write(std::span<const double> values) override;
  bool flush() override;

 private:
  OutputFile& file_;
  std::size_t row_bytes_;
  std::size_t head_bytes_ = 0;
  std::size_t count_at_ = 0;  ///< of the number of points in the head
};

}  // namespace pwlsim::waveform
