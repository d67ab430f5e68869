#pragma once
/// The contents of a Result.

#include <pwlsim/result.hpp>

#include "analysis/idealisation.hpp"
#include "analysis/transient.hpp"
#include "api/controllers.hpp"

namespace pwlsim {

/// The data for repeating a run.
struct KeptRun {
  std::shared_ptr<const circuit::Compiled> compiled;
  analysis::Simulate simulate;
  std::vector<analysis::Idealisation> departures;
  std::shared_ptr<const api::Controllers> controllers{};  ///< null: none
};

struct Result::Data {
  bool completed = false;
  double end = 0.0;
  std::vector<double> time;
  std::vector<std::string> signals;
  std::vector<std::vector<double>> columns;  ///< one per signal
  std::vector<Event> events;
  std::vector<std::string> on_at_start;
  std::vector<Measurement> measurements;
  std::vector<Fourier> fourier;
  Certificate certificate;
  Statistics statistics;
  std::vector<Message> messages;
  std::vector<std::pair<std::string, double>> stepped;
  std::shared_ptr<const KeptRun> kept;  ///< null if not kept
};

}  // namespace pwlsim
