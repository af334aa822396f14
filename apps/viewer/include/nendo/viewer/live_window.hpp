#pragma once
// The live window: the scene, a camera for the mouse, and a panel that shows how the loop does and
// has buttons for every command. It reads frames; it never waits for the loop, and the loop never
// waits for it. All calls belong to the main thread.

#include <memory>
#include <string>
#include <vector>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/viewer/hand_mover.hpp>
#include <nendo/viewer/scene_window.hpp>

namespace nendo::viewer {

/// What the panel shows beside the frame.
struct Gauges {
  std::string model;                 ///< its name
  double rate_hz = 0.0;              ///< wanted
  std::array<std::string, 2> gloves; ///< their names; empty: none
  std::array<std::uint64_t, 2> bad_records{};
  std::array<std::uint64_t, 2> lost{}; ///< samples that found no room
  bool recording = false;              ///< to a file
  double restart_ms = 0.0;             ///< of the last change of settings; 0: none yet
  std::string report;                  ///< what became of the last command to save something
};

/// What a person has asked for since the last picture, in that order.
using Commands = std::vector<flow::Command>;

class LiveWindow {
public:
  /// Opens a window. Errors: failed (no screen, no OpenGL 3.3), with what to do without.
  static Result<std::unique_ptr<LiveWindow>> open(const std::string& title, Size size);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// Begins to show another loop, over this model. The camera stays where it was.
  void begin(const deform::BlockLayout& layout, const SceneBuilder& builder,
             const flow::LoopSettings& settings);
  /// Draws one picture of the latest frame and waits for the screen, for 20 ms at most if there is
  /// none. fresh: the frame is another one than at the call before.
  Commands show(const flow::Frame& frame, bool fresh, const Gauges& gauges);

  /// These are SceneWindow's.
  Image screenshot() const { return window_->screenshot(); }
  Image silhouette(Size size) { return window_->silhouette(size); }
  const Camera& camera() const noexcept { return window_->camera(); }
  const Scene& scene() const noexcept { return window_->scene(); }
  std::uint64_t blocks_sent() const noexcept { return window_->blocks_sent(); }
  void pretend(const PretendedInput& input) { window_->pretend(input); }

private:
  struct Panel;
  explicit LiveWindow(std::unique_ptr<SceneWindow> window);
  bool move_hand(const flow::Frame& frame, Commands& commands);
  void draw_panel(const flow::Frame& frame, const Gauges& gauges, Commands& commands);

  std::unique_ptr<SceneWindow> window_;
  std::unique_ptr<Panel> panel_;
  HoldTracker holds_;
  SceneFrame moment_;
  HandMover hand_mover_;
};

} // namespace nendo::viewer
