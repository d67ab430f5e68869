#include "cli/analysis_session.hpp"

#include <fmt/format.h>

namespace pwlsim::cli {

std::vector<std::unique_ptr<AnalysisSession>> analysis_sessions(const circuit::Analyses& analyses) {
  std::vector<std::unique_ptr<AnalysisSession>> asked;
  for (const auto make : {operating_point_session, orbit_session, small_signal_session, transient_session, sensitivity_session})
    if (auto session = make(); session->is_asked(analyses)) asked.push_back(std::move(session));
  return asked;
}

int write_picture(PictureFile& file, const std::string& svg, RunContext& run, std::string& noted) {
  const int status = file.write(svg, run.messages);
  if (status != 0) return status;
  noted = file.name();
  run.messages.remark(fmt::format("wrote {}\n", noted));
  return 0;
}

}  // namespace pwlsim::cli
