#pragma once
/// Writes the texts and files of a command and reports failures. Every function returns an exit status, 0 for success.

#include <optional>
#include <string>
#include <vector>

#include "cli/messages.hpp"
#include "cli/status.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

/// Reports an error; returns the status.
int fail(Messages& messages, Status status, std::string id, std::string text);
/// E-interrupted, and the status of the signal that came.
[[nodiscard]] int fail_by_signal(Messages& messages, std::string text);

enum class Stream { output, error };

/// The number of significant digits for a stream: few on a terminal, else all.
[[nodiscard]] int digits_for(Stream stream);

/// Writes the whole text to a standard stream.
[[nodiscard]] int print(const std::string& text, Messages& messages, Stream stream = Stream::output);

/// E-output-is-deck if writing `name` would destroy a file that was read: the deck (the first of `read`), or one that it includes.
[[nodiscard]] int check_output(const std::string& name, const std::vector<std::string>& read, Messages& messages);

/// Opens a file for writing, which must not be one of those read; "-" is standard output.
[[nodiscard]] int open_output(const std::string& name, const std::vector<std::string>& read, Messages& messages,
                              std::optional<waveform::OutputFile>& file);

/// Writes the text to the file and commits it.
[[nodiscard]] int write_whole(waveform::OutputFile& file, const std::string& text, Messages& messages);

}  // namespace pwlsim::cli
