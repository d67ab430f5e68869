#include <cctype>
#include <set>

#include <catch2/catch.hpp>

#include "base/names.hpp"
#include "elements/catalogue.hpp"
#include "elements/waveform.hpp"

using namespace pwlsim;
using namespace pwlsim::elements;

namespace {

void check_table(ParameterTable table) {
  std::set<std::string> names;
  for (const Parameter& parameter : table) {
    INFO(parameter.name);
    CHECK(names.insert(without_case(parameter.name)).second);
    CHECK(parameter.text.ends_with("."));
    CHECK((parameter.use != Use::honoured || in_range(parameter, parameter.fallback) || parameter.name == table[0].name ||
           parameter.range == Range::positive));
  }
}

}  // namespace

TEST_CASE("every element of the contract is in the catalogue, once, and described", "[unit]") {
  std::string letters;
  for (const Kind& kind : catalogue()) {
    INFO(kind.name);
    letters += kind.letter;
    CHECK(find_kind(kind.letter) == &kind);
    CHECK(find_kind(lower_letter(kind.letter)) == &kind);
    CHECK(kind.usage.starts_with(std::string(1, kind.letter) + "<name> "));
    CHECK(kind.text.ends_with("."));
    CHECK(kind.emit != nullptr);
    CHECK((kind.tail == Tail::model || kind.tail == Tail::block || kind.tail == Tail::value || kind.models.empty()));
    CHECK(((kind.tail != Tail::model && kind.tail != Tail::block) || !kind.models.empty()));
    check_table(kind.parameters);
    for (const ModelKind* model : kind.models) check_table(model->parameters);
  }
  std::sort(letters.begin(), letters.end());
  CHECK(letters == "ABCDEFGHIJKLMQRSVWZ");
  CHECK(find_kind('?') == nullptr);
  CHECK(find_kind('T') == nullptr);
}

TEST_CASE("model types are found without case", "[unit]") {
  for (const char* type : {"D", "d", "SW", "sw", "CSW", "VSWITCH", "ISwitch", "nmos", "VDMOS", "npn", "res"})
    CHECK(find_model_kind(type) != nullptr);
  CHECK(find_model_kind("PIGBT") == nullptr);
}

TEST_CASE("waveforms are found by either name", "[unit]") {
  CHECK(find_waveform("sin") == find_waveform("SINE"));
  CHECK(find_waveform("pwl") == nullptr);
  for (const WaveformKind& kind : waveform_kinds()) {
    CHECK(kind.required <= kind.parameters.size());
    check_table(kind.parameters);
  }
}

TEST_CASE("ranges are what they say", "[unit]") {
  const auto with = [](Range range, bool infinity = false) { return Parameter{"x", "", 0.0, range, infinity, ""}; };
  CHECK(in_range(with(Range::any), -5.0));
  CHECK_FALSE(in_range(with(Range::any), infinite));
  CHECK(in_range(with(Range::any, true), infinite));
  CHECK_FALSE(in_range(with(Range::any, true), std::numeric_limits<double>::quiet_NaN()));
  CHECK(in_range(with(Range::not_negative), 0.0));
  CHECK_FALSE(in_range(with(Range::not_negative), -1e-300));
  CHECK_FALSE(in_range(with(Range::positive), 0.0));
  CHECK(in_range(with(Range::whole_positive), 3.0));
  CHECK_FALSE(in_range(with(Range::whole_positive), 2.5));
  CHECK_FALSE(in_range(with(Range::whole_positive), 0.0));
  CHECK(in_range(with(Range::minus_one_to_one), -1.0));
  CHECK_FALSE(in_range(with(Range::minus_one_to_one), 1.0000001));
}

TEST_CASE("values replace each other and fall back", "[unit]") {
  static constexpr Parameter table[] = {{"Ron", "ohm", 5.0, Range::any, false, "."}, {"Roff", "ohm", 7.0, Range::any, false, "."}};
  Values values(table);
  CHECK(values.get("RON") == 5.0);
  CHECK_FALSE(values.has("ron"));
  values.set("ron", 1.0);
  values.set("Ron", 2.0, {0, 3, 4});
  CHECK(values.get("Ron") == 2.0);
  CHECK(values.all().size() == 1);
  CHECK(values.span("ron") == SourceSpan{0, 3, 4});
  CHECK_FALSE(values.span("Roff").known());
}
