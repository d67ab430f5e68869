/// pwlsim-mpi: the runs of a deck with `.step` on many processes, one table (docs/reference/mpi.md).
///
/// Rank 0 hands out runs as workers become free and keeps a journal; with one rank it does them itself. Every rank works through a process of its own (worker.hpp).

#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pwlsim/pwlsim.hpp>

#include "table.hpp"
#include "worker.hpp"

namespace pwlsim::mpi {
namespace {

enum Status { done = 0, run_failed = 1, wrong_input = 2, file_error = 3 };
constexpr int tag = 1;
constexpr std::uint64_t no_more = std::numeric_limits<std::uint64_t>::max();

struct Arguments {
  std::string deck, output;
  bool resume = false, quiet = false;
};

constexpr const char* usage =
    "usage: mpirun -n N pwlsim-mpi DECK [-o FILE.csv] [--resume] [--quiet]\n"
    "Does the runs of the deck's .step and writes one row per run: run, stepped values, measurements, error.\n"
    "--resume continues a sweep that was killed, from FILE.csv.journal.\n";

/// Throws std::invalid_argument.
Arguments read_arguments(int count, char** words) {
  Arguments arguments;
  for (int k = 1; k < count; ++k) {
    const std::string word = words[k];
    if (word == "--resume")
      arguments.resume = true;
    else if (word == "--quiet")
      arguments.quiet = true;
    else if (word == "-o" && k + 1 < count)
      arguments.output = words[++k];
    else if (!word.starts_with('-') && arguments.deck.empty())
      arguments.deck = word;
    else
      throw std::invalid_argument("unknown argument " + word);
  }
  if (arguments.deck.empty()) throw std::invalid_argument("no deck is given");
  if (arguments.output.empty()) arguments.output = arguments.deck.substr(arguments.deck.rfind('/') + 1) + ".csv";
  return arguments;
}

Sweep sweep_of(const Arguments& arguments) {
  Options options;
  options.events = options.evaluable = false;
  return Sweep(Circuit::from_file(arguments.deck), options);
}

Record run_one(const Sweep& sweep, std::uint64_t number) {
  Record record{number, {}, {}};
  try {
    const Result result = sweep.run({}, number);
    for (const Measurement& each : result.measurements())
      record.measurements.push_back(each.failure.empty() ? each.value : std::numeric_limits<double>::quiet_NaN());
  } catch (const Error& error) {
    record.id = error.id();
  }
  return record;
}

/// FNV-1a of the deck's bytes: a journal of another deck is not resumed.
std::string fingerprint(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t hash = 1469598103934665603ULL;
  for (auto at = std::istreambuf_iterator<char>(file); at != std::istreambuf_iterator<char>(); ++at)
    hash = (hash ^ static_cast<unsigned char>(*at)) * 1099511628211ULL;
  return std::to_string(hash);
}

void send(const Record& record) {
  const std::string bytes = bytes_of(record);
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, tag, MPI_COMM_WORLD);
}

/// Of a rank other than 0.
void serve(Worker& worker) {
  send({no_more, {}, {}});  // ready
  for (;;) {
    std::uint64_t number = 0;
    MPI_Recv(&number, 1, MPI_UINT64_T, 0, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (number == no_more) return;
    send(worker.run(number));
  }
}

/// Rank 0.
class Office {
 public:
  Office(const Arguments& arguments, const Sweep& sweep, int ranks)
      : arguments_(arguments),
        sweep_(sweep),
        ranks_(ranks),
        records_(sweep.runs()),
        journal_(arguments.output + ".journal", head(), arguments.resume, records_) {
    finished_ =
        static_cast<std::size_t>(std::count_if(records_.begin(), records_.end(), [](const auto& record) { return record.has_value(); }));
  }

  int run(Worker& worker) {
    if (ranks_ == 1)
      for (std::uint64_t number = next(); number != no_more; number = next()) take(worker.run(number));
    else
      hand_out();
    write_table();
    journal_.remove();
    if (!arguments_.quiet)
      std::fprintf(stderr, "\nwrote %s: %zu runs, %zu of them failed\n", arguments_.output.c_str(), records_.size(), failed_);
    return failed_ > 0 ? run_failed : done;
  }

 private:
  [[nodiscard]] std::string head() const {
    std::string text = "pwlsim-mpi 1 " + fingerprint(arguments_.deck) + " " + std::to_string(sweep_.runs());
    for (const std::string& name : sweep_.measurements()) text += " " + name;
    return text;
  }

  /// The first run that nobody has begun.
  std::uint64_t next() {
    while (begun_ < records_.size() && records_[begun_]) ++begun_;
    return begun_ < records_.size() ? begun_++ : no_more;
  }

  void take(const Record& record) {
    journal_.add(record);
    records_[record.number] = record;
    ++finished_;
    if (!arguments_.quiet && ::isatty(2) != 0) std::fprintf(stderr, "\r%zu of %zu runs", finished_, records_.size());
  }

  struct Hand {
    int runs = 0;  ///< handed out, and not back
    bool is_done = false;
  };

  /// One run a worker, so that none waits behind a long one at the end; where runs are short a second one waits at the worker, which then does not wait for rank 0.
  [[nodiscard]] int runs_ahead() const {
    constexpr double short_run = 0.01;  // s
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    return finished_here_ > 0 && seconds * (ranks_ - 1) < short_run * static_cast<double>(finished_here_) ? 2 : 1;
  }

  void fill(int rank, Hand& hand) {
    for (const int wanted = runs_ahead(); !hand.is_done && hand.runs < wanted; ++hand.runs) {
      const std::uint64_t number = next();
      MPI_Send(&number, 1, MPI_UINT64_T, rank, tag, MPI_COMM_WORLD);
      hand.is_done = number == no_more;
      if (hand.is_done) return;
    }
  }

  void hand_out() {
    std::vector<Hand> hands(static_cast<std::size_t>(ranks_));
    const auto is_at_work = [](const Hand& hand) { return !hand.is_done || hand.runs > 0; };
    hands[0].is_done = true;
    while (std::any_of(hands.begin(), hands.end(), is_at_work)) {
      MPI_Status status;
      MPI_Probe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &status);
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      std::string bytes(static_cast<std::size_t>(size), '\0');
      MPI_Recv(bytes.data(), size, MPI_BYTE, status.MPI_SOURCE, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      const Record record = record_of(bytes);
      Hand& hand = hands[static_cast<std::size_t>(status.MPI_SOURCE)];
      const bool is_run = record.number != no_more;  // else the worker is ready
      hand.runs -= is_run ? 1 : 0;
      fill(status.MPI_SOURCE, hand);  // before the record is written: the worker goes on
      if (!is_run) continue;
      ++finished_here_;
      take(record);
    }
  }

  void write_table() {
    std::string text = "run";
    for (const std::string& name : sweep_.names()) text += "," + name;
    for (const std::string& name : sweep_.measurements()) text += "," + name;
    text += ",error\n";
    for (std::size_t k = 0; k < records_.size(); ++k) {
      text += std::to_string(k);
      for (const double value : sweep_.point(k)) text += "," + number_text(value);
      const Record& record = *records_[k];
      for (std::size_t m = 0; m < sweep_.measurements().size(); ++m)
        text += "," + (m < record.measurements.size() ? number_text(record.measurements[m]) : "");
      text += "," + record.id + "\n";
      failed_ += record.id.empty() ? 0 : 1;
    }
    const std::string partial = arguments_.output + ".partial";
    std::ofstream file(partial, std::ios::binary);
    file << text;
    file.close();
    if (!file || std::rename(partial.c_str(), arguments_.output.c_str()) != 0)
      throw std::runtime_error("cannot write " + arguments_.output);
  }

  const Arguments& arguments_;
  const Sweep& sweep_;
  int ranks_;
  std::vector<std::optional<Record>> records_;
  Journal journal_;
  std::uint64_t begun_ = 0;
  std::size_t finished_ = 0, failed_ = 0;
  std::size_t finished_here_ = 0;  ///< by other ranks, since `began_`
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

int lead(const Arguments& arguments, Worker& worker, int ranks) {
  int status = done;
  std::optional<Sweep> sweep;
  std::optional<Office> office;
  try {
    sweep.emplace(sweep_of(arguments));
    if (sweep->runs() == 0) throw std::invalid_argument("the deck has no .step: there is one run only; try pwlsim");
    office.emplace(arguments, *sweep, ranks);
  } catch (const Error& error) {
    std::fputs(error.what(), stderr);
    status = wrong_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pwlsim-mpi: %s\n", error.what());
    status = wrong_input;
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (status != done) return status;
  try {
    return office->run(worker);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pwlsim-mpi: %s\n", error.what());
    MPI_Abort(MPI_COMM_WORLD, file_error);
  }
  return file_error;
}

int follow(Worker& worker) {
  int status = done;
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (status == done) serve(worker);
  return done;
}

}  // namespace
}  // namespace pwlsim::mpi

int main(int count, char** words) {
  using namespace pwlsim::mpi;
  Arguments arguments;
  try {
    arguments = read_arguments(count, words);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "pwlsim-mpi: %s\n%s", error.what(), usage);
    return wrong_input;
  }
  int status = done;
  {
    Worker worker([&arguments]() -> Worker::Run {
      const auto sweep = std::make_shared<const pwlsim::Sweep>(sweep_of(arguments));
      return [sweep](std::uint64_t number) { return run_one(*sweep, number); };
    });
    MPI_Init(&count, &words);
    int rank = 0, ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    status = rank == 0 ? lead(arguments, worker, ranks) : follow(worker);
    MPI_Finalize();
  }
  return status;
}
