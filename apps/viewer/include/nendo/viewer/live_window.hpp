#pragma once
// The live window: the scene, a camera for the mouse, and a panel to see how the loop does and to
// ask it for something. It reads frames and never waits for the loop, nor the loop for it. All of
// this on the main thread, as windows demand.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/save_request.hpp>
#include <nendo/viewer/hand_mover.hpp>
#include <nendo/viewer/scene_window.hpp>

namespace nendo::viewer {

using flow::LoopSettings;

/// What the panel tells beside the frame.
struct Gauges {
  std::string model;                 ///< its name
  double rate_hz = 0.0;              ///< wanted
  std::array<std::string, 2> gloves; ///< their names; empty: none
  std::array<std::uint64_t, 2> bad_records{};
  std::array<std::uint64_t, 2> lost{}; ///< samples that found no room
  bool recording = false;              ///< goes on now
  double restart_ms = 0.0;             ///< of the last change of settings; 0: none yet
  std::string told;                    ///< what became of the last wish to keep something
};

/// What a person wants, since the last picture.
struct Wishes {
  std::vector<flow::Request> requests;
  std::optional<flow::WristMove> wrist; ///< a hand that the mouse holds is to be there
  std::optional<LoopSettings> settings; ///< to go on with, in place of those in force
  bool reset = false;                   ///< back to the model as it was loaded
  bool record = false;                  ///< the recording is to begin, or to end
  flow::SaveRequest save_request;
  bool quit = false;
};

class LiveWindow {
public:
  /// Opens a window. Errors: failed (no screen, no OpenGL 3.3), with what to do without.
  static Result<std::unique_ptr<LiveWindow>> open(const std::string& title, Size size);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// Another loop, over this model. Keeps the camera unless there was none.
  void begin(const deform::BlockLayout& layout, const SceneBuilder& builder,
             const LoopSettings& settings);
  /// One picture, of the latest frame; waits for the screen, 20 ms at most without one. fresh: the
  /// frame is another one than before.
  Wishes show(const flow::Frame& frame, bool fresh, const Gauges& gauges);

  /// As SceneWindow's.
  Image screenshot() const { return window_->screenshot(); }
  Image silhouette(Size size) { return window_->silhouette(size); }
  const Camera& camera() const noexcept { return window_->camera(); }
  const Scene& scene() const noexcept { return window_->scene(); }
  std::uint64_t blocks_sent() const noexcept { return window_->blocks_sent(); }
  void pretend(const PretendedInput& input) { window_->pretend(input); }

private:
  struct Panel;
  explicit LiveWindow(std::unique_ptr<SceneWindow> window);
  bool move_hand(const flow::Frame& frame, Wishes& wishes);
  void draw_panel(const flow::Frame& frame, const Gauges& gauges, Wishes& wishes);

  std::unique_ptr<SceneWindow> window_;
  std::unique_ptr<Panel> panel_;
  HoldFollower holds_;
  SceneFrame moment_;
  HandMover hand_mover_;
};

} // namespace nendo::viewer
