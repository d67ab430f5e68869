#pragma once
/// A schematic for the page of --report.

#include <string>
#include <vector>

#include "netlist/schematic/drawing.hpp"

namespace pwlsim::cli {

/// {"sheets": […], "places": […]}: the members of DrawnSheet and DrawnPlace, numbers of nets and sheets from 0. Empty if there is no drawing.
[[nodiscard]] std::string schematic_json(const netlist::Drawing& drawing, const std::vector<netlist::DrawnPlace>& places);

}  // namespace pwlsim::cli
