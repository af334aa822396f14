#include "studio/file_dialog.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

using viewer::button;
using viewer::em;
namespace fs = std::filesystem;

namespace {

fs::path home() {
  const char* const home = std::getenv("HOME");
  return home != nullptr && *home == '/' ? fs::path(home) : fs::path("/");
}

std::string size_in_words(std::uintmax_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " bytes";
  const bool is_large = bytes >= 1'000'000;
  const std::uintmax_t tenths = bytes / (is_large ? 100'000 : 100);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) +
         (is_large ? " MB" : " kB");
}

/// A field for a text of any length up to a path's.
bool text_field(const char* label, std::string& text) {
  std::array<char, 4096> typed{};
  text.copy(typed.data(), typed.size() - 1);
  const bool entered =
      ImGui::InputText(label, typed.data(), typed.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  text = typed.data();
  return entered;
}

} // namespace

void FileDialog::begin(Purpose purpose, std::string title, std::vector<std::string> endings,
                       const fs::path& beside) {
  purpose_ = purpose;
  title_ = std::move(title);
  endings_ = std::move(endings);
  name_.clear();
  std::error_code ignored;
  const fs::path whole = fs::absolute(beside, ignored);
  const bool is_folder = fs::is_directory(whole, ignored);
  if (!is_folder && purpose == Purpose::save) name_ = whole.filename().string();
  const fs::path folder = is_folder ? whole : whole.parent_path();
  go_to(fs::is_directory(folder, ignored) ? folder : home());
  begins_ = true;
}

bool FileDialog::fits(const std::string& name) const {
  return std::ranges::any_of(endings_,
                             [&](const std::string& ending) { return ends_in(name, ending); });
}

std::string FileDialog::ending_added(const std::string& name) const {
  return purpose_ == Purpose::open || fits(name) ? name : name + endings_.front();
}

void FileDialog::go_to(const fs::path& folder) {
  std::error_code error;
  folder_ = folder.lexically_normal();
  entries_.clear();
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code of_entry;
    Entry entry{at->path().filename().string(), at->is_directory(of_entry), 0};
    if (entry.name.starts_with('.') || (!entry.is_folder && !fits(entry.name))) continue;
    if (!entry.is_folder) entry.bytes = at->file_size(of_entry);
    if (!of_entry) entries_.push_back(std::move(entry));
  }
  trouble_ = error ? printable(folder_.string()) + ": cannot be read: " + error.message() : "";
  std::ranges::sort(entries_, [](const Entry& one, const Entry& other) {
    return std::pair(!one.is_folder, one.name) < std::pair(!other.is_folder, other.name);
  });
}

void FileDialog::draw_places() {
  if (button("Up") && folder_.has_relative_path()) go_to(folder_.parent_path());
  ImGui::SameLine();
  if (button("Home")) go_to(home());
  if (purpose_ == Purpose::open) {
    ImGui::SameLine();
    if (button("Models")) go_to(cli::shipped_model("moai.obj").parent_path());
  }
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(folder_.c_str());
}

std::optional<std::string> FileDialog::draw_list() {
  std::optional<std::string> taken;
  std::optional<fs::path> entered;
  ImGui::BeginChild("files", ImVec2(em(34.0F), em(18.0F)), true);
  if (!trouble_.empty()) ImGui::TextWrapped("%s", trouble_.c_str());
  if (trouble_.empty() && entries_.empty()) ImGui::TextDisabled("No file of these kinds is here.");
  for (const Entry& entry : entries_) {
    const std::string shown = printable(entry.name) + (entry.is_folder ? "/" : "");
    if (ImGui::Selectable(shown.c_str(), !entry.is_folder && entry.name == name_,
                          ImGuiSelectableFlags_DontClosePopups)) {
      if (entry.is_folder) entered = folder_ / entry.name;
      if (!entry.is_folder) name_ = entry.name;
    }
    viewer::note_control(shown, shown);
    if (!entry.is_folder && ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0))
      taken = (folder_ / entry.name).string();
    if (entry.is_folder) continue;
    ImGui::SameLine(em(27.0F));
    ImGui::TextDisabled("%s", size_in_words(entry.bytes).c_str());
  }
  ImGui::EndChild();
  if (entered) go_to(*entered);
  return purpose_ == Purpose::open ? taken : std::nullopt;
}

/// The buttons, and what a name means: a folder is entered, a path may be typed.
std::optional<std::string> FileDialog::draw_end(bool confirmed) {
  const fs::path file = folder_ / (name_.empty() ? "" : ending_added(name_));
  std::error_code ignored;
  const bool exists = !name_.empty() && fs::exists(file, ignored);
  const bool replaces = saves() && exists;
  if (replaces) ImGui::TextColored(viewer::warning(), "This file exists, and is replaced.");
  const bool is_possible = !name_.empty() && (saves() || exists);
  const char* const words = purpose_ == Purpose::open ? "Open" : replaces ? "Replace" : "Save";
  const bool pressed = button(words, em(6.0F), is_possible);
  ImGui::SameLine();
  const bool cancelled = button("Cancel", em(6.0F)) || viewer::pressed(GLFW_KEY_ESCAPE);
  if (cancelled) is_open_ = false;
  if (!(pressed || confirmed) || !is_possible) return std::nullopt;
  if (fs::is_directory(file, ignored)) {
    go_to(file);
    name_.clear();
    return std::nullopt;
  }
  return file.string();
}

std::optional<std::string> FileDialog::draw() {
  if (std::exchange(begins_, false)) {
    is_open_ = true;
    ImGui::OpenPopup(title_.c_str());
  }
  is_open_ = is_open_ && ImGui::IsPopupOpen(title_.c_str()); // a question may have replaced it
  if (!is_open_ || !viewer::begin_question(title_.c_str())) return std::nullopt;
  draw_places();
  auto taken = draw_list();
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(em(34.0F));
  const bool confirmed = text_field("##name", name_);
  viewer::note_control("file name", "");
  if (auto chosen = draw_end(confirmed)) taken = std::move(chosen);
  if (taken) is_open_ = false;
  if (!is_open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return taken;
}

} // namespace nendo::studio
