#include "convert.hpp"

namespace pwlsim::python {

Value value_of(const py::handle& object) {
  if (py::isinstance<py::str>(object)) return Value(object.cast<std::string>());
  if (PyFloat_Check(object.ptr())) return Value(PyFloat_AS_DOUBLE(object.ptr()));
  const py::object number = py::reinterpret_steal<py::object>(PyNumber_Float(object.ptr()));
  if (!number) throw py::error_already_set();
  return Value(number.cast<double>());
}

Parameters parameters_of(const py::dict& more) {
  Parameters parameters;
  for (const auto& [name, value] : more) parameters.emplace_back(name.cast<std::string>(), value_of(value));
  return parameters;
}

py::list list_of(const std::vector<Message>& messages) {
  py::list list;
  for (const Message& message : messages) {
    const char* const kind = message.kind == Message::Kind::error ? "error" : message.kind == Message::Kind::warning ? "warning" : "note";
    list.append(py::make_tuple(kind, message.id, message.text, message.full));
  }
  return list;
}

namespace {

/// The exceptions are classes of Python (pwlsim/errors.py), made where the package has been imported.
void raise(const char* maker, const py::list& messages, const py::object& result, const py::object& cause = py::none()) {
  const py::object error = py::module_::import("pwlsim.errors").attr(maker)(messages, result);
  if (!cause.is_none()) PyException_SetCause(error.ptr(), cause.inc_ref().ptr());
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

}  // namespace

void bind_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const RunError& error) {
      raise("_run_error", list_of(error.messages()), py::cast(error.result()), cause_of(error));
    } catch (const Error& error) {
      raise("_error", list_of(error.messages()), py::none());
    }
  });
}

}  // namespace pwlsim::python

PYBIND11_MODULE(_core, module) {
  using namespace pwlsim::python;
  module.doc() = "The library of pwlsim as Python sees it; use the package pwlsim.";
  module.attr("version") = pwlsim::version();
  bind_errors(module);
  bind_result(module);
  bind_circuit(module);
  bind_sweep(module);
}
