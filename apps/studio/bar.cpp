#include "studio/bar.hpp"

#include <filesystem>
#include <string_view>

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <nendo/base/text.hpp>

#include "session/kept_state.hpp"
#include "studio/opened_files.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

using viewer::em;

namespace {

constexpr float bar_em = 2.3F;
constexpr const char* question_title = "Unsaved changes";

bool item(const char* name, const char* keys, bool is_possible = true) {
  const bool taken = ImGui::MenuItem(name, keys, false, is_possible);
  viewer::note_control(name, name);
  return taken;
}

} // namespace

Bar::Bar(viewer::SceneWindow& window) : window_(window) {
  window.set_bar([this] { draw(); }, bar_em);
}

Bar::~Bar() {
  window_.set_bar({}, 0.0F);
}

Wish Bar::take_wish() {
  const auto dropped = window_.take_dropped();
  if (!dropped.empty()) wish_ = Open{dropped.front()};
  return std::exchange(wish_, {});
}

void Bar::ask(const std::string& what) {
  question_ = Question{"Save " + what + "?"};
}

void Bar::ask_to_discard(const std::string& what) {
  question_ = Question{"Discard " + what + "?", false};
}

void Bar::ask_where_to_save() {
  std::filesystem::path beside = std::filesystem::path(state_.file);
  if (beside.extension() != ".obj" && beside.extension() != ".ply" && beside.extension() != ".stl")
    beside.replace_extension(".obj");
  dialog_.begin(FileDialog::Purpose::save, "Save the shape", {".obj", ".ply", ".stl"},
                std::filesystem::path("shaped-" + beside.filename().string()));
}

void Bar::ask_what_to_open() {
  const auto recent = session::recent_files();
  dialog_.begin(FileDialog::Purpose::open, "Open a file", openable(),
                recent.empty() ? "." : recent.front());
}

void Bar::draw_file_menu() {
  if (viewer::button("File")) {
    ImGui::OpenPopup("file");
    recent_ = session::recent_files();
  }
  if (!ImGui::BeginPopup("file")) return;
  if (item("Open...", "Ctrl O")) ask_what_to_open();
  if (ImGui::BeginMenu("Open recent", !recent_.empty())) {
    for (const std::string& file : recent_)
      if (item(printable(file).c_str(), "")) wish_ = Open{file};
    ImGui::EndMenu();
  }
  ImGui::Separator();
  if (item("Save", "Ctrl S", state_.is_shaping)) save_ = "";
  if (item("Save as...", "Ctrl Shift S", state_.is_shaping)) ask_where_to_save();
  ImGui::Separator();
  if (item("Quit", "Ctrl Q")) wish_ = Quit{};
  ImGui::EndPopup();
}

void Bar::draw_tabs() {
  for (const Tab& tab : tabs) {
    ImGui::SameLine();
    const bool is_now = tab.screen == state_.now;
    if (viewer::button(tab.name, 0.0F, true, is_now) && !is_now) wish_ = Go{tab.screen};
    viewer::show_text(tab.help);
  }
}

void Bar::follow_keys() {
  if (!viewer::takes_keys() || !ImGui::GetIO().KeyCtrl) return;
  if (viewer::pressed(GLFW_KEY_O)) ask_what_to_open();
  if (viewer::pressed(GLFW_KEY_Q)) wish_ = Quit{};
  if (viewer::pressed(GLFW_KEY_S) && ImGui::GetIO().KeyShift && state_.is_shaping)
    ask_where_to_save();
}

void Bar::draw_question() {
  if (!question_) return;
  if (!ImGui::IsPopupOpen(question_title)) ImGui::OpenPopup(question_title);
  if (!viewer::begin_question(question_title)) return;
  ImGui::TextUnformatted(question_->words.c_str());
  ImGui::Dummy({0.0F, em(0.3F)});
  if (question_->offers_to_save) {
    if (viewer::button("Save", em(6.0F))) answer_ = Answer::save;
    ImGui::SameLine();
  }
  if (viewer::button("Discard", em(6.0F))) answer_ = Answer::discard;
  ImGui::SameLine();
  if (viewer::button("Stay", em(6.0F)) || viewer::pressed(GLFW_KEY_ESCAPE)) answer_ = Answer::stay;
  if (answer_) {
    question_.reset();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Bar::draw_error() {
  constexpr const char* title = "That did not work";
  if (error_.empty() || question_) return; // one after the other
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!viewer::begin_question(title)) return;
  ImGui::PushTextWrapPos(em(34.0F));
  ImGui::TextUnformatted(error_.c_str());
  ImGui::PopTextWrapPos();
  if (viewer::button("Close", em(6.0F)) || viewer::pressed(GLFW_KEY_ESCAPE) ||
      viewer::pressed(GLFW_KEY_ENTER)) {
    error_.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Bar::draw() {
  const float width = ImGui::GetIO().DisplaySize.x;
  ImGui::SetNextWindowPos({0.0F, 0.0F});
  ImGui::SetNextWindowSize({width, em(bar_em)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(0.7F), em(0.35F)));
  ImGui::Begin("bar", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  follow_keys();
  draw_file_menu();
  draw_tabs();
  if (!state_.file.empty()) {
    const std::string name = printable(std::filesystem::path(state_.file).filename().string()) +
                             (state_.is_modified ? " *" : "");
    const float text_width = ImGui::CalcTextSize(name.c_str()).x;
    ImGui::SameLine(width - text_width - em(0.7F));
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", name.c_str());
    viewer::note_control("file", name);
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  // Dialogs are no parts of the bar: ImGui puts windows that appear meanwhile behind them.
  if (auto chosen = dialog_.draw()) {
    if (dialog_.saves())
      save_ = *chosen;
    else
      wish_ = Open{*chosen};
  }
  draw_question();
  draw_error();
}

} // namespace nendo::studio
