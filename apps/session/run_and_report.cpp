#include "session/run_and_report.hpp"

#include <utility>

#include "service/service_notice.hpp"

namespace nendo::session {

Result<RunOutcome> run_and_report(const RunOptions& options, RunHands& opened, deform::Mesh model,
                                  std::span<const std::unique_ptr<PublishingSink>> published,
                                  RunParticipants participants, std::vector<flow::Grant> grants) {
  service::ServiceNotice service;
  participants.progress = [&service, shown = progress_for(options, opened.hands)](
                              const flow::Frame& frame, double elapsed_s) {
    service.alive();
    shown(frame, elapsed_s);
  };
  for (const auto& sink : published)
    participants.sinks.push_back(sink.get());
  grants.insert(grants.end(), opened.grants.begin(), opened.grants.end());
  auto outcome =
      run_session(options, opened.hands, std::move(model), participants, std::move(grants));
  if (!outcome) return outcome.error();
  for (const auto& sink : published)
    outcome->published.push_back(sink->end());
  print_summary(options, opened.hands, *outcome);
  return outcome;
}

} // namespace nendo::session
