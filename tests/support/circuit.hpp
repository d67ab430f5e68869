#pragma once
/// Circuits written in C++ for tests of the engine: one line a card, saved signals by name.

#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "engine/exact/exact.hpp"
#include "model/builder.hpp"

namespace pwlsim::test {

class TestCircuit {
 public:
  void r(const std::string& p, const std::string& n, double value) { b_.add(model::Resistor{label("R"), node(p), node(n), value}); }
  int c(const std::string& p, const std::string& n, double value, double initial = 0.0) {
    return b_.add(model::Capacitor{label("C"), node(p), node(n), value, true, initial});
  }
  int l(const std::string& p, const std::string& n, double value, double initial = 0.0) {
    return b_.add(model::Inductor{label("L"), node(p), node(n), value, true, initial});
  }
  void k(int a, int b, double coefficient) { b_.add(model::Coupling{label("K"), a, b, coefficient}); }
  int d(const std::string& p, const std::string& n, double drop = 0.0) {
    return b_.add(model::Diode{label("D"), node(p), node(n), 0.0, drop});
  }
  int v(const std::string& p, const std::string& n, model::SourceFunction f) {
    const int source = b_.add(model::Source{label("S"), f});
    return b_.add(model::Branch{label("V"), node(p), node(n), {{model::Term::Kind::source, source, 1.0}}});
  }
  void i(const std::string& p, const std::string& n, model::SourceFunction f) {
    const int source = b_.add(model::Source{label("S"), f});
    b_.add(model::Injection{label("I"), node(p), node(n), {{model::Term::Kind::source, source, 1.0}}});
  }
  /// v(p,n) = gain·v(cp,cn)
  int e(const std::string& p, const std::string& n, const std::string& cp, const std::string& cn, double gain) {
    return b_.add(model::Branch{label("E"), node(p), node(n), voltage(cp, cn, gain)});
  }
  void g(const std::string& p, const std::string& n, const std::string& cp, const std::string& cn, double gain) {
    b_.add(model::Injection{label("G"), node(p), node(n), voltage(cp, cn, gain)});
  }
  int s(const std::string& p, const std::string& n, const std::string& cp, const std::string& cn, double threshold, double hysteresis = 0.0,
        bool on = false) {
    model::Switch item;
    item.label = label("SW");
    item.p = node(p);
    item.n = node(n);
    item.control = voltage(cp, cn, 1.0);
    item.on_level = threshold + hysteresis;
    item.off_level = threshold - hysteresis;
    item.initially_on = on;
    return b_.add(item);
  }

  void save_v(const std::string& p, const std::string& n = "0") { save("v(" + p + "," + n + ")", voltage(p, n, 1.0)); }
  void save_i_l(int l) { save("i(L)", {{model::Term::Kind::inductor_current, l, 1.0}}); }
  void save_i_d(int d) { save("i(D)", {{model::Term::Kind::diode_current, d, 1.0}}); }
  void save_i_branch(int branch) { save("i(V)", {{model::Term::Kind::branch_current, branch, 1.0}}); }

  [[nodiscard]] const model::Network& network() const { return b_.network(); }
  [[nodiscard]] model::Network& network() { return b_.network(); }
  model::NodeIndex node(const std::string& name) { return b_.node(name); }

 private:
  model::LinearForm voltage(const std::string& p, const std::string& n, double gain) {
    return model::voltage_between(node(p), node(n), gain);
  }
  void save(const std::string& name, model::LinearForm form) { b_.add(model::Signal{name, std::move(form)}); }
  model::Label label(const std::string& letter) { return {letter + std::to_string(++count_[letter]), {}}; }

  model::NetworkBuilder b_;
  std::map<std::string, int> count_;
};

/// sin(2π·frequency·t) of unit angular frequency by default.
inline model::Sin sine(double amplitude = 1.0, double frequency = 0.5 / std::numbers::pi) {
  model::Sin s;
  s.amplitude = amplitude;
  s.frequency = frequency;
  return s;
}

struct Run : engine::RowSink {
  bool write(std::span<const double> values, std::size_t count) override {
    const std::size_t width = values.size() / count;
    for (std::size_t i = 0; i < count; ++i)
      rows.emplace_back(values.begin() + static_cast<long>(i * width), values.begin() + static_cast<long>((i + 1) * width));
    return true;
  }
  std::vector<std::vector<double>> rows;  ///< time, signals
  engine::Answer answer;
  std::string errors;

  [[nodiscard]] double at(std::size_t row, std::size_t signal) const { return rows.at(row).at(signal + 1); }
};

struct Setup {
  double stop = 1.0;
  std::uint64_t steps = 100;
  bool uic = true;
  bool events = false;
  double first = 0.0;  ///< time of the first row
};

inline Run simulate(const model::Network& network, const Setup& setup) {
  Run run;
  Diagnostics diagnostics;
  const auto model = engine::prepare(network, diagnostics);
  for (const auto& d : diagnostics.all()) run.errors += d.id + ": " + d.text + "\n";
  if (!model) return run;
  engine::Request request;
  request.stop = setup.stop;
  request.grid.rows = setup.steps + 1;
  request.grid.time = [&](std::uint64_t k) {
    return k == setup.steps ? setup.stop
                            : setup.first + (setup.stop - setup.first) * static_cast<double>(k) / static_cast<double>(setup.steps);
  };
  request.events = setup.events;
  request.use_initial_conditions = setup.uic;
  run.answer = engine::run(*model, request, run);
  return run;
}

/// Times at which --events wrote a pair of rows.
inline std::vector<double> event_times(const Run& run) {
  std::vector<double> times;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0]) times.push_back(run.rows[i][0]);
  return times;
}

}  // namespace pwlsim::test
