#pragma once
/// Ways to run the program on a deck.

#include <memory>

#include "converters/trial.hpp"

namespace pwlsim::test::converters {

/// In this process.
[[nodiscard]] std::unique_ptr<Program> make_inner_program();
/// A process for each deck.
[[nodiscard]] std::unique_ptr<Program> make_spawned_program(const std::string& path);

}  // namespace pwlsim::test::converters
