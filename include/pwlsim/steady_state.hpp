#pragma once
/// The periodic steady state, and small signals around it.

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pwlsim/result.hpp>

namespace pwlsim {

/// The settings of `.pss`. If nothing is set, the deck's own card is used, if there is one.
struct SteadyStateOptions {
  std::optional<double> period = {};         ///< s: a multiple of the common period of the sources; a guess for a self-timed circuit
  std::optional<int> multiple = {};          ///< periods of the sources in one period of the orbit
  std::string begins = {};                   ///< self-timed: the event that begins the period: "on=S1", "off=D1", "when v(a)=0 rise"
  std::optional<double> settling_time = {};  ///< s, simulated before the search
  std::optional<int> points = {};            ///< row intervals per period (1000)
  bool use_initial_conditions = false;       ///< the search starts from `ic=`

  [[nodiscard]] bool is_empty() const {
    return !period && !multiple && begins.empty() && !settling_time && !points && !use_initial_conditions;
  }
};

/// A periodic orbit.
struct SteadyState {
  double period = 0.0;    ///< s
  int multiple = 1;       ///< periods of the sources in one period of the orbit
  bool is_driven = true;  ///< by periodic sources; else self-timed
  std::string stability;  ///< "stable", "unstable", "marginal"; "" if the orbit has no derivative
  double residual = 0.0;  ///< difference of the states at both ends of the period, relative to the largest state
  int iterations = 0;     ///< of Newton's method
  int periods_simulated = 0;
  std::vector<std::complex<double>> multipliers;       ///< Floquet multipliers, the largest first
  std::vector<std::pair<std::string, double>> states;  ///< just after t = 0: "v(C1)" in V, "i(L1)" in A
  Result waveform;                                     ///< one period from t = 0, with the values of `.meas pss`
};

/// The settings of `.ac`.
struct SmallSignalOptions {
  std::string from = {};              ///< "V1", "freq(V1)", "duty(V1)"; "": all sources with AC values
  std::string loop = {};              ///< a source of 0 V in a loop: computes its loop gain too
  int harmonic = 0;                   ///< the sideband at f + harmonic/period
  std::optional<double> sample = {};  ///< s: the sampled response at that time of the period
};

/// T(f) = −v(n−)/v(n+) of a source in a loop.
struct LoopGain {
  std::vector<std::complex<double>> values;  ///< one per frequency
  struct Crossover {
    double frequency = 0.0, phase_margin = 0.0;  ///< Hz, degrees
  };
  std::vector<Crossover> crossovers;
  struct GainMargin {
    double frequency = 0.0, decibels = 0.0;
  };
  std::vector<GainMargin> gain_margins;
};

/// Small signals.
struct Response {
  std::vector<double> frequencies;  ///< Hz
  std::vector<std::string> signals;
  std::vector<std::vector<std::complex<double>>> values;  ///< by signal, then frequency; not finite where the response is infinite
  std::optional<LoopGain> loop;
  std::vector<Message> messages;
};

}  // namespace pwlsim
