#pragma once
/// Calls that tell of no progress of their own, under the signals of Python.

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <utility>

#include "convert.hpp"

namespace pwlsim::python {

/// `call` in a thread of its own, while this one sees to the signals of Python and calls `look` now and then. What these raise sets `flag`, and is thrown
/// once the call has ended.
template <class Call, class Look>
auto watched(std::atomic<int>& flag, const Call& call, const Look& look) {
  constexpr std::chrono::milliseconds pause{50};
  auto pending = std::async(std::launch::async, call);
  const auto is_done = [&] {
    const py::gil_scoped_release released;
    return pending.wait_for(pause) == std::future_status::ready;
  };
  std::optional<py::error_already_set> raised;
  while (!is_done()) {
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      look();
    } catch (py::error_already_set& error) {
      raised.emplace(std::move(error));
      flag.store(1);
    }
  }
  if (!raised) return pending.get();
  try {
    (void)pending.get();
  } catch (const Error&) {  // E-interrupted
  }
  throw std::move(*raised);
}

}  // namespace pwlsim::python
