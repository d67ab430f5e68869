#pragma once
/// The same converter written differently: its answer follows from that of the original.

#include <string>
#include <vector>

#include "converters/draw.hpp"
#include "converters/netlist.hpp"

namespace pwlsim::test::converters {

struct Variant {
  std::string name;
  Converter converter;
  std::vector<std::size_t> source;  ///< of each signal: the original's signal
  std::vector<double> factor;       ///< times the original's value
  std::size_t row_stride = 1;       ///< rows of the variant for each of the original
};

/// Cards in another order, terminals swapped, times, impedances and voltages times a power of two, twice as many rows.
[[nodiscard]] std::vector<Variant> make_variants(const Converter& converter, Draw& draw);

}  // namespace pwlsim::test::converters
