// What a finished run costs rank 0 of pwlsim-mpi: its line in the journal, and its two messages without their transport (a rank that sends to itself).
//
//     mpirun -n 1 bench_rank0
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "table.hpp"

namespace {

using pwlsim::mpi::Record;

constexpr int turns = 7, runs = 5000, tag = 1;

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Record record(int k) { return {static_cast<std::uint64_t>(k), "", {1.0 / 3.0, 2.0 / 7.0, 0.1 * k}}; }

void add_to_journal(int k, pwlsim::mpi::Journal& journal) { journal.add(record(k)); }

void send_and_receive(int k) {
  const std::string bytes = pwlsim::mpi::bytes_of(record(k));
  MPI_Request request{};
  MPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, tag, MPI_COMM_WORLD, &request);
  MPI_Status status;
  MPI_Probe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &status);
  std::string got(bytes.size(), '\0');
  MPI_Recv(got.data(), static_cast<int>(got.size()), MPI_BYTE, 0, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  (void)pwlsim::mpi::record_of(got);
}

template <class Call>
double least(const Call& call) {
  double best = 1e9;
  for (int turn = 0; turn < turns; ++turn) {
    const double start = processor_seconds();
    for (int k = 0; k < runs; ++k) call(k);
    best = std::min(best, (processor_seconds() - start) / runs);
  }
  return best;
}

}  // namespace

int main(int count, char** words) {
  MPI_Init(&count, &words);
  std::vector<std::optional<Record>> records(runs);
  pwlsim::mpi::Journal journal("bench_rank0.journal", "head", false, records);
  std::printf("journal %.2f us", 1e6 * least([&](int k) { add_to_journal(k, journal); }));
  std::printf(", a message to itself %.2f us\n", 1e6 * least([](int k) { send_and_receive(k); }));
  journal.remove();
  MPI_Finalize();
}
