#pragma once
/// Bytes of a file -> UTF-8 text: byte order marks, UTF-16, single Latin-1 bytes.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pwlsim::netlist {

/// A place in the decoded text that is not allowed in a deck.
struct TextProblem {
  enum class Kind {
    null,     ///< a zero byte: not a text file
    control,  ///< any control character except tab and line end
    encoding  ///< a byte in no known encoding; replaced by U+FFFD
  };
  Kind kind = Kind::control;
  std::uint32_t offset = 0;
  std::uint32_t size = 1;
};

struct DecodedText {
  std::string text;                   ///< valid UTF-8 without byte order mark; line ends are kept
  std::vector<TextProblem> problems;  ///< by offset; at most a thousand
};

/// UTF-16 is recognised by its byte order mark, or, little-endian without one (some of LTspice's files), by four ASCII letters at the start. A byte that is not UTF-8 is read as Windows-1252, which agrees with Latin-1 on µ.
/// A no-break space becomes a blank, half a UTF-16 pair U+FFFD. Linear in the size; a text that needs no change is moved, not copied.
[[nodiscard]] DecodedText decode(std::string bytes);

}  // namespace pwlsim::netlist
