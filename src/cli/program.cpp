#include "cli/program.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>
#include <string_view>
#include <vector>

#include "analysis/abandonable.hpp"
#include "cli/command_line.hpp"
#include "cli/compare_session.hpp"
#include "cli/export_session.hpp"
#include "cli/inspect_session.hpp"
#include "cli/messages.hpp"
#include "cli/session.hpp"
#include "cli/signals.hpp"
#include "cli/status.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {
namespace {

/// A file opened later must not take the number of a standard stream that the caller closed. Writing to a closed standard output still fails.
void hold_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) == -1) (void)::open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
}

int print(const Information& information) {
  std::size_t written = 0;
  const int error_number = waveform::write_all(STDOUT_FILENO, information.text, written);
  if (error_number == 0) return static_cast<int>(Status::done);
  return static_cast<int>(error_number == EPIPE ? Status::closed_pipe : Status::file_error);
}

int refuse(const Refused& refused) {
  Messages(false).report(refused.diagnostics, {});
  return static_cast<int>(Status::wrong_input);
}

int dispatch(const std::vector<std::string>& arguments, const char* version) {
  const CommandLine command = read_command_line(arguments, version);
  if (const auto* information = std::get_if<Information>(&command)) return print(*information);
  if (const auto* refused = std::get_if<Refused>(&command)) return refuse(*refused);
  if (const auto* inspect = std::get_if<InspectOptions>(&command)) return run_inspect_session(*inspect);
  if (const auto* exported = std::get_if<ExportOptions>(&command)) return run_export_session(*exported);
  if (const auto* compared = std::get_if<CompareOptions>(&command)) return run_compare_session(*compared);
  return run_session(std::get<RunOptions>(command));
}

/// Says it without asking for memory.
int give_up(std::string_view text) {
  std::size_t written = 0;
  (void)waveform::write_all(STDERR_FILENO, text, written);
  return static_cast<int>(Status::run_failed);
}

}  // namespace

int run_program(int argument_count, char** arguments, const char* version) noexcept {
  try {
    hold_standard_descriptors();
    catch_signals();
    const int status = dispatch(std::vector<std::string>(arguments + std::min(argument_count, 1), arguments + argument_count), version);
    if (analysis::any_abandoned()) std::_Exit(status);  // a thread still works on what would be destroyed
    return status;
  } catch (const std::bad_alloc&) {
    return give_up("error[E-out-of-memory]: no memory is left; try a smaller deck or a machine with more\n");
  } catch (...) {
    return give_up("error[E-internal]: the program met a state it should never reach; try to report it together with the deck\n");
  }
}

}  // namespace pwlsim::cli
