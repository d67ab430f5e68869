#include "elements/steps.hpp"

#include <utility>
#include <vector>

#include "elements/complementarity.hpp"
#include "model/step_loops.hpp"

namespace pwlsim::elements {
namespace {

using model::LinearForm;
using model::Network;

/// 1 where the argument is positive, 0 where it is negative, and at 0 as `at_zero` says: a half is the mean of both answers.
LinearForm add_decision(model::NetworkBuilder& builder, const model::Label& label, const MovingForm& argument, double at_zero) {
  const MovingForm nothing, one(LinearForm{model::constant(1.0)});
  const auto answer = [&](bool holds_at_zero) {
    return holds_at_zero ? add_choice(builder, label, {scaled(argument, -1.0), 0.0, 0.0}, nothing, one).form
                         : add_choice(builder, label, {argument, 0.0, 0.0}, one, nothing).form;
  };
  if (at_zero == 0.0 || at_zero == 1.0) return answer(at_zero == 1.0);
  LinearForm value;
  model::accumulate(value, answer(false), 1.0 - at_zero);
  model::accumulate(value, answer(true), at_zero);
  return value;
}

/// What parameters move in the slack of a complementarity that goes, taken.
std::vector<LinearForm> take_moves(model::NetworkBuilder& builder, int complementarity) {
  std::vector<LinearForm> moved;
  const auto is_own = [&](const model::NetworkMove& move) {
    return move.item == model::NetworkMove::Item::slack_form && move.index == complementarity;
  };
  for (std::size_t k = 0; k < builder.moves().size(); ++k) {
    model::NetworkMoves& moves = builder.moves()[k];
    for (const model::NetworkMove& move : moves)
      if (is_own(move)) {
        moved.resize(k + 1);
        model::accumulate(moved[k], move.form);
      }
    std::erase_if(moves, is_own);
  }
  return moved;
}

/// The inputs of complementarities that go become forms, the others get new numbers.
class Replacement {
 public:
  explicit Replacement(std::size_t complementarities) : form_(complementarities), goes_(complementarities, 0) {}

  void replace(int input, LinearForm form) {
    form_[static_cast<std::size_t>(input)] = std::move(form);
    goes_[static_cast<std::size_t>(input)] = 1;
  }

  void apply(model::NetworkBuilder& builder) {
    Network& network = builder.network();
    number();
    for (model::NetworkMoves& moves : builder.moves())
      for (model::NetworkMove& move : moves) {
        apply(move.form);
        if (move.item == model::NetworkMove::Item::slack_form) move.index = number_[static_cast<std::size_t>(move.index)];
      }
    for (auto& branch : network.branches) apply(branch.voltage);
    for (auto& injection : network.injections) apply(injection.current);
    for (auto& complementarity : network.complementarities) apply(complementarity.slack);
    for (auto& contact : network.switches) apply(contact.control);
    for (auto& signal : network.signals) apply(signal.form);
    std::vector<model::Complementarity> kept;
    for (std::size_t i = 0; i < goes_.size(); ++i)
      if (goes_[i] == 0) kept.push_back(std::move(network.complementarities[i]));
    network.complementarities = std::move(kept);
  }

 private:
  void number() {
    int next = 0;
    for (const char goes : goes_) number_.push_back(goes != 0 ? -1 : next++);
  }

  void apply(LinearForm& form) const {
    LinearForm result;
    for (model::Term term : form) {
      const auto index = static_cast<std::size_t>(term.index);
      if (term.kind != Quantity::slack_input) {
        result.push_back(term);
      } else if (goes_[index] != 0) {
        model::accumulate(result, form_[index], term.coefficient);
      } else {
        term.index = number_[index];
        result.push_back(term);
      }
    }
    form = std::move(result);
  }

  std::vector<LinearForm> form_;
  std::vector<char> goes_;
  std::vector<int> number_;
};

}  // namespace

void decide_steps(model::NetworkBuilder& builder) {
  const std::vector<model::Step> steps = builder.take_steps();
  if (steps.empty()) return;
  const std::vector<char> in_loop = model::steps_in_loops(builder.network(), steps);
  Replacement replacement(builder.network().complementarities.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (in_loop[i] != 0) continue;
    const model::Label label = builder.network().complementarities[static_cast<std::size_t>(steps[i].first)].label;
    MovingForm argument(steps[i].argument);
    argument.moved = take_moves(builder, steps[i].first);
    LinearForm input{model::constant(1.0)};
    model::accumulate(input, add_decision(builder, label, argument, steps[i].at_zero), -1.0);
    replacement.replace(steps[i].first, std::move(input));
    replacement.replace(steps[i].first + 1, {});
  }
  replacement.apply(builder);
}

}  // namespace pwlsim::elements
