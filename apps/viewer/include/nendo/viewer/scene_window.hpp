#pragma once
// A window with the scene in it, a camera for the mouse, and room for widgets. All of this on the
// main thread, as windows demand.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/viewer/gl_renderer.hpp>

struct GLFWwindow;

namespace nendo::viewer {

class QuickInput;

/// A mouse and a keyboard that are not there: for tests.
struct PretendedInput {
  Eigen::Vector2d pointer{-1.0, -1.0}; ///< pixels from the window's top left corner
  std::array<bool, 3> buttons{};       ///< left, right, middle
  double wheel = 0.0;
  bool control = false;
  bool shift = false;
  int key = 0; ///< GLFW's number of the one that is down; 0: none
  // Since the last picture:
  std::vector<int> taps;                     ///< keys that went down, and up again
  std::optional<Eigen::Vector2d> clicked_at; ///< where the pointer was when a button went down
};

class SceneWindow {
public:
  /// Errors: failed (no screen, no OpenGL 3.3), with `instead`, which says what to do without.
  static Result<std::unique_ptr<SceneWindow>> open(const std::string& title, Size size,
                                                   const std::string& instead);
  ~SceneWindow();
  SceneWindow(const SceneWindow&) = delete;
  SceneWindow& operator=(const SceneWindow&) = delete;

  void set_model(const deform::BlockLayout& layout, const SceneBuilder& builder);
  void follow(const deform::BlockShape& shape) { renderer_->follow(shape); }

  /// A picture begins: what has happened since the last, and what stands beside the model. The
  /// first one that is whole chooses the camera for good. Widgets may follow.
  void begin_picture(const SceneFrame& moment, bool is_whole = true);
  /// The mouse turns, shifts and zooms, unless it is over a widget.
  void move_camera();
  /// h, b, v and d show and hide the scene's parts, unless somebody writes or is asked something.
  void follow_part_keys();
  /// Draws it all; waits for the screen, 20 ms at most without one.
  void end_picture();

  /// Whether the person has asked to close the window since the last call.
  bool take_close_request() noexcept;
  /// So many pixels at the bottom are not the scene's.
  void leave_below(int pixels) noexcept { below_ = pixels; }
  Size scene_size() const noexcept; ///< of what is left; its corner is the window's top left one
  const Camera& camera() const noexcept { return camera_; }
  /// The same camera for places on the stage, as hands' are; the scene's are seen from its middle.
  Camera stage_camera() const noexcept;
  const Scene& scene() const noexcept { return scene_; } ///< but for its model's places
  std::uint64_t blocks_sent() const noexcept { return renderer_->blocks_sent(); }

  Image screenshot() const; ///< of what was shown last
  /// As viewer::silhouette(), of what was shown last, by OpenGL.
  Image silhouette(Size size);
  /// From the next picture on, in place of the mouse and the keyboard that are there.
  void pretend(const PretendedInput& input);

private:
  SceneWindow();
  void choose_camera();
  void put_pretended() const;
  void draw_all() const;

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<GlRenderer> renderer_;
  std::optional<SceneBuilder> builder_;
  std::optional<PretendedInput> pretended_;
  std::unique_ptr<QuickInput> quick_;
  SceneParts parts_;
  Scene scene_;
  Camera camera_;
  HostTime begun_{};
  int below_ = 0;
  bool framed_ = false;
};

} // namespace nendo::viewer
