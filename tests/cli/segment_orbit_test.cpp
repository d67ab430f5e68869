// .pss on Krylov segments: orbits and multipliers against independent references, closed forms and charge balances.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "cli/json_result.hpp"
#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// All that stands between each `first` and the end of its line.
std::string without(std::string deck, const std::string& first) {
  for (std::size_t at = deck.find(first); at != std::string::npos; at = deck.find(first)) deck.erase(at, deck.find('\n', at) - at);
  return deck;
}

/// As validation/large/circuits.py has it, with ideal diodes.
std::string cockcroft_walton(int stages) {
  std::ostringstream deck;
  deck.precision(12);
  deck << "Cockcroft-Walton multiplier\nV1 s 0 SIN(0 100 50)\n";
  const double capacitance = 1e-6 * stages * stages / 9.0 * 20.0;
  for (int n = 1; n <= stages; ++n) {
    const std::string k = std::to_string(n), before = std::to_string(n - 1);
    deck << "CA" << k << " a" << k << (n == 1 ? " s " : " a" + before + " ") << capacitance << " ic=" << (n == 1 ? 90 : 180) << '\n'
         << "CB" << k << " b" << k << (n == 1 ? " 0 " : " b" + before + " ") << capacitance << " ic=180\n"
         << "DA" << k << (n == 1 ? " 0" : " b" + before) << " a" << k << " DI\nDB" << k << " a" << k << " b" << k << " DI\n";
  }
  deck << "RL b" << stages << " 0 " << stages * 1e5 << "\n.model DI D\n.pss uic\n";
  for (int n = 1; n <= stages; ++n) deck << ".meas pss qa" << n << " AVG i(DA" << n << ")\n.meas pss qb" << n << " AVG i(DB" << n << ")\n";
  deck << ".meas pss load AVG i(RL)\n.save v(b" << stages << ")\n.end\n";
  return deck.str();
}

/// As validation/large/circuits.py has it, with sources of one frequency.
std::string grid(int side, int rectifiers) {
  std::ostringstream deck;
  deck.precision(12);
  deck << "RC grid fed by rectifiers\n";
  const auto node = [](int i, int j) { return "n" + std::to_string(i) + "_" + std::to_string(j); };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const std::string n = node(i, j);
      if (j + 1 < side) deck << "RH" << n << ' ' << n << ' ' << node(i, j + 1) << " 1\n";
      if (i + 1 < side) deck << "RV" << n << ' ' << n << ' ' << node(i + 1, j) << " 1\n";
      deck << 'C' << n << ' ' << n << " 0 1u ic=8\n";
      if ((i + j) % 7 == 0) deck << "RG" << n << ' ' << n << " 0 1k\n";
    }
  for (int r = 0; r < rectifiers; ++r) {
    const int place = r * side * side / rectifiers + side / 2;
    deck << 'V' << r << " v" << r << " 0 SIN(0 10 1k 0 0 " << 360.0 * r / rectifiers << ")\nRS" << r << " v" << r << " w" << r << " 0.5\nD"
         << r << " w" << r << ' ' << node(place / side % side, place % side) << " DI\n";
  }
  deck << ".model DI D\n.save v(" << node(0, 0) << ") v(" << node(side / 2, side / 2) << ") v(" << node(side - 1, side - 1) << ")\n";
  return deck.str();
}

/// One leg as validation/large/circuits.py has it: each submodule is in or out by its own pulse once a period.
std::string multilevel(int submodules) {
  constexpr double period = 20e-3, edge = 1e-6, link = 800.0;
  std::ostringstream deck;
  deck.precision(12);
  deck << "Modular multilevel converter\nVP p 0 " << link / 2 << "\nVN n 0 " << -link / 2 << '\n';
  for (const bool upper : {true, false})
    for (int k = 0; k < submodules; ++k) {
      const std::string name = (upper ? "U" : "L") + std::to_string(k), arm = upper ? "U" : "L";
      const std::string above = k > 0 ? name : upper ? "p" : "la";
      const std::string below = k + 1 < submodules ? arm + std::to_string(k + 1) : upper ? "ua" : "n";
      const double level = ((2.0 * k + 1.0) / submodules - 1.0) / 0.9;
      const double half = 0.25 * period + std::asin(std::clamp(level, -0.999, 0.999)) / (2.0 * std::numbers::pi) * period;
      const double start = std::fmod((upper ? 0.75 : 0.25) * period - half + period, period), width = 2.0 * half;
      const bool wraps = start + width > period;
      const double delay = wraps ? std::fmod(start + width, period) : start, length = (wraps ? period - width : width) - edge;
      for (const bool in : {true, false}) {
        const int pulsed = in != wraps ? 1 : 0;
        deck << 'V' << name << (in ? "g " : "h ") << name << (in ? "g" : "h") << " 0 PULSE(" << 1 - pulsed << ' ' << pulsed << ' ' << delay
             << ' ' << edge << ' ' << edge << ' ' << length << ' ' << period << ")\n";
      }
      deck << 'C' << name << ' ' << name << "c " << below << ' ' << 4e-3 * submodules / 10.0 << " ic=" << link / submodules << "\nSt"
           << name << ' ' << name << "c " << above << ' ' << name << "g 0 SW\nSb" << name << ' ' << above << ' ' << below << ' ' << name
           << "h 0 SW\nDt" << name << ' ' << above << ' ' << name << "c DI\nDb" << name << ' ' << below << ' ' << above << " DI\n";
    }
  deck << "LU ua o 3m\nLL o la 3m\nRO o x 10\nLO x 0 5m\n.model DI D\n.model SW SW(Ron=1m Roff=1meg Vt=0.5 Vh=0)\n"
       << ".save v(U0c,U1) v(p,ua) i(LO) i(LU)\n";
  return deck.str();
}

/// The first row, or the last, without its time.
std::vector<double> row_of(const std::filesystem::path& csv, bool last) {
  std::ifstream file(csv);
  std::string line, kept;
  std::getline(file, line);
  while (std::getline(file, line)) {
    kept = line;
    if (!last) break;
  }
  std::istringstream fields(kept);
  std::vector<double> values;
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
  REQUIRE(values.size() > 1);
  values.erase(values.begin());
  return values;
}

/// kind, name → re, im of the references of 20 digits.
struct Reference {
  std::map<std::string, double> states;
  std::vector<std::complex<double>> multipliers;
};

Reference reference_of(const std::filesystem::path& deck) {
  Reference reference;
  std::ifstream file(deck.parent_path() / "references" / (deck.stem().string() + ".csv"));
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string kind, name, re, im;
    std::getline(fields, kind, ',');
    std::getline(fields, name, ',');
    std::getline(fields, re, ',');
    std::getline(fields, im, ',');
    if (kind == "state") reference.states[name] = std::stod(re);
    if (kind == "multiplier") reference.multipliers.emplace_back(std::stod(re), im.empty() ? 0.0 : std::stod(im));
  }
  return reference;
}

double nearest(const std::vector<std::complex<double>>& list, std::complex<double> value) {
  double least = INFINITY;
  for (const auto& each : list) least = std::min(least, std::abs(each - value));
  return least;
}

}  // namespace

TEST_CASE("orbits by Krylov segments have the states and multipliers of the references", "[regression]") {
  // References: validation/steady_state/references.py, 20 digits, without this program.
  const std::filesystem::path folder = std::filesystem::path(PWLSIM_SOURCE_DIR) / "validation/steady_state";
  const std::string name =
      GENERATE("boost", "boost_discontinuous", "buck", "buck_boost", "buck_discontinuous", "buck_guess_continuous", "charge_pump",
               "cockcroft_walton", "cuk", "flyback_clamp", "freewheel", "half_wave", "input_filter", "inverter", "llc", "modulator",
               "rc_square", "resonant_rectifier", "rl_rectifier", "series_resonant", "six_pulse");
  INFO(name);
  const Reference reference = reference_of(folder / (name + ".net"));
  REQUIRE_FALSE(reference.states.empty());
  const Scratch scratch;
  std::filesystem::copy_file(folder / (name + ".net"), scratch.path() / "deck.net");
  const Finished finished = run_in(scratch, {"deck.net", "--json", "--engine", "krylov"});
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  const Json pss = read_json(finished.out)["pss"];
  CHECK(pss["all_multipliers"].truth == false);
  CHECK(pss["stability"].string == "stable");
  // At rest a state is as small as rounding makes it: they are compared with the largest, a current with 1/50 Ω of the largest voltage at least.
  double largest = 0.0;
  for (const auto& [state, value] : reference.states) largest = std::max(largest, std::abs(value));
  for (const Json& state : pss["states"].array) {
    const auto known = reference.states.find(state["name"].string);
    if (known == reference.states.end()) continue;
    INFO(known->first);
    CHECK(std::abs(state["value"].number - known->second) <= 1e-9 * std::max(largest, 1e-3));
  }
  std::vector<std::complex<double>> found;
  for (const Json& m : pss["multipliers"].array) {
    found.emplace_back(m["re"].number, m["im"].number);
    if (std::abs(found.back()) > 1e-7) CHECK(nearest(reference.multipliers, found.back()) <= 1e-8);
  }
  for (const auto& each : reference.multipliers)
    if (std::abs(each) > 1e-3 && (found.size() < 6 || std::abs(each) > std::abs(found.back()) + 1e-7)) CHECK(nearest(found, each) <= 1e-8);
}

TEST_CASE("an RC ladder of 120 sections: multipliers are those of its eigenvalues, in closed form", "[unit]") {
  // n sections of R and C, fed at one end: λ_k = −(4/RC) sin²((2k − 1)π/(4n + 2)); multipliers e^{λ_k T}. The mean at the end is that of the source.
  constexpr int n = 120;
  constexpr double rc = 1e-6, period = 1e-3;
  std::ostringstream deck;
  deck << "ladder\nV1 n0 0 PULSE(0 1 0 0 0 0.25m 1m)\n";
  for (int k = 1; k <= n; ++k) deck << "R" << k << " n" << k - 1 << " n" << k << " 1\nC" << k << " n" << k << " 0 1u\n";
  deck << ".pss\n.meas pss mean AVG v(n" << n << ")\n.save v(n" << n << ")\n.end\n";
  const Scratch scratch;
  const Json result = result_of(scratch, deck.str());
  const Json& pss = result["pss"];
  CHECK(pss["all_multipliers"].truth == false);
  CHECK(measured(result, "mean") == Approx(0.25).epsilon(1e-9));
  const auto& multipliers = pss["multipliers"].array;
  REQUIRE(multipliers.size() >= 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const double sine = std::sin((2.0 * static_cast<double>(k) + 1.0) * std::numbers::pi / (4.0 * n + 2.0));
    CHECK(std::abs(multipliers[k]["re"].number - std::exp(-4.0 / rc * sine * sine * period)) <= 1e-9);
    CHECK(multipliers[k]["im"].number == 0.0);
  }
}

/// No capacitor gains charge over a period, so that the columns pass on, from stage to stage, what the load takes: every diode carries the mean of the load current.
void check_balance_of_charge(const Json& result, int stages) {
  const Json& pss = result["pss"];
  CHECK(pss["residual"].number <= 1e-12);
  CHECK(pss["stability"].string == "stable");
  const double load = measured(result, "load");
  CHECK(load > 1e-4);
  for (int n = 1; n <= stages; ++n) {
    INFO(n);
    CHECK(measured(result, "qa" + std::to_string(n)) == Approx(load).epsilon(1e-7));
    CHECK(measured(result, "qb" + std::to_string(n)) == Approx(load).epsilon(1e-7));
  }
}

TEST_CASE("a Cockcroft-Walton of 26 stages on its orbit: every diode carries the mean of the load current", "[unit]") {
  constexpr int stages = 26;
  const Scratch scratch;
  const Json result = result_of(scratch, cockcroft_walton(stages));
  CHECK(result["pss"]["all_multipliers"].truth == false);
  check_balance_of_charge(result, stages);
}

TEST_CASE("where segments run a circuit, dense modes begin on the orbit that these find", "[unit]") {
  constexpr int stages = 28;
  std::string deck = cockcroft_walton(stages);
  deck.replace(deck.find("SIN(0 100 50)"), 13, "SIN(0 100 50) ac 1");
  deck.replace(deck.find(".pss uic"), 8, ".pss uic\n.ac lin 1 1k 1k");
  const Scratch scratch;
  const Json result = result_of(scratch, deck);
  CHECK(result["pss"]["all_multipliers"].truth == true);
  check_balance_of_charge(result, stages);
}

// From nine tenths of its charge the map of a period has a kink every few steps, between which Newton's method on dense modes goes to and fro. The orbit is that of the same circuit from empty
// stores, from which dense modes find it by themselves.
TEST_CASE("dense modes begin once more on the orbit of segments where they find none", "[unit]") {
  const std::string deck = without(cockcroft_walton(17), ".meas pss q");
  const Scratch scratch;
  const Json result = result_of(scratch, deck);
  CHECK(result["pss"]["all_multipliers"].truth == true);
  CHECK(result["pss"]["residual"].number <= 1e-12);
  CHECK(measured(result, "load") == Approx(measured(result_of(scratch, without(deck, " ic=")), "load")).epsilon(1e-10));
}

TEST_CASE("a run by Krylov segments begins on the orbit and stays there", "[unit]") {
  std::string deck = cockcroft_walton(6);
  deck.replace(deck.find(".pss uic"), 8, ".pss uic\n.tran 1m 60m");
  const Scratch scratch;
  scratch.write("deck.net", deck);
  const Finished finished = run_in(scratch, {"deck.net", "--engine", "krylov"});
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  std::istringstream rows(read_file(scratch / "deck.csv"));
  std::string line;
  std::getline(rows, line);
  std::vector<double> values;
  while (std::getline(rows, line)) values.push_back(std::stod(line.substr(line.find(',') + 1)));
  REQUIRE(values.size() == 61);
  for (std::size_t k = 0; k + 20 < values.size(); ++k) CHECK(values[k + 20] == Approx(values[k]).epsilon(1e-9));
}

// Charge and flux balance of any orbit; its mean beside that of dense modes, whose search has nothing of the products of segments.
TEST_CASE("a buck with a feedback that may feed energy in has its orbit by Krylov segments", "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "buck\nV1 in 0 12\nS1 in sw g 0 SW\nD1 0 sw DI\nL1 sw o 20u\nC1 o 0 20u\nR1 o 0 2\nE1 f 0 o 0 0.05\nVr r 0 0.8\nB1 c 0 "
      "V=v(r)-v(f)\nV2 w 0 PULSE(0 1 0 9.9u 0.1u 0 10u)\nB2 g 0 V=if(v(c)>v(w),1,0)\n.model SW SW(Ron=10m Roff=inf Vt=0.5)\n.model DI "
      "D(Ron=5m Vfwd=0.4)\n.pss\n.meas pss out AVG v(o)\n.meas pss switched AVG v(sw)\n.meas pss coil AVG i(L1)\n.save v(o) i(L1)\n.end\n";
  const Json segments = result_of(scratch, deck, {"--engine", "krylov"}), modes = result_of(scratch, deck);
  CHECK(measured(segments, "coil") == Approx(measured(segments, "out") / 2.0).epsilon(1e-10));
  CHECK(measured(segments, "switched") == Approx(measured(segments, "out")).epsilon(1e-10));
  CHECK(measured(segments, "out") == Approx(measured(modes, "out")).epsilon(1e-10));
}

TEST_CASE("what Krylov segments do not have around an orbit is refused by name", "[unit]") {
  const Scratch scratch;
  const std::string rectifier = "rectifier\nV1 a 0 SIN(0 10 50) AC 1\nD1 a b DX\nC1 b 0 1m\nR1 b 0 50\n.model DX D\n";
  scratch.write("ac.net", rectifier + ".pss\n.ac lin 3 10 30\n.end\n");
  const Finished response = run_in(scratch, {"ac.net", "--engine", "krylov"});
  CHECK(response.status == 2);
  CHECK_THAT(response.err, Contains("error[E-pss-engine]: small signals around an orbit need dense modes"));
  CHECK_FALSE(std::filesystem::exists(scratch / "ac.csv"));
  scratch.write("sens.net", rectifier + ".pss\n.meas pss mean AVG v(b)\n.sens param=R1\n.end\n");
  const Finished derivative = run_in(scratch, {"sens.net", "--engine", "krylov"});
  CHECK(derivative.status == 0);
  CHECK_THAT(derivative.err, Contains("W-sens-failed"));
  scratch.write("timer.net",
                "relaxation\nV1 p 0 10\nR1 p c 1k\nC1 c 0 1u\nS1 c 0 c 0 SX\n.model SX SW(Vt=4 Vh=2 Ron=10)\n.pss on=S1 uic\n.end\n");
  const Finished timer = run_in(scratch, {"timer.net", "--engine", "krylov"});
  CHECK(timer.status == 1);
  CHECK_THAT(timer.err, Contains("error[E-pss-engine]: without a periodic source"));
}

TEST_CASE("a charge that nothing takes away is told by Krylov segments, too", "[unit]") {
  // A half wave of 1 A adds 2·1 A/(2π·50 Hz) = 6.366 mC to C1, whose diode lets none back.
  const Scratch scratch;
  scratch.write("deck.net", "pump\nI1 0 a SIN(0 1 50)\nD1 a b DX\nD2 0 a DX\nC1 b 0 1\n.model DX D\n.pss\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--engine", "krylov"});
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-pss-not-converged]: no orbit was found: each period still adds 6.36"));
  CHECK_THAT(finished.err, Contains("mC to C1"));
}

TEST_CASE("k=2 of an orbit that repeats sooner is told by Krylov segments, too", "[unit]") {
  const Scratch scratch;
  scratch.write("deck.net", "rc\nV1 a 0 PULSE(0 1 0 0 0 0.5m 1m)\nR1 a b 1k\nC1 b 0 1u\n.pss k=2\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--engine", "krylov"});
  CHECK(finished.status == 0);
  CHECK_THAT(finished.err, Contains("note[N-pss-shorter-period]"));
}

// Expected: where simulation alone ends, by dense modes, which share no segment and no derivative with the search. The grid's largest multiplier is 0.007, the converter's 0.970 (700 periods: 6e-10
// of the first deviation, some volts of 200).
TEST_CASE("orbits of large circuits by Krylov segments are where simulation by dense modes settles", "[regression]") {
  struct Case {
    std::string deck, run;
    double voltage = 0.0, current = 0.0;
  };
  const Case each =
      GENERATE(Case{grid(10, 6), ".tran 1m 100m 90m uic", 10.0, 1.0}, Case{multilevel(4), ".tran 20m 14 13.9 uic", 200.0, 10.0});
  const Scratch scratch;
  const auto row_after = [&](const std::string& analysis, const std::string& engine, bool last) {
    scratch.write("deck.net", each.deck + analysis + "\n.end\n");
    const Finished finished = run_in(scratch, {"deck.net", "--engine", engine, "-o", "rows.csv"});
    INFO(finished.err);
    REQUIRE(finished.status == 0);
    return row_of(scratch.path() / "rows.csv", last);
  };
  const std::vector<double> orbit = row_after(".pss uic", "krylov", false), settled = row_after(each.run, "modes", true);
  REQUIRE(orbit.size() == settled.size());
  for (std::size_t i = 0; i < orbit.size(); ++i) {
    INFO("signal " << i << ": " << orbit[i] << " and " << settled[i]);
    CHECK(std::abs(orbit[i] - settled[i]) <= 1e-9 * (orbit.size() == 4 && i > 1 ? each.current : each.voltage));
  }
}

// Its stages begin to conduct one after the other on the way: the residual rises and falls, and rounding of steps in stages that are still empty must not decide the signs of their diodes.
TEST_CASE("a multiplier of many stages without charge finds its orbit by Krylov segments", "[unit]") {
  const int stages = 50;
  const Scratch scratch;
  const Json result = result_of(scratch, without(cockcroft_walton(stages), " ic="), {"--engine", "krylov"});
  CHECK(result["pss"]["iterations"].number <= 80.0);  // 47 today
  // Charge balance: in a period each capacitor gives what it takes, so every diode passes on what the load takes.
  const double load = measured(result, "load");
  for (int n = 1; n <= stages; ++n)
    for (const char* column : {"qa", "qb"}) CHECK(measured(result, column + std::to_string(n)) / load - 1.0 == Approx(0.0).margin(1e-7));
}
