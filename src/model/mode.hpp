#pragma once
/// One mode of a linear complementarity system: y_J = 0 and u_J free on the active set J, u = 0 elsewhere.
///
/// With V the consistent subspace and T the jump subspace of (A, B_J, C_J, D_JJ) (van der Schaft & Schumacher 1996, §4;
/// Hautus & Silverman 1983), the mode is regular when V ⊕ T is the whole space; then x⁺ = P x⁻ (projection on V along T)
/// and u = K x on V. Where u is not unique (parallel diodes, a floating part) K gives the least norm; x is unique all the same.
///
/// In the mode the state is c = Nᵀ(ξ − R ζ), N orthonormal in V ∩ {ζ = 0}; y = (c, ζ) obeys y' = A y.

#include <memory>
#include <string>
#include <vector>

#include "linalg/exponential.hpp"
#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

struct ModalForm;

/// A decay of e^-40 is rounding.
inline constexpr double time_constants_to_rest = 40.0;

/// The decays ψ_k e^{−τ/T_k} beside the slow motion that a mode on its slow manifold (slow_manifold.hpp) leaves out.
struct Decays {
  double slowest = 0.0;     ///< the largest T_k, s
  Vector time_constants;    ///< T_k, s; 0: a jump
  Matrix coordinates;       ///< ψ = coordinates·x (r × size)
  Matrix slow;              ///< the slow motion's c = slow·x, whatever ψ is (n1 × size)
  Matrix guards;            ///< contribution of ψ to each guard (guards × r)
  Matrix guard_doubt;       ///< their possible rounding errors
  Vector guard_rounding;    ///< of the sum, which is the guard in the mode itself, for a state of norm 1
  double rate_doubt = 0.0;  ///< possible error of the slow rates from rounding of A, 1/s
  bool are_sharp = false;   ///< each T_k has its digits, and holds to the decay's end
};

/// The coordinates φ of fast decays where the slow motion stands apart (slow_apart.hpp). They have the digits of the stores that they read, not those of the largest.
struct FastCoordinates {
  int first = 0;  ///< of c
  Matrix terms;   ///< |φ's terms| ≤ terms·|y| (fast × ny)
  double terms_norm = 0.0;
  Vector slow_guard_norm, guard_norm, source_guard_norm;  ///< ‖row‖ of the guards restricted to c, φ and ζ
};

struct Mode {
  Mode();
  ~Mode();
  Mode(const Mode&) = delete;
  Mode& operator=(const Mode&) = delete;

  IndexSet active;
  bool regular = false;
  bool unique_inputs = true;       ///< false: some u of the mode is not unique
  std::vector<char> input_unique;  ///< a port: its u and y are unique in this mode
  Matrix free_inputs;              ///< directions of u that the mode leaves open (ports × any number); empty where u is unique
  bool constrained = false;        ///< c is not ξ: V is smaller than the whole space, or slow_apart.hpp (n1 = n)
  int n1 = 0;                      ///< dim of c
  int ny = 0;                      ///< n1 + n_ζ
  Matrix projector;                ///< P (size × size); empty when not constrained
  Matrix k;                        ///< u = K x (ports × size)
  Matrix basis, lift;              ///< N (n × n1), R (n × n_ζ); empty when not constrained
  linalg::Exponential flow;        ///< of A in y
  Matrix absolute_a;               ///< |A|
  double norm_a = 0.0;             ///< Frobenius norm of A, for scaling derivatives
  double growth = 0.0;             ///< max(0, μ(A₁)): logarithmic norm of the c part
  Vector scale;  ///< diagonal of S (n1), powers of two, of another norm ‖S⁻¹c‖ that grows more slowly; empty: there is none
  double scaled_growth = 0.0;  ///< max(0, μ(S⁻¹A₁S))
  double noise = 0.0;          ///< relative rounding level of guard values in this mode
  Vector guard_noise;          ///< the same of each guard by itself, where that is known
  Matrix guard_error;          ///< of each entry of `guards`, which may be large and read a state that is nearly zero; empty: not known

  /// Guards in y: one a diode port (u_i or y_i, ≥ 0 while the mode lasts), then two a control: v − off_level, on_level − v.
  Matrix guards;
  Matrix absolute_guards;           ///< |guards|
  Vector guard_norm, guard_c_norm;  ///< ‖row‖, ‖row restricted to c‖
  Matrix guard_block_norm;          ///< guards × exosystem blocks
  /// One bit for each entry of c that the guard or one of its derivatives reads; 0, or empty: all of them. These entries obey an equation of
  /// their own: the other states, a lossless ring for example, do not affect the guard's bounds.
  std::vector<std::uint64_t> guard_reads;
  std::vector<char> guard_constant;                     ///< no derivative: cannot fire within a segment
  std::vector<int> guard_twin;                          ///< first row with the same values: representative of this one
  Vector input_block_norm;                              ///< ‖E₁ restricted to a block‖
  Vector scaled_guard_c_norm, scaled_input_block_norm;  ///< of row·S and S⁻¹E₁; empty without `scale`
  Matrix outputs;                                       ///< signals in y
  std::unique_ptr<FastCoordinates> apart;               ///< null: the mode's own coordinates
  std::unique_ptr<Decays> decays;                       ///< if the mode is the slow motion of its active set; null: it is the whole mode

  mutable std::uint64_t visits = 0;
  mutable const Mode* slow = nullptr;             ///< the mode of its slow motion, if it has one and it was requested
  bool piecewise_linear = false;                  ///< only constants, levels and ramps: every guard is linear in time within a segment
  mutable double reach = 1.5;                     ///< rate·h that the locator's series decided last in this mode
  mutable std::unique_ptr<ModalForm> modal_form;  ///< likewise
  mutable bool modal_form_known = false;
  mutable bool stiff = false;  ///< its segments are long against 1/‖A‖: the locator's high-order series is useless
};

/// Completes a mode whose coordinates and guard rows are set: its flow y' = A y, and norms and bounds of both.
void finish_mode(const System& system, Mode& mode, Matrix a);

/// What rounding of a guard at y is measured by: its terms, or a `share` of ‖row‖‖y‖ if that is more. Fast coordinates that stand apart have terms of their own instead.
[[nodiscard]] double guard_size(const Mode& mode, int row, const double* y, double share);
/// The error of a guard at y from the errors of its entries, by `guard_noise` or, if that is smaller, by `guard_error`. `size`: of its terms; `least`: the least noise.
[[nodiscard]] double guard_rounding(const Mode& mode, int row, const double* y, double size, double least);

/// x -> y and back. x has system.size() entries, y has mode.ny.
void to_mode(const System& system, const Mode& mode, const double* x, double* y);
void from_mode(const System& system, const Mode& mode, const double* y, double* x);

}  // namespace pwlsim::model
