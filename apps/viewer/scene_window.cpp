#include "viewer/scene_window.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <deque>
#include <thread>
#include <utility>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "gl/screen.hpp"
#include "gl/smooth_target.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

/// Makes short key presses and clicks visible to ImGui, which reads keyboard and mouse once per
/// picture. Where a picture takes long, as without a graphics card, a key can go down and up again
/// between two pictures, and the pointer can have moved before the button is seen to be down. Here
/// a short key press waits for the next picture, and a click keeps its place.
class QuickInput {
public:
  /// Reports that a key went down. key: GLFW's number.
  void press(int key, bool control, bool shift) {
    constexpr std::size_t max_waiting = 64; // if the user leans on the keyboard
    if (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER) return; // come with the others
    if (waiting_.size() < max_waiting) waiting_.push_back({key, control, shift});
  }
  /// Reports that the pointer has moved, in pixels from the window's top left corner.
  void point(double x, double y) noexcept {
    pointer_ = {static_cast<float>(x), static_cast<float>(y)};
  }
  /// Reports that a button went down at the place of the pointer.
  void click() noexcept {
    if (!clicked_) clicked_ = pointer_;
  }

  /// Passes the waiting input to ImGui. It must be called before ImGui begins a picture, after its
  /// back end has reported the present state.
  void put() {
    const ImGuiIO& io = ImGui::GetIO();
    if (const auto place = std::exchange(clicked_, {})) put_pointer(place->x, place->y);
    const int before = std::exchange(last_, 0);
    while (!waiting_.empty()) {
      const Tap tap = waiting_.front();
      if (tap.key == before) return; // tapped twice: it is seen to go up in between
      waiting_.pop_front();
      // If it still is down, ImGui sees that, but its modifiers may be up already.
      const bool is_down = is_key_down(tap.key);
      beside_ = {is_down ? 0 : tap.key, io.KeyCtrl, io.KeyShift};
      if (!is_down) put_key(tap.key, true);
      put_modifiers(tap.control, tap.shift);
      last_ = beside_->key;
      return;
    }
  }
  /// Sets the keyboard back to the state that the back end reported. It must be called after the
  /// picture. The back end reports the pointer for each picture, so the pointer needs no reset.
  void reset_keyboard() {
    // A field gets letters as text. Their keys would be commands when it is closed.
    if (ImGui::GetIO().WantTextInput)
      std::erase_if(waiting_, [](const Tap& tap) {
        return tap.key <= GLFW_KEY_GRAVE_ACCENT && !tap.control;
      });
    if (!beside_) return;
    if (beside_->key != 0) put_key(beside_->key, false);
    put_modifiers(beside_->control, beside_->shift);
    beside_.reset();
  }

  std::vector<std::string> dropped; ///< files, since they were taken

private:
  struct Tap {
    int key;
    bool control;
    bool shift;
  };

  std::deque<Tap> waiting_;
  ImVec2 pointer_;
  std::optional<ImVec2> clicked_; ///< since the last picture
  int last_ = 0;                  ///< the key that was passed for the latest picture; 0 means none
  std::optional<Tap> beside_;     ///< while a tap is passed: the real state of the modifiers
};

namespace {

Error without_window(const std::string& why, const std::string& instead) {
  return {Errc::failed, "no window: " + why + "; " + instead};
}

std::string glfw_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words != nullptr ? words : "GLFW does not say why";
}

render::Size pixels_of(GLFWwindow* window) {
  render::Size size;
  glfwGetFramebufferSize(window, &size.width, &size.height);
  return {std::max(1, size.width), std::max(1, size.height)};
}

/// Returns how many times denser the window's monitor is than one of 96 dots per inch.
float scale_of(GLFWwindow* window) {
  float x = 1.0F, y = 1.0F;
  glfwGetWindowContentScale(window, &x, &y);
  return std::clamp(std::max(x, y), 0.5F, 4.0F);
}

constexpr std::chrono::milliseconds min_period(8); // where no screen sets the pace

QuickInput& quick_of(GLFWwindow* window) {
  return *static_cast<QuickInput*>(glfwGetWindowUserPointer(window));
}

void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
  if (action != GLFW_PRESS) return;
  quick_of(window).press(key, (modifiers & GLFW_MOD_CONTROL) != 0,
                         (modifiers & GLFW_MOD_SHIFT) != 0);
}

// Not glfwGetCursorPos(): that asks where the pointer is now, and not where it was at this event.
void on_pointer(GLFWwindow* window, double x, double y) {
  quick_of(window).point(x, y);
}

void on_button(GLFWwindow* window, int, int action, int) {
  if (action == GLFW_PRESS) quick_of(window).click();
}

void on_drop(GLFWwindow* window, int count, const char** files) {
  for (int at = 0; at < count; ++at)
    quick_of(window).dropped.emplace_back(files[at]);
}

} // namespace

SceneWindow::SceneWindow() : builder_(deform::Mesh()), quick_(std::make_unique<QuickInput>()) {}

Result<std::unique_ptr<SceneWindow>>
SceneWindow::open(const std::string& title, const WindowLook& look, const std::string& instead) {
#ifdef GLFW_PLATFORM
  // Where there is no compositor, Wayland's library would add words of its own to the error.
  if (std::getenv("WAYLAND_DISPLAY") == nullptr) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (glfwInit() == GLFW_FALSE) return without_window(glfw_error(), instead);
  std::unique_ptr<SceneWindow> window(new SceneWindow);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, 0); // SmoothTarget has them, on screens without any, too
  if (!look.scale) glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  window->window_ =
      glfwCreateWindow(look.size.width, look.size.height, title.c_str(), nullptr, nullptr);
  if (window->window_ == nullptr)
    return without_window("no OpenGL 3.3 here: " + glfw_error(), instead);
  glfwMakeContextCurrent(window->window_);
  glfwSwapInterval(1);
  auto renderer = gl::Renderer::make();
  if (!renderer) return without_window(renderer.error().message, instead);
  window->renderer_ = *std::move(renderer);
  window->target_ = std::make_unique<gl::SmoothTarget>();
  window->draws_itself_ = gl::draws_without_card();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr; // leaves no file behind
  use_theme(look.theme, look.scale.value_or(scale_of(window->window_)));
  glfwSetWindowUserPointer(window->window_, window->quick_.get());
  glfwSetDropCallback(window->window_, on_drop);
  if (!imgui_queues_events) { // ImGui's own callbacks call these
    glfwSetKeyCallback(window->window_, on_key);
    glfwSetMouseButtonCallback(window->window_, on_button);
    glfwSetCursorPosCallback(window->window_, on_pointer);
  }
  ImGui_ImplGlfw_InitForOpenGL(window->window_, true);
  ImGui_ImplOpenGL3_Init("#version 330");
  return window;
}

SceneWindow::~SceneWindow() {
  if (ImGui::GetCurrentContext() != nullptr) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  target_.reset();
  renderer_.reset();
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void SceneWindow::set_model(const deform::BlockLayout& layout,
                            const render::SceneBuilder& builder) {
  if (!has_model()) framed_ = false;
  builder_ = builder;
  shown_.size = {};
  renderer_->set_model(layout, builder);
  parts_.ground = true;
  kept_framed_.reset();
}

void SceneWindow::clear_model(bool has_ground) {
  builder_ = render::SceneBuilder(deform::Mesh());
  parts_.ground = has_ground;
  shown_.size = {};
  renderer_->model().clear();
}

std::vector<std::string> SceneWindow::take_dropped() {
  return std::exchange(quick_->dropped, {});
}

void SceneWindow::set_bar(std::function<void()> draw, float height_em) {
  bar_ = std::move(draw);
  bar_em_ = bar_ ? height_em : 0.0F;
}

float SceneWindow::above_px() const {
  return em(bar_em_);
}

void SceneWindow::begin_picture(const render::SceneFrame& scene_frame, bool is_whole) {
  begun_ = HostClock::now();
  glfwPollEvents();
  render::SceneParts surfaces = parts_;
  surfaces.radii = false; // lines on the model show them
  const double metre_px = scene_size().height / (2.0 * camera_.tangent() * camera_.distance_m);
  surfaces.coarse_hands = metre_px * static_cast<double>(render::HandSkin::coarse_cell_m) < 5.0;
  builder_.build_beside(scene_frame, surfaces, scene_);
  set_reaches(scene_frame);
  if (kept_framed_)
    look_at(kept_framed_->points, kept_framed_->view);
  else if (!framed_)
    choose_camera({22.0, 10.0});
  camera_.centre = covered_part();
  framed_ = framed_ || is_whole;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (simulated_) put_simulated();
  quick_->put();
  forget_controls();
  ImGui::NewFrame();
  if (bar_) bar_();
}

void SceneWindow::set_reaches(const render::SceneFrame& scene_frame) {
  const ImVec4 line = accent();
  style_.accent = {line.x, line.y, line.z};
  style_.line_width_px = 2.0F * scale();
  style_.reaches.clear();
  style_.outlined = {deform::no_index, deform::no_index};
  if (!parts_.radii) return;
  style_.outlined = in_reach_;
  const bool is_at_starts = scene_frame.held && !scene_frame.accumulates;
  for (const auto& hand : scene_frame.hands) {
    if (!hand) continue;
    const render::TipPlaces tips = is_at_starts ? hand->starts : hand->pose.fingertip_positions();
    for (Eigen::Index finger = 0; finger < tips.cols(); ++finger) {
      const double radius_m = scene_frame.radius_m[static_cast<std::size_t>(finger)];
      if (!(radius_m > 0.0)) continue;
      const Eigen::Vector3d place_m = tips.col(finger) - builder_.origin_m();
      style_.reaches.emplace_back(place_m.homogeneous().cast<float>());
      style_.reaches.back().w() = static_cast<float>(radius_m);
    }
  }
}

void SceneWindow::add(render::Surface surface) {
  const bool is_veil = surface.material.opacity < 1.0F;
  (is_veil ? scene_.veils : scene_.solids).push_back(std::move(surface));
}

// Of the window's width: what is covered at its left.
double SceneWindow::covered_part() const noexcept {
  constexpr double most = 0.65;
  return std::clamp(1.0 * left_ / scene_size().width, 0.0, most);
}

void SceneWindow::choose_camera(render::View view) {
  auto points = scene_.outline();
  const Eigen::Vector3f half = (builder_.size_m() / 2).cast<float>();
  Eigen::AlignedBox3f box = renderer_->model().box();
  box.extend(Eigen::Vector3f(-half.x(), 0.0F, -half.z()));
  box.extend(Eigen::Vector3f(half.x(), 2.0F * half.y(), half.z()));
  for (int corner = 0; corner < 8; ++corner)
    points.push_back(box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)));
  look_at(points, view);
}

void SceneWindow::look_at(std::span<const Eigen::Vector3f> points, render::View view) {
  const render::Size size = scene_size();
  const auto above = static_cast<double>(above_px());
  const double free_width = (1.0 - covered_part()) * size.width;
  const double free_height = std::max(1.0, size.height - above);
  camera_ = render::framing(points, view, free_width / free_height, 0.1);
  camera_.distance_m *= size.height / free_height;
  camera_.pan(0.0, above / 2.0, size.height);
  camera_.centre = covered_part();
}

void SceneWindow::frame(std::vector<Eigen::Vector3f> points, render::View view) {
  kept_framed_ = Framed{std::move(points), view};
}

void SceneWindow::simulate(const SimulatedInput& input) {
#if IMGUI_VERSION_NUM >= 18700
  ImGui::GetIO().ConfigInputTrickleEventQueue =
      false; // each picture shows what is simulated for it
#endif
  if (simulated_ && simulated_->key > 0 && simulated_->key != input.key)
    put_key(simulated_->key, false);
  simulated_ = input;
  for (const int key : input.taps)
    quick_->press(key, input.control, input.shift);
  if (!input.clicked_at) return;
  quick_->point(input.clicked_at->x(), input.clicked_at->y());
  quick_->click();
}

// As the window's back end passes the real ones to ImGui.
void SceneWindow::put_simulated() const {
  put_pointer(static_cast<float>(simulated_->pointer.x()),
              static_cast<float>(simulated_->pointer.y()));
  for (std::size_t button = 0; button < simulated_->buttons.size(); ++button)
    put_button(static_cast<int>(button), simulated_->buttons[button]);
  put_wheel(static_cast<float>(simulated_->wheel));
  put_modifiers(simulated_->control, simulated_->shift);
  if (simulated_->key > 0) put_key(simulated_->key, true);
  for (const char32_t letter : simulated_->text)
    ImGui::GetIO().AddInputCharacter(letter);
}

void SceneWindow::move_camera() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  const auto dx = static_cast<double>(io.MouseDelta.x);
  const auto dy = static_cast<double>(io.MouseDelta.y);
  const bool shifts = ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
                      (ImGui::IsMouseDown(ImGuiMouseButton_Left) && io.KeyShift);
  const bool turns = !shifts && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  if (shifts) camera_.pan(dx, dy, scene_size().height);
  if (turns) camera_.orbit(dx, dy);
  if (io.MouseWheel != 0.0F) camera_.zoom(static_cast<double>(io.MouseWheel));
  if (io.MouseWheel != 0.0F || ((shifts || turns) && (dx != 0.0 || dy != 0.0)))
    kept_framed_.reset();
}

namespace {

struct ViewChoice {
  std::string_view name;   // of its command
  std::array<int, 2> keys; // also of the number pad
  render::View view, other;
};
constexpr std::array views{
    ViewChoice{"view front", {GLFW_KEY_1, GLFW_KEY_KP_1}, {0.0, 0.0}, {180.0, 0.0}},
    ViewChoice{"view right", {GLFW_KEY_3, GLFW_KEY_KP_3}, {90.0, 0.0}, {-90.0, 0.0}},
    ViewChoice{"view top", {GLFW_KEY_7, GLFW_KEY_KP_7}, {0.0, 90.0}, {0.0, -90.0}},
};

} // namespace

std::array<std::pair<std::string_view, bool*>, 6> SceneWindow::switches() noexcept {
  return {{{"show hands", &parts_.hands},
           {"show bones", &parts_.bones},
           {"show vectors", &parts_.vectors},
           {"show radii", &parts_.radii},
           {"show contact", &parts_.contacts},
           {"show facets", &style_.facets}}}; // flat instead of smooth shading
}

void SceneWindow::execute(std::string_view name) {
  if (name == "frame all") choose_camera(camera_.view);
  for (const auto& [command, part] : switches())
    if (name == command) *part = !*part;
  for (const ViewChoice& choice : views)
    if (name == choice.name) camera_.view = choice.view;
  if (name == "next material")
    style_.material = static_cast<gl::Material>((static_cast<std::size_t>(style_.material) + 1) %
                                                gl::material_names.size());
}

void SceneWindow::follow_view_keys() {
  if (!takes_keys()) return;
  for (const ViewChoice& choice : views)
    for (const int key : choice.keys)
      if (pressed(key)) camera_.view = ImGui::GetIO().KeyCtrl ? choice.other : choice.view;
}

void SceneWindow::end_picture() {
  ImGui::Render();
  quick_->reset_keyboard();
  draw_all(!draws_itself_, sharpness_.part());
  glfwSwapBuffers(window_);
  if (draws_itself_ && !shown_.smooth)
    sharpness_.took(1e3 * seconds_between(begun_, HostClock::now()));
  write_controls();
  std::this_thread::sleep_until(begun_ + min_period);
}

bool SceneWindow::Shown::is_of(const SceneWindow& window, render::Size wanted) const {
  return size == wanted && blocks_sent == window.blocks_sent() && style == window.style_ &&
         camera == window.camera_ && scene == window.scene_;
}

// An unchanged picture is drawn once. Where there is no graphics card, most of the time goes
// into the scene: there its edges are smoothed once it rests, and while it moves, it may have only
// a part of the window's pixels.
void SceneWindow::draw_scene(render::Size size, bool finest, double part) {
  const bool rests = target_->keeps() && shown_.is_of(*this, size);
  if (rests && shown_.smooth) return;
  const bool smooth = finest || rests;
  const auto drawn = [&](int pixels) {
    return smooth ? pixels : std::max(1, static_cast<int>(part * pixels));
  };
  const render::Size drawn_size{drawn(size.width), drawn(size.height)};
  gl::Style style = style_;
  if (!smooth) style.line_width_px *= static_cast<float>(part);
  target_->begin(drawn_size, smooth);
  renderer_->draw(scene_, camera_, drawn_size, style, !smooth);
  shown_ = {scene_, camera_, size, blocks_sent(), style_, smooth};
}

void SceneWindow::draw_all(bool finest, double part) {
  const render::Size all = pixels_of(window_);
  const int below = std::clamp(below_, 0, all.height - 1);
  const render::Size size{all.width, all.height - below};
  gl::clear_screen();
  draw_scene(size, finest, part);
  target_->end(size, below);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool SceneWindow::take_close_request() noexcept {
  const bool wanted = glfwWindowShouldClose(window_) != 0;
  glfwSetWindowShouldClose(window_, GLFW_FALSE);
  return wanted;
}

render::Size SceneWindow::scene_size() const noexcept {
  const render::Size all = pixels_of(window_);
  return {all.width, std::max(1, all.height - below_)};
}

render::Camera SceneWindow::stage_camera() const noexcept {
  render::Camera camera = camera_;
  camera.target += builder_.origin_m();
  return camera;
}

render::Image SceneWindow::screenshot() {
  draw_all(true); // again, for what was shown may be gone
  return gl::read_pixels(pixels_of(window_));
}

render::Image SceneWindow::moving_screenshot(double part) {
  shown_.size = {}; // as if it were the first one of its kind
  draw_all(false, part);
  return gl::read_pixels(pixels_of(window_));
}

render::Image SceneWindow::silhouette(render::Size size) {
  renderer_->draw_silhouette(scene_, camera_, size);
  return gl::read_pixels(size);
}

} // namespace nendo::viewer
