#include "files/model_folder.hpp"

#include <algorithm>
#include <system_error>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

namespace nendo::deform {
namespace {

constexpr std::size_t max_listed_files = 50'000; // of one folder
constexpr std::size_t max_listed_folders = 64;
constexpr std::string_view too_large_lack =
    ": is too large; at most 256 MiB are read of all textures together, and 16 MiB of a file of "
    "materials";

/// Names that a person takes for the same: capitals and repeated blanks count for nothing.
std::string folded(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c == ' ' && text.ends_with(' ')) continue;
    text += to_lower(c);
  }
  return text;
}

std::string_view folder_of(std::string_view name) noexcept {
  const std::size_t slash = name.rfind('/');
  return slash == std::string_view::npos ? std::string_view() : name.substr(0, slash);
}

bool is_absolute_anywhere(std::string_view name) noexcept {
  const bool has_drive = name.size() > 1 && name[1] == ':';
  return name.starts_with('/') || has_drive;
}

/// Returns whether a name with slashes leads out of any folder that it is relative to.
bool leads_out(std::string_view name) noexcept {
  if (is_absolute_anywhere(name)) return true;
  for (std::string_view rest = name; !rest.empty();)
    if (cut(rest, '/') == "..") return true;
  return false;
}

std::string slashed(std::string_view named) {
  std::string name(named);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

/// The names that a name can mean, the likeliest first. Of one that leads out of the folder, its
/// ends: the folder of textures that it names may have been copied beside the model.
std::vector<std::string> readings_of(std::string_view named, std::string_view beside) {
  const auto name = name_in_folder(named);
  if (!name) return {};
  std::vector<std::string> ends{*name};
  const std::string whole = slashed(named);
  if (leads_out(whole)) {
    constexpr std::size_t max_ends = 4;
    std::string end;
    std::vector<std::string_view> parts;
    for (std::string_view rest = whole; !rest.empty();)
      if (const std::string_view part = cut(rest, '/'); !part.empty() && part != ".")
        parts.push_back(part);
    for (auto part = parts.rbegin(); part != parts.rend() && ends.size() < max_ends; ++part) {
      if (*part == ".." || part->find(':') != std::string_view::npos) break;
      end = end.empty() ? std::string(*part) : std::string(*part) + "/" + end;
      if (end != *name) ends.insert(ends.begin(), end); // the longest first
    }
  }
  std::vector<std::string> readings;
  const std::string own_folder(folder_of(beside));
  for (const std::string& one : ends) {
    if (!own_folder.empty()) readings.push_back(own_folder + "/" + one);
    readings.push_back(one);
  }
  return readings;
}

bool is_below_folder(const std::filesystem::path& folder, const std::filesystem::path& path) {
  const auto [inside, below] =
      std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return inside == folder.end();
}

} // namespace

std::optional<std::string> name_in_folder(std::string_view named) {
  if (named.find('\0') != std::string_view::npos || named.size() > 1024) return std::nullopt;
  const std::string whole = slashed(named);
  std::string name;
  std::string_view last;
  for (std::string_view rest = whole; !rest.empty();) {
    const std::string_view part = cut(rest, '/');
    last = part;
    if (part.empty() || part == ".") continue;
    name += (name.empty() ? "" : "/") + std::string(part);
  }
  if (whole.ends_with('/') || last.empty() || last == "." || last == "..") return std::nullopt;
  if (!leads_out(whole)) return name;
  // "C:skin.png": the drive is no part of the name.
  last.remove_prefix(last.rfind(':') + 1); // of npos, 0
  if (last.empty() || last == "." || last == "..") return std::nullopt;
  return std::string(last);
}

ModelFolder::ModelFolder(const std::filesystem::path& model) {
  std::error_code failed;
  const auto parent = model.parent_path();
  folder_ = std::filesystem::canonical(parent.empty() ? "." : parent, failed);
  if (failed) folder_.clear();
}

FolderFile ModelFolder::find(std::string_view named, std::uint64_t max_bytes,
                             std::string_view beside) const {
  const std::vector<std::string> readings = readings_of(named, beside);
  if (readings.empty()) return {{}, {}, ": cannot be the name of a file"};
  for (const std::string& reading : readings)
    if (const auto name = spelled(reading)) return read(*name, max_bytes);
  return {readings.back(),
          {},
          leads_out(slashed(named))
              ? ": is named outside of the model's folder, where nothing is read; copy the "
                "file beside the model"
              : ": there is no such file; put it beside the model"};
}

/// How the file of that name is spelled, if there is one.
std::optional<std::string> ModelFolder::spelled(const std::string& name) const {
  if (folder_.empty()) return std::nullopt;
  std::error_code failed;
  if (std::filesystem::exists(folder_ / name, failed)) return name;
  std::string found;
  for (std::string_view rest = name; !rest.empty();) {
    const std::string_view part = cut(rest, '/');
    const auto& files = listing(found);
    const auto file = files.find(folded(part));
    if (file == files.end()) return std::nullopt;
    found += (found.empty() ? "" : "/") + file->second;
  }
  return found;
}

const std::map<std::string, std::string, std::less<>>&
ModelFolder::listing(const std::string& folder) const {
  static const std::map<std::string, std::string, std::less<>> none;
  if (const auto known = listings_.find(folder); known != listings_.end()) return known->second;
  if (listings_.size() >= max_listed_folders) return none;
  auto& files = listings_[folder];
  std::error_code failed;
  const auto path = std::filesystem::canonical(folder_ / folder, failed);
  if (failed || !is_below_folder(folder_, path)) return files;
  for (std::filesystem::directory_iterator file(path, failed), end;
       !failed && file != end && files.size() < max_listed_files; file.increment(failed)) {
    const std::string name = file->path().filename().string();
    // Of several that are alike, the first in the alphabet, for folders have no order.
    const auto [place, is_new] = files.emplace(folded(name), name);
    if (!is_new && name < place->second) place->second = name;
  }
  return files;
}

FolderFile ModelFolder::read(const std::string& name, std::uint64_t max_bytes) const {
  FolderFile file{name, {}, {}};
  std::error_code failed;
  const auto path = std::filesystem::canonical(folder_ / name, failed);
  if (failed || !is_below_folder(folder_, path)) {
    file.lack = ": is a link out of the model's folder, where nothing is read; copy the file "
                "itself beside the model";
    return file;
  }
  auto contents = read_file(path, max_bytes, "part of a model");
  if (contents && !contents->empty()) {
    file.contents = *std::move(contents);
    return file;
  }
  const auto bytes = std::filesystem::file_size(path, failed);
  if (contents)
    file.lack = ": is empty; export it once more";
  else if (!std::filesystem::is_regular_file(path, failed))
    file.lack = ": is no regular file";
  else if (!failed && bytes > max_bytes)
    file.lack = too_large_lack;
  else
    file.lack = ": cannot be read; check its permissions";
  return file;
}

void TextureFiles::read(const ModelFolder& folder, Texture& texture, std::string_view named,
                        std::string_view beside) {
  FolderFile file = folder.find(named, left_, beside);
  if (!file.name.empty()) texture.file = file.name;
  take(std::move(file), named, texture);
}

void TextureFiles::take(FolderFile file, std::string_view named, Texture& texture) {
  if (file.contents && file.contents->size() > left_) {
    file.contents.reset();
    file.lack = too_large_lack;
  }
  if (!file.contents) return notes_.add("texture", named, file.lack);
  left_ -= file.contents->size();
  texture.contents = std::make_shared<const std::string>(*std::move(file.contents));
}

void note_unplaced_textures(const Mesh& mesh, NoteSum& notes) {
  if (!mesh.corner_texcoords.empty()) return;
  for (const Texture& texture : mesh.look.textures)
    if (texture.contents)
      notes.add("texture", texture.file,
                ": the model has no texture coordinates, so it is not shown");
}

void read_textures(const ModelFolder& folder, const std::vector<std::string>& named, Mesh& mesh,
                   ReadNotes& notes) {
  NoteSum sum;
  TextureFiles files(sum);
  for (std::size_t at = 0; at < named.size(); ++at)
    files.read(folder, mesh.look.textures[at], named[at]);
  note_unplaced_textures(mesh, sum);
  sum.append_to(notes);
}

} // namespace nendo::deform
