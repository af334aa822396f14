#include <nendo/viewer/live_window.hpp>

#include <algorithm>
#include <thread>
#include <utility>

#include <GL/gl.h>
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "panel.hpp"

namespace nendo::viewer {
namespace {

Error without_window(const std::string& why) {
  return {Errc::failed,
          "no window: " + why +
              "; on a box without a screen `nendo run --web 8080` shows the run in a browser, "
              "and `nendo picture` and `nendo run --picture` draw files"};
}

std::string glfw_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words != nullptr ? words : "GLFW does not say why";
}

Image read_pixels(Size size) {
  std::vector<Pixel> rows(static_cast<std::size_t>(size.width) *
                          static_cast<std::size_t>(size.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(0, 0, size.width, size.height, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
  Image image(size);
  for (int y = 0; y < size.height; ++y) // OpenGL begins at the bottom
    for (int x = 0; x < size.width; ++x)
      image.at(x, y) = rows[static_cast<std::size_t>(size.height - 1 - y) *
                                static_cast<std::size_t>(size.width) +
                            static_cast<std::size_t>(x)];
  return image;
}

Size pixels_of(GLFWwindow* window) {
  Size size;
  glfwGetFramebufferSize(window, &size.width, &size.height);
  return {std::max(1, size.width), std::max(1, size.height)};
}

constexpr std::chrono::milliseconds least_period(8); // where no screen sets the pace

} // namespace

Result<std::unique_ptr<LiveWindow>> LiveWindow::open(const std::string& title, Size size) {
  if (glfwInit() == GLFW_FALSE) return without_window(glfw_error());
  std::unique_ptr<LiveWindow> window(new LiveWindow);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, 4);
  window->window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
  if (window->window_ == nullptr) { // perhaps only for want of samples
    glfwWindowHint(GLFW_SAMPLES, 0);
    window->window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
  }
  if (window->window_ == nullptr) return without_window("no OpenGL 3.3 here: " + glfw_error());
  glfwMakeContextCurrent(window->window_);
  glfwSwapInterval(1);
  auto renderer = GlRenderer::make();
  if (!renderer) return without_window(renderer.error().message);
  window->renderer_ = *std::move(renderer);
  window->panel_ = std::make_unique<Panel>();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr; // leaves no file behind
  ImGui_ImplGlfw_InitForOpenGL(window->window_, true);
  ImGui_ImplOpenGL3_Init("#version 330");
  return window;
}

LiveWindow::~LiveWindow() {
  if (ImGui::GetCurrentContext() != nullptr) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  renderer_.reset();
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void LiveWindow::begin(const deform::BlockLayout& layout, const SceneBuilder& builder,
                       const LoopSettings& settings) {
  builder_.emplace(builder);
  renderer_->set_model(layout, builder);
  panel_->in_force = panel_->wanted = settings;
  panel_->one_radius = std::all_of(settings.radius_m.begin(), settings.radius_m.end(),
                                   [&](double radius) { return radius == settings.radius_m[0]; });
  moment_.radius_m = settings.radius_m;
  moment_.vertices = layout.original();
  holds_ = {};
}

Wishes LiveWindow::show(const flow::Frame& frame, bool fresh, const Gauges& gauges) {
  const HostTime begin = HostClock::now();
  Wishes wishes;
  glfwPollEvents();
  if (fresh) {
    holds_.follow(frame);
    panel_->follow(frame, gauges.rate_hz);
    renderer_->follow(frame.shape);
  }
  see_hands(frame, holds_, moment_);
  builder_->build_beside(moment_, parts_, scene_);
  const Size size = pixels_of(window_);
  if (!framed_) {
    auto points = scene_.outline();
    const Eigen::Vector3f half = (builder_->size_m() / 2).cast<float>();
    for (const float x : {-half.x(), half.x()})
      for (const float y : {0.0F, 2.0F * half.y()})
        for (const float z : {-half.z(), half.z()})
          points.emplace_back(x, y, z);
    camera_ = framing(points, {22.0, 10.0}, 1.0 * size.width / size.height, 0.1);
    framed_ = true;
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  follow_mouse(frame, wishes);
  draw_panel(frame, gauges, wishes);
  ImGui::Render();
  renderer_->draw(scene_, camera_, size);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
  panel_->pictures_ms.add(static_cast<float>(1e3 * to_seconds(HostClock::now() - begin)));
  std::this_thread::sleep_until(begin + least_period);
  wishes.quit = wishes.quit || glfwWindowShouldClose(window_) != 0;
  return wishes;
}

// True: the mouse holds a hand, and does nothing else.
bool LiveWindow::move_hand(const flow::Frame& frame, Wishes& wishes) {
  const ImGuiIO& io = ImGui::GetIO();
  const Size size{static_cast<int>(io.DisplaySize.x), static_cast<int>(io.DisplaySize.y)};
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Right)) hand_mover_.let_go();
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Right))
    hand_mover_.take(camera_, frame, {io.MousePos.x, io.MousePos.y}, size);
  if (!hand_mover_.holds()) return false;
  const auto dx = static_cast<double>(io.MouseDelta.x);
  const auto dy = static_cast<double>(io.MouseDelta.y);
  if (io.KeyShift) {
    hand_mover_.turn(camera_, dx, dy);
  } else {
    hand_mover_.shift(camera_, dx, dy, static_cast<double>(io.DisplaySize.y));
  }
  hand_mover_.push(camera_, static_cast<double>(io.MouseWheel));
  if (dx != 0.0 || dy != 0.0 || io.MouseWheel != 0.0F) wishes.wrist = hand_mover_.move();
  return true;
}

void LiveWindow::follow_mouse(const flow::Frame& frame, Wishes& wishes) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse || move_hand(frame, wishes)) return;
  const auto dx = static_cast<double>(io.MouseDelta.x);
  const auto dy = static_cast<double>(io.MouseDelta.y);
  const bool shifts = ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
                      (ImGui::IsMouseDown(ImGuiMouseButton_Left) && io.KeyShift);
  if (shifts) {
    camera_.pan(dx, dy, static_cast<double>(io.DisplaySize.y));
  } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    camera_.orbit(dx, dy);
  }
  if (io.MouseWheel != 0.0F) camera_.zoom(static_cast<double>(io.MouseWheel));
}

Image LiveWindow::screenshot() const {
  // Drawn anew, for what was shown may be gone.
  const Size size = pixels_of(window_);
  renderer_->draw(scene_, camera_, size);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return read_pixels(size);
}

Image LiveWindow::silhouette(Size size) {
  renderer_->draw(scene_, camera_, size, GlRenderer::Look::silhouette);
  return read_pixels(size);
}

} // namespace nendo::viewer
