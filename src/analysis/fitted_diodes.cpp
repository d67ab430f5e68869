#include "analysis/fitted_diodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/quantity.hpp"
#include "measure/diode_currents.hpp"
#include "model/builder.hpp"

namespace pwlsim::analysis {
namespace {

constexpr int most_runs = 6;
constexpr double first_current = 1.0;         ///< A, of the tangents that a deck is compiled with
constexpr double least_current = 1e-9;        ///< A; a diode that carries less, and would at its highest voltage, stays as it is
constexpr double least_of_saturation = 10.0;  ///< likewise: below, the exponential is no straight line anywhere
constexpr double most_current = 1e6;          ///< A, that a voltage may ask for
constexpr std::size_t most_named = 8;         ///< diodes in the note
constexpr double two_digits = 10.0;           ///< two of them: what lies between changes a drop by less than a thousandth of kT/q

double rounded(double current) {
  const double unit = std::pow(10.0, std::floor(std::log10(current))) / two_digits;
  return std::round(current / unit) * unit;
}

class Fit {
 public:
  Fit(const circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt)
      : network_(compiled.network), choice_(choice), reltol_(reltol), interrupt_(interrupt) {
    network_.signals.clear();
    for (std::size_t k = 0; k < network_.diodes.size(); ++k) {
      const model::Diode& diode = network_.diodes[k];
      if (!diode.law) continue;
      diodes_.push_back(k);
      network_.signals.push_back({"", {{model::Term::Kind::diode_current, static_cast<int>(k), 1.0}}});
      network_.signals.push_back({"", model::voltage_between(diode.p, diode.n)});
    }
    currents_.assign(diodes_.size(), first_current);
  }

  [[nodiscard]] bool is_needed() const { return !diodes_.empty(); }

  /// False where a run does not come to its end.
  bool run(const circuit::Analyses& analyses) {
    for (int k = 0; k < most_runs; ++k) {
      measure::DiodeCurrents found(diodes_.size());
      if (!measure(analyses, found)) return false;
      if (!take(found)) return true;
    }
    return true;
  }

  void give(model::Network& network) const {
    for (const std::size_t k : diodes_) {
      network.diodes[k].resistance = network_.diodes[k].resistance;
      network.diodes[k].drop = network_.diodes[k].drop;
    }
  }

  /// Of the diodes whose tangent is another than before; none: nothing.
  [[nodiscard]] std::optional<Diagnostic> note() const {
    std::string list;
    std::size_t moved = 0;
    SourceSpan first;
    for (std::size_t k = 0; k < diodes_.size(); ++k) {
      const model::Diode& diode = network_.diodes[diodes_[k]];
      if (currents_[k] == first_current) continue;
      if (moved == 0) first = diode.label.span;
      if (++moved > most_named) continue;
      list += fmt::format("{}{} at {} (Ron = {:.6g} ohm, Vfwd = {:.6g} V)", moved > 1 ? ", " : "", diode.label.name,
                          quantity(currents_[k], "A", 2), diode.resistance, diode.drop);
    }
    if (moved == 0) return std::nullopt;
    if (moved > most_named) list += fmt::format(" and {} more", moved - most_named);
    return Diagnostic{Severity::note, "N-diode-current", first,
                      fmt::format("a preliminary run finds the currents of exponential diodes; their tangents are taken there: {}", list)};
  }

 private:
  bool measure(const circuit::Analyses& analyses, measure::DiodeCurrents& found) const {
    Diagnostics unheard;
    const PreparedEngine engine = interrupt_ != nullptr ? prepare_engine(network_, choice_, reltol_, unheard, *interrupt_)
                                                        : prepare_engine(network_, choice_, reltol_, unheard);
    if (!engine.simulate) return false;
    engine::Request request = request_of(analyses, {});
    request.grid = {};
    request.interrupt = interrupt_;
    request.unsaved_signals = network_.signals.size();
    request.probes = {{}, 0.0, request.stop, &found};
    for (std::size_t k = 0; k < network_.signals.size(); ++k) request.probes.signals.push_back(static_cast<int>(k));
    NoRows sink;
    return engine.simulate(request, sink).outcome == engine::Outcome::completed;
  }

  /// Whether a tangent has moved.
  bool take(const measure::DiodeCurrents& found) {
    bool has_moved = false;
    for (std::size_t k = 0; k < diodes_.size(); ++k) {
      model::Diode& diode = network_.diodes[diodes_[k]];
      double current = found.mean(k) / diode.law->parallel;
      const double least = std::max(least_current, least_of_saturation * diode.law->saturation);
      if (!(current > least)) current = std::min(diode.law->current(found.highest_voltage(k)), currents_[k]);
      if (!(current > least && current < most_current)) continue;
      current = rounded(current);
      if (current == currents_[k]) continue;
      currents_[k] = current;
      const model::Tangent tangent = diode.law->tangent(current);
      diode.resistance = tangent.resistance;
      diode.drop = tangent.drop;
      has_moved = true;
    }
    return has_moved;
  }

  model::Network network_;
  EngineChoice choice_;
  double reltol_;
  const std::atomic<int>* interrupt_;
  std::vector<std::size_t> diodes_;  ///< those that have a law
  std::vector<double> currents_;     ///< A, of one of those in parallel
};

}  // namespace

std::optional<Diagnostic> fit_diodes(circuit::Compiled& compiled, EngineChoice choice, double reltol, const std::atomic<int>* interrupt) {
  if (!compiled.analyses.transient) return std::nullopt;
  Fit fit(compiled, choice, reltol, interrupt);
  if (!fit.is_needed() || !fit.run(compiled.analyses)) return std::nullopt;
  fit.give(compiled.network);
  return fit.note();
}

}  // namespace pwlsim::analysis
