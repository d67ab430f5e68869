#include "engine/sparse/sparse.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/from_start.hpp"
#include "engine/left_out.hpp"
#include "engine/sparse/sparse_model.hpp"
#include "engine/sparse/sparse_run.hpp"
#include "model/islands.hpp"
#include "model/structure_errors.hpp"

namespace pwlsim::engine::sparse {

namespace {

std::size_t stores_and_ports(const model::Network& n) {
  return n.capacitors.size() + n.inductors.size() + n.diodes.size() + n.complementarities.size() + n.switches.size();
}

std::size_t unknowns(const model::Network& n) {
  return n.nodes.size() + n.capacitors.size() + 2 * n.inductors.size() + n.branches.size() + n.diodes.size() + n.complementarities.size() +
         n.switches.size();
}

}  // namespace

Starts starts_of(const SparseModel& model, bool uic) {
  Starts starts;
  for (const auto& part : model.parts) {
    starts.parts.push_back(uic ? start_from_initial_values(part->island.network, part->descriptor)
                               : start_from_operating_point(part->island.network, part->descriptor));
    starts.missing.add(starts.parts.back().missing);
    if (!starts.parts.back().is_unique) starts.answer.remarks.push_back(operating_point_not_unique(part->island.name, "one of them"));
    if (starts.parts.back().answer.outcome == Outcome::completed) continue;
    starts.answer = starts.parts.back().answer;
    starts.parts.clear();
    break;
  }
  return starts;
}

std::shared_ptr<const SparseModel> prepare(const model::Network& network, Diagnostics& diagnostics) {
  auto result = std::make_shared<SparseModel>();
  result->signals = network.signals.size();
  bool regular = true;
  const auto runs = [](const model::Island& island) {  // a large one is sooner run than examined
    return stores_and_ports(island.network) > dense_limit ? !island.network.diodes.empty() || !island.network.switches.empty()
                                                          : must_run(island);
  };
  std::vector<model::Island> islands = model::split_islands(with_controls_of_sources(network), runs, model::Controls::joined);
  const std::set<std::string> running = running_sources(islands);
  for (model::Island& island : islands) {
    if (!island.needed)
      if (auto remark = left_out(island, running)) result->remarks.push_back(std::move(*remark));
    auto part = std::make_unique<Part>(std::move(island));
    if (!part->descriptor.coupling_is_possible()) {
      model::report_impossible_coupling(part->island.network, diagnostics);
      regular = false;
      continue;
    }
    Factors factors(part->island.network, part->descriptor);
    if (!factors.at(1.0, first_position(part->island.network, part->descriptor)) && !factors.out_of_memory()) {
      const int unknown = factors.singular_unknown();
      diagnostics.error("E-singular", {},
                        fmt::format("the equations do not determine {}; try a resistor to ground, or one in its loop of sources",
                                    unknown >= 0 ? part->descriptor.unknown_name(unknown) : part->loop_of_sources()));
      regular = false;
    }
    if (part->island.needed) result->parts.push_back(std::move(part));
  }
  return regular ? result : nullptr;
}

namespace {

Answer run_by(PartRun::Method method, const SparseModel& model, const Request& request, double reltol, double shift_factor, RowSink& sink) {
  const auto began = std::chrono::steady_clock::now();
  const Starts starts = starts_of(model, request.use_initial_conditions);
  Answer answer = run_from_start(request, began, starts, [&](const Starts& from) {
    SparseRun run(model.parts, model.signals, request, reltol, method, sink);
    run.scale_shifts(shift_factor);
    return run.run(from.parts);
  });
  answer.remarks.insert(answer.remarks.begin(), model.remarks.begin(), model.remarks.end());
  return answer;
}

}  // namespace

Answer run(const SparseModel& model, const Request& request, double reltol, RowSink& sink) {
  return run_by(PartRun::Method::steps, model, request, reltol, 1.0, sink);
}

Answer run_segments(const SparseModel& model, const Request& request, double reltol, RowSink& sink, double shift_factor) {
  return run_by(PartRun::Method::segments, model, request, reltol, shift_factor, sink);
}

OperatingPoint operating_point(const SparseModel& model) {
  OperatingPoint result;
  result.values.resize(model.signals, 0.0);
  const Starts starts = starts_of(model, false);
  for (std::size_t k = 0; k < starts.parts.size(); ++k)
    for (std::size_t i = 0; i < starts.parts[k].signals.size(); ++i)
      result.values[static_cast<std::size_t>(model.parts[k]->island.signal_number[i])] += starts.parts[k].signals[i];
  result.answer = answer_of_operating_point(starts);
  result.answer.remarks.insert(result.answer.remarks.begin(), model.remarks.begin(), model.remarks.end());
  return result;
}

std::size_t largest_part(const model::Network& network) {
  if (stores_and_ports(network) <= dense_limit) return stores_and_ports(network);
  std::size_t largest = 0;
  for (const model::Island& island : model::split_islands(network))
    if (island.needed) largest = std::max(largest, stores_and_ports(island.network));
  return largest;
}

std::size_t most_unknowns(const model::Network& network) {
  if (unknowns(network) <= unknown_limit) return unknowns(network);
  std::size_t most = 0;
  for (const model::Island& island : model::split_islands(network)) most = std::max(most, unknowns(island.network));
  return most;
}

}  // namespace pwlsim::engine::sparse
