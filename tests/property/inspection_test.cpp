/// What inspect says of random passive networks, against what the run itself uses and against the theory of passive systems.
#include "analysis/inspection.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/json.hpp"
#include "engine/exact/exact.hpp"
#include "model/build_mode.hpp"
#include "model/subspaces.hpp"
#include "property/random_network.hpp"
#include "support/json.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double tight = 1e-9;

/// D1=on and so on for ports picked at random.
analysis::ModeRequest some_mode(const RandomNetwork& network, Random& random) {
  analysis::ModeRequest mode;
  for (const NetworkPart& part : network.parts)
    if (part.kind == NetworkPart::Kind::diode || part.kind == NetworkPart::Kind::switch_) mode.emplace_back(part.name, random.chance(0.5));
  return mode;
}

bool holds_port(const engine::ExactModel& model, const std::string& name) {
  for (const auto& island : model.islands) {
    for (const auto& diode : island.island.network.diodes)
      if (diode.label.name == name) return true;
    for (const auto& contact : island.island.network.switches)
      if (contact.label.name == name) return true;
  }
  return false;
}

/// The KYP inequality with the stored energy itself, [A + Aᵀ, B − Cᵀ; Bᵀ − C, −(D + Dᵀ)] ⪯ 0, each variable scaled to entries of order one.
void check_position(const analysis::PositionView& position) {
  if (!position.problem.empty()) return;
  const auto& s = position.space;
  const auto n = s.a.rows(), k = s.d.rows();
  const double rate = std::max(linalg::spectral_norm(s.a), 1e-300);
  model::Matrix kyp(n + k, n + k);
  kyp << s.a + s.a.transpose(), s.b - s.c.transpose(), s.b.transpose() - s.c, -(s.d + s.d.transpose());
  model::Vector scale = model::Vector::Constant(n + k, 1.0 / std::sqrt(rate));
  for (Eigen::Index j = 0; j < k; ++j) {
    const double size = std::max({std::abs(s.d(j, j)), s.b.col(j).squaredNorm() / rate, s.c.row(j).squaredNorm() / rate});
    scale[n + j] = size > 0.0 ? 1.0 / std::sqrt(size) : 1.0;
  }
  CHECK(linalg::logarithmic_norm(scale.asDiagonal() * kyp * scale.asDiagonal()) <= tight);
  if (!position.ports.empty()) CHECK(position.certificate.kind == analysis::CertificateKind::passive);
}

/// The mode that a run builds, by factorisations, has the dimension of V, by its recursion.
void check_dimensions(const model::System& system, Random& random) {
  model::IndexSet active(system.ports);
  for (int i = 0; i < system.ports; ++i) active.set(i, random.chance(0.5));
  const auto mode = model::build_mode(system, active);
  if (!mode->regular) return;
  const model::Subspaces subspaces = model::subspaces_without_sources(system, active);
  CHECK(subspaces.regular);
  CHECK(subspaces.dim_v == mode->n1);
}

void check_mode(const analysis::IslandView& island) {
  const analysis::ModeView& mode = *island.mode;
  CHECK(mode.states == static_cast<int>(island.states));
  if (mode.complementary) CHECK(mode.consistent + mode.jump == mode.states);
  if (mode.well_posed) CHECK(mode.complementary);
}

}  // namespace

TEST_CASE("inspect agrees with the theory of passive networks", "[property]") {
  Recipe recipe;
  recipe.spread = GENERATE(1.0, 3.0);
  recipe.switch_ = 2.0;
  int positions = 0, modes = 0;
  for (std::uint64_t seed = 60'001; seed <= 60'200; ++seed) {
    const RandomNetwork network = make_random_network(seed, recipe);
    Diagnostics diagnostics;
    circuit::Compiled compiled;
    compiled.network = to_model(network);
    const auto model = engine::prepare(compiled.network, diagnostics);
    if (!model) continue;
    INFO("seed " << seed << "\n" << to_deck(network));
    Random random(seed);
    analysis::ModeRequest mode = some_mode(network, random);
    std::erase_if(mode, [&](const auto& item) { return !holds_port(*model, item.first); });
    const auto inspection = analysis::inspect(compiled, *model, mode, diagnostics);
    REQUIRE(inspection);
    for (const auto& island : inspection->islands) {
      for (const auto& position : island.positions) check_position(position);
      check_mode(island);
      positions += static_cast<int>(island.positions.size());
      modes += island.mode->well_posed ? 1 : 0;
    }
    for (const auto& island : model->islands)
      for (int k = 0; k < 4; ++k) check_dimensions(island.extraction.system, random);
    CHECK(read_json(analysis::inspection_json(*inspection))["islands"].array.size() == inspection->islands.size());
  }
  CHECK(positions > 200);
  CHECK(modes > 100);
}
