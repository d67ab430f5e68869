#pragma once
/// What a deviation along a run of Krylov segments needs of the run (segment_deviation.hpp).

#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

/// A guard that falls to zero: its form, without sources and constants, and how fast it falls.
struct FallingGuard {
  Form form;
  double rate = 0.0;     ///< 1/s, of the form
  std::size_t port = 0;  ///< that it decides
};

/// A segment as far as the run followed it.
struct SegmentRecord {
  std::vector<Position> jumps;                       ///< before it: positions in which states jumped, in order
  Position on;                                       ///< of its ports
  double shift = 0.0;                                ///< of its space, 1/s
  bool refines = false;                              ///< its solutions are corrected by their residuals
  double begin = 0.0, length = 0.0;                  ///< s
  double size = 0.0;                                 ///< the largest √energy of its begin and end
  std::vector<double> rates_at_begin, rates_at_end;  ///< E z'
  std::vector<double> unknowns_at_begin;             ///< of the first
  std::vector<double> stores_at_begin;               ///< values of its states there, in volts
  std::vector<FallingGuard> guards;  ///< the one that ended it, then others that are at zero there; none: a time that depends on no state
  bool ends_unknown = false;         ///< neither a guard nor a known time ended it: as far as it can be said
};

}  // namespace pwlsim::engine::sparse
