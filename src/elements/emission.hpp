#pragma once
/// What an element uses to emit itself into the model: its own values, and the builder.

#include <string_view>
#include <vector>

#include "base/diagnostic.hpp"
#include "elements/kind.hpp"
#include "model/builder.hpp"

namespace pwlsim::elements {

using Quantity = model::Term::Kind;
[[nodiscard]] inline model::LinearForm quantity(Quantity kind, int index) { return {{kind, index, 1.0}}; }

/// The emitted quantities of a raw system.
struct RawSignals {
  std::vector<model::LinearForm> x, u, y;
};

/// The quantities of an emitted element that others may use.
struct Emitted {
  model::LinearForm current;                     ///< into its first node and out of its second
  std::vector<model::LinearForm> current_moved;  ///< by each parameter of `.sens` that moves this form
  int item = -1;                                 ///< its main item in the network, for the second pass
  int inductor = -1;                             ///< its inductor, if it has one that can be coupled
  RawSignals raw;
};

class Emission {
 public:
  /// `emitted` has one entry per instance of the circuit; the lists outlive the Emission.
  Emission(const std::vector<Instance>& instances, const std::vector<Model>& models, std::vector<Emitted>& emitted,
           model::NetworkBuilder& builder, Diagnostics& diagnostics)
      : instances_(instances),
        models_(models),
        emitted_(emitted),
        builder_(builder),
        diagnostics_(diagnostics),
        followed_(instances.size(), 0) {
    mark_followed();
  }

  void select(std::size_t index) { index_ = index; }
  /// Comparisons of sources stay comparisons: what moves the sources moves them.
  void keep_comparisons() { keeps_comparisons_ = true; }
  [[nodiscard]] bool keeps_comparisons() const { return keeps_comparisons_; }

  [[nodiscard]] const Instance& instance() const { return instances_[index_]; }
  [[nodiscard]] const Model& model() const { return models_[static_cast<std::size_t>(instance().model)]; }
  [[nodiscard]] double value(std::string_view parameter) const { return instance().values.get(parameter); }
  [[nodiscard]] bool has(std::string_view parameter) const { return instance().values.has(parameter); }
  /// The span of a parameter, else of the element's name.
  [[nodiscard]] SourceSpan span_of(std::string_view parameter) const;

  [[nodiscard]] model::NodeIndex p() const { return instance().nodes[0]; }
  [[nodiscard]] model::NodeIndex n() const { return instance().nodes[1]; }
  /// The element's name, or "R1 (part)" for a part of it.
  [[nodiscard]] model::Label label(std::string_view part = {}) const;
  [[nodiscard]] model::NodeIndex inner_node(std::string_view part) { return builder_.inner_node(label(part)); }

  [[nodiscard]] Emitted& result() { return emitted_[index_]; }
  /// Whether another element, or this one itself, reads the element's current.
  [[nodiscard]] bool is_referenced() const { return followed_[index_] != 0; }
  [[nodiscard]] const Instance& referenced(std::size_t k) const { return instances_[reference(k)]; }
  [[nodiscard]] const Emitted& referenced_result(std::size_t k) const { return emitted_[reference(k)]; }

  [[nodiscard]] model::NetworkBuilder& builder() { return builder_; }
  [[nodiscard]] Diagnostics& diagnostics() { return diagnostics_; }

 private:
  [[nodiscard]] std::size_t reference(std::size_t k) const { return static_cast<std::size_t>(instance().references[k].index); }

  void mark_followed();

  const std::vector<Instance>& instances_;
  const std::vector<Model>& models_;
  std::vector<Emitted>& emitted_;
  model::NetworkBuilder& builder_;
  Diagnostics& diagnostics_;
  std::vector<char> followed_;  ///< instances whose current another one reads
  std::size_t index_ = 0;
  bool keeps_comparisons_ = false;
};

/// coefficients[0] + Σ coefficients[k]·v(control pair k)
[[nodiscard]] model::LinearForm voltage_control(const Instance& instance);
/// coefficients[0] + Σ coefficients[k]·i(reference k); second pass only
[[nodiscard]] model::LinearForm current_control(const Emission& emission);

/// Adds the source function of a V or I card; the form of its value.
[[nodiscard]] model::LinearForm add_source(Emission& emission);

}  // namespace pwlsim::elements
