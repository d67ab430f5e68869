#pragma once
/// What a Result holds.

#include <pwlsim/result.hpp>

#include "analysis/idealisation.hpp"
#include "analysis/transient.hpp"
#include "api/controllers.hpp"

namespace pwlsim {

/// What it takes to do a run again.
struct KeptRun {
  std::shared_ptr<const circuit::Compiled> compiled;
  analysis::Simulate simulate;
  std::vector<analysis::Departure> departures;
  std::shared_ptr<const api::Controllers> controllers{};  ///< null: none
};

struct Result::Data {
  bool completed = false;
  double end = 0.0;
  std::vector<double> time;
  std::vector<std::string> signals;
  std::vector<std::vector<double>> columns;  ///< one a signal
  std::vector<Event> events;
  std::vector<std::string> on_at_start;
  std::vector<Measurement> measurements;
  std::vector<Fourier> fourier;
  Certificate certificate;
  Statistics statistics;
  std::vector<Message> messages;
  std::vector<std::pair<std::string, double>> stepped;
  std::shared_ptr<const KeptRun> kept;  ///< null where it was not to be kept
};

}  // namespace pwlsim
