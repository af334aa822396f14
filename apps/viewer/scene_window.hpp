#pragma once
// A window with the scene, a camera that the mouse moves, and space for widgets. Main thread, as
// window systems require.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gl/renderer.hpp"
#include "viewer/motion_sharpness.hpp"
#include "viewer/window_look.hpp"

struct GLFWwindow;

namespace nendo::gl {
class SmoothTarget;
}

namespace nendo::viewer {

class QuickInput;

/// Simulated input of a mouse and a keyboard, for tests.
struct SimulatedInput {
  Eigen::Vector2d pointer{-1.0, -1.0}; ///< pixels from the window's top left corner
  std::array<bool, 3> buttons{};       ///< left, right, middle
  double wheel = 0.0;
  bool control = false;
  bool shift = false;
  int key = 0;           ///< the GLFW key that is down; 0: none
  std::u32string text{}; ///< that is typed into a field
  // Since the last picture:
  std::vector<int> taps;                     ///< keys that were pressed and released
  std::optional<Eigen::Vector2d> clicked_at; ///< the pointer when a button went down
};

class SceneWindow {
public:
  /// Opens a window. Error: failed (no screen, no OpenGL 3.3). The message ends with `instead`, the
  /// alternative without a window.
  static Result<std::unique_ptr<SceneWindow>> open(const std::string& title, const WindowLook& look,
                                                   const std::string& instead);
  ~SceneWindow();
  SceneWindow(const SceneWindow&) = delete;
  SceneWindow& operator=(const SceneWindow&) = delete;

  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  /// Shows no model, as before the first set_model(). The scene is in metres. With `has_ground`,
  /// y = 0 is the ground. The next model gets a camera of its own.
  void clear_model(bool has_ground = false);
  bool has_model() const noexcept { return !builder_.corners().empty(); }
  void follow(const deform::BlockShape& shape) { renderer_->model().follow(shape); }

  /// Begins a picture: processes the input since the last one, and builds the scene except the
  /// model. Chooses the camera for each frame until the first one with is_whole. Widgets may
  /// follow.
  void begin_picture(const render::SceneFrame& scene_frame, bool is_whole = true);
  /// Adds a translucent or opaque surface to the current picture, in metres of the scene.
  void add(render::Surface surface);
  /// Orbits, pans and zooms the camera by the mouse, unless it is over a widget.
  void move_camera();
  /// Chooses a camera that looks from there at these points, metres of the scene, also when the
  /// window's size changes, until the user moves it, or another model is set.
  void frame(std::vector<Eigen::Vector3f> points, render::View view);
  /// Executes a command of the table that shows or hides a part of the scene, looks from a side, or
  /// shows all of the model and the hands. Ignores others.
  void execute(std::string_view name);
  /// Handles the keys 1, 3 and 7: views from the front, right and top, with ctrl from the back,
  /// left and bottom, as in Blender.
  void follow_view_keys();
  render::SceneParts& parts() noexcept { return parts_; }
  /// Returns the commands that show or hide something of the scene, and what they change.
  std::array<std::pair<std::string_view, bool*>, 6> switches() noexcept;
  gl::Material& material() noexcept { return style_.material; } ///< the model's
  /// Sets the parts of the model that are in reach of the hands. They have an outline while radii
  /// are shown.
  void set_parts_in_reach(std::shared_ptr<const deform::ModelParts> parts,
                          const std::array<std::uint32_t, 2>& numbers) noexcept {
    style_.parts = std::move(parts);
    in_reach_ = numbers;
  }
  /// Draws the picture and waits for the screen, or for at most 8 ms if there is none.
  void end_picture();

  /// Returns whether the user has asked to close the window since the last call.
  bool take_close_request() noexcept;
  /// Returns the files that were dropped on the window since the last call.
  std::vector<std::string> take_dropped();
  /// Calls `draw` in each picture before all other widgets, for a bar of `height_em` multiples of
  /// the font's size at the top, and for dialogs. Without `draw` there is no bar.
  void set_bar(std::function<void()> draw, float height_em);
  /// Returns the height of the bar in pixels, which panels leave free.
  float above_px() const;
  /// Reserves pixels at the bottom of the window, where the scene is not drawn.
  void leave_below(int pixels) noexcept { below_ = pixels; }
  /// Sets the covered pixels at the left of the window. The scene extends under them, but is
  /// centred in the free part, as long as that is most of the window.
  void leave_left(int pixels) noexcept { left_ = pixels; }
  render::Size scene_size() const noexcept; ///< from the window's top left corner
  const render::Camera& camera() const noexcept { return camera_; }
  /// Looks by this camera from the next picture on.
  void look_by(const render::Camera& camera) noexcept {
    camera_ = camera, framed_ = true;
    kept_framed_.reset();
  }
  /// Returns the camera in stage coordinates, such as those of hands. camera() is in scene
  /// coordinates.
  render::Camera stage_camera() const noexcept;
  const render::Scene& scene() const noexcept { return scene_; } ///< without the model's positions
  std::uint64_t blocks_sent() const noexcept { return renderer_->model().blocks_sent(); }

  /// Returns the last shown picture.
  render::Image screenshot();
  /// Draws the last shown picture as without a graphics card while something moves, with a scene
  /// of that part of the window's width and height in pixels.
  render::Image moving_screenshot(double part);
  /// Does the same as render::silhouette() with OpenGL, for the last shown scene.
  render::Image silhouette(render::Size size);
  /// Replaces mouse and keyboard by `input` from the next picture on.
  void simulate(const SimulatedInput& input);

private:
  /// The inputs of a picture, with the model's blocks.
  struct Shown {
    render::Scene scene;
    render::Camera camera;
    render::Size size;
    std::uint64_t blocks_sent = 0;
    gl::Style style;
    bool smooth = false; ///< multisampled; not compared
    /// Returns whether the picture would be the same now. Compares the scene last, because it is
    /// the largest.
    bool is_of(const SceneWindow& window, render::Size wanted) const;
  };

  SceneWindow();
  double covered_part() const noexcept;
  void set_reaches(const render::SceneFrame& scene_frame);
  void choose_camera(render::View view);
  void look_at(std::span<const Eigen::Vector3f> points, render::View view);
  void put_simulated() const;
  void draw_all(bool finest, double part = 1.0);
  void draw_scene(render::Size size, bool finest, double part);

  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<gl::SmoothTarget> target_;
  render::SceneBuilder builder_;
  std::optional<SimulatedInput> simulated_;
  std::unique_ptr<QuickInput> quick_;
  std::function<void()> bar_;
  float bar_em_ = 0.0F;
  render::SceneParts parts_;
  render::Scene scene_;
  render::Camera camera_;
  gl::Style style_;
  std::array<std::uint32_t, 2> in_reach_{deform::no_index, deform::no_index};
  MotionSharpness sharpness_;
  Shown shown_; ///< the inputs of the picture in target_; initially of zero size
  HostTime begun_{};
  struct Framed {
    std::vector<Eigen::Vector3f> points;
    render::View view;
  };
  std::optional<Framed> kept_framed_; ///< the camera follows these
  int below_ = 0;
  int left_ = 0;
  bool framed_ = false;
  bool draws_itself_ = false; ///< software rendering
};

} // namespace nendo::viewer
