#include "converters/equations.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::test::converters {
namespace {

using Kind = Branch::Kind;
constexpr std::size_t none = static_cast<std::size_t>(-1);

template <class Scalar>
void scale(std::vector<Entry<Scalar>>& row) {
  Real largest = 0;
  for (const auto& entry : row) largest = std::max(largest, magnitude(entry.value));
  for (auto& entry : row) entry.value = entry.value * Scalar(1 / largest);
}

}  // namespace

Equations::Equations(const Converter& converter) : converter_(converter) {
  const std::vector<Branch>& branches = converter_.branches;
  for (const Branch& branch : branches) {
    plus_.push_back(node(branch.plus));
    minus_.push_back(node(branch.minus));
  }
  current_ = nodes_.size();
  const std::size_t first_capacitor = current_ + branches.size();
  std::size_t capacitors = 0;
  std::map<std::string, std::size_t> by_name;
  inductances_.resize(branches.size());
  ratios_.resize(branches.size());
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    by_name[branch.name] = b;
    capacitor_unknown_.push_back(branch.kind == Kind::capacitor ? first_capacitor + capacitors++ : none);
    if (branch.kind == Kind::capacitor || branch.kind == Kind::inductor) {
      states_.push_back(branch.kind == Kind::capacitor ? capacitor_unknown_[b] : current_ + b);
      voltage_state_.push_back(branch.kind == Kind::capacitor);
      initial_.push_back(branch.initial);
    }
    if (branch.kind == Kind::inductor) inductances_[b].push_back({b, branch.value});
    place_in_mode_.push_back(branch.is_valve() ? valves_.size() : none);
    if (branch.is_valve()) valves_.push_back(b);
    if (branch.is_valve() || branch.kind == Kind::contact) largest_off_ = std::max(largest_off_, resistance(branch, false));
  }
  for (std::size_t b = 0; b < branches.size(); ++b)
    if (branches[b].kind == Kind::contact) place_in_mode_[b] = valves_.size() + branches[b].gate;
  for (const Coupling& coupling : converter_.couplings)
    for (const std::string& one : coupling.inductors)
      for (const std::string& other : coupling.inductors) {
        if (one == other) continue;
        const std::size_t a = by_name.at(one), b = by_name.at(other);
        inductances_[a].push_back({b, coupling.factor * std::sqrt(static_cast<Real>(branches[a].value) * branches[b].value)});
        if (std::abs(coupling.factor) == 1.0 && one == coupling.inductors.front())
          ratios_[b] = {{a, coupling.factor * std::sqrt(static_cast<Real>(branches[b].value) / branches[a].value)}};
      }
  sums_ = branches.size();
  capacitor_rows_ = sums_ + nodes_.size();
  size_ = capacitor_rows_ + capacitors;
}

std::size_t Equations::node(const std::string& name) {
  if (name == "0") return none;
  return nodes_.emplace(name, nodes_.size()).first->second;
}

template <class Scalar>
void Equations::add(std::vector<Entry<Scalar>>& row, std::size_t plus, std::size_t minus, const Scalar& factor) const {
  if (plus != none) row.push_back({plus, factor});
  if (minus != none) row.push_back({minus, Scalar(0) - factor});
}

Real Equations::resistance(const Branch& branch, bool on) const {
  const Contact& model = converter_.models[branch.model];
  return on ? std::max<Real>(model.on, least_on) : std::min<Real>(model.off, largest_off_allowed);
}

bool Equations::conducts(std::size_t branch, const Mode& mode) const { return mode[place_in_mode_[branch]] == '1'; }

template <class Scalar>
SparseMatrix<Scalar> Equations::matrix(const Mode& mode, const Scalar& value, Real step) const {
  SparseMatrix<Scalar> result(size_);
  const std::vector<Branch>& branches = converter_.branches;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    auto& row = result[b];
    const std::size_t current = current_ + b;
    if (!ratios_[b].empty()) {
      const auto& [other, ratio] = ratios_[b].front();
      add(row, plus_[b], minus_[b], Scalar(1));
      add(row, plus_[other], minus_[other], Scalar(-ratio));
    } else if (branch.kind == Kind::inductor) {
      for (const auto& [other, henry] : inductances_[b]) row.push_back({current_ + other, value * Scalar(henry / unit_resistance)});
      add(row, plus_[b], minus_[b], Scalar(-step));
    } else if (branch.kind == Kind::capacitor) {
      add(row, plus_[b], minus_[b], Scalar(1));
      row.push_back({capacitor_unknown_[b], Scalar(-1)});
      auto& charge = result[capacitor_rows_ + capacitor_unknown_[b] - current_ - branches.size()];
      charge = {{capacitor_unknown_[b], value * Scalar(branch.value)}, {current, Scalar(-step / unit_resistance)}};
      scale(charge);
    } else {
      add(row, plus_[b], minus_[b], Scalar(1));
      const Real ohm = branch.kind == Kind::source     ? 0
                       : branch.kind == Kind::resistor ? branch.value
                                                       : resistance(branch, conducts(b, mode));
      row.push_back({current, Scalar(-ohm / unit_resistance)});
    }
    scale(row);
    if (plus_[b] != none) result[sums_ + plus_[b]].push_back({current, Scalar(1)});
    if (minus_[b] != none) result[sums_ + minus_[b]].push_back({current, Scalar(-1)});
  }
  return result;
}

template SparseMatrix<Real> Equations::matrix(const Mode&, const Real&, Real) const;
template SparseMatrix<Complex> Equations::matrix(const Mode&, const Complex&, Real) const;

Vector Equations::right_side(const Mode& mode, const Vector& states, Real time, Real inside) const {
  Vector result(size_, 0);
  const std::vector<Branch>& branches = converter_.branches;
  std::size_t state = 0;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Branch& branch = branches[b];
    if (branch.kind == Kind::capacitor) result[b] = states[state++];
    if (branch.kind == Kind::inductor) {
      const Real current = states[state++] * unit_resistance;
      if (plus_[b] != none) result[sums_ + plus_[b]] -= current;
      if (minus_[b] != none) result[sums_ + minus_[b]] += current;
    }
    if (branch.kind == Kind::source) result[b] = branch.wave.value(time, inside);
    if (branch.is_valve() && conducts(b, mode)) {
      const Real drop = converter_.models[branch.model].drop, on = resistance(branch, true);
      result[b] = (drop - on * drop / resistance(branch, false)) / std::max<Real>(1, on / unit_resistance);
    }
  }
  return result;
}

Real Equations::state(const Vector& solution, std::size_t k) const {
  return voltage_state_[k] != 0 ? solution[states_[k]] : solution[states_[k]] / unit_resistance;
}

void Equations::add_state(Vector& solution, std::size_t k, Real value) const {
  solution[states_[k]] += voltage_state_[k] != 0 ? value : value * unit_resistance;
}

Real Equations::slack(const Vector& solution, const Mode& mode, std::size_t valve) const {
  const std::size_t b = valves_[valve];
  const Branch& branch = converter_.branches[b];
  const Real drop = converter_.models[branch.model].drop;
  if (mode[valve] == '1') return solution[current_ + b] / unit_resistance - drop / resistance(branch, false);
  const Real plus = plus_[b] == none ? 0 : solution[plus_[b]], minus = minus_[b] == none ? 0 : solution[minus_[b]];
  return drop - (plus - minus);
}

}  // namespace pwlsim::test::converters
