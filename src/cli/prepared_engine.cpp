#include "cli/prepared_engine.hpp"

#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"

namespace pwlsim::cli {

PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics) {
  if (choice == EngineChoice::sparse || (choice == EngineChoice::automatic && engine::sparse::pays(network))) {
    const auto model = engine::sparse::prepare(network, diagnostics);
    if (!model) return {"sparse", {}, {}};
    return {"sparse",
            [=](const engine::Request& request, engine::RowSink& sink) { return engine::sparse::run(*model, request, reltol, sink); },
            [=] { return engine::sparse::operating_point(*model); }};
  }
  const auto model = engine::prepare(network, diagnostics);
  if (!model) return {"exact", {}, {}};
  return {"exact", [=](const engine::Request& request, engine::RowSink& sink) { return engine::run(*model, request, sink); },
          [=] { return engine::operating_point(*model); }};
}

}  // namespace pwlsim::cli
