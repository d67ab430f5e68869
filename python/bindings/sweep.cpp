#include <algorithm>
#include <limits>
#include <tuple>

#include "convert.hpp"
#include "watched.hpp"

namespace pwlsim::python {
namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<std::vector<double>> rows_of(const Points& points) {
  std::vector<std::vector<double>> rows;
  for (py::ssize_t k = 0; k < points.shape(0); ++k) rows.emplace_back(points.data(k, 0), points.data(k, 0) + points.shape(1));
  return rows;
}

/// (measurements of every run, its id, its message); `progress` is called with the number of runs that are done, or is None.
py::tuple run_points(const Sweep& sweep, const Points& points, std::size_t jobs, const py::object& progress) {
  const std::vector<std::vector<double>> rows = rows_of(points);
  std::vector<SweptRun> runs(rows.size());
  std::atomic<std::size_t> done = 0;
  std::atomic<int> flag = 0;
  const auto take = [&](std::size_t number, const SweptRun& run) {
    runs[number] = run;
    ++done;
  };
  watched(
      flag, [&] { run_all(sweep, rows, jobs, take, &flag); },
      [&] {
        if (!progress.is_none()) progress(done.load());
      });
  if (!progress.is_none()) progress(done.load());
  py::list measurements, ids, texts;
  for (SweptRun& run : runs) {
    measurements.append(array_of(std::move(run.measurements)));
    ids.append(run.id);
    texts.append(run.message);
  }
  return py::make_tuple(measurements, ids, texts);
}

}  // namespace

void bind_sweep(py::module_& module) {
  py::class_<Sweep>(module, "Sweep")
      .def(py::init([](const Circuit& circuit, std::vector<std::string> names, const py::dict& options) {
        return Sweep(circuit, std::move(names), options_of(options));
      }))
      .def("run",
           [](const Sweep& self, const std::vector<double>& values, std::size_t number) {
             const py::gil_scoped_release released;
             return self.run(values, number);
           })
      .def("measurements", &Sweep::measurements)
      .def("run_points", &run_points);
}

}  // namespace pwlsim::python
