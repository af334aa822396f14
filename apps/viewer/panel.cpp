#include "viewer/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include <nendo/flow/setting.hpp>

#include "viewer/controls.hpp"
#include "viewer/puppet_tool.hpp"
#include "viewer/status_bar.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

namespace {

constexpr float width_em = 19.0F;
constexpr const char* mouse_words =
    "right drag on a hand moves it, with shift turns it, with the wheel pushes and pulls it;\n"
    "while a puppet is edited, a click places a point, a drag of a point sets where it goes,\n"
    "with shift how it turns, the wheel over one how far it reaches";

/// Returns whether the window is wide enough for a panel at its right.
bool is_wide() {
  return ImGui::GetIO().DisplaySize.x > em(60.0F);
}

} // namespace

void LiveWindow::Panel::follow(const flow::Frame& frame, double rate_hz) {
  if (frame.ticks_run == 0) return;
  const auto ms = [](HostClock::duration time) {
    return static_cast<float>(1e3 * to_seconds(time));
  };
  late_ms.add(std::max(0.0F, ms(frame.woke - frame.scheduled)));
  uneven_ms.add(
      static_cast<float>(std::abs(static_cast<double>(ms(frame.since_last)) - 1e3 / rate_hz)));
}

bool LiveWindow::Panel::has_history() const {
  return !is_wide();
}

void LiveWindow::Panel::describe_look(forms::Form& form, const commands::Situation& now) {
  auto material = static_cast<std::size_t>(window.material());
  const std::string help = commands::help_of(*commands::named("next material"), now);
  if (form.choice("material", help, gl::material_names, material))
    window.material() = static_cast<gl::Material>(material);
}

void LiveWindow::Panel::describe_painting(forms::Form& form) {
  if (editor.brushes() && !editor.message().empty())
    form.text(editor.message(), forms::Form::Tone::plain, "What painting has done, or what to do.");
}

bool LiveWindow::Panel::is_on(const commands::Row& row) const {
  if (row.name == "paint masks") return editor.brushes();
  const auto switches = window.switches();
  const auto found =
      std::ranges::find(switches, row.name, [](const auto& one) { return one.first; });
  return found != switches.end() && *found->second;
}

int LiveWindow::Panel::covered_px() const {
  return folded ? 0 : static_cast<int>(em(gap_em + width_em));
}

void LiveWindow::Panel::draw_tools(const flow::Frame& frame, const Gauges& gauges, float top) {
  const float gap = em(gap_em);
  const float high = ImGui::GetIO().DisplaySize.y - status_bar_height() - gap - top;
  if (std::exchange(fold_asked, false)) ImGui::SetNextWindowCollapsed(!folded);
  // Without navigation, or Tab, which begins to edit a puppet, would also begin to edit a number.
  const std::string title = gauges.model + "###panel";
  const bool open =
      begin_pane(title.c_str(), {gap, top}, {0.0F, 0.0F}, {em(width_em), std::max(em(3.0F), high)},
                 ImGuiWindowFlags_NoNavInputs);
  folded = ImGui::IsWindowCollapsed();
  if (open) describe(tools_, {frame, gauges.facts}, gauges.devices);
  ImGui::End();
}

/// At the window's right, where tools of any length leave it in sight.
void LiveWindow::Panel::draw_history(const flow::Frame& frame, float top) {
  begin_pane("history", {ImGui::GetIO().DisplaySize.x - em(gap_em), top}, {1.0F, 0.0F},
             {em(12.0F), em(20.0F)}, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoNav);
  describe_history(history_, frame);
  ImGui::End();
}

/// Over the picture, for the first minutes.
void LiveWindow::Panel::draw_hints() {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float middle = (static_cast<float>(covered_px()) + all.x) / 2.0F;
  const float bottom = all.y - status_bar_height() - em(gap_em);
  begin_pane("hints", {middle, bottom}, {0.5F, 1.0F}, {0.0F, 0.0F},
             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoNav);
  for (const auto& [keys, text] : commands::hints) {
    ImGui::TextColored(accent(), "%s", keys.data());
    ImGui::SameLine(em(4.0F));
    ImGui::TextUnformatted(text.data());
  }
  ImGui::TextDisabled("F3 finds any command, ? lists the keys.");
  ImGui::SameLine();
  if (button("Do not show again")) hints = false;
  show_text("Closes these hints for good.");
  ImGui::End();
}

void LiveWindow::Panel::draw(const flow::Frame& frame, const Gauges& gauges) {
  const float top = em(gap_em) + window.above_px();
  draw_tools(frame, gauges, top);
  if (!folded && is_wide()) draw_history(frame, top);
  if (!commands.empty()) note.clear();
  const commands::Situation now{frame, gauges.facts};
  if (gesture.is_on()) {
    gesture.follow(); // which takes all keys
  } else {
    window.follow_view_keys();
    for (const commands::Row* const row : search.asked(commands::in_window, now, mouse_words))
      take(*row, now);
  }
  message = gesture.is_on() ? gesture.message() : note.empty() ? gauges.report : note;
  const bool is_error = !note.empty() || gauges.report_is_error;
  draw_status_bar(frame, gauges, message, is_error && !gesture.is_on());
  if (hints) draw_hints();
  if (const auto change = pending.ask()) commands.push_back(*change);
}

void LiveWindow::Panel::take(const commands::Row& row, const commands::Situation& now) {
  if (row.is_for_run())
    ask(row, now);
  else if (!row.setting.empty())
    begin_gesture(row, now);
  else
    execute(row);
}

/// Returns the metres of a pixel at the model under the mouse or, beside it, at what the camera
/// looks at.
double LiveWindow::Panel::metres_of_pixel(const flow::Frame& frame) const {
  const ModelPicture picture(window, frame.units_per_metre);
  const deform::Points& rest = editor.model().vertices;
  deform::Mesh shape = editor.seen();
  if (!editor.is_on() && rest.cols() > 0) {
    const deform::BlockLayout layout(rest);
    if (frame.shape.block_count() == layout.block_count())
      layout.unpack(frame.shape, shape.vertices);
  }
  const auto hit = picture.hit_of_mouse(shape, rest);
  const Eigen::Vector3d place = hit ? hit->at : picture.camera.target;
  return way_in_picture(picture.camera, place, 1.0, 0.0, picture.size.height).norm() /
         frame.units_per_metre;
}

void LiveWindow::Panel::begin_gesture(const commands::Row& row, const commands::Situation& now) {
  using flow::setting::brush_strength;
  const bool is_radius = row.setting == flow::setting::radius.name;
  const bool is_editor = is_radius && editor.is_on(); // of its brush or of its points
  const char* const refusal = is_editor ? nullptr : row.refusal_in(now);
  note = refusal != nullptr ? refusal : "";
  if (refusal != nullptr) return;
  if (!is_radius) {
    gesture.begin({std::string(brush_strength.label), "", pending.now.brush_strength,
                   brush_strength.range, 2},
                  [this](double strength) { pending.now.brush_strength = strength; });
    return;
  }
  const double cm_of_pixel = 100.0 * metres_of_pixel(now.frame);
  const auto begin = [&](double first_cm, const flow::Range& range, auto use) {
    gesture.begin({"radius", "cm", first_cm, range, 1, cm_of_pixel},
                  [first_cm, use](double cm) { use(cm / first_cm); });
  };
  if (is_editor) {
    const double radius = editor.brushes() ? editor.brush_radius() : editor.radius();
    begin(100.0 * radius / now.frame.units_per_metre, {0.1, 1000.0},
          [this](double factor) { editor.multiply_radius(factor); });
    return;
  }
  const auto& radii_m = pending.now.radius_m; // all keep their ratios to the largest
  const flow::Range& handy_m = flow::setting::radius.handy;
  begin(100.0 * *std::max_element(radii_m.begin(), radii_m.end()),
        {100.0 * handy_m.min, 100.0 * handy_m.max}, [this, radii_m](double factor) {
          for (std::size_t finger = 0; finger < radii_m.size(); ++finger)
            pending.now.radius_m[finger] =
                flow::setting::radius.range.nearest(factor * radii_m[finger]);
        });
}

/// Executes a command that concerns the window alone.
void LiveWindow::Panel::execute(const commands::Row& row) {
  const std::string_view name = row.name;
  window.execute(name);
  if (name == "fold panel") fold_asked = true;
  if (name == "edit puppet") editor.turn(!editor.is_on());
  if (name == "paint masks") editor.toggle_brush();
  if (!editor.is_on()) return;
  if (editor.brushes() && !editor.rig().puppet().is_played()) {
    if (name == "forget place") editor.toggle_brush();
    if (name == "delete point") commands.emplace_back(flow::SetMask{flow::MaskEdit::clear});
    return;
  }
  if (name == "mirror puppet") editor.toggle_mirror();
  if (name == "pin point") editor.toggle_pin();
  if (name == "delete point") editor.remove_point();
  if (name == "forget place") editor.forget_place();
}

} // namespace nendo::viewer
