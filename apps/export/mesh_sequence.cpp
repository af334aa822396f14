#include "export/mesh_sequence.hpp"

#include <filesystem>
#include <optional>
#include <system_error>

#include <nendo/deform/mesh_file.hpp>

namespace nendo::exporting {

Result<NumberedName> NumberedName::parse(const std::string& pattern) {
  const Error refused{Errc::usage,
                      "--out " + pattern +
                          ": is a file a frame, so give the number a place, as in take-%04d" +
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
  Exported done{{}, 0, frames.first_s(), frames.first_s()};
  const auto so_far = [&](const Error& error) {
    const std::string count = std::to_string(done.frames);
    return Error{error.code, done.frames == 0
                                 ? error.message
                                 : error.message + "; " + count + " frames before it are whole"};
  };
  for (;;) {
    const auto more = frames.next();
    if (!more) return so_far(more.error());
    if (!*more) break;
    if (version != frames.frame().model) {
      version = frames.frame().model;
      mesh = frames.source().model(*version);
    }
    frames.vertices(mesh.vertices);
    const std::string file = name->of(frames.made());
    // One file of materials for all of them.
    const auto materials = std::filesystem::path(done.files.empty() ? file : done.files.front())
                               .replace_extension(".mtl");
    if (const auto written = deform::write_mesh(file, mesh, materials, frames.source().up());
        !written)
      return so_far(written.error());
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(file, unknown);
    if (!unknown) done.bytes += bytes;
    done.files.push_back(file);
    done.frames = frames.made();
    done.last_s = frames.time_s();
  }
  done.rate_hz = frames.rate_hz();
  done.exact = frames.source().is_exact();
  return done;
}

} // namespace nendo::exporting
