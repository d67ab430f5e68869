// Models at hand.

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "circuit/deck.hpp"
#include "circuit/devices.hpp"

using namespace pwlsim;
using circuit::find_device;
using test::compile_deck;
using test::CompiledDeck;
using test::named;

namespace {

std::string parameters_of(std::string_view name) {
  const auto device = find_device(name);
  return device ? std::string(device->type) + ' ' + device->parameters : "none";
}

std::string card_of(std::string_view type, std::string_view name) {
  if (type == "OPAMP" || type == "COMPARATOR" || type == "PUSHPULL")
    return fmt::format("X1 0 b c d b {}\nV2 c 0 5\nV3 0 d 5\nR1 b 0 1", name);
  if (type == "D") return fmt::format("D1 a 0 {}", name);
  const char letter = type == "VDMOS" || type == "NMOS" || type == "PMOS" ? 'M' : type == "NPN" || type == "PNP" ? 'Q' : 'J';
  return fmt::format("{}1 a b 0 {}\nR2 b 0 1", letter, name);
}

}  // namespace

TEST_CASE("a name stands for itself and for itself with letters behind it", "[unit]") {
  CHECK(parameters_of("1n4148") == "D Vfwd=0.7 Ron=2 Vrev=100");
  CHECK(parameters_of("1N4148WS") == parameters_of("1N4148"));
  CHECK(parameters_of("1N41480") == "none");
  CHECK(parameters_of("1N414") == "none");
  CHECK(parameters_of("MBRS140T3G") == parameters_of("MBRS140"));
  CHECK(parameters_of("IRF540NPBF") == parameters_of("IRF540N"));
  CHECK(parameters_of("IRF540") != parameters_of("IRF540N"));
  CHECK(parameters_of("MURB1620CT") == parameters_of("MUR1620"));  // the same die in another package
  CHECK(parameters_of("SPA20N60C3") == parameters_of("SPP20N60C3"));
  CHECK(parameters_of("MURX1620") == "none");
  CHECK(parameters_of("J201") == "NJF Vto=-2 Beta=1m");
  CHECK(parameters_of("J201X") == "none");  // too short for anything but itself
  CHECK(parameters_of("1N4148_with_a_long_name") == "none");
  CHECK(parameters_of("") == "none");
}

TEST_CASE("the names of PSpice's libraries have the letter of their card before the part", "[unit]") {
  const auto deck = compile_deck("V1 a 0 1\nD1 a b D1N4148\nR1 b 0 1\nQ1 a b 0 Q2N2222\nD2 b 0 D1N750\nD3 b 0 DBAT54\n.tran 1u 1m\n");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(deck.count("N-model-at-hand") == 4);
  CHECK(named(deck.network().diodes, "D1").drop == 0.7);  // of the row 1N4148
  // The letter of another element is none of the name's.
  CHECK(compile_deck("V1 a 0 1\nD1 a b Q1N4148\nR1 b 0 1\n.tran 1u 1m\n").count("E-unknown-model") == 1);
}

TEST_CASE("the voltage of a Zener diode stands in its name", "[unit]") {
  CHECK(parameters_of("BZX84C5V1") == "D Vfwd=0.75 Ron=1.5 Vrev=5.1 Rrev=20");
  CHECK(parameters_of("bzx84c24vly") == "D Vfwd=0.75 Ron=1.5 Vrev=24 Rrev=20");
  CHECK(parameters_of("BZX79-C12") == "D Vfwd=0.75 Ron=1.5 Vrev=12 Rrev=20");
  CHECK(parameters_of("P6KE6.8A") == "D Vfwd=0.8 Ron=20m Vrev=6.8 Rrev=0.5");
  CHECK(parameters_of("BZX84C") == "none");
  CHECK(parameters_of("BZX84C5231") == "none");
}

TEST_CASE("resistance and voltage from the names of Infineon's MOSFETs", "[unit]") {
  CHECK(parameters_of("BSC900N20NS3") == "VDMOS Vto=3 Ron=0.09 Vfwd=0.75 Rfwd=0.045 BV=200");
  CHECK(parameters_of("BSZ100N03MS") == "VDMOS Vto=1.7 Ron=0.01 Vfwd=0.75 Rfwd=0.005 BV=30");
  CHECK(parameters_of("IPP052N8N5") == "VDMOS Vto=3 Ron=0.0052 Vfwd=0.75 Rfwd=0.0026 BV=80");
  CHECK(parameters_of("BSC009NE2LS5") == "VDMOS Vto=1.7 Ron=0.0009 Vfwd=0.75 Rfwd=0.00045 BV=25");
  CHECK(parameters_of("IPB180N04S4") == "none");  // 180 A
  CHECK(parameters_of("BSC9N") == "none");
  CHECK(parameters_of("IPPabcN10") == "none");
  CHECK(parameters_of("BSC22DN20NS3") == "VDMOS Vto=3 Ron=0.225 Vfwd=0.75 Rfwd=0.1125 BV=200");
  CHECK(parameters_of("IPD042P03L3") == "VDMOS pchan Vto=-1.7 Ron=0.0042 Vfwd=0.75 Rfwd=0.0021 BV=30");
  CHECK(parameters_of("IPW60R190C6") == "VDMOS Vto=3 Ron=0.19 Vfwd=0.75 Rfwd=0.095 BV=600");
}

TEST_CASE("the names of other makers' parts are read", "[unit]") {
  // Expected: what the data sheet of each part has for resistance or current, and voltage.
  CHECK(parameters_of("BUK7Y7R6-40E") == "VDMOS Vto=3 Ron=0.0076 Vfwd=0.75 Rfwd=0.0038 BV=40");
  CHECK(parameters_of("BUK7Y7R640E") == parameters_of("BUK7Y7R6-40E"));
  CHECK(parameters_of("BUK9Y14-40B") == "VDMOS Vto=1.7 Ron=0.014 Vfwd=0.75 Rfwd=0.007 BV=40");
  CHECK(parameters_of("PSMN1R5-30YLC") == "VDMOS Vto=1.7 Ron=0.0015 Vfwd=0.75 Rfwd=0.00075 BV=30");
  CHECK(parameters_of("PSMN013-100PS") == "VDMOS Vto=3 Ron=0.013 Vfwd=0.75 Rfwd=0.0065 BV=100");
  CHECK(parameters_of("C3M0280090J") == "VDMOS Vto=2.5 Ron=0.28 Vfwd=3.5 Rfwd=0.28 BV=900");
  CHECK(parameters_of("C5D25170H") == "D Vfwd=0.95 Ron=0.022 Vrev=1700 Iave=25");
  CHECK(parameters_of("UF3C065040") == "VDMOS Vto=5 Ron=0.04 Vfwd=1 Rfwd=0.04 BV=650");
  CHECK(parameters_of("SCT3080KL") == "VDMOS Vto=4 Ron=0.08 Vfwd=2.5 Rfwd=0.08 BV=1200");
  CHECK(parameters_of("SUD50P06-15L") == "VDMOS pchan Vto=-2 Ron=0.015 Vfwd=0.75 Rfwd=0.0075 BV=60");
  CHECK(parameters_of("SUD35N10-26P") == "VDMOS Vto=2 Ron=0.026 Vfwd=0.75 Rfwd=0.013 BV=100");
  CHECK(parameters_of("SUM90N10-8m2P") == "VDMOS Vto=2 Ron=0.0082 Vfwd=0.75 Rfwd=0.0041 BV=100");
  CHECK(parameters_of("RFN10NS3S") == "D Vfwd=0.8 Ron=0.03 Vrev=300 Iave=10");
  CHECK(parameters_of("STTH8L06") == "D Vfwd=0.85 Ron=0.075 Vrev=600 Iave=8");
  CHECK(parameters_of("STTH1210") == "D Vfwd=0.85 Ron=0.05 Vrev=1000 Iave=12");
  CHECK(parameters_of("STPS15L30CB") == "D Vfwd=0.35 Ron=0.0167 Vrev=30 Iave=15");
  CHECK(parameters_of("STPS30150CT") == "D Vfwd=0.5 Ron=0.00833 Vrev=150 Iave=30");
  CHECK(parameters_of("VS-30ETH06-M3") == "D Vfwd=0.9 Ron=0.0167 Vrev=600 Iave=30");
  CHECK(parameters_of("VS-E5TH0812") == "D Vfwd=0.9 Ron=0.113 Vrev=1200 Iave=8");
  for (const char* name : {"BUK7", "PSMN-30", "PSMN1R-30YL", "C3M65090", "C9D10060", "UJ3C65", "SCT3080ML", "SUD99N04", "RFN10NS", "STTH",
                           "STPS12", "30XTH06", "VS-E5TH08"}) {
    CAPTURE(name);
    CHECK(parameters_of(name) == "none");
  }
}

TEST_CASE("every model at hand can be used", "[unit]") {
  for (const std::string& name : circuit::device_names()) {
    INFO(name);
    const auto device = find_device(name);
    REQUIRE(device);
    CHECK_FALSE(device->source.empty());
    const CompiledDeck deck = compile_deck(fmt::format("V1 a 0 SIN(0 1 50)\n{}\n.tran 1m\n", card_of(device->type, name)));
    INFO(deck.messages());
    CHECK(deck.compiled.has_value());
    CHECK(deck.diagnostics.all().size() == 1);
    CHECK(deck.count("N-model-at-hand") == 1);
  }
}

TEST_CASE("a model at hand is told of where it is used, once", "[unit]") {
  const CompiledDeck deck = compile_deck("V1 a 0 1\nD1 a b 1N4148\nD2 b 0 1N4148\n.subckt unused x y\nD1 x y 1N4007\n.ends\n.tran 1m\n");
  INFO(deck.messages());
  CHECK(deck.count("N-model-at-hand") == 1);
  CHECK(deck.diagnostics.all().size() == 1);
}

TEST_CASE("a model of the deck rules over one at hand", "[unit]") {
  const CompiledDeck deck = compile_deck("V1 a 0 1\nD1 a b 1N4148\nR1 b 0 1\n.model 1n4148 D(Vfwd=0.5)\n.tran 1m\n");
  CHECK(deck.messages().empty());
  const CompiledDeck inner =
      compile_deck("V1 a 0 1\nX1 a s\n.subckt s p\nD1 p 0 1N4148\n.model 1N4148 D(Vfwd=0.5 Ron=1)\n.ends\n.tran 1m\n");
  CHECK(inner.messages().empty());
}

TEST_CASE("a model at hand is of the kind that the element takes", "[unit]") {
  CHECK(compile_deck("V1 a 0 1\nD1 a 0 IRF540\n.tran 1m\n").count("E-unknown-model") == 1);
  CHECK(compile_deck("V1 a 0 1\nD1 a 0 notathand\n.tran 1m\n").count("E-unknown-model") == 1);
}

TEST_CASE("the levels of LTspice's universal amplifier", "[unit]") {
  for (const char* name : {"level.1", "level1", "level.2", "level2", "level.3a", "level3b"}) {
    INFO(name);
    const CompiledDeck deck = compile_deck(fmt::format(
        "V1 in 0 1\nV2 p 0 15\nV3 n 0 -15\nXU1 in out p n out {} Avol=1Meg GBW=10Meg en=0 ink=0\nR1 out 0 1k\n.tran 1m\n", name));
    INFO(deck.messages());
    CHECK(deck.compiled.has_value());
  }
  CHECK(compile_deck("X1 a b c d e level.9\n.tran 1m\n").count("E-unknown-subckt") == 1);
}
