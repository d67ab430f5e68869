#include "convert.hpp"

namespace pwlsim::python {
namespace {

using Names = const std::vector<std::string>&;
using Text = const std::string&;

/// A pair of nodes, a value, further parameters.
template <class Given>
auto two_nodes(Circuit& (Circuit::*add)(std::string_view, std::string_view, std::string_view, const Given&, const Parameters&)) {
  return [add](Circuit& self, Text name, Text p, Text n, const py::object& value, const py::dict& more) {
    (self.*add)(name, p, n, value_of(value), parameters_of(more));
  };
}

/// Two pairs of nodes and a gain.
auto four_nodes(Circuit& (Circuit::*add)(std::string_view, std::string_view, std::string_view, std::string_view, std::string_view,
                                         const Value&)) {
  return [add](Circuit& self, Text name, Text p, Text n, Text cp, Text cn, const py::object& gain) {
    (self.*add)(name, p, n, cp, cn, value_of(gain));
  };
}

auto by_current(Circuit& (Circuit::*add)(std::string_view, std::string_view, std::string_view, std::string_view, const Value&)) {
  return [add](Circuit& self, Text name, Text p, Text n, Text element, const py::object& gain) {
    (self.*add)(name, p, n, element, value_of(gain));
  };
}

void bind_elements(py::class_<Circuit>& circuit) {
  circuit.def("resistor", two_nodes(&Circuit::resistor))
      .def("capacitor", two_nodes(&Circuit::capacitor))
      .def("inductor", two_nodes(&Circuit::inductor))
      .def("voltage_source", two_nodes(&Circuit::voltage_source))
      .def("current_source", two_nodes(&Circuit::current_source))
      .def("coupling", [](Circuit& self, Text name, Names inductors, const py::object& k) { self.coupling(name, inductors, value_of(k)); })
      .def("diode", [](Circuit& self, Text name, Text a, Text k, Text model,
                       const py::dict& more) { self.diode(name, a, k, model, parameters_of(more)); })
      .def("voltage_switch", [](Circuit& self, Text name, Text p, Text n, Text cp, Text cn, Text model,
                                bool on) { self.voltage_switch(name, p, n, cp, cn, model, on); })
      .def("current_switch", [](Circuit& self, Text name, Text p, Text n, Text element, Text model,
                                bool on) { self.current_switch(name, p, n, element, model, on); })
      .def("voltage_controlled_voltage", four_nodes(&Circuit::voltage_controlled_voltage))
      .def("voltage_controlled_current", four_nodes(&Circuit::voltage_controlled_current))
      .def("current_controlled_voltage", by_current(&Circuit::current_controlled_voltage))
      .def("current_controlled_current", by_current(&Circuit::current_controlled_current))
      .def("expression_voltage", [](Circuit& self, Text name, Text p, Text n, Text e) { self.expression_voltage(name, p, n, e); })
      .def("expression_current", [](Circuit& self, Text name, Text p, Text n, Text e) { self.expression_current(name, p, n, e); })
      .def("subcircuit", [](Circuit& self, Text name, Names nodes, Text definition, const py::dict& more) {
        self.subcircuit(name, nodes, definition, parameters_of(more));
      });
}

void bind_cards(py::class_<Circuit>& circuit) {
  circuit
      .def("model",
           [](Circuit& self, Text name, Text type, const py::dict& parameters) { self.model(name, type, parameters_of(parameters)); })
      .def("parameter", [](Circuit& self, Text name, const py::object& value) { self.parameter(name, value_of(value)); })
      .def("option", [](Circuit& self, Text name, const py::object& value) { self.option(name, value_of(value)); })
      .def("initial_voltage", [](Circuit& self, Text node, const py::object& value) { self.initial_voltage(node, value_of(value)); })
      .def("initial_current",
           [](Circuit& self, Text inductor, const py::object& value) { self.initial_current(inductor, value_of(value)); })
      .def("save", [](Circuit& self, Names signals) { self.save(signals); })
      .def("measure", [](Circuit& self, Text name, Text what) { self.measure(name, what); })
      .def("cards", [](Circuit& self, Text lines) { self.cards(lines); })
      .def("set_value", [](Circuit& self, Text element, const py::object& value) { self.set_value(element, value_of(value)); })
      .def("value", [](const Circuit& self, Text element) { return self.value(element); })
      .def("elements", [](const Circuit& self) { return self.elements(); })
      .def("text", &Circuit::text);
}

std::string sine_text(const py::list& v) {
  return sine({value_of(v[0]), value_of(v[1]), value_of(v[2]), value_of(v[3]), value_of(v[4]), value_of(v[5])}).text();
}

std::string pulse_text(const py::list& v) {
  return pulse({value_of(v[0]), value_of(v[1]), value_of(v[2]), value_of(v[3]), value_of(v[4]), value_of(v[5]), value_of(v[6])}).text();
}

}  // namespace

void bind_circuit(py::module_& module) {
  py::class_<Circuit> circuit(module, "Circuit");
  circuit.def(py::init<std::string>()).def_static("from_file", &Circuit::from_file).def_static("from_text", &Circuit::from_text);
  circuit.def("copy", [](const Circuit& self) { return self; });
  bind_elements(circuit);
  bind_cards(circuit);
  bind_running(circuit);
  bind_controller(circuit);
  bind_gradient(circuit);
  module.def("sine", &sine_text);
  module.def("pulse", &pulse_text);
  module.def("straight_lines",
             [](const std::vector<std::pair<double, double>>& points, bool repeat) { return straight_lines(points, repeat).text(); });
}

}  // namespace pwlsim::python
