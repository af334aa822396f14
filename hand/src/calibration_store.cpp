#include <nendo/hand/calibration_store.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>
#include <tuple>

#include <pwd.h>
#include <unistd.h>

#include "file_name_part.hpp"

namespace nendo::hand {
namespace {

namespace fs = std::filesystem;

fs::path home() {
  const char* const from_environment = std::getenv("HOME");
  if (from_environment != nullptr && from_environment[0] == '/') return from_environment;
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  const int failed = ::getpwuid_r(::getuid(), &entry, buffer.data(), buffer.size(), &found);
  return failed == 0 && found != nullptr ? fs::path(found->pw_dir) : fs::path{};
}

bool is_kept(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

// FNV-1a: a name too long to keep apart by itself is kept apart by this.
std::uint64_t hash_of(const std::string& text) noexcept {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

} // namespace

std::string file_name_part(const std::string& text) {
  constexpr std::size_t most = 80;
  constexpr std::string_view hex = "0123456789ABCDEF";
  std::string part;
  const auto escape = [&](char c) {
    const auto byte = static_cast<unsigned char>(c);
    part += {'%', hex[byte >> 4U], hex[byte & 0xFU]};
  };
  for (const char c : text.substr(0, most)) // later ones are cut off again
    is_kept(c) ? part.push_back(c) : escape(c);
  if (part.size() <= most && text.size() <= most) return part;
  part.resize(std::min(part.size(), most - 17));
  part += '.'; // no escaped text has one
  for (unsigned shift = 64; shift > 0; shift -= 4)
    part += hex[(hash_of(text) >> (shift - 4)) & 0xFU];
  return part;
}

namespace {

void list_folder(const fs::path& folder, bool shared, CalibrationList& list) {
  if (folder.empty()) return;
  std::error_code failed;
  std::vector<fs::path> paths;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    const fs::path& path = at->path();
    if (path.extension() == ".toml" && !is_earlier_version(path)) paths.push_back(path);
  }
  if (failed && failed != std::errc::no_such_file_or_directory) {
    list.unreadable.push_back({Errc::bad_input, folder.string() +
                                                    ": cannot be listed: " + failed.message() +
                                                    "; it should be a folder that you may read"});
  }
  std::sort(paths.begin(), paths.end());
  for (const auto& path : paths) {
    auto wearer = read_calibration(path);
    if (wearer) {
      list.files.push_back({path, shared, *std::move(wearer)});
    } else {
      list.unreadable.push_back(wearer.error());
    }
  }
}

std::optional<GloveMatch> match_of(const WearerCalibration& wearer, const GloveIdentity& glove) {
  if (wearer.side != glove.side) return std::nullopt;
  if (wearer.counts.self_calibrated != glove.counts.self_calibrated) return std::nullopt;
  if (!glove.user.empty() && wearer.user != glove.user) return std::nullopt;
  const bool same_model = wearer.glove_model == glove.model;
  if (!same_model && !wearer.glove_model.empty()) return std::nullopt;
  if (!glove.serial.empty() && wearer.glove_serial == glove.serial) return GloveMatch::this_glove;
  if (wearer.glove_serial.empty()) return GloveMatch::any_glove;
  return same_model ? std::optional(GloveMatch::other_glove) : std::nullopt;
}

} // namespace

CalibrationFolders calibration_folders() {
  CalibrationFolders folders{{}, "/etc/nendo/calibrations"};
  const char* const config = std::getenv("XDG_CONFIG_HOME");
  // The XDG specification: a relative path is to be ignored.
  const fs::path root =
      config != nullptr && config[0] == '/' ? fs::path(config) : home() / ".config";
  if (root.is_absolute()) folders.own = root / "nendo" / "calibrations";
  return folders;
}

std::string calibration_file_name(const std::string& user, const std::string& glove_serial,
                                  Side side) {
  // A glove whose number is "any" is not any glove.
  const std::string glove = glove_serial.empty()    ? "any"
                            : glove_serial == "any" ? "%61ny"
                                                    : file_name_part(glove_serial);
  return file_name_part(user) + "+" + glove + "+" + std::string(name_of(side)) + ".toml";
}

Result<fs::path> own_calibration_path(const std::string& user, const std::string& glove_serial,
                                      Side side) {
  const fs::path folder = calibration_folders().own;
  if (folder.empty())
    return Error{Errc::failed, "you have no home folder; set XDG_CONFIG_HOME to a folder"};
  return folder / calibration_file_name(user, glove_serial, side);
}

CalibrationList list_calibrations(const CalibrationFolders& folders) {
  CalibrationList list;
  list_folder(folders.own, false, list);
  list_folder(folders.shared, true, list);
  return list;
}

std::optional<CalibrationChoice> choose_calibration(const std::vector<StoredCalibration>& files,
                                                    const GloveIdentity& glove) {
  std::optional<CalibrationChoice> best;
  const auto rank = [](const CalibrationChoice& choice) {
    return std::tuple(choice.match, !choice.file->shared, choice.file->wearer.made);
  };
  for (const auto& file : files) {
    const auto match = match_of(file.wearer, glove);
    if (!match) continue;
    const CalibrationChoice choice{&file, *match};
    if (!best || rank(choice) > rank(*best)) best = choice;
  }
  return best;
}

bool is_active_calibration(const StoredCalibration& file,
                           const std::vector<StoredCalibration>& files) {
  const auto& wearer = file.wearer;
  const auto choice = choose_calibration(
      files, {wearer.user, wearer.glove_model, wearer.glove_serial, wearer.side, wearer.counts});
  return choice && choice->file->path == file.path;
}

} // namespace nendo::hand
