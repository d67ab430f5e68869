#pragma once
/// The unknowns right after an instant, before anything decays.
///
/// A segment is made for its length: of decays that are over within far less of it, its vectors leave out what has next to no energy, be that the current of an inductor across megohms, whose voltage is hundreds
/// of volts. Here steps are as short as such decays ask for (KrylovSpace::unknowns_at_start), with factors of their own, so that the run is the same whether or not a row asks for them.

#include <optional>
#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/sources.hpp"

namespace pwlsim::engine::sparse {

class StartUnknowns {
 public:
  /// All must outlive it. `stop`: end of the run, s.
  StartUnknowns(const Descriptor& descriptor, const Sources& sources, double stop);

  /// What a segment begins from, of whose states √energy is `size`; `step`: its γ, s.
  struct Start {
    double time = 0.0;
    const Position& on;
    const KrylovSpace::Origin& origin;
    double size = 0.0, step = 0.0;
  };
  /// None where no step is short enough, or ports have their signs in no position: one that is on its wrong side in that of the segment, and changes sides while something decays that the segment
  /// does not follow, begins on the other.
  [[nodiscard]] std::optional<KrylovSpace::Beginning> find(const Start& start);
  [[nodiscard]] const linalg::KluOrdering::Counts& counts() const { return factors_.counts(); }

 private:
  [[nodiscard]] std::optional<KrylovSpace::Beginning> find_in(const Position& on, const Start& start);
  [[nodiscard]] std::vector<std::size_t> ports_on_wrong_side(const Position& on, const std::vector<double>& z, double time) const;

  const Descriptor& descriptor_;
  const Sources& sources_;
  Factors factors_;
  KrylovSpace space_;
  double longest_;  ///< step, s
};

}  // namespace pwlsim::engine::sparse
