#pragma once
/// The slow motion of a mode that also has very fast decays.
///
/// A blocked diode's Roff beside an inductor, or a small Ron beside a capacitor, gives a mode rates of 10¹³ s⁻¹ beside those of milliseconds. Its matrix A_J has lost the
/// slow ones to rounding. They are all in its resolvent at a shift σ between the two, which the ports give without ever forming a fast rate:
///
///     S = (σ − A_J)⁻¹ = R + R B U,   R = (σ − A)⁻¹,   U = −(D_JJ + C_J R B_J)⁻¹ C_J R,
///
/// where x = S z and u_J = U z are state and inputs with σx − x' = z. What is fast is nearly zero in S: the dominant subspace N of its states is the slow one (subspace
/// iteration, which contracts by the ratio of the rates; Golub & Van Loan, Matrix Computations, §7.3), the dominant one W of Sᵀ tells it from the fast one, and with the
/// quasi-static response L of the fast part to the sources
///
///     ξ = N c + L ζ + F φ,   c = (WᵀN)⁻¹ Wᵀ (ξ − L ζ),   c' = A_s c + E_s ζ,   φ' = Λ φ,   WᵀF = 0,
///
/// an exact similarity (Kokotović, Khalil, O'Reilly, Singular Perturbation Methods in Control (1986), §2.4). With Roff = ∞ the slow motion is that of the ideal
/// mode, and the decay of φ its jump.

#include <map>
#include <optional>
#include <vector>

#include "linalg/fast_decays.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

struct Mode;

struct SlowManifold {
  linalg::WideMatrix feedback;       ///< u_J = feedback·x on the manifold (|J| × size)
  linalg::WideMatrix rate;           ///< ξ' = rate·x there (n × size)
  linalg::WideMatrix constraints;    ///< the manifold is {x : constraints·x = 0} (r × size)
  linalg::WideMatrix projector;      ///< onto the manifold along the fast subspace (size × size)
  linalg::WideMatrix free_inputs;    ///< directions of u_J that the mode leaves open (|J| × any number)
  linalg::Matrix fast;               ///< ξ of the decays ψ, one a column (n × r)
  linalg::Matrix coordinates;        ///< ψ of x (r × size)
  linalg::Vector time_constants;     ///< of the decays, s (r); 0: that one is a jump
  double slowest = 0.0;              ///< of the time constants
  bool are_sharp = false;            ///< they have their digits
  linalg::WideMatrix slow, of_rows;  ///< N, and the same of the transpose, W
  linalg::WideMatrix lift;           ///< L
  linalg::Wide shift = 0;            ///< σ, 1/s
  double rate_doubt = 0.0;           ///< what rounding of A, entry by entry, may make of the slow rates, 1/s
};

using linalg::Cut;
using linalg::Rates;

/// Of its states; none where no time constant can be as short as `longest`, s, or where they cannot be computed.
[[nodiscard]] Rates rates_by_speed(const Mode& whole, double longest);

/// R at one shift, and what it makes of all ports, whichever of them a mode has active.
struct ShiftedSystem {
  linalg::Wide shift = 0;
  linalg::WideMatrix states;      ///< ξ of z (n × size)
  linalg::WideMatrix of_inputs;   ///< R B (n × ports)
  linalg::WideMatrix of_ports;    ///< C R (ports × size)
  linalg::WideMatrix impedances;  ///< D + C R B (ports × ports)
  bool is_regular = false;        ///< σ is no rate of the system without ports
};

/// The shifted systems that the modes of one system have asked for. Shifts differ by powers of two, or thrice one, so that modes of like rates share them.
class ShiftedSystems {
 public:
  explicit ShiftedSystems(const System& system) : system_(system) {}
  const ShiftedSystem& at(linalg::Wide shift);

 private:
  const System& system_;
  std::map<linalg::Wide, ShiftedSystem> known_;
};

/// The cut with the slowest decays whose time constant is at most `longest`, s.
[[nodiscard]] inline Cut find_cut(const System& system, const Rates& rates, double longest) {
  return linalg::find_cut(rates, longest, system.exosystem->fastest());
}

/// Ratio of rates on both sides of a cut with which the subspaces on both sides are found to all their digits.
inline constexpr double least_gap_of_subspaces = 30.0;
/// All cuts with at least that, the fastest first.
[[nodiscard]] inline std::vector<Cut> find_cuts(const System& system, const Rates& rates, double longest) {
  return linalg::find_cuts(rates, longest, system.exosystem->fastest(), least_gap_of_subspaces);
}

/// Of `whole`, the mode of the active ports, whose rates have this cut. None if the fast part is not a plain decay.
[[nodiscard]] std::optional<SlowManifold> slow_manifold(const System& system, const Mode& whole, const Cut& cut,
                                                        const std::vector<int>& active, ShiftedSystems& shifted);

struct Feedback {
  linalg::WideMatrix inputs;       ///< as SlowManifold::feedback
  linalg::WideMatrix free_inputs;  ///< as SlowManifold::free_inputs
  linalg::WideMatrix slow, lift;   ///< N and L
};
/// The same feedback at another shift, from which it differs by rounding. Its own resolvent is applied to the subspaces of the first once.
[[nodiscard]] std::optional<Feedback> feedback_at_other_shift(const System& system, const std::vector<int>& active, ShiftedSystems& shifted,
                                                              const SlowManifold& first);

}  // namespace pwlsim::model
