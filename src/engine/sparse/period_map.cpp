#include "engine/sparse/period_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "base/disjoint_sets.hpp"
#include "engine/sparse/sparse_run.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Vector;

constexpr std::uint64_t most_times = 3, most_openings = 200;  ///< of a trial: of those of the run kept, and at least

class NoRows : public RowSink {
 public:
  bool write(std::span<const double>, std::size_t) override { return true; }
};

}  // namespace

PeriodMap::PeriodMap(std::shared_ptr<const SparseModel> model, const std::atomic<int>* interrupt)
    : model_(std::move(model)), interrupt_(interrupt) {
  for (const auto& part : model_->parts) {
    deviations_.push_back(std::make_unique<SegmentDeviation>(*part));
    size_ += part->descriptor.size();
    const model::Network& network = part->island.network;
    for (const auto& c : network.capacitors) stores_.push_back({fmt::format("v({})", c.label.name), "V", c.label.name, "C", 0.0});
    for (const auto& l : network.inductors) stores_.push_back({fmt::format("i({})", l.label.name), "A", l.label.name, "Vs", 0.0});
    const auto& states = part->descriptor.states();
    for (std::size_t i = 0; i < states.size(); ++i) stores_[stores_.size() - states.size() + i].storage = std::abs(states[i].storage);
  }
}

Answer PeriodMap::advance(State& state, double length, bool records, bool is_trial) {
  Request request;
  request.stop = length;
  request.use_initial_conditions = true;
  request.interrupt = interrupt_;
  NoRows none;
  SparseRun transient(model_->parts, model_->signals, request, segment_tolerance, PartRun::Method::segments, none);
  transient.begin_lap(records ? &last_ : nullptr, is_trial ? std::max(most_times * openings_, most_openings) : 0);
  Answer answer = transient.run(state);
  if (records) last_openings_ = transient.openings();
  if (answer.outcome == Outcome::completed) state = transient.ends();
  return answer;
}

Answer PeriodMap::run(const State& from, const Request& request, RowSink& sink) const {
  return SparseRun(model_->parts, model_->signals, request, segment_tolerance, PartRun::Method::segments, sink).run(from);
}

Vector PeriodMap::unknowns(const State& state) const {
  Vector z(size_);
  Eigen::Index first = 0;
  for (const PartStart& part : state) {
    const auto count = static_cast<Eigen::Index>(part.unknowns.size());
    z.segment(first, count) = Eigen::Map<const Vector>(part.unknowns.data(), count);
    first += count;
  }
  return z;
}

void PeriodMap::move_to(State& state, const Vector& unknowns) const {
  Eigen::Index first = 0;
  for (PartStart& part : state) {
    const auto count = static_cast<Eigen::Index>(part.unknowns.size());
    Eigen::Map<Vector>(part.unknowns.data(), count) = unknowns.segment(first, count);
    first += count;
  }
}

void PeriodMap::step_to(State& state, const Vector& unknowns) const {
  const Vector before = this->unknowns(state);
  move_to(state, unknowns);
  const double* z = before.data();
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Descriptor& descriptor = model_->parts[i]->descriptor;
    std::vector<double>& after = state[i].unknowns;
    const auto size_of = [&](std::span<const double> own) {
      return pwlsim::largest(own.first(static_cast<std::size_t>(descriptor.nodes())));
    };
    const double size = std::max(size_of({z, after.size()}), size_of(after));
    DisjointSets one(descriptor.nodes() + 1);  // ground, and each node
    for (const sparse::State& store : descriptor.states()) {
      const bool stays =
          std::abs(store.value(z)) <= tolerance::empty_store * size && std::abs(store.value(after.data())) <= tolerance::moved_store * size;
      if (stays && !store.is_current) one.join(store.plus + 1, store.minus + 1);
      if (stays && store.is_current && store.current.empty()) after[static_cast<std::size_t>(store.plus)] = 0.0;
    }
    for (int node = 1; node <= descriptor.nodes(); ++node) {
      const int root = one.find(node);
      after[static_cast<std::size_t>(node - 1)] = root > 0 ? after[static_cast<std::size_t>(root - 1)] : 0.0;
    }
    z += after.size();
  }
}

Vector PeriodMap::energies(const Vector& unknowns) const {
  Vector x(static_cast<Eigen::Index>(stores_.size()));
  const double* z = unknowns.data();
  Eigen::Index at = 0;
  for (const auto& part : model_->parts) {
    const double r0 = part->descriptor.r0();
    for (const sparse::State& state : part->descriptor.states())
      x[at++] = std::sqrt(std::abs(state.storage)) / (state.is_current ? r0 : 1.0) * state.value(z);
    z += part->descriptor.size();
  }
  return x;
}

template <class Follow>
bool PeriodMap::each_part(Vector& deviation, const Follow& follow) {
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < deviations_.size(); ++i) {
    const auto count = static_cast<Eigen::Index>(model_->parts[i]->descriptor.size());
    std::vector<double> z(deviation.data() + first, deviation.data() + first + count);
    if (!follow(*deviations_[i], records_[i], z)) {
      failure_ = deviations_[i]->failure();
      return false;
    }
    deviation.segment(first, count) = Eigen::Map<const Vector>(z.data(), count);
    first += count;
  }
  return true;
}

bool PeriodMap::derivative(Vector& deviation) {
  beside_.clear();
  if (interrupt_ != nullptr && interrupt_->load(std::memory_order_relaxed) != 0) {
    failure_ = "interrupted";
    return false;
  }
  return each_part(deviation, [this](SegmentDeviation& own, const std::vector<SegmentRecord>& records, std::vector<double>& z) {
    const bool is_followed = own.follow(records, z);
    worst_ = std::max(worst_, own.worst_error());
    beside_.insert(beside_.end(), own.beside().begin(), own.beside().end());
    return is_followed;
  });
}

bool PeriodMap::smooth(Vector& deviation) {
  return each_part(deviation, [](SegmentDeviation& own, const std::vector<SegmentRecord>& records, std::vector<double>& z) {
    return own.smooth(records, z);
  });
}

bool PeriodMap::keeps_switches(const State& from, const State& to) const {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto first = static_cast<std::ptrdiff_t>(model_->parts[i]->descriptor.first_switch());
    if (!std::equal(from[i].on.begin() + first, from[i].on.end(), to[i].on.begin() + first, to[i].on.end())) return false;
  }
  return true;
}

std::vector<Position> PeriodMap::positions(const std::vector<std::vector<SegmentRecord>>& run) {
  std::vector<Position> positions;
  for (const auto& records : run)
    for (const SegmentRecord& record : records) positions.push_back(record.on);
  return positions;
}

double PeriodMap::largest() const {
  double square = 0.0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    double most = 0.0;
    for (const SegmentRecord& record : records_[i]) most = std::max(most, record.size);
    square += most * most / model_->parts[i]->descriptor.r0();  // a part's own norm is that of energy times R0
  }
  return std::sqrt(square);
}

std::size_t PeriodMap::segments() const {
  std::size_t count = 0;
  for (const auto& records : records_) count += records.size();
  return count;
}

Vector PeriodMap::largest_values() const {
  Vector most = Vector::Zero(static_cast<Eigen::Index>(stores_.size()));
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const Descriptor& descriptor = model_->parts[i]->descriptor;
    const auto& states = descriptor.states();
    for (const SegmentRecord& record : records_[i])
      for (std::size_t k = 0; k < states.size(); ++k) {
        double& largest = most[first + static_cast<Eigen::Index>(k)];
        largest = std::max(largest, std::abs(record.stores_at_begin[k]) / (states[k].is_current ? descriptor.r0() : 1.0));
      }
    first += static_cast<Eigen::Index>(states.size());
  }
  return most;
}

Vector PeriodMap::values(const Vector& energies) const {
  Vector values = energies;
  for (std::size_t i = 0; i < stores_.size(); ++i)
    if (stores_[i].storage > 0.0) values[static_cast<Eigen::Index>(i)] /= std::sqrt(stores_[i].storage);
  return values;
}

Vector PeriodMap::after_start() const {
  Vector z(size_);
  Eigen::Index first = 0;
  for (const auto& records : records_) {
    const std::vector<double>& part = records.front().unknowns_at_begin;
    z.segment(first, static_cast<Eigen::Index>(part.size())) =
        Eigen::Map<const Vector>(part.data(), static_cast<Eigen::Index>(part.size()));
    first += static_cast<Eigen::Index>(part.size());
  }
  return z;
}

}  // namespace pwlsim::engine::sparse
