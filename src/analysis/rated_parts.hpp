#pragma once
/// Parts of the models at hand break down at the rated voltage of their data sheet. A warning reports this and for how long, because LTspice's own models mostly do not break down.

#include <optional>
#include <string>
#include <vector>

#include "circuit/compile.hpp"
#include "engine/run.hpp"

namespace pwlsim::analysis {

/// Passes its calls on to another watcher, if there is one.
class RatedParts : public engine::EventWatcher {
 public:
  /// `ports`: the names of diodes of the network that are such breakdowns.
  RatedParts(const std::vector<std::string>& ports, engine::EventWatcher* next) : ports_(ports), next_(next) {}

  void begin(std::span<const std::string> elements, std::span<const char> on) override;
  void happened(const engine::Event& event, std::span<const char> on) override;

  /// A warning if parts broke down for more than a thousandth of the run, which ended at `end`.
  [[nodiscard]] std::optional<engine::Remark> remark(double end);

 private:
  struct RatedPart {
    std::size_t port = 0;  ///< of the engine
    std::string name;
    bool on = false;
    double seconds = 0.0;
  };
  void count(double until, std::span<const char> on);

  const std::vector<std::string>& ports_;
  engine::EventWatcher* next_;
  std::vector<RatedPart> parts_;
  double time_ = 0.0;
};

/// Adds up the currents of such parts over the rows.
class RatedCurrents {
 public:
  /// `columns`: of a row, the time first.
  RatedCurrents(const std::vector<circuit::RatedCurrent>& rated, const std::vector<std::string>& columns);

  void add(std::span<const double> rows, std::size_t columns);

  /// A warning if the mean of a current was far beyond the rating.
  [[nodiscard]] std::optional<engine::Remark> remark() const;

 private:
  struct Column {
    std::size_t index = 0;
    const circuit::RatedCurrent* rated = nullptr;
    double sum = 0.0;
  };
  std::vector<Column> columns_;
  double rows_ = 0.0;
};

}  // namespace pwlsim::analysis
