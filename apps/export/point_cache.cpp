#include "export/point_cache.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include <nendo/base/file_replacement.hpp>

namespace nendo::app {
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

  std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

private:
  bool big_endian_;
  std::vector<std::byte> bytes_;
};

Result<void> write_head(FileReplacement& file, PointCache format, const ChosenFrames& frames,
                        std::uint32_t points, Words& words) {
  const auto count = static_cast<std::uint32_t>(*frames.count());
  if (format == PointCache::mdd) {
    words.put(count);
    words.put(points);
    for (std::uint32_t at = 0; at < count; ++at)
      words.put(at * frames.period_s());
  } else {
    const std::string_view magic("POINTCACHE2", 12); // with its zero byte
    if (const auto written = file.write(magic); !written) return written;
    words.put(std::uint32_t{1});
    words.put(points);
    words.put(0.0F);
    words.put(1.0F);
    words.put(count);
  }
  return file.write(words.bytes());
}

} // namespace

Result<Exported> export_point_cache(ChosenFrames& frames, PointCache format,
                                    const std::filesystem::path& path) {
  assert(frames.count());
  const std::size_t points = frames.source().layout().vertex_count();
  if (points > std::numeric_limits<std::int32_t>::max() / 3)
    return Error{Errc::bad_input, path.string() + ": too many vertices for a point cache"};
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  Words words(format == PointCache::mdd);
  Exported done{{path.string()}, 0, frames.first_s(), frames.first_s(), 0, {}};
  if (const auto head =
          write_head(*file, format, frames, static_cast<std::uint32_t>(points), words);
      !head)
    return head.error();
  deform::Points vertices;
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) break;
    frames.vertices(vertices);
    if (!vertices.cast<float>().allFinite())
      return Error{Errc::bad_input, path.string() + ": a vertex is too far out for 32-bit floats; "
                                                    "scale the model down"};
    words.clear();
    for (const double coordinate : vertices.reshaped())
      words.put(coordinate);
    if (const auto written = file->write(words.bytes()); !written) return written.error();
    done.last_s = frames.time_s();
  }
  if (const auto finished = file->finish(); !finished) return finished.error();
  done.frames = frames.made();
  done.bytes = file->size();
  return done;
}

} // namespace nendo::app
