#include "waveform/thinned_rows.hpp"

#include <algorithm>
#include <cassert>

namespace pwlsim::waveform {

ThinnedRows::ThinnedRows(double from, double to, std::size_t signals, std::size_t most_rows)
    : from_(from), to_(to), signals_(signals), most_rows_(most_rows) {
  assert(most_rows >= 2);
}

void ThinnedRows::add(std::span<const double> row) {
  assert(row.size() == signals_ + 1);
  if (thinned()) {
    add_to_piece(row);
    return;
  }
  all_.insert(all_.end(), row.begin(), row.end());
  if (all_.size() > most_rows_ * row.size()) fold();
}

void ThinnedRows::fold() {
  pieces_.resize(most_rows_ / 2);
  extremes_.resize(pieces_.size() * signals_);
  const std::size_t width = signals_ + 1;
  for (std::size_t at = 0; at < all_.size(); at += width) add_to_piece({all_.data() + at, width});
  all_ = {};
}

void ThinnedRows::add_to_piece(std::span<const double> row) {
  const double share = to_ > from_ ? (row[0] - from_) / (to_ - from_) : 0.0;
  const auto last = static_cast<double>(pieces_.size() - 1);
  const auto number = static_cast<std::size_t>(std::clamp(share * static_cast<double>(pieces_.size()), 0.0, last));
  Piece& piece = pieces_[number];
  Extremes* const extremes = extremes_.data() + number * signals_;
  const bool first = !piece.used;
  if (first) piece = {row[0], row[0], true};
  piece.last = row[0];
  for (std::size_t k = 0; k < signals_; ++k) {
    const double value = row[k + 1];
    Extremes& e = extremes[k];
    if (first) {
      e = {value, value, true};
    } else if (value < e.low) {
      e.low = value;
      e.low_first = false;
    } else if (value > e.high) {
      e.high = value;
      e.low_first = true;
    }
  }
}

ThinnedRows::Rows ThinnedRows::rows() const {
  Rows result;
  result.columns.resize(signals_);
  const std::size_t width = signals_ + 1;
  for (std::size_t at = 0; at < all_.size(); at += width) {
    result.times.push_back(all_[at]);
    for (std::size_t k = 0; k < signals_; ++k) result.columns[k].push_back(all_[at + k + 1]);
  }
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (!pieces_[p].used) continue;
    result.times.insert(result.times.end(), {pieces_[p].first, pieces_[p].last});
    for (std::size_t k = 0; k < signals_; ++k) {
      const Extremes& e = extremes_[p * signals_ + k];
      result.columns[k].insert(result.columns[k].end(), {e.low_first ? e.low : e.high, e.low_first ? e.high : e.low});
    }
  }
  return result;
}

}  // namespace pwlsim::waveform
