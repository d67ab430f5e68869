#include <atomic>

#include "convert.hpp"
#include "watched.hpp"

namespace pwlsim::python {
namespace {

/// (parameter, value, normalised, left, right, kink, failure).
py::list derivatives_of(const Gradient& gradient) {
  py::list list;
  for (const Derivative& each : gradient.derivatives)
    list.append(py::make_tuple(each.parameter, each.value, each.normalised, each.left, each.right, each.kink, each.failure));
  return list;
}

/// (measurement, its value, derivatives, messages), one a measurement.
py::list gradients(const Circuit& circuit, const std::vector<std::string>& measurements, const std::vector<std::string>& parameters,
                   const py::dict& given) {
  Options options = options_of(given);
  std::atomic<int> flag = 0;
  options.interrupt = &flag;
  const std::vector<Gradient> found = watched(
      flag, [&] { return circuit.gradients(measurements, parameters, options); }, [] {});
  py::list list;
  for (const Gradient& each : found)
    list.append(py::make_tuple(each.measurement, each.measured, derivatives_of(each), list_of(each.messages)));
  return list;
}

}  // namespace

void bind_gradient(py::class_<Circuit>& circuit) { circuit.def("gradients", &gradients); }

}  // namespace pwlsim::python
