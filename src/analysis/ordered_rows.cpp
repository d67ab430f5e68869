#include "analysis/ordered_rows.hpp"

#include <string_view>

#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

constexpr std::size_t worth_writing = std::size_t{1} << 18;
constexpr std::size_t most_kept = std::size_t{1} << 24;  ///< bytes of a run whose turn has not come

}  // namespace

bool OrderedRows::put(const std::string& text) { return text.empty() ? !file_.failed() : file_.write(text, row_bytes_); }

void OrderedRows::wait_to_begin(std::size_t run) {
  std::unique_lock lock(mutex_);
  turn_.wait(lock, [&] { return run < next_ + ahead_; });
}

bool OrderedRows::write(std::size_t run, std::string& text) {
  std::unique_lock lock(mutex_);
  if (file_.failed()) return false;
  if (run != next_ && text.size() < most_kept) return true;
  turn_.wait(lock, [&] { return run == next_ || file_.failed(); });
  const bool written = put(text);
  text.clear();
  return written;
}

bool OrderedRows::failed() {
  const std::scoped_lock lock(mutex_);
  return file_.failed();
}

bool OrderedRows::finish(std::size_t run, std::string text) {
  const std::scoped_lock lock(mutex_);
  if (run >= next_) finished_.emplace(run, std::move(text));  // else it is finished already
  bool written = !file_.failed();
  for (auto first = finished_.begin(); first != finished_.end() && first->first == next_; first = finished_.erase(first), ++next_)
    written = put(first->second);
  turn_.notify_all();
  return written;
}

RowFormatter stepped_csv(const std::vector<double>& stepped) {
  std::string prefix;
  for (const double value : stepped) prefix += waveform::shortest(value) + ",";
  return [=](std::string& text, std::span<const double> row) { waveform::append_csv_row(text, prefix, row); };
}

RowFormatter stepped_doubles(const std::vector<double>& stepped) {
  const auto bytes = [](std::span<const double> values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  };
  return [=, suffix = std::string(bytes(stepped))](std::string& text, std::span<const double> row) { (text += bytes(row)) += suffix; };
}

bool SteppedRows::write(std::span<const double> values) {
  for (std::size_t at = 0; at < values.size(); at += columns_) format_(text_, values.subspan(at, columns_));
  return text_.size() < worth_writing || rows_.write(run_, text_);
}

}  // namespace pwlsim::analysis
