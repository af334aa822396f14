#include "cli/model_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "cli/cli.hpp"
#include "cli/figures.hpp"

namespace nendo::cli {

namespace {

namespace fs = std::filesystem;
constexpr std::string_view between = " + ";

template <class Change>
std::string changed_name(const std::string& name, const Change& change) {
  std::vector<std::string> files = files_of_name(name);
  for (std::string& file : files)
    file = change(fs::path(file)).string();
  return name_of_files(files);
}

std::vector<std::string>& kept_model_notes() {
  static std::vector<std::string> notes;
  return notes;
}

} // namespace

std::string name_of_files(const std::vector<std::string>& files) {
  return joined(files, between);
}

// The name of a file may have the separator in it.
std::vector<std::string> files_of_name(const std::string& name) {
  std::vector<std::string> files;
  std::vector<std::string> pieces; // no file that exists has been found for them
  for (std::size_t first = 0; first <= name.size();) {
    const std::size_t end = std::min(name.find(between, first), name.size());
    pieces.push_back(name.substr(first, end - first));
    first = end + between.size();
    const std::string file = name_of_files(pieces);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    files.push_back(file);
    pieces.clear();
  }
  files.insert(files.end(), pieces.begin(), pieces.end());
  return files;
}

std::string absolute_name(const std::string& name) {
  return changed_name(name, [](const fs::path& file) { return fs::absolute(file); });
}

std::string short_name(const std::string& name) {
  return changed_name(name, [](const fs::path& file) { return file.filename(); });
}

void note_model(const std::string& text) {
  auto& notes = kept_model_notes();
  if (std::find(notes.begin(), notes.end(), text) != notes.end()) return; // read once more
  notes.push_back(text);
  note(text);
}

const std::vector<std::string>& model_notes() {
  return kept_model_notes();
}

} // namespace nendo::cli
