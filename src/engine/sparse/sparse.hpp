#pragma once
/// Entry points of the sparse engine (implicit steps on KLU), for circuits too large for the dense modes of the exact one.

#include <memory>
#include <vector>

#include "base/diagnostic.hpp"
#include "engine/run.hpp"
#include "model/network.hpp"

namespace pwlsim::engine::sparse {

inline constexpr double default_tolerance = 1e-4;
/// The same of exact segments.
inline constexpr double segment_tolerance = 1e-13;
/// Below this rounding takes part in the error estimate.
inline constexpr double least_tolerance = 1e-11;
inline constexpr double largest_tolerance = 0.1;

/// A network prepared for running. Opaque to callers.
class SparseModel;

/// Errors of structure go to `diagnostics`; then the result is null.
[[nodiscard]] std::shared_ptr<const SparseModel> prepare(const model::Network& network, Diagnostics& diagnostics);

/// Runs from 0 to request.stop and hands every row to `sink`. `reltol`: bound on the local error of a step relative to each state's running
/// maximum.
[[nodiscard]] Answer run(const SparseModel& model, const Request& request, double reltol, RowSink& sink);

/// The same by exact segments between located events (exact_segment.hpp). `reltol`: of a segment's estimated error. `shift_factor`: every shift 1/γ that segments take is
/// so many times what it would be; nothing but cost may depend on it.
[[nodiscard]] Answer run_segments(const SparseModel& model, const Request& request, double reltol, RowSink& sink,
                                  double shift_factor = 1.0);

/// The DC operating point.
[[nodiscard]] OperatingPoint operating_point(const SparseModel& model);

/// Stores and ports of the largest part that must run; of all together where they are few.
[[nodiscard]] std::size_t largest_part(const model::Network& network);

/// `auto` takes this engine where that is more: then the exact engine, whose time grows with the cube of it for every mode, needs more than some seconds
/// (docs/developer/performance.md).
inline constexpr std::size_t dense_limit = 300;

/// Unknowns of the equations that the exact engine's extraction works on, of the largest part, needed or not; of all together where they are few.
[[nodiscard]] std::size_t most_unknowns(const model::Network& network);

/// `auto` takes this engine where that is more: extraction is dense, and takes 0.9 s for 500 unknowns, 7 s for 1,000, 52 s for 2,000
/// (docs/developer/performance.md).
inline constexpr std::size_t unknown_limit = 1000;

}  // namespace pwlsim::engine::sparse
