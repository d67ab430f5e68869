#pragma once
/// Bytes of a file -> UTF-8 text: byte order marks, UTF-16, single Latin-1 bytes.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pwlsim::netlist {

/// A place of the decoded text that no deck may hold.
struct TextProblem {
  enum class Kind {
    null,     ///< a zero byte: this is not a text
    control,  ///< any control character but tab and line end
    encoding  ///< a byte that no known encoding explains; U+FFFD stands for it
  };
  Kind kind = Kind::control;
  std::uint32_t offset = 0;
  std::uint32_t size = 1;
};

struct DecodedText {
  std::string text;                   ///< valid UTF-8 without byte order mark; line ends are kept
  std::vector<TextProblem> problems;  ///< by offset; after a thousand no more are listed
};

/// UTF-16 is recognised by its byte order mark, or, little-endian without one (some of LTspice's files), by four letters of ASCII at the front. A byte that is not UTF-8 is read as Windows-1252, which agrees with Latin-1 on µ.
/// A no-break space becomes a blank, half a UTF-16 pair U+FFFD. Linear in the size; a text that needs no change is moved, not copied.
[[nodiscard]] DecodedText decode(std::string bytes);

}  // namespace pwlsim::netlist
