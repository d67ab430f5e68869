#include "convert.hpp"

namespace pwlsim::python {
namespace {

py::tuple tuple_of(const std::vector<std::string>& names) {
  py::tuple tuple(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) tuple[k] = names[k];
  return tuple;
}

/// Columns of the events: time, three flags, names that turned on and off.
py::tuple events_of(const Result& result) {
  const std::size_t count = result.events().size();
  std::vector<double> time;
  py::array_t<bool> edge(count), mode(count), jump(count);
  py::list on, off;
  for (std::size_t k = 0; k < count; ++k) {
    const Event& event = result.events()[k];
    time.push_back(event.time);
    edge.mutable_at(k) = event.source_edge;
    mode.mutable_at(k) = event.mode_change;
    jump.mutable_at(k) = event.jump;
    on.append(tuple_of(event.turned_on));
    off.append(tuple_of(event.turned_off));
  }
  return py::make_tuple(array_of(std::move(time)), edge, mode, jump, on, off);
}

py::list measurements_of(const Result& result) {
  py::list list;
  for (const Measurement& each : result.measurements())
    list.append(py::make_tuple(each.name, each.value, each.unit, each.failure, each.left_out));
  return list;
}

py::list fourier_of(const Result& result) {
  py::list list;
  for (const Fourier& each : result.fourier()) {
    std::vector<double> frequency, magnitude, phase;
    for (const auto& h : each.harmonics) {
      frequency.push_back(h.frequency);
      magnitude.push_back(h.magnitude);
      phase.push_back(h.phase);
    }
    list.append(py::make_tuple(each.signal, array_of(frequency), array_of(magnitude), array_of(phase), each.distortion, each.failure));
  }
  return list;
}

py::tuple certificate_of(const Result& result) {
  const Certificate& c = result.certificate();
  return py::make_tuple(c.complementarity, c.kcl_kvl, c.energy, c.passive);
}

py::tuple statistics_of(const Result& result) {
  const Statistics& s = result.statistics();
  return py::make_tuple(s.engine, s.states, s.ports, s.switches, s.modes_visited, s.events, s.jumps, s.seconds);
}

std::vector<double> at(const Result& result, const std::string& name, const std::vector<double>& times) {
  const py::gil_scoped_release released;
  return result.at(name, times);
}

std::string report(const Result& result) {
  const py::gil_scoped_release released;
  return result.report();
}

}  // namespace

void bind_result(py::module_& module) {
  py::class_<Result>(module, "Result")
      .def_property_readonly("completed", &Result::completed)
      .def_property_readonly("end", &Result::end)
      .def_property_readonly("time", [](const py::object& self) { return view_of(self.cast<const Result&>().time(), self); })
      .def_property_readonly("signals", [](const Result& self) { return tuple_of(self.signals()); })
      .def("signal", [](const py::object& self, const std::string& name) { return view_of(self.cast<const Result&>().signal(name), self); })
      .def("has_signal", &Result::has_signal)
      .def("at",
           [](const Result& self, const std::string& name, const std::vector<double>& times) { return array_of(at(self, name, times)); })
      .def("report", &report)
      .def_property_readonly("events", &events_of)
      .def_property_readonly("on_at_start", [](const Result& self) { return tuple_of(self.on_at_start()); })
      .def_property_readonly("measurements", &measurements_of)
      .def_property_readonly("fourier", &fourier_of)
      .def_property_readonly("certificate", &certificate_of)
      .def_property_readonly("statistics", &statistics_of)
      .def_property_readonly("messages", [](const Result& self) { return list_of(self.messages()); })
      .def_property_readonly("stepped", &Result::stepped);
}

}  // namespace pwlsim::python
