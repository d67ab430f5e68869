#include "converters/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pwlsim::test::converters {
namespace {

/// Warnings that the rows may be wrong.
constexpr const char* doubts[] = {"W-certificate", "W-events-sampled"};

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::agree:
      return "agree";
    case Verdict::silent:
      return "SILENT";
    case Verdict::told:
      return "told";
    case Verdict::error:
      return "error";
    case Verdict::unresolved:
      return "unresolved";
  }
  return "";
}

Judgement judge(const Converter& converter, const Resolved& reference, const ProgramAnswer& answer, double threshold) {
  Judgement result;
  const Waveforms& waveforms = reference.waveforms;
  if (answer.status != 0) {
    result.verdict = Verdict::error;
    result.detail = fmt::format("status {} {}", answer.status, answer.messages);
    return result;
  }
  if (!waveforms.trouble.empty() || reference.error > threshold / 5) {
    result.detail = waveforms.trouble.empty()
                        ? fmt::format("{} at {:.5g}", converter.signals()[reference.where.signal], waveforms.times[reference.where.row])
                        : waveforms.trouble;
    return result;
  }
  result.detail = answer.messages;
  if (answer.rows.size() != waveforms.rows.size()) {
    result.verdict = Verdict::silent;
    result.difference = 1.0;
    result.detail = fmt::format("{} rows for {}", answer.rows.size(), waveforms.rows.size());
    return result;
  }
  const Difference difference = largest_difference(waveforms, answer.rows, converter);
  result.difference = difference.size;
  result.signal =
      fmt::format("{} at {:.4g}: {:.8g}, expected {:.8g}", converter.signals()[difference.signal], waveforms.times[difference.row],
                  answer.rows[difference.row][difference.signal], waveforms.rows[difference.row][difference.signal]);
  const bool told = std::ranges::any_of(doubts, [&](const char* id) { return answer.messages.find(id) != std::string::npos; });
  result.verdict = difference.size <= threshold ? Verdict::agree : told ? Verdict::told : Verdict::silent;
  return result;
}

Resolved transformed(const Resolved& reference, const Variant& variant) {
  Resolved result = reference;
  const std::vector<std::vector<double>>& rows = reference.waveforms.rows;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t k = 0; k < variant.source.size(); ++k) result.waveforms.rows[r][k] = rows[r][variant.source[k]] * variant.factor[k];
  for (std::size_t k = 0; k < variant.source.size(); ++k)
    result.waveforms.scales[k] = reference.waveforms.scales[variant.source[k]] * static_cast<Real>(std::abs(variant.factor[k]));
  return result;
}

ProgramAnswer common_rows(ProgramAnswer answer, const Variant& variant) {
  if (variant.row_stride == 1) return answer;
  std::vector<std::vector<double>> rows;
  for (std::size_t r = 0; r < answer.rows.size(); r += variant.row_stride) rows.push_back(answer.rows[r]);
  answer.rows = std::move(rows);
  return answer;
}

}  // namespace pwlsim::test::converters
