#include "analysis/inspection.hpp"
#include "analysis/json.hpp"

namespace pwlsim::analysis {
namespace {

using model::Matrix;

std::string names_line(const std::vector<std::string>& names) {
  std::vector<std::string> members;
  for (const std::string& name : names) members.push_back(json_string(name));
  return json_line(members);
}

void write_matrix(JsonWriter& json, const Matrix& m) {
  json.begin_array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    std::vector<std::string> row;
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(json_number(m(i, j)));
    json.value(json_line(row));
  }
  json.end_array();
}

void write_matrix(JsonWriter& json, std::string_view name, const Matrix& m) {
  json.key(name);
  write_matrix(json, m);
}

void write_states(JsonWriter& json, const std::vector<model::EnergyState>& states) {
  json.key("states");
  json.begin_array();
  for (const auto& state : states) {
    std::vector<std::string> terms;
    for (const auto& term : state.terms)
      terms.push_back(json_line({{"element", json_string(term.element)},
                                 {"quantity", json_string(term.is_voltage ? "voltage" : "current")},
                                 {"coefficient", json_number(term.coefficient)}}));
    json.value(json_line(terms));
  }
  json.end_array();
}

void write_ports(JsonWriter& json, const std::vector<PortView>& ports) {
  json.key("ports");
  json.begin_array();
  for (const PortView& port : ports) {
    const char* current = port.is_diode ? "current" : "multiplier";
    const char* voltage = port.is_diode ? "blocking voltage" : "slack";
    json.value(json_line({{"name", json_string(port.name)},
                          {"u", json_string(port.input_is_current ? current : voltage)},
                          {"y", json_string(port.input_is_current ? voltage : current)}}));
  }
  json.end_array();
}

std::string order_text(int order) { return order < 0 ? "null" : std::to_string(order); }

void write_markov(JsonWriter& json, const model::Markov& markov) {
  json.key("markov_parameters");
  json.begin_array();
  for (const Matrix& parameter : markov.parameters) write_matrix(json, parameter);
  json.end_array();
  json.key("relative_degree");
  json.begin_object();
  json.member("uniform", order_text(markov.uniform_degree));
  json.key("pairs");
  json.begin_array();
  for (const auto& row : markov.degree) {
    std::vector<std::string> members;
    for (const int order : row) members.push_back(order_text(order));
    json.value(json_line(members));
  }
  json.end_array();
  json.end_object();
}

const char* kind_name(CertificateKind kind) {
  switch (kind) {
    case CertificateKind::no_ports:
      return "no ports";
    case CertificateKind::passive:
      return "passive";
    case CertificateKind::principal_minors:
      return "principal minors";
    case CertificateKind::none:
      break;
  }
  return "not certified";
}

void write_certificate(JsonWriter& json, const CertificateView& certificate) {
  json.key("certificate");
  json.begin_object();
  json.member("kind", json_string(kind_name(certificate.kind)));
  json.member("solution_unique", certificate.kind == CertificateKind::none ? "null" : "true");
  json.member("solution_exists", certificate.always_solvable ? "true" : "null");
  json.member("kyp_residual", json_number(certificate.kyp_residual));
  json.end_object();
}

void write_switches(JsonWriter& json, const std::vector<std::string>& names, const std::vector<char>& on) {
  json.key("switches");
  json.begin_object();
  for (std::size_t i = 0; i < names.size(); ++i) json.member(names[i], json_string(on[i] != 0 ? "on" : "off"));
  json.end_object();
}

void write_position(JsonWriter& json, const IslandView& island, const PositionView& position) {
  json.begin_object();
  write_switches(json, island.switches, position.on);
  json.member("start", json_truth(position.of_start));
  json.member("problem", position.problem.empty() ? "null" : json_string(position.problem));
  if (position.problem.empty()) {
    write_states(json, position.space.states);
    write_ports(json, position.ports);
    write_matrix(json, "A", position.space.a);
    write_matrix(json, "B", position.space.b);
    write_matrix(json, "C", position.space.c);
    write_matrix(json, "D", position.space.d);
    write_markov(json, position.markov);
    write_certificate(json, position.certificate);
  }
  json.end_object();
}

void write_mode(JsonWriter& json, const ModeView& mode) {
  json.key("mode");
  json.begin_object();
  json.member("on", names_line(mode.on));
  json.member("states", std::to_string(mode.states));
  json.member("consistent_dimension", std::to_string(mode.consistent));
  json.member("jump_dimension", std::to_string(mode.jump));
  json.member("complementary", json_truth(mode.complementary));
  json.member("well_posed", json_truth(mode.well_posed));
  json.member("indeterminate", names_line(mode.indeterminate));
  json.end_object();
}

void write_island(JsonWriter& json, const IslandView& island) {
  json.begin_object();
  json.member("name", json_string(island.name));
  json.member("elements", names_line(island.elements));
  json.member("states", std::to_string(island.states));
  json.member("ports", std::to_string(island.ports));
  json.member("switches", names_line(island.switches));
  json.member("positions_in_all", json_number(island.positions_in_all));
  json.key("positions");
  json.begin_array();
  for (const PositionView& position : island.positions) write_position(json, island, position);
  json.end_array();
  if (island.mode) write_mode(json, *island.mode);
  json.end_object();
}

}  // namespace

std::string inspection_json(const Inspection& inspection) {
  JsonWriter json;
  json.begin_object();
  json.member("title", json_string(inspection.title));
  json.key("islands");
  json.begin_array();
  for (const IslandView& island : inspection.islands) write_island(json, island);
  json.end_array();
  json.key("left_out");
  json.begin_array();
  for (const auto& names : inspection.left_out) {
    json.begin_object();
    json.member("elements", names_line(names));
    json.member("reason", json_string("no saved signal depends on it"));
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return json.take();
}

}  // namespace pwlsim::analysis
