#include "elements/moving_form.hpp"

namespace pwlsim::elements {

MovingForm constant_form(const Varied& value) {
  MovingForm result;
  accumulate(result, MovingForm(model::LinearForm{model::constant(1.0)}), value);
  return result;
}

void accumulate(MovingForm& sum, const MovingForm& form, const Varied& factor) {
  if (factor.value != 0.0) model::accumulate(sum.form, form.form, factor.value);
  const auto moved = [&](std::size_t k) -> model::LinearForm& {
    if (sum.moved.size() <= k) sum.moved.resize(k + 1);
    return sum.moved[k];
  };
  for (std::size_t k = 0; k < factor.gradient.size(); ++k)
    if (factor.gradient[k] != 0.0) model::accumulate(moved(k), form.form, factor.gradient[k]);
  if (factor.value == 0.0) return;
  for (std::size_t k = 0; k < form.moved.size(); ++k)
    if (!form.moved[k].empty()) model::accumulate(moved(k), form.moved[k], factor.value);
}

MovingForm scaled(const MovingForm& form, const Varied& factor) {
  MovingForm result;
  accumulate(result, form, factor);
  return result;
}

void add_moves(model::NetworkBuilder& builder, model::NetworkMove::Item item, int index, const std::vector<model::LinearForm>& moved) {
  for (std::size_t k = 0; k < moved.size(); ++k)
    if (!moved[k].empty()) builder.move(k, {.item = item, .index = index, .form = moved[k]});
}

void add_moves(model::NetworkBuilder& builder, model::NetworkMove::Item item, int index, const Varied& number) {
  for (std::size_t k = 0; k < number.gradient.size(); ++k)
    if (number.gradient[k] != 0.0) builder.move(k, {.item = item, .index = index, .derivative = number.gradient[k]});
}

}  // namespace pwlsim::elements
