#pragma once
/// One run of the program on a deck, and whether it kept its promises (docs/reference/command-line.md):
/// status 0, 1 or 2, or 3 where an included file is missing; a message with a known id where it is not 0, none of them E-internal; no file half written, none at all where the deck is wrong;
/// no more than 10 s and 1 GiB resident.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "random_decks/random_deck.hpp"
#include "support/scratch.hpp"

namespace pwlsim::test {

struct Trial {
  int status = -1;  ///< as Finished::status
  std::string out, err;
  double seconds = 0.0;             ///< of the processor
  double resident_mebibytes = 0.0;  ///< at most
};

/// How a deck is run.
class TrialRunner {
 public:
  virtual ~TrialRunner() = default;
  /// The current directory of the program is `folder`.
  virtual Trial run(const Scratch& folder, const std::vector<std::string>& arguments) = 0;
};

/// A process for each.
[[nodiscard]] std::unique_ptr<TrialRunner> make_spawning_runner();
/// All in this process, which takes `folder` as its current directory. A run that does not end
/// is interrupted, and if that is no use the process ends.
[[nodiscard]] std::unique_ptr<TrialRunner> make_inner_runner();

class Examiner {
 public:
  explicit Examiner(TrialRunner& runner);

  /// What is wrong, "" where nothing is; its words up to the first colon are the same for the same fault.
  [[nodiscard]] std::string examine(const RandomDeck& deck, const std::string& name);
  [[nodiscard]] const Trial& last() const { return last_; }
  /// Decks that asked for more events than there was time for, and were interrupted as they should.
  [[nodiscard]] const std::vector<std::string>& long_runs() const { return long_runs_; }
  /// Ids of messages seen, each with the name of the first deck.
  [[nodiscard]] const std::map<std::string, std::string>& first_with() const { return first_with_; }
  [[nodiscard]] const Scratch& folder() const { return folder_; }

 private:
  void run(const RandomDeck& deck, const std::string& name);
  [[nodiscard]] bool had_many_events() const;
  void note_messages(const std::string& name);
  [[nodiscard]] std::string judge(const RandomDeck& deck, const std::string& name) const;
  [[nodiscard]] std::string judge_messages() const;
  [[nodiscard]] std::string judge_files(const RandomDeck& deck, const std::string& name) const;
  void tidy() const;

  TrialRunner& runner_;
  Scratch folder_;
  std::set<std::string> known_ids_;
  Trial last_;
  std::vector<std::string> long_runs_;
  std::map<std::string, std::string> first_with_;
};

/// The deck without the lines, files and words of the command line that the fault does not need.
[[nodiscard]] RandomDeck smallest(RandomDeck deck, Examiner& examiner, const std::string& fault);

}  // namespace pwlsim::test
