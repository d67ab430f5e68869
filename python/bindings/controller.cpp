#include <algorithm>
#include <exception>
#include <memory>

#include "convert.hpp"

namespace pwlsim::python {
namespace {

/// A function of Python, called by a run that has released the interpreter: time and inputs as arguments, outputs as what it returns.
class SampledFunction {
 public:
  SampledFunction(py::object function, std::size_t inputs) : function_(std::move(function)), arguments_(inputs + 1) {}
  SampledFunction(const SampledFunction&) = delete;
  SampledFunction& operator=(const SampledFunction&) = delete;
  ~SampledFunction() {
    const py::gil_scoped_acquire acquired;
    function_ = {};
  }

  void call(double time, const std::vector<double>& inputs, std::vector<double>& outputs) const {
    const py::gil_scoped_acquire acquired;
    std::vector<py::object> arguments;
    arguments.reserve(arguments_);
    arguments.push_back(number(time));
    for (const double input : inputs) arguments.push_back(number(input));
    std::vector<PyObject*> pointers;
    pointers.reserve(arguments_);
    for (const py::object& argument : arguments) pointers.push_back(argument.ptr());
    const auto answer = py::reinterpret_steal<py::object>(PyObject_Vectorcall(function_.ptr(), pointers.data(), pointers.size(), nullptr));
    if (!answer) throw py::error_already_set();
    take(answer, outputs);
  }

 private:
  static py::object number(double value) { return py::reinterpret_steal<py::object>(PyFloat_FromDouble(value)); }

  static double value_of_output(const py::handle& object) {
    const double value = PyFloat_AsDouble(object.ptr());
    if (value == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
    return value;
  }

  /// A number, a sequence of numbers, or None: the outputs stay.
  static void take(const py::object& answer, std::vector<double>& outputs) {
    if (answer.is_none()) return;
    if (outputs.size() == 1 && (PyFloat_Check(answer.ptr()) || PyNumber_Check(answer.ptr()))) {
      outputs[0] = value_of_output(answer);
      return;
    }
    const py::object list =
        py::reinterpret_steal<py::object>(PySequence_Fast(answer.ptr(), "a controller returns a number, a sequence of numbers, or None"));
    if (!list) throw py::error_already_set();
    const auto count = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(list.ptr()));
    if (count != outputs.size()) {
      PyErr_Format(PyExc_ValueError, "a controller of %zu outputs returned %zu values", outputs.size(), count);
      throw py::error_already_set();
    }
    for (std::size_t k = 0; k < count; ++k) outputs[k] = value_of_output(PySequence_Fast_GET_ITEM(list.ptr(), static_cast<Py_ssize_t>(k)));
  }

  py::object function_;
  std::size_t arguments_;
};

void add_controller(Circuit& circuit, const std::vector<std::string>& inputs, const std::vector<std::string>& outputs, double every,
                    double delay, const std::vector<double>& initial, const py::object& function) {
  const auto sampled = std::make_shared<const SampledFunction>(function, inputs.size());
  circuit.controller(
      {inputs, outputs, every, delay, initial,
       [sampled](double time, const std::vector<double>& seen, std::vector<double>& set) { sampled->call(time, seen, set); }});
}

}  // namespace

py::object cause_of(const RunError& error) {
  try {
    std::rethrow_if_nested(error);
  } catch (const py::error_already_set& raised) {
    const py::object value = raised.value();
    if (raised.trace()) PyException_SetTraceback(value.ptr(), raised.trace().ptr());
    return value;
  } catch (const std::exception& other) {
    return py::reinterpret_borrow<py::object>(PyExc_RuntimeError)(other.what());
  } catch (...) {
  }
  return py::none();
}

void bind_controller(py::class_<Circuit>& circuit) { circuit.def("controller", &add_controller); }

}  // namespace pwlsim::python
