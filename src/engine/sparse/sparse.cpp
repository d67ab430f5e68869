#include "engine/sparse/sparse.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/sparse/transient.hpp"
#include "model/islands.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// Stores and ports beyond which the dense modes of the exact engine cost more than steps do.
constexpr std::size_t dense_limit = 400;

bool is_large(const model::Network& n) {
  return n.capacitors.size() + n.inductors.size() + n.diodes.size() + n.complementarities.size() + n.switches.size() > dense_limit;
}

}  // namespace

class SparseModel {
 public:
  std::vector<std::unique_ptr<const Part>> parts;
  std::size_t signals = 0;
};

std::shared_ptr<const SparseModel> prepare(const model::Network& network, Diagnostics& diagnostics) {
  auto result = std::make_shared<SparseModel>();
  result->signals = network.signals.size();
  bool regular = true;
  for (model::Island& island : model::split_islands(with_controls_of_sources(network), {}, model::Controls::joined)) {
    auto part = std::make_unique<Part>(std::move(island));
    Factors factors(part->island.network, part->descriptor);
    if (!factors.at(1.0, first_position(part->island.network, part->descriptor)) && !factors.out_of_memory()) {
      const int unknown = factors.singular_unknown();
      diagnostics.error("E-singular", {},
                        fmt::format("the equations leave {} open; try a resistor to ground, or one in its loop of sources",
                                    unknown >= 0 ? part->descriptor.unknown_name(unknown) : part->loop_of_sources()));
      regular = false;
    }
    if (part->island.needed) result->parts.push_back(std::move(part));
  }
  return regular ? result : nullptr;
}

Answer run(const SparseModel& model, const Request& request, double reltol, RowSink& sink) {
  return Transient(model.parts, model.signals, request, reltol, sink).run();
}

OperatingPoint operating_point(const SparseModel& model) {
  OperatingPoint result;
  result.values.resize(model.signals, 0.0);
  for (const auto& part : model.parts) {
    const Start start = start_from_operating_point(part->island.network, part->descriptor);
    if (start.answer.outcome != Outcome::completed) {
      result.answer = start.answer;
      return result;
    }
    for (std::size_t i = 0; i < start.signals.size(); ++i)
      result.values[static_cast<std::size_t>(part->island.signal_number[i])] += start.signals[i];
  }
  return result;
}

bool pays(const model::Network& network) {
  if (!is_large(network)) return false;
  const std::vector<model::Island> islands = model::split_islands(network);
  return std::any_of(islands.begin(), islands.end(), [](const model::Island& island) { return island.needed && is_large(island.network); });
}

}  // namespace pwlsim::engine::sparse
