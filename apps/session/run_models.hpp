#pragma once
// Makes new versions of the model during a run, and hands them to the loop.

#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/place_loop.hpp"
#include "session/report.hpp"
#include "session/sink.hpp"

namespace nendo::session {

class RunModels {
public:
  /// Both must outlive this. `placed` must have its loop before the first call. The model is
  /// refined automatically up to `refine_to` vertices; 0: only on request. With `changes_topology`,
  /// this also separates, opens or fuses thin places.
  RunModels(const PlacedLoop& placed, const std::vector<Sink*>& sinks, std::uint32_t refine_to,
            bool changes_topology)
      : placed_(placed), sinks_(sinks), refine_to_(refine_to), changes_topology_(changes_topology) {
  }

  /// Requests a new model, made from the current one (flow::model_asked_by()).
  void ask(const flow::ChangeModel& change) noexcept { asked_ = change; }
  /// Requests a cut of the current model by the wire.
  void cut(const flow::WirePath& wire) noexcept {
    wire_ = wire;
    ask({0, flow::ModelSource::cut});
  }
  /// Requests the stored settings and version that an undo or a redo awaits (flow::Frame::awaited).
  /// Returns a message for the user if that is impossible.
  std::optional<Report> go_to(const flow::Awaited& awaited);
  /// Continues the work without waiting for other threads; call it repeatedly. Pass `may_begin`
  /// false while the loop must not hold still. Returns a message for the user, if any.
  std::optional<Report> follow(bool may_begin);
  /// Returns whether a request is pending.
  bool is_due() const noexcept { return asked_ || (!is_by_itself_ && (finer_ || making_.valid())); }
  /// Returns whether the loop holds still, or is about to get a model. No recording may begin or
  /// end then.
  bool is_handing_over() const noexcept { return stage_ != Stage::none; }

private:
  enum class Stage { none, holding_still, handing_over };
  /// The result of the worker thread.
  struct Made {
    Result<flow::PendingModel> finer;
    bool is_wanted = true; ///< requested, or enough edges are unfit, or places are thin
    flow::ModelSource source = flow::ModelSource::refined; ///< the kind of change
  };

  std::optional<Report> begin();
  std::optional<Report> choose_part();
  void look();
  std::optional<Report> hand_over();
  Result<void> prepare(const flow::ModelVersion& version);

  const PlacedLoop& placed_;
  const std::vector<Sink*>& sinks_;
  std::uint32_t refine_to_;
  bool changes_topology_;
  HostTime looked_at_{};                       ///< the last search
  std::pair<std::uint64_t, bool> last_look_{}; ///< the newest stamp; is in a stroke
  bool is_by_itself_ = false;                  ///< the current work was not requested
  bool was_refined_ = false;                   ///< the last automatic change was a refinement
  std::optional<flow::ChangeModel> asked_;     ///< without its number
  std::future<Made> making_;
  flow::ChangeModel made_;                  ///< the change of making_ and finer_
  flow::WirePath wire_;                     ///< the wire that cuts
  std::optional<flow::PendingModel> finer_; ///< the next version, which the loop does not have yet
  Stage stage_ = Stage::none;
};

} // namespace nendo::session
