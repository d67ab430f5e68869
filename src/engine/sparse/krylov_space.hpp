#pragma once
/// The motion of the equations in one position of the ports, from one point on, in a space of few vectors.
///
/// The sources' states ζ (constant 1 among them) are part of the state:  E z' = −(G z + H C ζ + g ζ₁),  ζ' = A_w ζ,  closing rows as the position has them. With
/// S = (1 − γ A)⁻¹, which is one solution of  shift·E + G  at shift = 1/γ, the space is that of S z₀, S² z₀, … It is built from T = S − 1:
///
///     T Z = Z H + h z_{m+1} eᵀ,   K = (1 + H)⁻¹,   A_m = H K/γ,   y' = A_m y,   y(0) = |S z₀| K e₁,   z(τ) = W K y(τ),   W = Z + T Z.
///
/// Rules that it does not work without:
///  - T z is solved for by itself, to its own digits: S z − z would cancel where γ is short against the motion;
///  - on rows of E that are zero the right-hand side of T z is an exact zero (but for sources), so that constraints of index 2 collect no rounding;
///  - the space ends where what is new is rounding.
/// Columns are orthonormal in the norm of the stored energy (mutual inductances left out) and of ζ, each of its states by its own largest value and all weighted to be of the same size. W K y satisfies all algebraic
/// rows, and  E z' + G z + … = E h z_{m+1} (b' − b/γ),  b = eᵀK y, from which the error is estimated.
///
/// Shift-invert Krylov methods for the exponential: van den Eshof and Hochbruck, SIAM J. Sci. Comput. 27 (2006).

#include <optional>
#include <vector>

#include "engine/sparse/factors.hpp"
#include "engine/sparse/resting_parts.hpp"
#include "engine/sparse/start_change.hpp"
#include "linalg/dense.hpp"
#include "linalg/exponential.hpp"
#include "linalg/fast_decays.hpp"
#include "model/exosystem.hpp"

namespace pwlsim::engine::sparse {

class KrylovSpace {
 public:
  /// `stop`: end of the run, s. Sources count by what they may reach until then.
  KrylovSpace(const Descriptor& descriptor, const model::Exosystem& exosystem, double stop = model::forever);

  /// From now on errors count where they are large in a state, too, against its size, in volts: what an amplifier reads may be in a store with next to no energy.
  void count_by(std::vector<double> sizes) { state_sizes_ = std::move(sizes); }
  /// Unknowns of that size, in volts, are not small: where all are smaller a position may hold at zero what is rounding.
  void note_least_voltage(double least) { least_ = least; }
  /// The point to start from: E z + more are charges and fluxes; z itself need not satisfy the position.
  struct Origin {
    const std::vector<double>& z;
    const std::vector<double>& more;  ///< may be empty
    const std::vector<double>& zeta;  ///< all zero: z is a deviation of two motions
    int passed = -1;                  ///< a port that has just passed zero: what is left of it in z is rounding; −1: none
  };
  enum class Begun { yes, contradicted };
  /// The factor must last until the last `grow`. `size`: √energy that counts, at least.
  [[nodiscard]] Begun begin(const Factor& factor, double shift, const Position& on, const Origin& start, double size);
  /// From now on solutions that begin a space stay as they are, where they are for signs only.
  void begin_roughly(bool does) { begins_roughly_ = does; }
  /// From now on each solution T z is corrected by its residual: where rows of one of far larger terms took part in the elimination of others, these have lost digits.
  void refine_all(bool does) { refines_ = does; }
  /// Whether the last one has all its digits.
  [[nodiscard]] bool is_refined() const { return is_refined_; }
  /// Takes the space to m vectors, or to where it is full.
  void grow(int m);
  /// Where it is full, but the last solution has something more that is small and far above its rounding: grows again, beyond that. False: there is none.
  bool goes_on();
  /// Back to m vectors, which is then all there is: what came after them was rounding.
  void shrink(int m);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] double shift() const { return shift_; }
  /// All that the motion takes part in.
  [[nodiscard]] bool is_full() const { return full_; }
  /// False: K is nothing but rounding.
  [[nodiscard]] bool is_sound() const { return sound_; }
  /// √energy at the start, in the norm of the space and without sources.
  [[nodiscard]] double start_size() const { return size_; }
  /// √energy of the difference of two points' states, in the norm of the space.
  [[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b) const;
  /// The rounding of the states that it begins with, of a jump's impulses.
  [[nodiscard]] double start_rounding() const { return rounding_; }
  /// S z₀
  [[nodiscard]] std::vector<double> first_unknowns() const;
  /// What the motion begins with, however fast it then decays: S⁻² S² z₀ = Σ (k + 1) (−T)ᵏ S² z₀. None where γ is too long for what decays, and the terms do not become shorter. The space has none of its
  /// vectors after that.
  struct Beginning {
    std::vector<double> z;
    std::vector<std::vector<double>> decays;  ///< directions in which it moves first, of √energy 1
  };
  [[nodiscard]] std::optional<Beginning> unknowns_at_start();
  /// What impulses at the start make of S z₀, γ times which they are: S z₀ without S z(0).
  [[nodiscard]] std::vector<double> impulses();
  /// y(0).
  [[nodiscard]] const linalg::Vector& first() const { return first_; }
  [[nodiscard]] const linalg::Exponential& flow() const { return flow_; }
  /// The fastest oscillation in the space, radians per s; a bound of it where that is not more than `least`.
  [[nodiscard]] double turning(double least) const;
  /// Rates of the motions in it, the fastest first, 1/s. Empty where they do not converge.
  [[nodiscard]] const linalg::Rates& rates_of_motions() const;
  /// The error in the norm of the space at up to `checkpoints` times, the last of them length: h|b(τ)| and a tenth of h ∫|b' − b/γ|.
  static constexpr int checkpoints = 32;
  /// √energy a second by which y' at the start misses the equations, in the norm of the space.
  [[nodiscard]] double defect_at_start() const;
  /// What its motion is made of, for a bound of its error (krylov_bound.hpp).
  struct Relation {
    linalg::Matrix h;  ///< one row more than columns
    const linalg::Matrix& k;
    linalg::Matrix zetas;  ///< the sources' states of the vectors, z_{m+1} too
    linalg::Vector delta;  ///< rounding of T Z
    const linalg::Exponential& flow;
    const linalg::Vector& first;
    double shift;
    bool has_next;  ///< z_{m+1} is there
  };
  [[nodiscard]] Relation relation() const;
  /// √energy of the difference of two points, with mutual inductances.
  [[nodiscard]] double energy_distance(const std::vector<double>& a, const std::vector<double>& b) const;
  /// How many times as large √energy with mutual inductances may be as the norm of the space.
  [[nodiscard]] double coupling() const { return coupling_; }
  struct Checkpoint {
    double tau = 0.0, error = 0.0;
    double rounding = 0.0;  ///< a bound of ∫ Σ δ_i |c_i| dτ/γ: what the rounding δ_i of T z_i, of which y' is made, adds up to, c = K y
  };
  [[nodiscard]] const std::vector<Checkpoint>& estimate(double length);
  /// Whether a motion in all directions is far larger after that length.
  [[nodiscard]] bool grows(double length);
  /// h|b(0)|, the error at once, as far as that can be told before the space is full.
  [[nodiscard]] double error_at_start() const { return h_ * std::abs(last_row_.dot(first_)); }
  /// z_{m+1}, which the error is along; zero where the space is full.
  [[nodiscard]] std::vector<double> next_unknowns() const;
  /// Of a form: its row on y. Without its sources and constant.
  [[nodiscard]] linalg::Vector row_of_unknowns(const Form& form) const;
  /// factor · the value of a form, or of one unknown, + offset.
  struct Reading {
    const Form* form = nullptr;  ///< null: the unknown, or nothing where that is −1
    int unknown = -1;
    double factor = 1.0, offset = 0.0;
  };
  /// The rows of several, whole.
  [[nodiscard]] linalg::Matrix rows(const std::vector<Reading>& readings) const;
  /// max |y_j| over the length last estimated.
  [[nodiscard]] const linalg::Vector& reach() const { return reach_; }
  /// Sum of the magnitudes that a form's value is a sum of, over that length: its rounding is a part of them.
  [[nodiscard]] double row_terms(const Form& form) const;
  /// The same of the largest of several unknowns, with what their vectors have lost in orthogonalisation.
  [[nodiscard]] double largest_terms(int first, int count) const;
  struct Sizes {
    double voltage = 0.0, other = 0.0;
  };
  /// The same of all voltages, and of all other unknowns.
  [[nodiscard]] Sizes largest_terms() const;
  /// The largest of them in S z₀.
  [[nodiscard]] Sizes largest_first() const { return {norm_ * largest_(0, 0), norm_ * largest_(1, 0)}; }
  /// How many times its own rounding a vector has, on average over what the motion takes of them in that length.
  [[nodiscard]] double loss() const;
  /// Of the states in the unknowns at y(0), in the norm of the space: vectors may hold impulses of voltage that cancel.
  [[nodiscard]] double rounding_at_start();
  /// z, and E z' with |E| |z'|, at y.
  void unknowns(const double* y, std::vector<double>& z) const;
  void rates(const double* y, std::vector<double>& k, std::vector<double>& sizes);

 private:
  [[nodiscard]] static double coupling_of(const model::Network& network);
  void begin_change(const Origin& start, const linalg::Vector& zeta);
  void forget_inputs();
  void solve(std::vector<double>& r, const linalg::Vector& w, double one);
  void settle(std::vector<double>& z, const linalg::Vector& w, double one);
  void correct(std::vector<double>& z, const linalg::Vector& w, double one);
  void share_out(std::vector<double>& z, const linalg::Vector& w, double one) const;
  void add_sources(const linalg::Vector& zeta, std::vector<double>& r) const;
  void close(const linalg::Vector& w, double one, std::vector<double>& r) const;
  [[nodiscard]] double source_part(const Form& form, const linalg::Vector& w, double one) const;
  [[nodiscard]] bool contradicts(const std::vector<double>& z, const linalg::Vector& w, double one) const;
  [[nodiscard]] static double step_of(double length);
  [[nodiscard]] double weight_of_error() const;
  void measure(const std::vector<double>& z, const linalg::Vector& zeta, double* x) const;
  [[nodiscard]] double largest_conducted(const std::vector<double>& z);
  [[nodiscard]] double rounding_of_states(const std::vector<double>& z);
  [[nodiscard]] double terms_of(const linalg::Vector& of_vectors, const linalg::Vector& of_changes) const;
  void note_largest(const linalg::Matrix& columns, Eigen::Index row, Eigen::Index j);
  template <class Value>
  [[nodiscard]] double norm_of_states(const Value& value) const;
  [[nodiscard]] double size_of_states(const std::vector<double>& z) const;
  void assemble();
  void find_residual(const std::vector<double>& d);
  void find_wide_residual(const std::vector<double>& d);
  void refine(std::vector<double>& d, double counts);
  [[nodiscard]] double rounding_of(const std::vector<double>& d, double counts);
  [[nodiscard]] double rounding_of_sums(const std::vector<double>& z) const;
  void reserve(int columns);
  void apply(int j);
  void note_decay(std::vector<std::vector<double>>& decays) const;
  void add_vector();
  void note_lost(const linalg::Vector& c, double size, double h);
  void reduce();

  const Descriptor& descriptor_;
  const model::Exosystem& exosystem_;
  StartChange change_;
  RestingParts resting_;
  std::vector<char> differential_;
  std::vector<double> stores_;  ///< the diagonal of E
  double coupling_ = 1.0;
  linalg::SparseMatrix conduction_of_stores_;  ///< the rows of G that are rows of E, too, as columns
  linalg::SparseMatrix conduction_of_nodes_;   ///< the rows of nodes of |G|, as columns
  std::vector<double> state_weight_;
  std::vector<double> state_sizes_;                             ///< empty: errors count by their energy alone
  linalg::Vector source_weight_;                                ///< 1 over what a state of sources is at most
  double weight_of_voltages_ = 0.0, weight_of_currents_ = 0.0;  ///< root of the sum of their squares
  double weight_of_rates_ = 0.0;                                ///< the same of what a volt across an inductor moves in a second
  const Factor* factor_ = nullptr;
  double least_ = 0.0, shift_ = 0.0, zeta_weight_ = 1.0, norm_ = 0.0, size_ = 0.0, h_ = 0.0, rounding_ = 0.0;
  double largest_size_ = 0.0;  ///< √energy that counts
  Position on_;
  int dimension_ = 0;
  bool has_next_ = false;      ///< z_{m+1} is a vector
  bool is_assembled_ = false;  ///< the matrix is in `values_`
  bool may_go_on_ = false;     ///< z_{m+1} is a vector, and small
  bool full_ = false, sound_ = true, begins_roughly_ = false, is_refined_ = true, refines_ = false;
  linalg::Matrix vectors_, changes_, sums_;  ///< Z, T Z, and W, their sum (unknowns × columns)
  linalg::Matrix zetas_, zeta_changes_;      ///< the same of ζ
  linalg::Matrix largest_;                   ///< the largest voltage and the largest other unknown of each column of Z, and of T Z
  linalg::Matrix passed_on_;     ///< what each solution's rounding makes of each vector: orthogonalisation adds it up, signs included
  linalg::Vector delta_;         ///< rounding of T z of each vector, in the norm of the space
  linalg::Vector lost_;          ///< rounding of a vector in that of its largest terms: what orthogonalisation costs
  linalg::Matrix measured_;      ///< what the norm measures of Z
  linalg::Matrix h_matrix_, k_;  ///< H (one row more than columns) and K
  linalg::Vector first_, last_row_, reach_;  ///< y(0), eᵀK, max |y|
  linalg::Exponential flow_;
  mutable std::optional<linalg::Rates> rates_of_motions_;
  std::vector<double> right_, product_, sizes_, conducted_, values_, work_;
  std::vector<long double> wide_;
  std::vector<Checkpoint> estimate_;
  std::vector<double> given_start_, start_;  ///< z₀ as it was given, and without what carries nothing
  std::vector<double> given_;                ///< right-hand side of the last solution
};

}  // namespace pwlsim::engine::sparse
