#pragma once
// A run as commands have it: with its published targets, its notices to systemd, and its report.

#include <memory>
#include <span>
#include <vector>

#include "session/open_hands.hpp"
#include "session/run_publishing.hpp"
#include "session/run_session.hpp"

namespace nendo::session {

/// Does what run_session() does, publishes to `published`, which it ends, and prints the progress
/// and the summary. Notifies systemd that the run lives. `participants.progress` is set here;
/// `grants` are those of the process. Blocks. Errors: those of run_session().
Result<RunOutcome> run_and_report(const RunOptions& options, RunHands& opened, deform::Mesh model,
                                  std::span<const std::unique_ptr<PublishingSink>> published,
                                  RunParticipants participants, std::vector<flow::Grant> grants);

} // namespace nendo::session
