#include "export/shape_files.hpp"

#include <bit>
#include <cassert>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

#include <nendo/deform/mesh_file.hpp>

#include "export/chosen_frames.hpp"

namespace nendo::exporting {
Result<NumberedName> NumberedName::parse(const std::string& pattern) {
  const Error refused{Errc::usage,
                      "--out " + pattern +
                          ": is one file per frame, so give the number a place, as in take-%04d" +
                          std::filesystem::path(pattern).extension().string()};
  NumberedName name;
  bool found = false;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    std::string& part = found ? name.after_ : name.before_;
    if (pattern[at] != '%') {
      part += pattern[at];
      continue;
    }
    const std::string rest = pattern.substr(at + 1, 3);
    if (rest.starts_with('%')) {
      part += '%';
      at += 1;
    } else if (!found && rest.starts_with('d')) {
      found = true;
      at += 1;
    } else if (!found && rest.size() == 3 && rest[0] == '0' && rest[1] >= '1' && rest[1] <= '9' &&
               rest[2] == 'd') {
      found = true;
      name.digits_ = static_cast<std::size_t>(rest[1] - '0');
      at += 3;
    } else {
      return refused;
    }
  }
  if (!found) return refused;
  return name;
}

std::string NumberedName::of(std::uint64_t number) const {
  const std::string digits = std::to_string(number);
  const std::size_t zeros = digits_ > digits.size() ? digits_ - digits.size() : 0;
  return before_ + std::string(zeros, '0') + digits + after_;
}

Result<Exported> export_mesh_sequence(ChosenFrames& frames, const std::string& pattern) {
  const auto name = NumberedName::parse(pattern);
  if (!name) return name.error();
  deform::Mesh mesh;
  std::optional<std::uint32_t> version; // that it is of
  std::vector<std::string> files;
  std::uint64_t bytes = 0;
  const auto written = frames.for_each([&]() -> Result<void> {
    if (version != frames.frame().model) {
      version = frames.frame().model;
      mesh = frames.source().model(*version);
    }
    frames.vertices(mesh.vertices);
    const std::string file = name->of(frames.made());
    // One file of materials for all of them.
    const auto materials =
        std::filesystem::path(files.empty() ? file : files.front()).replace_extension(".mtl");
    auto fine = deform::write_mesh(file, mesh, materials, frames.source().up());
    if (!fine) return fine;
    std::error_code unknown;
    const auto size = std::filesystem::file_size(file, unknown);
    if (!unknown) bytes += size;
    files.push_back(file);
    return {};
  });
  if (!written && !files.empty())
    return Error{written.error().code, written.error().message + "; " +
                                           std::to_string(files.size()) +
                                           " frames before it are whole"};
  if (!written) return written.error();
  Exported report = frames.report();
  report.files = std::move(files);
  report.bytes = bytes;
  return report;
}

namespace {

/// Numbers of 32 bits in either byte order.
class Words {
public:
  explicit Words(bool big_endian) : big_endian_(big_endian) {}

  void put(std::uint32_t word) {
    for (unsigned at = 0; at < 4; ++at) {
      const unsigned shift = 8 * (big_endian_ ? 3 - at : at);
      bytes_.push_back(static_cast<std::byte>(word >> shift & 0xFFU));
    }
  }
  void put(float number) { put(std::bit_cast<std::uint32_t>(number)); }
  void put(double number) { put(static_cast<float>(number)); }

  void put(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

  std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

private:
  bool big_endian_;
  std::vector<std::byte> bytes_;
};

/// Consecutive frames of one version of the model, by their numbers from 1.
struct Part {
  std::uint64_t first = 1;
  std::uint32_t count = 0;
  std::uint32_t version = 0;
  double begin_s = 0.0;
};

/// Goes through all frames.
Result<std::vector<Part>> parts_of(ChosenFrames& frames) {
  std::vector<Part> parts;
  const auto counted = frames.for_each([&]() -> Result<void> {
    const std::uint32_t version = frames.frame().model;
    if (parts.empty() || parts.back().version != version)
      parts.push_back({frames.made(), 0, version, frames.time_s()});
    ++parts.back().count;
    return {};
  });
  if (!counted) return counted.error();
  return parts;
}

void put_head(PointCache format, const ChosenFrames& frames, std::uint32_t count,
              std::uint32_t points, Words& words) {
  if (format == PointCache::mdd) {
    words.put(count);
    words.put(points);
    for (std::uint32_t at = 0; at < count; ++at)
      words.put(at * frames.period_s());
    return;
  }
  words.put(std::string_view("POINTCACHE2\0", 12)); // with its zero byte
  words.put(std::uint32_t{1});
  words.put(points);
  words.put(0.0F);
  words.put(1.0F);
  words.put(count);
}

/// The frames before and behind the part are made and left out.
Result<Exported> export_part(ChosenFrames& frames, const Part& part, PointCache format,
                             const std::filesystem::path& path) {
  Words words(format == PointCache::mdd);
  deform::Points vertices;
  return export_to_one_file(frames, path, [&](FileReplacement& file) -> Result<void> {
    const std::uint64_t number = frames.made();
    if (number < part.first || number >= part.first + part.count) return {};
    frames.vertices(vertices);
    if (frames.source().up() == deform::UpAxis::z) deform::lay_z_up(vertices); // as the file is
    if (vertices.cols() > std::numeric_limits<std::int32_t>::max() / 3)
      return Error{Errc::bad_input, path.string() + ": too many vertices for a point cache"};
    words.clear();
    if (number == part.first)
      put_head(format, frames, part.count, static_cast<std::uint32_t>(vertices.cols()), words);
    if (!vertices.cast<float>().allFinite())
      return Error{Errc::bad_input, path.string() + ": a vertex is too far out for 32-bit floats; "
                                                    "scale the model down"};
    for (const double coordinate : vertices.reshaped())
      words.put(coordinate);
    return file.write(words.bytes());
  });
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t number) {
  if (number == 1) return path;
  std::filesystem::path name = path.parent_path() / path.stem();
  name += "-" + std::to_string(number);
  name += path.extension();
  return name;
}

} // namespace

Result<Exported> export_point_caches(const OpenFrames& open, const Choice& choice,
                                     PointCache format, const std::filesystem::path& path) {
  assert(choice.rate_hz);
  auto source = open();
  if (!source) return source.error();
  auto frames = ChosenFrames::make(**source, choice);
  if (!frames) return frames.error();
  if ((*source)->has_one_model())
    return export_part(*frames, {1, static_cast<std::uint32_t>(*frames->count()), 0, 0.0}, format,
                       path);
  const auto parts = parts_of(*frames);
  if (!parts) return parts.error();
  Exported all;
  for (std::size_t at = 0; at < parts->size(); ++at) {
    source = open();
    if (!source) return source.error();
    frames = ChosenFrames::make(**source, choice);
    if (!frames) return frames.error();
    const auto part = export_part(*frames, (*parts)[at], format, numbered(path, at + 1));
    if (!part) return part;
    if (at == 0) {
      all = *part;
    } else {
      all.files.push_back(part->files.front());
      all.bytes += part->bytes;
    }
    if (parts->size() > 1) all.begin_s.push_back((*parts)[at].begin_s);
  }
  return all;
}

} // namespace nendo::exporting
