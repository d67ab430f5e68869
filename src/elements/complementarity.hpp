#pragma once
/// Nonlinearities of one linear form, as complementarity ports and driven switches. All have the name of the element.

#include "elements/emission.hpp"
#include "elements/moving_form.hpp"

namespace pwlsim::elements {

/// max(x, 0) = u with 0 ≤ u ⊥ u − x ≥ 0.
[[nodiscard]] model::LinearForm add_positive_part(Emission& emission, const MovingForm& x);

/// 1 for x > 0, 0 for x < 0, any value between for x = 0: 1 − λ with 0 ≤ λ ⊥ x + μ ≥ 0, 0 ≤ μ ⊥ 1 − λ ≥ 0
/// (van der Schaft & Schumacher 1996, the relay of section 2, for levels 0 and 1).
/// If only a source decides, it is a function of time instead, `at_zero` while the source stays at 0; decide_steps replaces others by switches.
[[nodiscard]] model::LinearForm add_step(Emission& emission, const MovingForm& x, double at_zero);

struct ChoiceCondition {
  MovingForm control;
  Varied on_level{}, off_level{};
};
/// `above` after the control has risen above on_level until it falls below off_level, else `below`.
[[nodiscard]] MovingForm add_choice(model::NetworkBuilder& builder, const model::Label& label, const ChoiceCondition& choice,
                                    const MovingForm& above, const MovingForm& below);

}  // namespace pwlsim::elements
