#include "steady/carried_trace.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/exact/tolerances.hpp"
#include "linalg/dense.hpp"
#include "linalg/factorisations.hpp"
#include "model/store_values.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using engine::Change;
using engine::IslandModel;
using linalg::Matrix;
using linalg::Vector;
using model::Exosystem;
using model::Mode;
using model::System;

/// (a − b) against both.
bool are_close(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && (a - b).norm() <= tolerance::same_coordinates * (a.norm() + b.norm());
}

const std::string& source_name(const IslandModel& island, const Exosystem::Block& block) {
  static const std::string shared;
  return block.source < 0 ? shared : island.island.network.sources[static_cast<std::size_t>(block.source)].label.name;
}

/// Where each entry of ζ stands among those of the other model; empty where one is not found there.
std::optional<std::vector<Eigen::Index>> places_of_sources(const IslandModel& from, const IslandModel& to) {
  std::vector<Eigen::Index> places(static_cast<std::size_t>(from.extraction.system.n_zeta), -1);
  std::vector<char> is_taken(to.extraction.system.exosystem->blocks().size(), 0);
  for (const Exosystem::Block& own : from.extraction.system.exosystem->blocks()) {
    const auto& blocks = to.extraction.system.exosystem->blocks();
    std::size_t k = 0;
    const auto is_same = [&](const Exosystem::Block& other) {
      return other.kind == own.kind && other.rate == own.rate && other.omega == own.omega && other.damping == own.damping &&
             other.phase == own.phase && other.delay == own.delay && other.end == own.end &&
             source_name(to, other) == source_name(from, own);
    };
    while (k < blocks.size() && (is_taken[k] != 0 || !is_same(blocks[k]))) ++k;
    if (k == blocks.size()) return std::nullopt;
    is_taken[k] = 1;
    for (int i = 0; i < own.size(); ++i) places[static_cast<std::size_t>(own.first + i)] = blocks[k].first + i;
  }
  return places;
}

bool have_the_same_ports(const System& a, const System& b) {
  const auto is_same = [](const model::Port& p, const model::Port& q) {
    return p.name == q.name && p.input_is_current == q.input_is_current;
  };
  const auto same_control = [](const model::Control& p, const model::Control& q) { return p.driven == q.driven; };
  return a.diodes == b.diodes && a.ports == b.ports && std::equal(a.port.begin(), a.port.end(), b.port.begin(), b.port.end(), is_same) &&
         std::equal(a.controls.begin(), a.controls.end(), b.controls.begin(), b.controls.end(), same_control) &&
         a.clocked.size() == b.clocked.size();
}

/// One island in both models.
class Island {
 public:
  Island(const IslandModel& from, const IslandModel& to, std::size_t number, model::Selector& selector)
      : from_(from.extraction.system), to_(to.extraction.system), number_(number), selector_(selector) {
    auto places = places_of_sources(from, to);
    if (!places || from_.n != to_.n || !have_the_same_ports(from_, to_)) return;
    places_ = std::move(*places);
    is_there_ = find_stores(from, to);
  }

  [[nodiscard]] bool is_there() const { return is_there_; }
  [[nodiscard]] std::size_t number() const { return number_; }

  /// The same mode of the other model; null where it has none.
  const Mode* mode(const Mode* own) {
    const Known* known = known_of(own);
    return known == nullptr ? nullptr : known->mode;
  }

  /// y of a mode that is known there.
  std::vector<double> state(const Mode* own, const std::vector<double>& y) {
    const Known& known = *known_of(own);
    std::vector<double> there(static_cast<std::size_t>(known.mode->ny), 0.0);
    if (known.coordinates.size() > 0)
      linalg::multiply(known.coordinates, y.data(), there.data());
    else
      std::copy_n(y.begin(), own->n1, there.begin());
    for (std::size_t k = 0; k < places_.size(); ++k)
      there[static_cast<std::size_t>(known.mode->n1 + places_[k])] = y[static_cast<std::size_t>(own->n1) + k];
    return there;
  }

 private:
  struct Known {
    const Mode* mode = nullptr;
    Matrix coordinates;  ///< c there from y here; empty: they are the same
  };

  /// Columns of ζ there, sorted as they stand here.
  [[nodiscard]] Matrix taken(const Matrix& columns) const { return columns(Eigen::all, places_); }

  /// ξ there from x here, by what the stores hold.
  bool find_stores(const IslandModel& from, const IslandModel& to) {
    const model::StoreValues here(from.island, from.extraction), there(to.island, to.extraction);
    if (here.names() != there.names()) return false;
    const Eigen::Index n = from_.n;
    const Matrix own = there.rows().leftCols(n), rest = taken(there.rows().rightCols(to_.n_zeta));
    if (own == here.rows().leftCols(n) && rest == here.rows().rightCols(from_.n_zeta)) return true;
    Matrix wanted = here.rows();
    wanted.rightCols(from_.n_zeta) -= rest;
    // Each store has a unit of its own.
    const Vector size = own.rowwise().norm().cwiseMax(1e-300).cwiseInverse();
    const Eigen::ColPivHouseholderQR<Matrix> qr(size.asDiagonal() * own);
    if (n > 0 && qr.rank() < n) return false;
    stores_ = n > 0 ? Matrix(qr.solve(size.asDiagonal() * wanted)) : Matrix(0, wanted.cols());
    return are_close(size.asDiagonal() * own * stores_, size.asDiagonal() * wanted);
  }

  const Known* known_of(const Mode* own) {
    const auto found = modes_.find(own);
    if (found != modes_.end()) return found->second.mode == nullptr ? nullptr : &found->second;
    Known& known = modes_[own];
    const Mode* const there = own->decays ? selector_.modes().slow_mode(own->active) : &selector_.modes().followed(own->active);
    if (there == nullptr || there->n1 != own->n1 || there->constrained != own->constrained) return nullptr;
    if (there->guards.rows() != own->guards.rows() || !find_coordinates(*own, *there, known)) return nullptr;
    known.mode = there;
    return &known;
  }

  bool find_coordinates(const Mode& own, const Mode& there, Known& known) const {
    if (!own.constrained && stores_.size() == 0) return true;
    const Eigen::Index n = from_.n, nz = from_.n_zeta;
    const bool is_alike = own.constrained && stores_.size() == 0 && own.basis == there.basis;
    if (is_alike && own.lift == taken(there.lift)) return true;
    Matrix x = Matrix::Zero(n + nz, own.ny);  // x here from y here
    x.bottomRightCorner(nz, nz).setIdentity();
    if (own.constrained)
      x.topRows(n) << own.basis, own.lift;
    else
      x.topLeftCorner(n, n).setIdentity();
    const Matrix xi = stores_.size() > 0 ? Matrix(stores_ * x) : Matrix(x.topRows(n));
    known.coordinates = there.constrained ? Matrix(there.basis.transpose() * xi) : xi;
    if (!there.constrained) return true;
    Matrix again = there.basis * known.coordinates;
    again.rightCols(nz) += taken(there.lift);
    return are_close(again, xi);
  }

  const System &from_, &to_;
  std::size_t number_;
  model::Selector& selector_;
  std::vector<Eigen::Index> places_;  ///< of ζ, there
  Matrix stores_;                     ///< ξ there from x here; empty: it is the same
  bool is_there_ = false;
  std::map<const Mode*, Known> modes_;
};

class Carrier {
 public:
  Carrier(const engine::ExactModel& from, const engine::ExactModel& to, engine::Selectors& selectors, double stop) {
    for (std::size_t i = 0; i < to.islands.size(); ++i)
      selectors.of(i).set_unseen(engine::tolerance::unseen_per_merge * engine::tolerance::merge * stop);
    for (const IslandModel& island : from.islands) {
      const auto same = std::find_if(to.islands.begin(), to.islands.end(),
                                     [&](const IslandModel& other) { return other.island.name == island.island.name; });
      is_possible_ &= same != to.islands.end();
      if (!is_possible_) return;
      const auto at = static_cast<std::size_t>(same - to.islands.begin());
      islands_.emplace_back(island, *same, at, selectors.of(at));
      is_possible_ &= islands_.back().is_there();
    }
    is_possible_ &= islands_.size() == to.islands.size();
  }

  /// False where it is not possible; the trace is of no use then.
  bool carry(Trace& trace) {
    for (TraceStep& step : trace.steps) {
      carry(step.segments);
      for (Change& change : step.changes)
        if (is_possible_) carry(change);
      if (!is_possible_) return false;
    }
    carry(trace.tail);
    return is_possible_;
  }

 private:
  void carry(std::vector<TraceSegment>& segments) {
    for (TraceSegment& segment : segments) {
      const Mode* const mode = this->mode(segment.island, segment.mode);
      if (mode == nullptr) return;
      Island& island = islands_[segment.island];
      segment.y0 = island.state(segment.mode, segment.y0);
      segment.y1 = island.state(segment.mode, segment.y1);
      segment.island = island.number();
      segment.mode = mode;
    }
  }

  void carry(Change& change) {
    Island& island = islands_[change.island];
    const Mode *const before = mode(change.island, change.before), *const after = mode(change.island, change.after);
    if (before != nullptr && !change.y_before.empty()) change.y_before = island.state(change.before, change.y_before);
    if (after != nullptr && !change.y_after.empty()) change.y_after = island.state(change.after, change.y_after);
    for (const Mode*& way : change.by_way_of) way = mode(change.island, way);
    change.before = before;
    change.after = after;
    change.island = island.number();
  }

  const Mode* mode(std::size_t island, const Mode* own) {
    if (own == nullptr) return nullptr;
    const Mode* const there = islands_[island].mode(own);
    is_possible_ &= there != nullptr;
    return there;
  }

  std::vector<Island> islands_;
  bool is_possible_ = true;
};

}  // namespace

bool carry(Trace& trace, const engine::ExactModel& from, const engine::ExactModel& to, engine::Selectors& selectors, double stop) {
  return Carrier(from, to, selectors, stop).carry(trace);
}

}  // namespace pwlsim::steady
