#pragma once
/// The program on a converter beside the independent integrator.

#include <string>
#include <vector>

#include "converters/integrator.hpp"
#include "converters/variants.hpp"

namespace pwlsim::test::converters {

struct ProgramAnswer {
  int status = -1;
  std::string messages;                   ///< ids, parted by blanks
  std::vector<std::vector<double>> rows;  ///< without the time
};

/// What runs a deck.
class Program {
 public:
  virtual ~Program() = default;
  [[nodiscard]] virtual ProgramAnswer run(const std::string& deck, const std::vector<std::string>& options) = 0;
};

enum class Verdict { agree, silent, told, error, unresolved };
[[nodiscard]] const char* name_of(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::unresolved;
  double difference = 0.0;  ///< relative to the signal's largest value
  std::string signal, detail;
};

/// `threshold`: differences up to it agree.
[[nodiscard]] Judgement judge(const Converter& converter, const Resolved& reference, const ProgramAnswer& answer, double threshold);

/// What the reference becomes for a variant, and every row of an answer that it has.
[[nodiscard]] Resolved transformed(const Resolved& reference, const Variant& variant);
[[nodiscard]] ProgramAnswer common_rows(ProgramAnswer answer, const Variant& variant);

}  // namespace pwlsim::test::converters
