#pragma once
/// The page of --report: what its data hold, and how headless Chromium shows it.

#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <string>
#include <vector>

#include "support/json.hpp"
#include "support/scratch.hpp"

namespace pwlsim::test {

inline std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  REQUIRE(begin != std::string::npos);
  const std::size_t start = begin + from.size();
  return text.substr(start, text.find(to, start) - start);
}

inline Json data_of(const std::string& page) {
  return read_json(between(page, "<script type=\"application/json\" id=\"run\">", "</script>"));
}

/// A signal of the page from its Legendre series on the piece that holds the time.
inline double value_of(const Json& data, std::size_t signal, double time) {
  const Json& shown = data["signals"][signal];
  const auto& edges = data["records"][static_cast<std::size_t>(shown["record"].number)]["edges"].array;
  std::size_t piece = 0, start = 0;
  const auto length = [&](std::size_t k) { return std::stoul(shown["lengths"].string.substr(k, 1), nullptr, 16) + 1; };
  for (; piece + 2 < edges.size() && edges[piece + 1].number < time; ++piece) start += length(piece);
  const double from = edges[piece].number, to = edges[piece + 1].number;
  double value = 0.0;
  for (std::size_t k = 0; k < length(piece); ++k)
    value += shown["coefficients"][start + k].number * std::legendre(static_cast<unsigned>(k), (2.0 * time - from - to) / (to - from));
  return value;
}

inline double end_of(const Json& data, std::size_t signal) {
  return data["records"][static_cast<std::size_t>(data["signals"][signal]["record"].number)]["edges"].array.back().number;
}

/// The numbers of a signal's line of measurements, all digits: at A, at B, B − A, minimum, maximum, peak to peak, mean, RMS (those that there are).
inline std::vector<double> figures_of(const std::string& page, const std::string& signal) {
  const std::string line = between(page, "<tr><td>" + signal + "</td>", "</tr>");
  std::vector<double> values;
  static const std::regex title("title=\"([^\"]*)\"");
  for (auto found = std::sregex_iterator(line.begin(), line.end(), title); found != std::sregex_iterator(); ++found)
    values.push_back(std::stod((*found)[1]));
  return values;
}

/// Without what shows only where the pointer rests.
inline std::string without_titles(const std::string& page) { return std::regex_replace(page, std::regex(" title=\"[^\"]*\""), ""); }

/// The page as it stands when its scripts have run; empty where there is no Chromium, or PWLSIM_NO_BROWSER is set, as under the sanitizers, which see nothing of it.
inline std::string shown(const Scratch& scratch, const std::string& page, const std::string& view = "", const std::string& options = "") {
  if (std::getenv("PWLSIM_NO_BROWSER") != nullptr) return "";
  if (std::system("command -v chromium > /dev/null 2>&1") != 0) {
    WARN("chromium is not installed: this test is skipped");
    return "";
  }
  const std::string command =
      "cd '" + scratch.path().string() +
      "' && HOME=\"$PWD\" timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --window-size=1200,1000 " +
      options + " --virtual-time-budget=10000 --dump-dom 'file://" + (scratch / page) + view + "' > dom.html 2> chromium.log";
  // Chromium itself falls now and then (by a signal, which the shell reports as 128 and its number; timeout as 124): that says nothing of the page.
  const auto has_fallen = [](int status) { return WIFSIGNALED(status) || WEXITSTATUS(status) == 124 || WEXITSTATUS(status) > 128; };
  constexpr int tries = 3;
  int status = std::system(command.c_str());
  for (int more = 1; more < tries && has_fallen(status); ++more) status = std::system(command.c_str());
  INFO("chromium ended with status " << status << "\n" << read_file(scratch / "chromium.log"));
  REQUIRE(status == 0);
  return read_file(scratch / "dom.html");
}

/// How wide a window is in which a page is used, and in which colours.
struct Window {
  int width = 1200;
  bool is_dark = false;
};

/// The page after a script (the body of an async function, with what tests/cli/page_player.js offers) has used it: what the script stored in `seen`.
/// Null where there is no Chromium. The page stands in a frame, for Chromium makes no window less than 500 pixels wide.
inline Json played(const Scratch& scratch, const std::string& page, const std::string& script, const std::string& view = "",
                   Window window = {}) {
  std::string text = read_file(scratch / page);
  const std::string player = read_file(std::string(PWLSIM_SOURCE_DIR) + "/tests/cli/page_player.js");
  const std::string body = "<body>";
  text.insert(text.find(body) + body.size(), "<script>" + player + "\nplay(async () => {" + script + "\n});</script>");
  scratch.write("played.html", text);
  scratch.write("frame.html", "<!DOCTYPE html><meta charset=\"utf-8\"><body style=\"margin:0\"><iframe style=\"border:0;width:" +
                                  std::to_string(window.width) + "px;height:900px\" src=\"played.html" + view +
                                  "\"></iframe><pre id=\"played\"></pre>" +
                                  "<script>onmessage = event => { document.getElementById('played').textContent = "
                                  "event.data.replace(/[&<>]/g, c => '\\\\u00' + c.charCodeAt(0).toString(16)); };</script>");
  const std::string dom = shown(scratch, "frame.html", "", window.is_dark ? "--blink-settings=preferredColorScheme=0" : "");
  if (dom.empty()) return {};
  Json seen = read_json(between(dom, "<pre id=\"played\">", "</pre>"));
  if (seen.object.count("error") > 0) FAIL(seen["error"].string);
  return seen;
}

}  // namespace pwlsim::test
