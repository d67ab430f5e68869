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
  explicit SparseModel(const model::Network& n) : network(n), descriptor(network) {}
  model::Network network;
  Descriptor descriptor;
};

std::shared_ptr<const SparseModel> prepare(const model::Network& network, Diagnostics& diagnostics) {
  auto model = std::make_shared<SparseModel>(network);
  Factors factors(model->network, model->descriptor);
  if (!factors.at(1.0, first_position(network, model->descriptor)) && !factors.out_of_memory()) {
    const int unknown = factors.singular_unknown();
    diagnostics.error("E-singular", {},
                      fmt::format("the equations leave {} open; try a resistor to ground, or one in its loop of sources",
                                  unknown >= 0 ? model->descriptor.unknown_name(unknown) : "some unknown"));
    return nullptr;
  }
  return model;
}

Answer run(const SparseModel& model, const Request& request, double reltol, RowSink& sink) {
  return Transient(model.network, model.descriptor, request, reltol, sink).run();
}

OperatingPoint operating_point(const SparseModel& model) {
  Start start = start_from_operating_point(model.network, model.descriptor);
  OperatingPoint result{std::move(start.answer), std::move(start.signals)};
  result.values.resize(model.network.signals.size(), 0.0);
  return result;
}

bool pays(const model::Network& network) {
  if (!is_large(network)) return false;
  const std::vector<model::Island> islands = model::split_islands(network);
  return std::any_of(islands.begin(), islands.end(), [](const model::Island& island) { return island.needed && is_large(island.network); });
}

}  // namespace pwlsim::engine::sparse
