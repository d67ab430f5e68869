#pragma once
/// The run: blocks side by side, rows in between.

#include <chrono>
#include <memory>
#include <vector>

#include "engine/sparse/block.hpp"

namespace pwlsim::engine::sparse {

class Transient {
 public:
  Transient(const model::Network& network, const Descriptor& descriptor, const Request& request, double reltol, RowSink& sink);
  Answer run();

 private:
  bool begin();
  bool rows_before(double time, bool inclusive);
  bool event_rows();
  bool push_row();
  bool flush();
  bool interrupted();
  void finish();

  const model::Network& network_;
  const Request& request_;
  double reltol_;
  RowSink& sink_;
  Block block_;
  Answer answer_;
  double tolerance_ = 0.0;
  std::size_t width_ = 1, buffered_ = 0;
  std::vector<double> rows_;
  std::uint64_t next_row_ = 0;
  double row_time_ = 0.0, first_row_time_ = 0.0, last_event_row_ = -1.0;
  double sink_seconds_ = 0.0;
};

}  // namespace pwlsim::engine::sparse
