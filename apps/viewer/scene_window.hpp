#pragma once
// A window with the scene, a camera that the mouse moves, and space for widgets. All calls belong
// to the main thread, as window systems demand.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/gl_renderer.hpp"

struct GLFWwindow;

namespace nendo::viewer {

class QuickInput;
class SmoothTarget;

/// Simulated input of a mouse and a keyboard, for tests.
struct SimulatedInput {
  Eigen::Vector2d pointer{-1.0, -1.0}; ///< pixels from the window's top left corner
  std::array<bool, 3> buttons{};       ///< left, right, middle
  double wheel = 0.0;
  bool control = false;
  bool shift = false;
  int key = 0; ///< GLFW's number of the key that is down; 0 means none
  // Since the last picture:
  std::vector<int> taps;                     ///< keys that went down and up again
  std::optional<Eigen::Vector2d> clicked_at; ///< where the pointer was when a button went down
};

class SceneWindow {
public:
  /// Opens a window. Error: failed (no screen, no OpenGL 3.3). The message ends with `instead`,
  /// which must say what to do without a window.
  static Result<std::unique_ptr<SceneWindow>> open(const std::string& title, render::Size size,
                                                   const std::string& instead);
  ~SceneWindow();
  SceneWindow(const SceneWindow&) = delete;
  SceneWindow& operator=(const SceneWindow&) = delete;

  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  void follow(const deform::BlockShape& shape) { renderer_->follow(shape); }

  /// Begins a picture: processes the input since the last one and builds the scene's parts other
  /// than the model. The camera is chosen again for each frame until the first one with is_whole.
  /// Widgets may follow.
  void begin_picture(const render::SceneFrame& scene_frame, bool is_whole = true);
  /// Adds a translucent or an opaque surface to the picture that has begun, in metres of the scene.
  void add(render::Surface surface);
  /// Turns, shifts and zooms the camera by the mouse, unless the mouse is over a widget.
  void move_camera();
  /// Moves the camera, without turning it, so that it has all of the model and the hands.
  void frame_all();
  /// Lets the keys h, b, v, d, 0 and f show and hide parts of the scene, unless a text is being
  /// entered or a question is open.
  void follow_part_keys();
  /// Lets the keys 1, 3 and 7 turn the camera to the front, the right and the top, and with ctrl to
  /// the back, the left and the bottom, as in Blender.
  void follow_view_keys();
  render::SceneParts& parts() noexcept { return parts_; }
  bool& facets() noexcept { return facets_; } ///< in place of smooth shading
  /// Draws the picture and waits for the screen, or for at most 8 ms if there is none.
  void end_picture();

  /// Returns whether the user has asked to close the window since the last call.
  bool take_close_request() noexcept;
  /// Reserves these pixels at the bottom of the window, which the scene does not use.
  void leave_below(int pixels) noexcept { below_ = pixels; }
  /// Sets how many pixels at the left of the window something covers. The scene is behind it, but
  /// its middle is the middle of the free part, as long as that is most of the window.
  void leave_left(int pixels) noexcept { left_ = pixels; }
  render::Size scene_size() const noexcept; ///< from the window's top left corner
  const render::Camera& camera() const noexcept { return camera_; }
  /// Returns the same camera for places on the stage, such as those of hands. camera() is for
  /// places in the scene.
  render::Camera stage_camera() const noexcept;
  const render::Scene& scene() const noexcept { return scene_; } ///< without the model's positions
  std::uint64_t blocks_sent() const noexcept { return renderer_->blocks_sent(); }

  render::Image screenshot(); ///< the picture that was shown last
  /// Does the same as render::silhouette() with OpenGL, for the scene that was shown last.
  render::Image silhouette(render::Size size);
  /// Replaces the real mouse and keyboard by `input` from the next picture on.
  void simulate(const SimulatedInput& input);

private:
  /// All that decides the picture of a scene, with the model's blocks.
  struct Shown {
    render::Scene scene;
    render::Camera camera;
    render::Size size;
    std::uint64_t blocks_sent = 0;
    bool facets = false;
    bool smooth = false; ///< at edges; does not count as a change
    /// Returns whether the picture would be the same now. Compares the scene last, as it is
    /// largest.
    bool is_of(const SceneWindow& window, render::Size wanted) const;
  };

  SceneWindow();
  double covered_part() const noexcept;
  void choose_camera(render::View view);
  void put_simulated() const;
  void draw_all(bool finest);
  void draw_scene(render::Size size, bool finest);

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<GlRenderer> renderer_;
  std::unique_ptr<SmoothTarget> target_;
  std::optional<render::SceneBuilder> builder_;
  std::optional<SimulatedInput> simulated_;
  std::unique_ptr<QuickInput> quick_;
  render::SceneParts parts_;
  render::Scene scene_;
  render::Camera camera_;
  Shown shown_; ///< what target_ keeps the picture of; of no size at first
  HostTime begun_{};
  int below_ = 0;
  int left_ = 0;
  bool framed_ = false;
  bool draws_itself_ = false; ///< there is no graphics card
  bool facets_ = false;
};

} // namespace nendo::viewer
