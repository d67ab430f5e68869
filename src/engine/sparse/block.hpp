#pragma once
/// A part of the network with steps and events of its own.
///
/// Steps are h_max·2^−j, with a step of its own length to a breakpoint of a source or to an event. After each step
///  - a switch whose control has passed its level, and a diode whose change of sides matters, are located and stepped to;
///  - a change of sides inside the step whose error and whose effect on the saved signals are within the tolerance is left where it is.
/// After a breakpoint or a located event three short implicit Euler steps: the first takes the jump, the other two start rates and polynomial.

#include <functional>
#include <optional>
#include <unordered_set>

#include "engine/sparse/certificate.hpp"
#include "engine/sparse/controls.hpp"
#include "engine/sparse/history.hpp"
#include "engine/sparse/start.hpp"
#include "engine/sparse/stepper.hpp"

namespace pwlsim::engine::sparse {

class Block {
 public:
  Block(const model::Network& network, const Request& request, double reltol);

  [[nodiscard]] const Descriptor& descriptor() const { return descriptor_; }
  /// Begins at t = 0. False: failed.
  bool begin(const Start& start);
  [[nodiscard]] double time() const { return point_.time; }
  /// Rows before this time can be asked for.
  [[nodiscard]] double known() const;
  [[nodiscard]] bool finished() const { return finished_; }
  /// One accepted step, or the event it stands before. False: failed.
  bool advance();
  /// The saved signals at a time in the last step.
  void signals(double time, double* values);

  struct Instant {
    double time = 0.0;
    bool source_edge = false, mode_change = false, jump = false;
    [[nodiscard]] bool happened() const { return source_edge || mode_change || jump; }
  };
  /// The event that the last `advance` handled, with the signals before it (where the request wants events).
  [[nodiscard]] const std::optional<Instant>& instant() const { return instant_; }
  [[nodiscard]] const std::vector<double>& signals_before() const { return signals_before_; }

  /// Outcome, id, message and elements after a failure.
  [[nodiscard]] const Answer& failure() const { return failure_; }
  void add_statistics(Statistics& statistics) const;
  [[nodiscard]] const CertificateRecorder& certificate() const { return certificate_; }
  /// Whether the start contradicted the network.
  [[nodiscard]] bool start_projected() const { return start_projected_; }

 private:
  using Trial = Stepper::Trial;
  static constexpr int last_level = 44;  ///< of the ladder

  // block.cpp: steps
  [[nodiscard]] bool stands_before_instant() const;
  [[nodiscard]] double ladder(int level) const { return h_max_ * std::ldexp(1.0, -level); }
  [[nodiscard]] double step_size() const;
  bool step();
  bool settle_changes(double h, Trial& trial, bool& accepted);
  void accept(Trial& trial, double h);
  void control_size(double error);
  bool reduce(double error);
  bool fail_step(const Trial& trial);
  void fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements);
  [[nodiscard]] std::vector<std::string> names(const std::vector<int>& ports) const;
  [[nodiscard]] bool matters(const Point& a, const Point& b) const;
  void note_signals();

  // block_events.cpp
  struct Crossing {
    std::size_t index = 0;  ///< port, or control
    bool is_control = false;
  };
  [[nodiscard]] double margin(const Crossing& crossing, const Position& on, const std::vector<double>& z,
                              const std::vector<double>& w) const;
  [[nodiscard]] double sign_tolerance_of(const Crossing& crossing) const;
  [[nodiscard]] double margin_size(const Crossing& crossing) const;
  [[nodiscard]] std::vector<Crossing> crossings(const Position& on, const Point& end, bool ports_too) const;
  /// A crossing on the way to be located.
  struct Candidate {
    Crossing crossing;
    double tolerance = 0.0;
    std::vector<std::pair<double, double>> points;  ///< (time, margin)
  };
  bool take_up(const Crossing& crossing, const Trial& trial, std::vector<Candidate>& list) const;
  bool locate(double h, Trial& trial);
  bool restart(double time);
  bool settle(double h, Instant& instant, Point& first);
  bool start_rates(double h);
  bool jump_settles(double h);
  bool flip(const Point& at, bool by_sources, double time, Instant& instant, Position& on);
  [[nodiscard]] bool jumped(const Point& before, const Point& first, const Point& second) const;
  bool watch_crowd(double time);

  const Request& request_;
  double reltol_;
  Descriptor descriptor_;
  Factors factors_;
  PortSolver ports_;
  Sources sources_;
  Stepper stepper_;
  StateScale scale_;
  std::vector<Control> controls_;
  std::vector<Form> signals_;
  std::vector<double> signal_scale_;
  bool signals_read_sources_ = false;
  CertificateRecorder certificate_;
  History history_;
  Point point_;
  Trial trial_, frozen_;
  Point euler_[3];
  std::vector<double> w_, signals_before_;
  std::vector<double> start_states_;  ///< until the first instant is settled
  std::optional<Instant> instant_;
  Answer failure_;
  double h_max_ = 0.0, tolerance_ = 0.0, break_tolerance_ = 0.0;
  int level_ = 0;
  bool passive_ = false, restart_due_ = false, finished_ = false, start_projected_ = false, rejected_ = false;
  bool located_ = false;
  Position frozen_position_;  ///< of the step to a located event
  double crowd_start_ = 0.0;
  int crowd_ = 0;
  std::uint64_t steps_ = 0, events_ = 0, jumps_ = 0;
  std::unordered_set<std::size_t> positions_;
};

}  // namespace pwlsim::engine::sparse
