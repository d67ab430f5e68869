#include "cli/output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "cli/signals.hpp"

namespace pwlsim::cli {

int fail(Messages& messages, Status status, std::string id, std::string text) {
  messages.report({Severity::error, std::move(id), {}, std::move(text)});
  return static_cast<int>(status);
}

int fail_by_signal(Messages& messages, std::string text) {
  (void)fail(messages, Status::run_failed, "E-interrupted", std::move(text));
  return status_of_signal(caught_signal());
}

int print(const std::string& text, Messages& messages, Stream stream) {
  std::size_t written = 0;
  const int error_number = waveform::write_all(stream == Stream::error ? STDERR_FILENO : STDOUT_FILENO, text, written);
  if (error_number == 0) return static_cast<int>(Status::done);
  if (error_number == EPIPE) return static_cast<int>(Status::closed_pipe);
  return fail(messages, Status::file_error, "E-cannot-write", fmt::format("standard output: {}", std::strerror(error_number)));
}

int digits_for(Stream stream) {
  constexpr int for_people = 6, all = 0;
  return ::isatty(stream == Stream::output ? STDOUT_FILENO : STDERR_FILENO) == 1 ? for_people : all;
}

int check_output(const std::string& name, const std::vector<std::string>& read, Messages& messages) {
  if (name == "-") return static_cast<int>(Status::done);
  for (const std::string& written : {name, waveform::partial_of(name)})
    for (std::size_t file = 0; file < read.size(); ++file)
      if (waveform::same_file(written, read[file]))
        return fail(messages, Status::wrong_input, "E-output-is-deck",
                    fmt::format("{} is {}; try another name", written, file == 0 ? "the deck itself" : "a file that the deck reads"));
  return static_cast<int>(Status::done);
}

int open_output(const std::string& name, const std::vector<std::string>& read, Messages& messages,
                std::optional<waveform::OutputFile>& file) {
  if (const int status = check_output(name, read, messages); status != 0) return status;
  std::string problem;
  auto opened = waveform::OutputFile::open(name, problem);
  if (!opened) return fail(messages, Status::file_error, "E-cannot-write", fmt::format("{}: {}; try another place", name, problem));
  file.emplace(std::move(*opened));
  return static_cast<int>(Status::done);
}

int write_whole(waveform::OutputFile& file, const std::string& text, Messages& messages) {
  if (file.write(text) && file.commit()) return static_cast<int>(Status::done);
  if (file.closed_pipe()) return static_cast<int>(Status::closed_pipe);
  file.discard();
  return fail(messages, Status::file_error, "E-cannot-write", fmt::format("{}: {}", file.name(), file.problem()));
}

}  // namespace pwlsim::cli
