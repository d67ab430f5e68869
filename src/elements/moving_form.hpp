#pragma once
/// Linear forms with their derivatives to the parameters of `.sens`, as forms.

#include <vector>

#include "elements/varied.hpp"
#include "model/builder.hpp"

namespace pwlsim::elements {

struct MovingForm {
  model::LinearForm form;
  std::vector<model::LinearForm> moved{};  ///< by each varied parameter; the last ones that move nothing may be left out

  MovingForm() = default;
  MovingForm(model::LinearForm own) : form(std::move(own)) {}  // NOLINT(google-explicit-constructor): one that nothing moves
};

[[nodiscard]] MovingForm constant_form(const Varied& value);
/// sum += factor·form
void accumulate(MovingForm& sum, const MovingForm& form, const Varied& factor = 1.0);
[[nodiscard]] MovingForm scaled(const MovingForm& form, const Varied& factor);

/// Tells the builder that a form of the network, which has been added, moves so; or that a number does.
void add_moves(model::NetworkBuilder& builder, model::NetworkMove::Item item, int index, const std::vector<model::LinearForm>& moved);
void add_moves(model::NetworkBuilder& builder, model::NetworkMove::Item item, int index, const Varied& number);

}  // namespace pwlsim::elements
