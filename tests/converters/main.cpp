/// converters SEED [COUNT] [--family NAME] [--engine exact|sparse] [--program PATH] [--print] [--all] [--keep FOLDER] [--variants N] [--leaks]: runs these
/// converters beside the independent integrator, in this process or by the program at PATH, and prints what does not agree (--all: everything; --keep:
/// its deck goes to FOLDER) and a table by family. Each N-th converter is also run in its variants (variants.hpp). Status 1 where the limits below are
/// exceeded. --leaks hangs large resistors on them (leaks.hpp). --print writes the deck to standard output instead.
/// converters --formulas: the integrator beside answers in closed form.

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <string_view>

#include "converters/families.hpp"
#include "converters/formulas.hpp"
#include "converters/leaks.hpp"
#include "converters/runners.hpp"

namespace {

using namespace pwlsim::test::converters;

constexpr double threshold = 1e-6;          ///< relative difference that counts for the exact engine
constexpr double sparse_threshold = 1e-3;   ///< for the sparse engine at --reltol 1e-6
constexpr double formula_threshold = 1e-8;  ///< of the integrator beside answers in closed form
constexpr double patience = 15.0;           ///< s of the processor for the integrator's runs of a converter
// Parts of all runs that a test may have. The aims are 0 and 1e-3: they become the limits when stiff modes (Roff beside L) are solved.
constexpr double most_silent = 0.005;  ///< differences without a warning
constexpr double most_errors = 0.01, most_sparse_errors = 0.01;
constexpr double most_unresolved = 0.01;  ///< by the integrator: they show nothing

struct Options {
  std::uint64_t seed = 1, count = 1, variants = 0;
  std::string family, engine = "exact", program, keep;
  bool formulas = false, print = false, all = false, leaks = false;
};

Options read_options(int count, char** arguments) {
  Options result;
  int numbers = 0;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = arguments[i];
    const auto next = [&] { return i + 1 < count ? std::string(arguments[++i]) : std::string(); };
    if (word == "--family")
      result.family = next();
    else if (word == "--engine")
      result.engine = next();
    else if (word == "--program")
      result.program = next();
    else if (word == "--keep")
      result.keep = next();
    else if (word == "--variants")
      result.variants = std::strtoull(next().c_str(), nullptr, 10);
    else if (word == "--formulas")
      result.formulas = true;
    else if (word == "--print")
      result.print = true;
    else if (word == "--all")
      result.all = true;
    else if (word == "--leaks")
      result.leaks = true;
    else
      (numbers++ == 0 ? result.seed : result.count) = std::strtoull(arguments[i], nullptr, 10);
  }
  return result;
}

Converter converter_of(const Options& options, std::uint64_t seed) {
  Converter converter = make_converter(seed, options.family);
  if (options.leaks) hang_leaks(converter, seed);
  return converter;
}

struct Counts {
  std::map<Verdict, int> verdicts;
  double worst = 0.0, reference_seconds = 0.0, program_seconds = 0.0;
  std::size_t events = 0;
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int number_of(const Counts& counts, Verdict verdict) {
  const auto found = counts.verdicts.find(verdict);
  return found == counts.verdicts.end() ? 0 : found->second;
}

void print_table(const std::map<std::string, Counts>& table) {
  fmt::print(
      "\n| family | runs | agree | silent | with a warning | error | unresolved | worst that agrees | events |\n"
      "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const auto& [family, counts] : table) {
    int runs = 0;
    for (const auto& [verdict, number] : counts.verdicts) runs += number;
    const auto number = [&of = counts](Verdict verdict) { return number_of(of, verdict); };
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} |\n", family, runs, number(Verdict::agree), number(Verdict::silent),
               number(Verdict::told), number(Verdict::error), number(Verdict::unresolved), counts.worst, counts.events);
  }
}

/// How far the sparse engine is from the reference.
std::string second_opinion(Program& program, const Converter& converter, const Resolved& reference) {
  for (const char* tolerance : {"1e-9", "1e-7"}) {
    const ProgramAnswer answer = program.run(converter.text(), {"--engine", "sparse", "--reltol", tolerance});
    if (answer.status != 0 || answer.rows.size() != reference.waveforms.rows.size()) continue;
    return fmt::format(", sparse engine {:.1e}", largest_difference(reference.waveforms, answer.rows, converter).size);
  }
  return ", sparse engine fails";
}

class Examination {
 public:
  explicit Examination(const Options& options)
      : options_(options),
        sparse_(options.engine == "sparse"),
        program_(options.program.empty() ? make_inner_program() : make_spawned_program(options.program)) {
    words_ = {"--engine", options.engine};
    if (sparse_) words_.insert(words_.end(), {"--reltol", "1e-6"});
  }

  void examine(std::uint64_t seed) {
    const Converter converter = converter_of(options_, seed);
    const double start = now();
    const Resolved reference = resolve(converter, limit() / 10, patience);
    total_.reference_seconds += now() - start;
    for (Counts* counts : {&table_[converter.family], &total_}) {
      counts->events += reference.waveforms.events;
    }
    compare(seed, converter, reference, unchanged_);
    if (options_.variants == 0 || seed % options_.variants != 0) return;
    Draw draw(seed);
    for (const Variant& variant : make_variants(converter, draw))
      compare(seed, variant.converter, transformed(reference, variant), variant);
  }

  /// Within the limits.
  bool summarize() {
    print_table(table_);
    print_table({{"all", total_}});
    fmt::print("\n{:.0f} s in the integrator, {:.0f} s in the program\n", total_.reference_seconds, total_.program_seconds);
    const int all = number_of(total_, Verdict::agree) + number_of(total_, Verdict::silent) + number_of(total_, Verdict::told) +
                    number_of(total_, Verdict::error);
    return number_of(total_, Verdict::silent) <= most_silent * all &&
           number_of(total_, Verdict::error) <= (sparse_ ? most_sparse_errors : most_errors) * all &&
           number_of(total_, Verdict::unresolved) <= most_unresolved * all;
  }

 private:
  [[nodiscard]] double limit() const { return sparse_ ? sparse_threshold : threshold; }

  void compare(std::uint64_t seed, const Converter& converter, const Resolved& reference, const Variant& variant) {
    const double start = now();
    const ProgramAnswer answer = common_rows(program_->run(converter.text(), words_), variant);
    const Judgement judgement = judge(converter, reference, answer, limit());
    for (Counts* counts : {&table_[converter.family], &total_}) {
      ++counts->verdicts[judgement.verdict];
      if (judgement.verdict == Verdict::agree) counts->worst = std::max(counts->worst, judgement.difference);
    }
    total_.program_seconds += now() - start;
    if (!options_.all && judgement.verdict == Verdict::agree) return;
    fmt::print("{} --family {}{}{}: {} {:.1e} {} [{}] (reference {:.1e}{})\n", seed, converter.family, variant.name.empty() ? "" : ", ",
               variant.name, name_of(judgement.verdict), judgement.difference, judgement.signal, judgement.detail, reference.error,
               sparse_ || judgement.verdict == Verdict::agree ? "" : second_opinion(*program_, converter, reference));
    std::fflush(stdout);
    if (!options_.keep.empty())
      std::ofstream(fmt::format("{}/{}-{}{}.net", options_.keep, converter.family, seed, variant.name)) << converter.text();
  }

  const Options& options_;
  bool sparse_;
  std::unique_ptr<Program> program_;
  std::vector<std::string> words_;
  Variant unchanged_;
  std::map<std::string, Counts> table_;
  Counts total_;
};

}  // namespace

int main(int argument_count, char** arguments) {
  const Options options = read_options(argument_count, arguments);
  if (options.formulas) return check_formulas() <= formula_threshold ? EXIT_SUCCESS : EXIT_FAILURE;
  if (!options.print) {
    Examination examination(options);
    for (std::uint64_t seed = options.seed; seed < options.seed + options.count; ++seed) examination.examine(seed);
    return examination.summarize() ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  std::fputs(converter_of(options, options.seed).text().c_str(), stdout);
  return EXIT_SUCCESS;
}
