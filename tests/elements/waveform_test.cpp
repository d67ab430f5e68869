#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "elements/waveform.hpp"

using namespace pwlsim;
using namespace pwlsim::elements;

namespace {

struct Made {
  std::optional<model::SourceFunction> function;
  Diagnostics diagnostics;
};

Made make(std::string_view name, std::initializer_list<double> numbers) {
  const WaveformKind* kind = find_waveform(name);
  REQUIRE(kind != nullptr);
  Values values(kind->parameters);
  std::size_t k = 0;
  for (double number : numbers) values.set(kind->parameters[k++].name, number);
  Made made;
  made.function = kind->make(values, {}, made.diagnostics);
  return made;
}

template <class T>
T get(const Made& made) {
  REQUIRE(made.function.has_value());
  return std::get<T>(*made.function);
}

PwlPart part(std::initializer_list<std::pair<double, double>> points, double passes = 1.0) {
  PwlPart result;
  result.passes = passes;
  for (const auto& [time, value] : points) result.points.push_back({time, value, false, {}});
  return result;
}

model::Pwl pwl(std::vector<PwlPart> parts, std::optional<double> repeat_from = {}, double delay = 0.0) {
  PwlCard card;
  card.parts = std::move(parts);
  card.repeat_from = repeat_from;
  card.delay = delay;
  Diagnostics diagnostics;
  const auto function = make_pwl(card, diagnostics);
  REQUIRE(function.has_value());
  return std::get<model::Pwl>(*function);
}

bool has_points(const model::Pwl& pwl, std::initializer_list<std::pair<double, double>> expected) {
  std::size_t k = 0;
  if (pwl.points.size() != expected.size()) return false;
  for (const auto& [time, value] : expected) {
    if (pwl.points[k].time != time || pwl.points[k].value != value) return false;
    ++k;
  }
  return true;
}

}  // namespace

TEST_CASE("PULSE has the defaults of the contract", "[unit]") {
  // Tr, Tf omitted: a true jump; Ton omitted: to the end; Tper omitted or 0: one pulse; Ncycles 0: no limit.
  const auto brief = get<model::Pulse>(make("pulse", {1, 2}));
  CHECK(brief.initial == 1.0);
  CHECK(brief.pulsed == 2.0);
  CHECK(brief.delay == 0.0);
  CHECK(brief.rise == 0.0);
  CHECK(brief.fall == 0.0);
  CHECK(std::isinf(brief.width));
  CHECK(std::isinf(brief.period));
  CHECK(std::isinf(brief.cycles));
  const auto zero_width = get<model::Pulse>(make("PULSE", {0, 1, 1e-3, 1e-6, 2e-6, 0, 0, 0}));
  CHECK(zero_width.width == 0.0);
  CHECK(std::isinf(zero_width.period));
  CHECK(std::isinf(zero_width.cycles));
  const auto full = get<model::Pulse>(make("PULSE", {0, 1, 1e-3, 1e-6, 2e-6, 3e-6, 1e-5, 7}));
  CHECK(full.delay == 1e-3);
  CHECK(full.rise == 1e-6);
  CHECK(full.fall == 2e-6);
  CHECK(full.width == 3e-6);
  CHECK(full.period == 1e-5);
  CHECK(full.cycles == 7.0);
}

TEST_CASE("edges that fill the period but for rounding never overtake the next pulse", "[unit]") {
  const double period = 1e-5, rise = 1e-9, fall = 1e-9;
  for (double duty : {0.1, 0.3, 0.7, 0.9}) {
    // Ton from the other side: rise + width + fall is the period up to rounding.
    const double width = std::nextafter(period - rise - fall, 1.0);
    const auto pulse = get<model::Pulse>(make("PULSE", {0, 1, duty * period, rise, fall, width, period}));
    CHECK(pulse.rise + pulse.width + pulse.fall <= pulse.period);
    CHECK(pulse.width == Approx(width).epsilon(1e-12));
  }
}

TEST_CASE("a pulse cut by the next is a repeated polyline", "[unit]") {
  const auto made = make("PULSE", {0, 4, 1, 2, 2, 6, 8});
  REQUIRE(made.diagnostics.all().size() == 1);
  CHECK(made.diagnostics.all()[0].id == "W-pulse-cut");
  const auto cut = get<model::Pwl>(made);
  // Rise 0→4 in [0,2], top until 8, which is the period: the fall never happens. All from Td = 1.
  CHECK(has_points(cut, {{1, 0}, {3, 4}, {9, 4}}));
  CHECK(cut.repeat_from == 1.0);
  CHECK(std::isinf(cut.repeats));
  // Cut in the rise: half of it in a period of 1.
  CHECK(has_points(get<model::Pwl>(make("PULSE", {0, 4, 0, 2, 2, 6, 1})), {{0, 0}, {1, 2}}));
  // Cut in the fall: at 9 of 8…10 the value is half.
  CHECK(has_points(get<model::Pwl>(make("PULSE", {0, 4, 0, 2, 2, 6, 9})), {{0, 0}, {2, 4}, {8, 4}, {9, 2}}));
}

TEST_CASE("SIN takes its phase in degrees", "[unit]") {
  const auto sin = get<model::Sin>(make("sine", {1, 2, 50, 1e-3, 10, 90, 3}));
  CHECK(sin.offset == 1.0);
  CHECK(sin.amplitude == 2.0);
  CHECK(sin.frequency == 50.0);
  CHECK(sin.delay == 1e-3);
  CHECK(sin.damping == 10.0);
  CHECK(sin.phase == Approx(std::numbers::pi / 2).epsilon(1e-15));
  CHECK(sin.cycles == 3.0);
  CHECK(std::isinf(get<model::Sin>(make("SIN", {0, 1, 50})).cycles));
}

TEST_CASE("EXP without Td2 never falls", "[unit]") {
  const auto rising = get<model::Exp>(make("EXP", {0, 1, 1e-3, 2e-3}));
  CHECK(rising.td1 == 1e-3);
  CHECK(rising.tau1 == 2e-3);
  CHECK(std::isinf(rising.td2));
  const auto both = get<model::Exp>(make("EXP", {0, 1, 1e-3, 2e-3, 3e-3, 4e-3}));
  CHECK(both.td2 == 3e-3);
  CHECK(both.tau2 == 4e-3);
}

TEST_CASE("PWL repeats from r on, after its delay", "[unit]") {
  const auto once = pwl({part({{0, 0}, {1, 5}})});
  CHECK(once.repeats == 0.0);
  const auto repeated = pwl({part({{0, 0}, {1, 5}, {3, 0}})}, 1.0, 0.5);
  CHECK(has_points(repeated, {{0.5, 0}, {1.5, 5}, {3.5, 0}}));
  CHECK(repeated.repeat_from == 1.5);
  CHECK(std::isinf(repeated.repeats));
  CHECK(pwl({part({{0, 0}, {1, 5}})}, -1.0).repeats == 0.0);
}

TEST_CASE("PWL parts are passed as often as the card says", "[unit]") {
  const auto thrice = pwl({part({{0, 0}, {1, 1}, {2, 0}}, 3.0)});
  CHECK(has_points(thrice, {{0, 0}, {1, 1}, {2, 0}}));
  CHECK(thrice.repeats == 2.0);
  CHECK(thrice.repeat_from == 0.0);
  const auto behind = pwl({part({{0, 7}, {1, 7}}), part({{0, 0}, {1, 1}}, infinite)});
  CHECK(has_points(behind, {{0, 7}, {1, 7}, {1, 0}, {2, 1}}));
  CHECK(behind.repeat_from == 1.0);
  CHECK(std::isinf(behind.repeats));
  // A finite part that something follows is written out; its passes join by a jump at 1 and 2.
  const auto out = pwl({part({{0, 0}, {1, 1}}, 2.0), part({{1, 9}})});
  CHECK(has_points(out, {{0, 0}, {1, 1}, {1, 0}, {2, 1}, {3, 9}}));
  CHECK(out.repeats == 0.0);
  // A part that starts after 0: later passes are led there from where the last one ended.
  const auto led = pwl({part({{1, 0}, {2, 3}}, infinite)});
  CHECK(has_points(led, {{1, 0}, {2, 3}, {3, 0}, {4, 3}}));
  CHECK(led.repeat_from == 2.0);
  const auto twice = pwl({part({{1, 0}, {2, 3}}, 2.0)});
  CHECK(has_points(twice, {{1, 0}, {2, 3}, {3, 0}, {4, 3}}));
  CHECK(twice.repeats == 0.0);
}

TEST_CASE("relative times count from the point before", "[unit]") {
  PwlPart relative;
  relative.points = {{0, 0, false, {}}, {1, 5, true, {}}, {2, 0, true, {}}};
  CHECK(has_points(pwl({relative}), {{0, 0}, {1, 5}, {3, 0}}));
}
