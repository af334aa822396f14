#pragma once
// The keys of a run: what they are, and what they ask of the loop.

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/save_request.hpp>

#include "cli/keys.hpp"
#include "session/run_recording.hpp"

namespace nendo::session {

class RunKeys {
public:
  /// Asks in options.loop.requests; saved shapes are called as options.out and numbered. All must
  /// outlive this. Says on standard error what the keys are, if any can come.
  RunKeys(const RunOptions& options, const deform::Mesh& model, RunRecorder& recorder);

  /// Waits so long for a key, and does what it stands for; the user sees the frame at the front.
  /// False: the run is to end.
  bool handle(std::chrono::milliseconds patience, flow::DeformLoop& loop);
  /// What keys want kept, since the last call.
  flow::SaveRequest next_save_request() noexcept { return std::exchange(wanted_, {}); }
  /// Keeps it; what became of that, which standard error tells, too.
  std::string keep(const flow::SaveRequest& wanted, flow::DeformLoop& loop);

private:
  void ask(flow::Request request);
  std::string save(flow::DeformLoop& loop);
  std::string keep_recording();
  void wait_until_heard() const;

  cli::Keys keys_;
  flow::RequestRing& requests_;
  const deform::Mesh& model_;
  std::string out_;
  RunRecorder& recorder_;
  flow::SaveRequest wanted_;
  int saved_ = 0;
};

} // namespace nendo::session
