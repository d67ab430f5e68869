#include "analysis/prepared_engine.hpp"

#include <fmt/format.h>

#include <string>

#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"

namespace pwlsim::analysis {
namespace {

Diagnostic sparse_warning(EngineChoice choice, double reltol, std::size_t size) {
  const std::string reason =
      choice == EngineChoice::automatic
          ? fmt::format(
                "a part of this circuit is too large for the exact engine's dense modes ({} stores, diodes and switches; up to {} are "
                "run exactly); ",
                size, engine::sparse::dense_limit)
          : "";
  return {
      Severity::warning,
      "W-sparse-engine",
      {},
      fmt::format("{}the sparse engine takes implicit steps: rows carry errors of about its tolerance ({}) and more over many events, and "
                  "it does not examine whether the solution is the only one; compare a smaller case with --engine exact",
                  reason, reltol)};
}

bool is_tolerance(double reltol, Diagnostics& diagnostics) {
  if (reltol >= engine::sparse::least_tolerance && reltol <= engine::sparse::largest_tolerance) return true;
  const bool is_below = reltol < engine::sparse::least_tolerance;
  diagnostics.error("E-tolerance", {},
                    fmt::format("a relative tolerance of {} is {}; try {}, or --engine exact", reltol, is_below ? "below rounding" : "none",
                                is_below ? engine::sparse::least_tolerance : engine::sparse::largest_tolerance));
  return false;
}

PreparedEngine prepare_sparse(const model::Network& network, EngineChoice choice, double reltol, std::size_t size,
                              Diagnostics& diagnostics) {
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model || !is_tolerance(reltol, diagnostics)) return {"sparse", {}, {}, {}};
  return {"sparse",
          [=](const engine::Request& request, engine::RowSink& sink) { return engine::sparse::run(*model, request, reltol, sink); },
          [=] { return engine::sparse::operating_point(*model); }, sparse_warning(choice, reltol, size)};
}

PreparedEngine prepare_exact(const model::Network& network, Diagnostics& diagnostics) {
  const auto model = engine::prepare(network, diagnostics);
  if (!model) return {"exact", {}, {}, {}};
  return {"exact",
          [=](const engine::Request& request, engine::RowSink& sink) { return engine::run(*model, request, sink); },
          [=] { return engine::operating_point(*model); },
          {}};
}

}  // namespace

double relative_tolerance(const std::optional<double>& asked, const circuit::Analyses& analyses) {
  return asked.value_or(analyses.relative_tolerance.value_or(engine::sparse::default_tolerance));
}

PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics) {
  const std::size_t size = choice == EngineChoice::automatic ? engine::sparse::largest_part(network) : 0;
  const bool sparse = choice == EngineChoice::sparse || size > engine::sparse::dense_limit;
  return sparse ? prepare_sparse(network, choice, reltol, size, diagnostics) : prepare_exact(network, diagnostics);
}

}  // namespace pwlsim::analysis
