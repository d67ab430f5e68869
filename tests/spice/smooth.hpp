#pragma once
/// Decks in a string as ngspice decks, and what ngspice gives for them; for tests.

#include <catch2/catch.hpp>
#include <string>
#include <string_view>

#include "circuit/deck.hpp"
#include "spice/deck.hpp"
#include "spice/ngspice.hpp"
#include "spice/study.hpp"

namespace pwlsim::test {

inline CompiledDeck keep_circuit(std::string_view cards) { return compile_deck(cards, {.analysis_required = true, .keep_circuit = true}); }

inline spice::SmoothDeck smooth(const CompiledDeck& deck, const spice::DeckSettings& settings = {}) {
  INFO(deck.messages());
  REQUIRE(deck.compiled);
  Diagnostics diagnostics;
  auto result = spice::smooth_deck(*deck.compiled->circuit, settings, diagnostics);
  REQUIRE(result);
  return *result;
}

/// The cards without the title, one a line.
inline std::string smooth_text(std::string_view cards) {
  const std::string text = smooth(keep_circuit(cards)).text;
  return text.substr(text.find('\n') + 1);
}

/// Where ngspice is not installed the rest of the test is left out, and says so.
inline bool has_ngspice() {
  if (spice::find_ngspice()) return true;
  WARN("ngspice is not installed: this test is skipped");
  return false;
}

inline waveform::RawFile run_smooth(const spice::SmoothDeck& deck) {
  const auto run = spice::run_ngspice(*spice::find_ngspice(), deck.text);
  INFO(deck.text << run.words);
  REQUIRE(run.ended);
  REQUIRE(run.raw);
  return *run.raw;
}

/// A signal of the deck at a time, by ngspice with the finest settings that are quick.
inline double smooth_value(std::string_view cards, std::size_t signal, double time) {
  spice::DeckSettings settings;
  settings.sharpness = 1e-4;
  settings.reltol = 1e-5;
  settings.sample_times = {time};
  const spice::SmoothDeck deck = smooth(keep_circuit(cards), settings);
  const waveform::RawFile raw = run_smooth(deck);
  return spice::SignalReader(raw, deck.signals.at(signal)).at(time);
}

}  // namespace pwlsim::test
