#pragma once
/// Python objects as the library takes them, and what it gives as Python objects.

#include <pybind11/complex.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <pwlsim/pwlsim.hpp>

#include <memory>
#include <string>
#include <vector>

namespace pwlsim::python {

namespace py = pybind11;

/// A number, taken over to the last bit; a string as a deck has it. TypeError for anything else.
[[nodiscard]] Value value_of(const py::handle& object);
/// The same for a dict of further parameters.
[[nodiscard]] Parameters parameters_of(const py::dict& more);

/// An array of a vector that `owner` keeps alive, without a copy; it cannot be written to.
template <class Number>
[[nodiscard]] py::array view_of(const std::vector<Number>& values, const py::handle& owner) {
  py::array_t<Number> array({values.size()}, {sizeof(Number)}, values.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}
/// An array that takes the vector over.
template <class Number>
[[nodiscard]] py::array_t<Number> array_of(std::vector<Number> values) {
  auto* const kept = new std::vector<Number>(std::move(values));
  const py::capsule owner(kept, [](void* pointer) { delete static_cast<std::vector<Number>*>(pointer); });
  return py::array_t<Number>({kept->size()}, {sizeof(Number)}, kept->data(), owner);
}

/// (kind, id, text, full).
[[nodiscard]] py::list list_of(const std::vector<Message>& messages);

void bind_errors(py::module_& module);
void bind_result(py::module_& module);
void bind_circuit(py::module_& module);
void bind_running(py::class_<Circuit>& circuit);
void bind_gradient(py::class_<Circuit>& circuit);
void bind_controller(py::class_<Circuit>& circuit);
void bind_sweep(py::module_& module);

/// What the function of a controller raised, which ended the run; None: nothing did.
[[nodiscard]] py::object cause_of(const RunError& error);
[[nodiscard]] Options options_of(const py::dict& from);

}  // namespace pwlsim::python
