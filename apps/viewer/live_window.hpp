#pragma once
// The live window: the scene, a camera that the mouse moves, and a panel with the loop's state and
// buttons for all commands. The window and the loop never wait for each other. Main thread.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>

#include "commands/commands.hpp"
#include "forms/run_panel.hpp"
#include "viewer/picture_times.hpp"
#include "viewer/pointing.hpp"
#include "viewer/puppet_tool.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::viewer {

/// Values for the panel in addition to the frame.
struct Gauges {
  std::string model;        ///< the model's name
  double rate_hz = 0.0;     ///< the requested rate
  std::size_t vertices = 0; ///< the number of the model's vertices
  forms::DeviceLines devices;
  std::shared_ptr<const deform::ModelParts>
      parts{}; ///< those of the frame's model; null: not in use
  commands::RunFacts facts{};
  std::string report; ///< the latest report of the run
  bool report_is_error = false;
};

/// The user's commands since the last picture, in order.
using Commands = std::vector<flow::Command>;

class LiveWindow {
public:
  /// Draws into `window`, not null, which others may use between two pictures.
  explicit LiveWindow(std::shared_ptr<SceneWindow> window);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// Begins to show a loop with this model and these initial settings.
  void begin(const deform::BlockLayout& layout, const render::SceneBuilder& builder,
             const flow::LoopSettings& settings);
  /// Shows another version of the model, for all frames from now on. Keeps the camera.
  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  /// Draws one picture of the latest frame and waits for the screen, or for at most 8 ms if there
  /// is none. fresh: the frame is new since the last call.
  Commands show(const flow::Frame& frame, bool fresh, const Gauges& gauges);

  /// The editor of the puppet, after its own begin().
  PuppetEditor& editor() noexcept { return editor_; }

  /// Shows hints over the picture until the user closes them.
  void show_hints() noexcept;
  /// Returns whether hints are shown.
  bool has_hints() const noexcept;
  /// Returns the message in the status bar: the report, or a command's refusal.
  const std::string& message() const noexcept;
  /// Returns the settings that the panel shows.
  const flow::LoopSettings& settings() const noexcept;

  const PictureTimes& picture_times() const noexcept { return picture_times_; }
  SceneWindow& scene_window() noexcept { return *window_; }

private:
  struct Panel;
  bool edit_puppet();
  void show_model(const flow::Frame& frame);
  bool move_hand(const flow::Frame& frame);

  std::shared_ptr<SceneWindow> window_;
  PuppetEditor editor_;
  PuppetTool tool_;
  PuppetMarks marks_;
  std::unique_ptr<Panel> panel_;
  std::optional<render::SceneBuilder> builder_;
  bool shows_loop_ = true; ///< otherwise the editor's model
  bool plays_ = false;     ///< the loop has a puppet
  render::HoldTracker holds_;
  render::SceneFrame scene_frame_;
  HandMover hand_mover_;
  PictureTimes picture_times_;
};

} // namespace nendo::viewer
