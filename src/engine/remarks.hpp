#pragma once
/// Remarks and failures of runs, worded once for every engine.

#include <set>
#include <string>
#include <vector>

#include "engine/run.hpp"

namespace pwlsim::engine {

/// W-certificate: `worst` is the residual that is doubtful.
[[nodiscard]] Remark doubtful_certificate(double worst);

/// W-start-projected: of the whole circuit.
[[nodiscard]] Remark projected_start();

inline constexpr const char* no_operating_point = "E-no-operating-point";
/// W-no-operating-point: `what` has none.
[[nodiscard]] Remark starts_without_operating_point(const std::string& what);

/// W-op-not-unique: `part`, as its island is called, has others; `which` says which is taken, "the one of least energy".
[[nodiscard]] Remark operating_point_not_unique(const std::string& part, const std::string& which);

/// N-indeterminate: the names of the signals.
[[nodiscard]] Remark indeterminate(const std::set<std::string>& signals);

/// Ends a run early.
struct Ending {
  Outcome outcome = Outcome::completed;
  std::string id, text;
  std::vector<std::string> elements{};
};
/// Sets it in the answer of the run; Answer::mode stays.
void end_run(Answer& answer, Ending ending);
/// E-interrupted
[[nodiscard]] Ending interrupted(double time);
/// E-no-settle: switches for which no round of changes is valid.
[[nodiscard]] Ending keeps_toggling(double time, std::vector<std::string> switches);
/// Events closer together than the run can follow.
struct Crowd {
  double start = 0.0;  ///< s
  std::uint64_t count = 0;

  /// Takes one more event; whether there are too many of them within `length`, s.
  bool note(double time, double length);
};
/// E-accumulation: `names` change sides there; where they are not known `part` says where it is, if it is not empty.
[[nodiscard]] Ending accumulation(double time, const Crowd& crowd, std::vector<std::string> names, const std::string& part);

/// The first jumps of a run, which Answer::jumps holds.
inline constexpr std::size_t most_jumps_kept = 1000;

/// Sides of ports for Answer::mode. Ports of one element are adjacent; the element is on if one of them is.
class ModeText {
 public:
  void add(const std::string& name, bool is_on);
  /// "D1, S2 on, D3 off"; a long list is cut and counted.
  [[nodiscard]] std::string str() const;

 private:
  struct Side {
    std::string name;
    bool is_on = false;
  };
  [[nodiscard]] std::string side(bool is_on) const;

  std::vector<Side> sides_;
};

}  // namespace pwlsim::engine
