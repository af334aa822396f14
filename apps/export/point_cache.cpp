#include "export/point_cache.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "export/one_file.hpp"

namespace nendo::exporting {
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

void put_head(PointCache format, const ChosenFrames& frames, std::uint32_t points, Words& words) {
  const auto count = static_cast<std::uint32_t>(*frames.count());
  if (format == PointCache::mdd) {
    words.put(count);
    words.put(points);
    for (std::uint32_t at = 0; at < count; ++at)
      words.put(at * frames.period_s());
    return;
  }
  words.put(std::string_view("POINTCACHE2", 12)); // with its zero byte
  words.put(std::uint32_t{1});
  words.put(points);
  words.put(0.0F);
  words.put(1.0F);
  words.put(count);
}

} // namespace

Result<Exported> export_point_cache(ChosenFrames& frames, PointCache format,
                                    const std::filesystem::path& path) {
  assert(frames.count());
  const std::size_t points = frames.source().layout().vertex_count();
  if (points > std::numeric_limits<std::int32_t>::max() / 3)
    return Error{Errc::bad_input, path.string() + ": too many vertices for a point cache"};
  Words words(format == PointCache::mdd);
  deform::Points vertices;
  return export_to_one_file(frames, path, [&](FileReplacement& file) -> Result<void> {
    words.clear();
    if (frames.made() == 1) put_head(format, frames, static_cast<std::uint32_t>(points), words);
    frames.vertices(vertices);
    if (!vertices.cast<float>().allFinite())
      return Error{Errc::bad_input, path.string() + ": a vertex is too far out for 32-bit floats; "
                                                    "scale the model down"};
    for (const double coordinate : vertices.reshaped())
      words.put(coordinate);
    return file.write(words.bytes());
  });
}

} // namespace nendo::exporting
