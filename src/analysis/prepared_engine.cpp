#include "analysis/prepared_engine.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "analysis/abandonable.hpp"
#include "analysis/abandonable_run.hpp"
#include "analysis/quantity.hpp"
#include "analysis/trial_run.hpp"
#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"
#include "model/certificate.hpp"

namespace pwlsim::analysis {
namespace {

/// Why `auto` takes the sparse engine; "" where it does not.
std::string too_large(const model::Network& network) {
  constexpr const char* text = "a part of this circuit is too large for the exact engine's dense {} ({} {}; up to {} are run exactly); ";
  const std::size_t size = engine::sparse::largest_part(network), unknowns = engine::sparse::most_unknowns(network);
  if (size > engine::sparse::dense_limit)
    return fmt::format(text, "modes", size, "stores, diodes and switches", engine::sparse::dense_limit);
  if (unknowns > engine::sparse::unknown_limit)
    return fmt::format(text, "equations", unknowns, "node voltages and branch currents", engine::sparse::unknown_limit);
  return {};
}

Diagnostic sparse_warning(const std::string& reason, double reltol) {
  return {
      Severity::warning,
      "W-sparse-engine",
      {},
      fmt::format("{}the sparse engine takes implicit steps: rows carry errors of about its tolerance ({}) and more over many events, and "
                  "it does not check whether the solution is unique; compare a smaller case with --engine exact",
                  reason, reltol)};
}

bool is_tolerance(double reltol, Diagnostics& diagnostics) {
  if (reltol >= engine::sparse::least_tolerance && reltol <= engine::sparse::largest_tolerance) return true;
  const bool is_below = reltol < engine::sparse::least_tolerance;
  diagnostics.error(
      "E-tolerance", {},
      fmt::format("a relative tolerance of {} is {}; try {}, or --engine exact", reltol, is_below ? "below rounding" : "too large",
                  is_below ? engine::sparse::least_tolerance : engine::sparse::largest_tolerance));
  return false;
}

Simulate sparse_run(std::shared_ptr<const engine::sparse::SparseModel> model, double reltol) {
  return [=](const engine::Request& request, engine::RowSink& sink) { return engine::sparse::run(*model, request, reltol, sink); };
}

Simulate segment_run(std::shared_ptr<const engine::sparse::SparseModel> model) {
  return [=](const engine::Request& request, engine::RowSink& sink) {
    return engine::sparse::run_segments(*model, request, engine::sparse::segment_tolerance, sink);
  };
}

PreparedEngine prepare_sparse(const model::Network& network, double reltol, Diagnostics& diagnostics) {
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model || !is_tolerance(reltol, diagnostics)) return {"sparse", {}, {}, {}};
  return {"sparse", sparse_run(model, reltol), [=] { return engine::sparse::operating_point(*model); }, sparse_warning("", reltol)};
}

/// Its tolerance is its own: that of steps would make segments whose errors exceed their guards' margins.
PreparedEngine prepare_krylov(const model::Network& network, Diagnostics& diagnostics) {
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model) return {"krylov", {}, {}, {}};
  return {"krylov", segment_run(model), [=] { return engine::sparse::operating_point(*model); },
          Diagnostic{Severity::warning,
                     "W-krylov-engine",
                     {},
                     "the Krylov engine is experimental: errors of its segments are estimated, not bounded; compare a smaller case with "
                     "--engine exact"}};
}

PreparedEngine prepare_exact(const model::Network& network, Diagnostics& diagnostics) {
  const auto model = engine::prepare(network, diagnostics);
  if (!model) return {"exact", {}, {}, {}};
  return {"exact",
          [=](const engine::Request& request, engine::RowSink& sink) { return engine::run(*model, request, sink); },
          [=] { return engine::operating_point(*model); },
          {},
          true};
}

struct ModelWhenNeeded {
  model::Network network;
  std::shared_ptr<const engine::ExactModel> model{};
  Diagnostics diagnostics{};

  [[nodiscard]] bool prepare() {
    if (!model && !diagnostics.has_errors()) model = engine::prepare(network, diagnostics);
    return model != nullptr;
  }
  /// The first error of the circuit's structure.
  [[nodiscard]] engine::Answer failure() const {
    engine::Answer answer;
    answer.outcome = engine::Outcome::no_solution;
    for (const Diagnostic& diagnostic : diagnostics.all()) {
      if (diagnostic.severity != Severity::error) continue;
      answer.id = diagnostic.id;
      answer.message = diagnostic.text;
      break;
    }
    return answer;
  }
};

/// What makes a run end soon after a signal.
using Guard = std::function<Simulate(Simulate)>;

/// The exact engine on Krylov segments. Where they find no solution the run is repeated with dense modes, or with steps where those would be too large. A run with a controller
/// has dense modes. Each of these runs is guarded by itself: what a trial has told by the time of a signal is passed on, also where the trial does not return.
PreparedEngine prepare_segments(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics,
                                const Guard& guarded) {
  const auto model = engine::sparse::prepare(network, diagnostics);
  const std::string reason = too_large(network);
  PreparedEngine dense = exact_engine_when_needed(network);
  dense.simulate = guarded(std::move(dense.simulate));
  const bool steps = !reason.empty() && choice == EngineChoice::automatic;
  if (!model || (steps && !is_tolerance(reltol, diagnostics))) return {"exact", {}, {}, {}};
  const Simulate by_steps = [=, run = guarded(sparse_run(model, reltol))](const engine::Request& request, engine::RowSink& sink) {
    engine::Answer answer = run(request, sink);
    answer.engine = "sparse";
    answer.remarks.push_back({"W-sparse-engine", sparse_warning(reason, reltol).text});
    return answer;
  };
  const Simulate segments = guarded(segment_run(model));
  // Empty: what segments do not solve is not solved.
  const bool modes = reason.empty() || !model::has_passive_parts_only(network);
  const Simulate other = steps ? by_steps : modes ? dense.simulate : Simulate{};
  const auto why = [=](const engine::Answer& failed) {
    return engine::Remark{"N-other-engine", fmt::format("Krylov segments found no solution at t = {}; the whole run was repeated {}",
                                                        quantity(failed.time, "s"), steps ? "with the sparse engine" : "with dense modes")};
  };
  const Simulate simulate = other ? tried_first(segments, other, why) : segments;
  return {"exact",
          [simulate, dense = dense.simulate](const engine::Request& request, engine::RowSink& sink) {
            return request.sampler != nullptr ? dense(request, sink) : simulate(request, sink);
          },
          reason.empty() ? dense.operating_point : [=] { return engine::sparse::operating_point(*model); },
          {},
          has_modes(network, choice)};
}

void append(const Diagnostics& more, Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : more.all()) {
    const auto add = diagnostic.severity == Severity::error     ? &Diagnostics::error
                     : diagnostic.severity == Severity::warning ? &Diagnostics::warning
                                                                : &Diagnostics::note;
    (diagnostics.*add)(diagnostic.id, diagnostic.span, diagnostic.text);
  }
}

PreparedEngine prepare_guarded(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics,
                               const Guard& guarded) {
  if (runs_by_segments(network, choice)) return prepare_segments(network, choice, reltol, diagnostics, guarded);
  PreparedEngine engine = choice == EngineChoice::krylov   ? prepare_krylov(network, diagnostics)
                          : choice == EngineChoice::sparse ? prepare_sparse(network, reltol, diagnostics)
                                                           : prepare_exact(network, diagnostics);
  if (engine.simulate) engine.simulate = guarded(std::move(engine.simulate));
  return engine;
}

}  // namespace

PreparedEngine exact_engine_when_needed(const model::Network& network) {
  const auto when_needed = std::make_shared<ModelWhenNeeded>(ModelWhenNeeded{network});
  return {"exact",
          [when_needed](const engine::Request& request, engine::RowSink& sink) {
            return when_needed->prepare() ? engine::run(*when_needed->model, request, sink) : when_needed->failure();
          },
          [when_needed] {
            if (when_needed->prepare()) return engine::operating_point(*when_needed->model);
            engine::OperatingPoint none;
            none.answer = when_needed->failure();
            return none;
          },
          {},
          true};
}

bool is_quick(const model::Network& network) { return engine::sparse::most_unknowns(network) <= quick_unknowns; }

Simulate without_rows(Simulate simulate) {
  return [simulate = std::move(simulate)](engine::Request request, engine::RowSink& sink) {
    request.grid = {};
    return simulate(request, sink);
  };
}

double relative_tolerance(const std::optional<double>& asked, const circuit::Analyses& analyses) {
  return asked.value_or(analyses.relative_tolerance.value_or(engine::sparse::default_tolerance));
}

bool has_modes(const model::Network& network, EngineChoice choice) {
  return choice == EngineChoice::exact || choice == EngineChoice::modes ||
         (choice == EngineChoice::automatic && too_large(network).empty());
}

bool runs_by_segments(const model::Network& network, EngineChoice choice) {
  if (choice != EngineChoice::exact && choice != EngineChoice::automatic) return false;
  const bool is_passive = model::has_passive_parts_only(network);
  return !too_large(network).empty() || (is_passive && engine::sparse::largest_part(network) > most_in_modes);
}

PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics) {
  return prepare_guarded(network, choice, reltol, diagnostics, [](Simulate simulate) { return simulate; });
}

PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics,
                              const std::atomic<int>& interrupt) {
  if (is_quick(network)) return prepare_engine(network, choice, reltol, diagnostics);
  struct Preparation {
    model::Network network;
    PreparedEngine engine;
    Diagnostics diagnostics;
  };
  const auto preparation = std::make_shared<Preparation>(Preparation{network, {}, {}});
  const auto prepare = [preparation, choice, reltol, &interrupt] {
    preparation->engine = prepare_guarded(preparation->network, choice, reltol, preparation->diagnostics,
                                          [&interrupt](Simulate simulate) { return abandonable(std::move(simulate), interrupt); });
  };
  const bool is_prepared = finished_in_time(prepare, interrupt);
  if (!is_prepared) return {};
  append(preparation->diagnostics, diagnostics);
  PreparedEngine engine = std::move(preparation->engine);
  if (!engine.simulate) return engine;
  engine.operating_point = [find = std::move(engine.operating_point), &interrupt] {
    const auto point = std::make_shared<engine::OperatingPoint>();
    if (finished_in_time([point, find] { *point = find(); }, interrupt)) return std::move(*point);
    engine::OperatingPoint none;
    none.answer.outcome = engine::Outcome::interrupted;
    none.answer.id = "E-interrupted";
    none.answer.message = "interrupted before the operating point was found";
    return none;
  };
  return engine;
}

}  // namespace pwlsim::analysis
