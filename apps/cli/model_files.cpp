#include "cli/model_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "cli/cli.hpp"

namespace nendo::cli {

namespace {

namespace fs = std::filesystem;
constexpr std::string_view between = " + ";

std::vector<std::string> split(const std::string& name) {
  std::vector<std::string> pieces;
  std::size_t first = 0;
  for (std::size_t at = name.find(between); at != std::string::npos;
       at = name.find(between, first)) {
    pieces.push_back(name.substr(first, at - first));
    first = at + between.size();
  }
  pieces.push_back(name.substr(first));
  return pieces;
}

template <class Change>
std::string changed_name(const std::string& name, const Change& change) {
  std::vector<std::string> files = files_of_name(name);
  for (std::string& file : files)
    file = change(fs::path(file)).string();
  return name_of_files(files);
}

} // namespace

std::string name_of_files(const std::vector<std::string>& files) {
  std::string name;
  for (const std::string& file : files)
    name += (name.empty() ? "" : std::string(between)) + file;
  return name;
}

// The name of a file may have the separator in it.
std::vector<std::string> files_of_name(const std::string& name) {
  const std::vector<std::string> pieces = split(name);
  std::vector<std::string> files;
  std::string file;
  auto first = pieces.begin(); // of that file
  for (auto piece = pieces.begin(); piece != pieces.end(); ++piece) {
    file += (piece == first ? "" : std::string(between)) + *piece;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    files.push_back(std::exchange(file, {}));
    first = piece + 1;
  }
  files.insert(files.end(), first, pieces.end()); // of which some are missing
  return files;
}

std::string absolute_name(const std::string& name) {
  return changed_name(name, [](const fs::path& file) { return fs::absolute(file); });
}

std::string short_name(const std::string& name) {
  return changed_name(name, [](const fs::path& file) { return file.filename(); });
}

namespace {

std::vector<std::string>& kept_model_notes() {
  static std::vector<std::string> notes;
  return notes;
}

} // namespace

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
