#include "studio/opened_files.hpp"

#include <filesystem>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "cli/output_place.hpp"
#include "timeline/edit.hpp"

namespace nendo::studio {

std::vector<std::string> openable() {
  return {".obj", ".ply", ".stl", ".gltf", ".glb", ".puppet.toml", ".timeline.toml", ".nendo"};
}

bool opens_in_timeline(const std::string& file) {
  return ends_in(file, ".nendo") || timeline::is_timeline(file);
}

namespace {

/// Returns the length of the ending of a file that the studio opens.
Result<std::size_t> ending_in(const std::string& name) {
  std::string all;
  for (const std::string& ending : openable()) {
    if (ends_in(name, ending)) return ending.size();
    all += (all.empty() ? "" : ", ") + ending;
  }
  return Error{Errc::bad_input,
               printable(name) + ": the studio opens no such file; it opens " + all};
}

} // namespace

Result<void> check_openable(const std::string& name) {
  const auto ending = ending_in(name);
  return ending ? Result<void>() : ending.error();
}

Result<void> check_there(const std::string& file) {
  if (auto fine = check_openable(file); !fine) return fine;
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return {};
  return Error{Errc::bad_input,
               printable(file) + ": there is no such file on the machine of the gloves"};
}

namespace {

bool is_same_place(const std::string& one, const std::string& other) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const auto place_of = [&](const std::string& file) {
    return fs::weakly_canonical(fs::absolute(file, ignored), ignored);
  };
  return !other.empty() && place_of(one) == place_of(other);
}

} // namespace

Result<std::string> store_sent(const std::string& name, std::string_view bytes,
                               const std::string& reserved) {
  const auto ending = ending_in(name);
  if (!ending) return ending.error();
  const std::size_t stem = name.size() - *ending;
  std::error_code ignored;
  int number = 0;
  std::string place = name;
  while (exists(std::filesystem::symlink_status(place, ignored)) || is_same_place(place, reserved))
    place = cli::next_free_name(name.substr(0, stem), name.substr(stem), number);
  if (const auto written = replace_file(place, bytes); !written) return written.error();
  return place;
}

void remove_sent(const Wish& wish) {
  const auto* const file = std::get_if<Open>(&wish);
  std::error_code ignored;
  if (file != nullptr && file->was_sent) std::filesystem::remove(file->file, ignored);
}

} // namespace nendo::studio
