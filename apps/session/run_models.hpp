#pragma once
// Makes other versions of the model while a run goes on, and hands them over to the loop.

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/place_loop.hpp"
#include "session/sink.hpp"

namespace nendo::session {

class RunModels {
public:
  /// Both must outlive this. `placed` has its loop before the first call.
  RunModels(const PlacedLoop& placed, const std::vector<Sink*>& sinks)
      : placed_(placed), sinks_(sinks) {}

  /// Asks for the present model, subdivided.
  void subdivide() noexcept { asked_ = true; }
  /// Goes back, or on, to settings and a version that are kept: flow::Frame::awaited. Returns a
  /// message for people if that cannot be.
  std::optional<std::string> go_to(const flow::Awaited& awaited);
  /// Does what is due, and does not wait for what another thread makes. To be called again and
  /// again, without `may_begin` while the loop is not to hold still. Returns a message for people,
  /// if there is something to tell.
  std::optional<std::string> follow(bool may_begin);
  /// Tells whether something was asked for and is not done.
  bool is_due() const noexcept { return asked_ || finer_ || making_.valid(); }
  /// Tells whether the loop holds still, or will, or is about to get a model. No recording may
  /// begin or end then.
  bool is_handing_over() const noexcept { return stage_ != Stage::none; }

private:
  enum class Stage { none, holding_still, handing_over };

  std::optional<std::string> begin();
  std::optional<std::string> hand_over();
  Result<void> prepare(const flow::ModelVersion& version);

  const PlacedLoop& placed_;
  const std::vector<Sink*>& sinks_;
  bool asked_ = false;
  std::future<std::unique_ptr<flow::FinerModel>> making_;
  std::unique_ptr<flow::FinerModel> finer_; ///< made, and not the loop's yet
  Stage stage_ = Stage::none;
};

} // namespace nendo::session
