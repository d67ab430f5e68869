#pragma once
/// Texts and files that a command writes, and what it says where that fails. Every function returns an exit status, 0 where all is well.

#include <optional>
#include <string>
#include <vector>

#include "cli/messages.hpp"
#include "cli/status.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

/// Reports an error; returns the status.
int fail(Messages& messages, Status status, std::string id, std::string text);

enum class Stream { output, error };

/// How many significant digits a stream is given: on a terminal those that people read, elsewhere all.
[[nodiscard]] int digits_for(Stream stream);

/// The text on a standard stream, whole.
[[nodiscard]] int print(const std::string& text, Messages& messages, Stream stream = Stream::output);

/// E-output-is-deck where writing `name` would destroy a file that was read: the deck (the first of `read`), or one that it includes.
[[nodiscard]] int check_output(const std::string& name, const std::vector<std::string>& read, Messages& messages);

/// Opens a file to write, which must be none of those read; "-" is standard output.
[[nodiscard]] int open_output(const std::string& name, const std::vector<std::string>& read, Messages& messages,
                              std::optional<waveform::OutputFile>& file);

/// Writes the text to the file and commits it.
[[nodiscard]] int write_whole(waveform::OutputFile& file, const std::string& text, Messages& messages);

}  // namespace pwlsim::cli
