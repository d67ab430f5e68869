#pragma once
/// The controllers of a circuit during its runs. The first run calls their functions and keeps their outputs; repeated runs use these.

#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <pwlsim/controller.hpp>

#include "engine/sampler.hpp"
#include "model/network.hpp"

namespace pwlsim::api {

class Controllers : public engine::Sampler {
 public:
  /// The channels are the outputs in order. Throws Error (E-unknown-signal) if an input is not among the signals of the network.
  Controllers(const std::vector<Controller>& list, const model::Network& network);
  /// For a run that repeats that of `first`, which must have ended and must outlive this.
  [[nodiscard]] static Controllers repeating(const Controllers& first);

  void begin() override;
  [[nodiscard]] double next() const override;
  bool sample(double time, std::span<const double> signals, std::vector<Setting>& settings) override;
  /// The exception of a function; null: none.
  [[nodiscard]] const std::exception_ptr& thrown() const { return thrown_; }

 private:
  struct Loop {
    Controller controller;
    std::vector<std::size_t> inputs;  ///< numbers of signals
    int first_channel = 0;
    std::vector<double> initial;    ///< outputs before the first call
    std::vector<double> seen, set;  ///< values of inputs and outputs
    std::uint64_t calls = 0;
    [[nodiscard]] double next() const { return static_cast<double>(calls) * controller.every; }
  };
  struct Pending {
    double time = 0.0;
    Setting setting;
  };
  static void check_finite(const Loop& loop);
  bool call(Loop& loop, std::span<const double> signals);
  void set(const Loop& loop, double time, std::vector<Setting>& settings);

  std::vector<Loop> loops_;
  std::deque<Pending> pending_;                ///< by time
  std::shared_ptr<std::vector<double>> kept_;  ///< outputs of each call, in the order of the calls
  std::size_t repeated_ = 0;                   ///< of them, in this run
  bool repeats_ = false, began_ = false;
  std::exception_ptr thrown_;
};

/// The sentence of E-controller for such an exception, with what() where it has one.
[[nodiscard]] std::string sentence_of(const std::exception_ptr& thrown, double time);

}  // namespace pwlsim::api
