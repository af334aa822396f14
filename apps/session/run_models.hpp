#pragma once
// Makes other versions of the model while a run continues, and hands them over to the loop.

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/place_loop.hpp"
#include "session/sink.hpp"

namespace nendo::session {

class RunModels {
public:
  /// Both must outlive this. `placed` has its loop before the first call. The model is refined
  /// again and again where it needs that, up to `refine_to` vertices; 0: only when asked. With
  /// `changes_topology`, what is thin then parts, opens or fuses.
  RunModels(const PlacedLoop& placed, const std::vector<Sink*>& sinks, std::uint32_t refine_to,
            bool changes_topology)
      : placed_(placed), sinks_(sinks), refine_to_(refine_to), changes_topology_(changes_topology) {
  }

  /// Asks for another model, made of the present one: flow::model_asked_by().
  void ask(const flow::ChangeModel& change) noexcept { asked_ = change; }
  /// Asks for the present model, cut by that wire.
  void cut(const flow::WirePath& wire) noexcept {
    wire_ = wire;
    ask({0, flow::ModelSource::cut});
  }
  /// Goes back, or on, to settings and a version that are kept: flow::Frame::awaited. Returns a
  /// message for people if that cannot be.
  std::optional<std::string> go_to(const flow::Awaited& awaited);
  /// Does what is due, and does not wait for what another thread makes. To be called again and
  /// again, without `may_begin` while the loop is not to hold still. Returns a message for people,
  /// if there is something to tell.
  std::optional<std::string> follow(bool may_begin);
  /// Returns whether something was asked for and is not done.
  bool is_due() const noexcept { return asked_ || (!is_by_itself_ && (finer_ || making_.valid())); }
  /// Returns whether the loop holds still, or will, or is about to get a model. No recording may
  /// begin or end then.
  bool is_handing_over() const noexcept { return stage_ != Stage::none; }

private:
  enum class Stage { none, holding_still, handing_over };
  /// What another thread has made.
  struct Made {
    Result<flow::PendingModel> finer;
    bool is_wanted = true; ///< enough edges are unfit, or something is thin, if nobody has asked
    flow::ModelSource source = flow::ModelSource::refined; ///< then
  };

  std::optional<std::string> begin();
  std::optional<std::string> choose_part();
  void look();
  std::optional<std::string> hand_over();
  Result<void> prepare(const flow::ModelVersion& version);

  const PlacedLoop& placed_;
  const std::vector<Sink*>& sinks_;
  std::uint32_t refine_to_;
  bool changes_topology_;
  HostTime looked_at_{};                       ///< whether the model needs refining
  std::pair<std::uint64_t, bool> last_look_{}; ///< the newest stamp in the shape, in a stroke
  bool is_by_itself_ = false;                  ///< what is being made
  bool was_refined_ = false;                   ///< by itself, the last time
  std::optional<flow::ChangeModel> asked_;     ///< without its number
  std::future<Made> making_;
  flow::ChangeModel made_;                  ///< what making_ and finer_ are
  flow::WirePath wire_;                     ///< that cuts
  std::optional<flow::PendingModel> finer_; ///< made, and not the loop's yet
  Stage stage_ = Stage::none;
};

} // namespace nendo::session
