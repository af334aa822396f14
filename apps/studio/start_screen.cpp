#include "studio/start_screen.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include <imgui.h>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "session/kept_state.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/picture_card.hpp"
#include "viewer/theme.hpp"

namespace nendo::studio {

using viewer::em;
using viewer::gap_em;
namespace fs = std::filesystem;

namespace {

constexpr float panel_part = 0.62F; // of the window's width
constexpr float picture_ratio = 4.0F / 3.0F;

struct ModeCard {
  const char* title;
  const char* picture; ///< a file of share/nendo/pictures
  const char* mode;    ///< empty: a puppet is played
  const char* puppet;  ///< that is played without a chosen model
  const char* help;
};
constexpr std::array modes{
    ModeCard{"Puppet", "puppet.png", "", "face",
             "Each finger plays an action of a face or a figure."},
    ModeCard{"Pull", "pull.png", "type1", "",
             "Fingertips hold the surface and pull it; from rest, it follows them."},
    ModeCard{"Strokes", "strokes.png", "type2", "",
             "Strokes of the fingertips add up; brushes push, smooth, pinch and more."},
    ModeCard{"Clay", "clay.png", "clay", "", "Whole hands press clay, which keeps its volume."},
    ModeCard{"Parts", "parts.png", "parts", "",
             "Closing hands take separate parts of a model, move and turn them."},
};

const char* const state_words[] = {"opening", "streaming", "silent", "not usable", "tracker"};

} // namespace

std::vector<StartScreen::Model> StartScreen::models() {
  const auto with = [](const char* title, const char* file, const char* puppet) {
    return Model{title, cli::shipped_model(file).string(), puppet};
  };
  std::vector<Model> all{with("Moai", "moai.obj", "moai"), with("Head", "head.obj", ""),
                         with("Face", "face.obj", "face"), with("Spot", "spot.obj", "spot"),
                         with("Ball of clay", "clay.ply", "")};
  constexpr std::array endings{".obj", ".ply", ".stl", ".gltf", ".glb"};
  for (const std::string& file : session::recent_files()) {
    const bool is_model = std::ranges::any_of(
        endings, [&](const char* ending) { return fs::path(file).extension() == ending; });
    if (is_model) all.push_back({printable(fs::path(file).filename().string()), file, ""});
  }
  return all;
}

std::vector<std::string> StartScreen::files_of(const std::vector<Model>& models) {
  std::vector<std::string> files;
  for (const Model& model : models)
    files.push_back(model.file);
  return files;
}

StartScreen::StartScreen(viewer::SceneWindow& window, const StartOptions& options)
    : models_(models()), gallery_(files_of(models_)), board_(options.gloves, options.calibration),
      chosen_(models_.size()) {
  if (options.gloves.empty())
    simulated_.emplace(std::vector<std::string>{"sim:wave?hand=left", "sim:wave?hand=right&seed=2"},
                       gloves::CalibrationOptions{});
  window.clear_model(true);
  // About both hands, whether they are there or not.
  window.frame(
      {{-0.24F, 0.0F, 0.0F}, {0.24F, 0.0F, 0.0F}, {0.0F, 0.24F, 0.0F}, {0.0F, -0.16F, 0.0F}},
      {0.0, 12.0});
  load_pictures();
}

StartScreen::~StartScreen() = default;

void StartScreen::load_pictures() {
  for (const ModeCard& card : modes) {
    const auto image = render::read_png(cli::shipped_model("").parent_path().parent_path() /
                                        "pictures" / card.picture);
    modes_.push_back(image ? std::make_unique<gl::Picture>(*image) : nullptr);
  }
}

/// A model that was chosen is played by its own puppet, or by one that is begun beside it.
Shape StartScreen::shape_of(std::size_t mode) const {
  Shape shape;
  shape.mode = modes[mode].mode;
  shape.puppet = modes[mode].puppet;
  if (hands_ == 1) shape.hands = Hands::moving;
  if (hands_ == 2) shape.hands = Hands::still;
  if (chosen_ == models_.size()) {
    if (shape.mode == "type2") shape.model = models_[1].file; // strokes show on a head
    return shape;
  }
  const Model& model = models_[chosen_];
  shape.model = model.file;
  if (shape.puppet.empty()) return shape;
  shape.puppet = model.puppet.empty()
                     ? fs::path(model.file).replace_extension(".puppet.toml").string()
                     : model.puppet;
  if (!model.puppet.empty()) shape.model.clear(); // the puppet names it
  return shape;
}

void StartScreen::draw_modes(Wish& wish) {
  ImGui::TextUnformatted("Start");
  ImGui::SameLine();
  ImGui::TextDisabled("A click on one of these begins.");
  const float width = viewer::share_of_line(modes.size());
  for (std::size_t at = 0; at < modes.size(); ++at) {
    if (at > 0) ImGui::SameLine();
    if (viewer::picture_card(modes[at].title, modes_[at].get(), picture_ratio, width))
      wish = shape_of(at);
    viewer::show_text(modes[at].help);
  }
}

void StartScreen::draw_models(Wish& wish) {
  constexpr std::size_t in_line = 5;
  const float width = viewer::share_of_line(in_line);
  ImGui::TextUnformatted("With this model");
  ImGui::SameLine();
  ImGui::TextDisabled("If none is chosen, each way takes its own.");
  for (std::size_t at = 0; at < models_.size(); ++at) {
    const bool begins_recent = at == shipped && at > 0;
    if (begins_recent) ImGui::TextUnformatted("Recent");
    const std::size_t in_group = at < shipped ? at : at - shipped;
    if (in_group % in_line != 0) ImGui::SameLine();
    if (viewer::picture_card(models_[at].title, gallery_.picture(at), picture_ratio, width,
                             at == chosen_))
      chosen_ = at == chosen_ ? models_.size() : at;
    viewer::show_text(models_[at].file);
  }
  if (viewer::button("Open a file...")) wish = Open{};
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Or drop one on the window: a model, a puppet, a recording, a timeline.");
}

void StartScreen::draw_device(const DeviceCard& card, Wish& wish) {
  ImGui::PushID(&card);
  const bool is_fine =
      card.state == DeviceCard::State::streaming || card.state == DeviceCard::State::tracker;
  const ImVec4 colour = is_fine ? ImGui::GetStyle().Colors[ImGuiCol_Text] : viewer::warning();
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(card.title.c_str());
  viewer::note_control("device " + card.title, "");
  ImGui::TextColored(colour, "%s", state_words[static_cast<std::size_t>(card.state)]);
  ImGui::TextDisabled("%s", card.words.c_str());
  if (!card.remedy.empty()) ImGui::TextColored(viewer::warning(), "%s", card.remedy.c_str());
  ImGui::PopTextWrapPos();
  if (card.side && card.state == DeviceCard::State::streaming) {
    const char* const words = card.is_uncalibrated ? "Calibrate..." : "Calibrate again...";
    if (viewer::button(words)) wish = Go{Screen::calibration, card.spec};
    viewer::show_text("Takes a minute. Each finger then moves as yours does.");
  }
  ImGui::Separator();
  ImGui::PopID();
}

void StartScreen::draw_choice_of_hands() {
  const bool any = board_.has_gloves() || !simulated_;
  const std::array<std::string_view, 3> names{any ? "the gloves" : "gloves, if one comes",
                                              "simulated, moving", "simulated, still"};
  viewer::choice_field("Hands", names, hands_);
  viewer::show_text("The hands of the run. The right mouse button moves a simulated one.");
}

void StartScreen::draw_hands(const viewer::SceneWindow& window, Wish& wish) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float left = panel_part * all.x + em(gap_em);
  ImGui::SetNextWindowPos({left, all.y - em(gap_em)}, ImGuiCond_Always, {0.0F, 1.0F});
  const float width = all.x - left - em(gap_em);
  const float high = (all.y - window.above_px()) * 0.45F;
  ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, high});
  ImGui::Begin("Your hands", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  for (const DeviceCard& card : board_.cards())
    draw_device(card, wish);
  if (board_.cards().empty()) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted("No glove is plugged in. Simulated hands play in its place; plug one "
                           "in at any time.");
    ImGui::PopTextWrapPos();
  }
  draw_choice_of_hands();
  ImGui::End();
}

std::string StartScreen::found_glove() const {
  for (const DeviceCard& card : board_.cards())
    if (card.side && card.state == DeviceCard::State::streaming) return card.spec;
  return {};
}

Wish StartScreen::show(viewer::SceneWindow& window) {
  Wish wish;
  board_.update();
  if (simulated_) simulated_->update();
  scene_frame_.hands = {};
  if (simulated_ && !board_.has_gloves()) simulated_->pose(scene_frame_);
  board_.pose(scene_frame_);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  window.leave_left(static_cast<int>(panel_part * all.x));
  window.leave_below(0);
  window.begin_picture(scene_frame_);
  window.move_camera();
  const float gap = em(gap_em), top = window.above_px() + gap;
  const float width = panel_part * all.x - gap;
  ImGui::SetNextWindowPos({gap, top});
  ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, all.y - top - gap});
  ImGui::Begin("start", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  draw_modes(wish);
  ImGui::Dummy({0.0F, em(0.5F)});
  draw_models(wish);
  ImGui::End();
  draw_hands(window, wish);
  window.end_picture();
  return wish;
}

} // namespace nendo::studio
