#pragma once
/// Runs a compiled circuit and fills a result.

#include <memory>

#include <pwlsim/circuit.hpp>

#include "analysis/prepared_engine.hpp"
#include "api/compilation.hpp"
#include "api/result_data.hpp"

namespace pwlsim::api {

/// Signals, messages so far, engine.
[[nodiscard]] std::shared_ptr<Result::Data> begin_result(Compilation& compilation, const analysis::PreparedEngine& engine);

[[nodiscard]] std::shared_ptr<Result::Data> begin_result(const circuit::Compiled& compiled, std::vector<Message> messages,
                                                         std::string engine);

/// The run of `kept`; with options.evaluable the result keeps it. False if it failed; `data` then has the message.
/// `sampler` may be null. `longest_window`: as in analysis::RunControl.
[[nodiscard]] bool run_into(Result::Data& data, std::shared_ptr<const KeptRun> kept, const Options& options, engine::Sampler* sampler,
                            double longest_window = 0.0);

/// Where the deck has `.pss`, `.tran` starts on its orbit, as in the program. Throws RunError where there is none; the messages of the search are in `data`.
void start_on_orbit(const circuit::Compiled& compiled, analysis::PreparedEngine& engine, const Options& options,
                    const std::shared_ptr<Result::Data>& data);

/// Certificate, counts, end and remarks of an operating point.
void take_answer_of(const engine::Answer& answer, Result::Data& data);

}  // namespace pwlsim::api
