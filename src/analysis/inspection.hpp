#pragma once
/// The report of `pwlsim inspect`: the islands of a circuit, each as a linear complementarity system for every position of its switches, what
/// certifies that the system has one solution, and the subspaces of a mode.

#include <optional>
#include <string>
#include <vector>

#include "analysis/port_table.hpp"
#include "circuit/compile.hpp"
#include "model/energy_coordinates.hpp"
#include "model/markov.hpp"

namespace pwlsim::analysis {

/// Up to this many positions, 2^switches, all are shown; beyond, only that of the start and that of `--mode`.
inline constexpr std::size_t most_positions = 16;

struct PortView {
  std::string name;
  bool is_diode = true;           ///< else a complementarity: its current is its multiplier, its voltage its slack
  bool input_is_current = false;  ///< u is the current and y the blocking voltage; else the reverse
};

enum class CertificateKind {
  no_ports,          ///< a linear differential equation
  passive,           ///< in energy coordinates: at most one solution
  principal_minors,  ///< G(s) is a P-matrix for large s: the rational complementarity problem has one solution from every state
  none
};

struct CertificateView {
  CertificateKind kind = CertificateKind::none;
  bool always_solvable = false;  ///< a solution exists from every state
  bool too_many_ports = false;   ///< for principal minors to be tried
  double kyp_residual = 0.0;
};

struct PositionView {
  std::vector<char> on;   ///< one per switch of the island
  bool of_start = false;  ///< the position by the flags on the cards
  std::string problem;    ///< why this position has no (A, B, C, D); everything else is empty then
  model::StateSpace space;
  std::vector<PortView> ports;
  model::Markov markov;
  CertificateView certificate;
};

/// A mode of the island with its switches as ports.
struct ModeView {
  std::vector<std::string> on;  ///< ports
  int states = 0;
  int consistent = 0, jump = 0;            ///< dimensions of V and T, sources at zero
  bool complementary = false;              ///< V ⊕ T is the whole space
  bool well_posed = false;                 ///< and the sources do not contradict the mode
  std::vector<std::string> indeterminate;  ///< ports whose current or voltage the mode does not determine
};

struct IslandView {
  std::string name;
  std::vector<std::string> elements;
  std::vector<std::string> switches;
  std::size_t states = 0, ports = 0;  ///< with all switches as ports; ports without them
  double positions_in_all = 1.0;
  std::vector<PositionView> positions;
  std::optional<ModeView> mode;
};

struct Inspection {
  std::string title;
  std::vector<IslandView> islands;
  std::vector<std::vector<std::string>> left_out;  ///< elements that no saved signal depends on, part by part
};

/// `request`: the mode of --mode; empty for none. Unknown names are reported in `diagnostics` as E-mode; the result is empty then.
[[nodiscard]] std::optional<Inspection> inspect(const circuit::Compiled& compiled, const engine::ExactModel& model,
                                                const std::optional<ModeRequest>& request, Diagnostics& diagnostics);

[[nodiscard]] std::string inspection_text(const Inspection& inspection);
[[nodiscard]] std::string inspection_json(const Inspection& inspection);

}  // namespace pwlsim::analysis
