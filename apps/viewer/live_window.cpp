#include "viewer/live_window.hpp"

#include <utility>

#include <imgui.h>

#include "viewer/panel.hpp"
#include "viewer/status_bar.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

namespace {

/// Returns the radius about each fingertip within which the hands move the model; 0: none.
std::array<double, 5> reach_of(const flow::Frame& frame) {
  std::array<double, 5> radius_m = frame.settings.radius_m;
  if (frame.function_count > 0 || frame.parts.count > 0) radius_m.fill(0.0);
  if (frame.clay.is_clay)
    for (double& radius : radius_m)
      radius = std::max(radius, flow::ClayHands::min_radius_m);
  return radius_m;
}

} // namespace

LiveWindow::LiveWindow(std::shared_ptr<SceneWindow> window)
    : window_(std::move(window)), panel_(std::make_unique<Panel>(*window_, editor_)) {}

LiveWindow::~LiveWindow() = default;

void LiveWindow::begin(const deform::BlockLayout& layout, const render::SceneBuilder& builder,
                       const flow::LoopSettings& settings) {
  set_model(layout, builder);
  panel_->pending.follow(settings);
  holds_ = {};
}

void LiveWindow::set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder) {
  window_->set_model(layout, builder);
  builder_.emplace(builder);
  shows_loop_ = true;
  scene_frame_.vertices = layout.original();
}

Commands LiveWindow::show(const flow::Frame& frame, bool fresh, const Gauges& gauges) {
  const HostTime begin = HostClock::now();
  if (fresh) {
    holds_.follow(frame);
    panel_->follow(frame, gauges.rate_hz);
    if (shows_loop_) window_->follow(frame.shape);
    scene_frame_.radius_m = reach_of(frame);
  }
  window_->set_parts_in_reach(gauges.parts, frame.parts.in_reach);
  set_hands(frame, holds_, scene_frame_);
  if (frame.ticks_run > 0) panel_->pending.follow(frame.settings);
  window_->leave_left(panel_->covered_px());
  window_->leave_below(static_cast<int>(status_bar_height()));
  window_->begin_picture(scene_frame_, frame.ticks_run > 0); // before, no hand is there
  if ((editor_.is_on() || editor_.has_masks()) && !editor_.is_dragging())
    for (const render::Surface& veil : marks_.veils(editor_, *builder_))
      window_->add(veil);
  if (!move_hand(frame) && !edit_puppet()) window_->move_camera();
  panel_->draw(frame, gauges);
  show_model(frame);
  // A puppet that was begun here is played by hands that had nothing to hold.
  const bool begins = !std::exchange(plays_, frame.function_count > 0) && plays_;
  if (begins && frame.puppet > 0 && !frame.held) panel_->commands.emplace_back(flow::Request::grab);
  const HostTime prepared = HostClock::now();
  window_->end_picture();
  const HostTime end = HostClock::now();
  panel_->pictures_ms.add(static_cast<float>(1e3 * to_seconds(end - begin)));
  if (fresh) {
    picture_times_.preparing.record(prepared - begin);
    picture_times_.whole.record(end - begin);
  }
  if (window_->take_close_request()) panel_->commands.emplace_back(flow::EndRun{});
  return std::exchange(panel_->commands, {});
}

void LiveWindow::show_hints() noexcept {
  panel_->hints = true;
}

bool LiveWindow::has_hints() const noexcept {
  return panel_->hints;
}

const std::string& LiveWindow::message() const noexcept {
  return panel_->message;
}

const flow::LoopSettings& LiveWindow::settings() const noexcept {
  return panel_->pending.now;
}

// That of the loop, or that of the editor.
void LiveWindow::show_model(const flow::Frame& frame) {
  if (const deform::BlockShape* const shape = editor_.is_on() ? editor_.shape() : nullptr) {
    shows_loop_ = false;
    window_->follow(*shape);
  } else if (!std::exchange(shows_loop_, true)) {
    window_->follow(frame.shape);
  }
}

bool LiveWindow::edit_puppet() {
  if (!editor_.is_on()) return false;
  const ModelPicture picture(*window_, builder_->units_per_metre());
  const bool is_taken = tool_.follow(picture, editor_);
  draw_points(editor_, picture, tool_.hovered());
  return is_taken;
}

// True: the mouse holds a hand, and does nothing else.
bool LiveWindow::move_hand(const flow::Frame& frame) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return false;
  const render::Camera camera = window_->stage_camera();
  const render::Size size = window_->scene_size();
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Right)) hand_mover_.release();
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Right))
    hand_mover_.take(camera, frame, pointer_px(), size);
  if (!hand_mover_.holds()) return false;
  const Eigen::Vector2d by = moved_px();
  if (io.KeyShift) {
    hand_mover_.turn(camera, by.x(), by.y());
  } else {
    hand_mover_.shift(camera, by.x(), by.y(), size.height);
  }
  hand_mover_.push(camera, static_cast<double>(io.MouseWheel));
  if (!by.isZero(0.0) || io.MouseWheel != 0.0F) panel_->commands.emplace_back(hand_mover_.move());
  return true;
}

} // namespace nendo::viewer
