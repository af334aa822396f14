#include "export/glb_file.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>
#include <utility>

#include <nendo/base/byte_writer.hpp>
#include <nendo/base/files.hpp>

namespace nendo::exporting {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF's numbers are little-endian");

// glTF's names for them.
constexpr int component_u8 = 5121;
constexpr int component_u16 = 5123;
constexpr int component_u32 = 5125;
constexpr int component_f32 = 5126;
constexpr int target_vertices = 34962;
constexpr int target_indices = 34963;

constexpr std::uint32_t magic = 0x46546C67; // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;
constexpr std::uint32_t binary_chunk = 0x004E4942;

std::span<const std::byte> bytes_of(const Eigen::Matrix3Xf& vectors) {
  return std::as_bytes(std::span(vectors.data(), static_cast<std::size_t>(vectors.size())));
}

GlbFile::Json list_of(const Eigen::Vector3f& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

void bound(GlbFile::Json& accessor, const Eigen::Matrix3Xf& vectors) {
  accessor["min"] = list_of(vectors.rowwise().minCoeff());
  accessor["max"] = list_of(vectors.rowwise().maxCoeff());
}

// 65535 itself would be a primitive's restart.
bool are_narrow(std::span<const std::uint32_t> indices) {
  return std::ranges::all_of(indices, [](std::uint32_t index) { return index < UINT16_MAX; });
}

} // namespace

GlbFile::GlbFile(std::string_view generator, std::uint64_t max_bytes) : max_bytes_(max_bytes) {
  json_["asset"] = {{"version", "2.0"}, {"generator", generator}};
}

GlbFile::Index GlbFile::add(std::string_view list, Json item) {
  Json& items = json_[std::string(list)];
  items.push_back(std::move(item));
  return items.size() - 1;
}

GlbFile::Index GlbFile::add_view(std::span<const std::byte> bytes, std::optional<Use> use) {
  assert(!bytes.empty());
  Json view{{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", bytes.size()}};
  if (use == Use::vertices) view["target"] = target_vertices;
  if (use == Use::indices) view["target"] = target_indices;
  views_.push_back(std::move(view));
  const std::size_t padded = (bytes.size() + 3) / 4 * 4;
  bytes_ += padded;
  // What cannot be written need not be kept.
  if (bytes_ > max_bytes_) return views_.size() - 1;
  auto& part = parts_.emplace_back(padded);
  std::memcpy(part.data(), bytes.data(), bytes.size());
  return views_.size() - 1;
}

/// Returns the index of the view, and the type of its numbers.
std::pair<GlbFile::Index, int> GlbFile::add_index_view(std::span<const std::uint32_t> indices,
                                                       std::optional<Use> use) {
  if (!are_narrow(indices)) return {add_view(std::as_bytes(indices), use), component_u32};
  const std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
  return {add_view(std::as_bytes(std::span(narrow)), use), component_u16};
}

GlbFile::Index GlbFile::add_accessor(Index view, int component, std::size_t count,
                                     const char* type) {
  accessors_.push_back(
      {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  return accessors_.size() - 1;
}

GlbFile::Index GlbFile::add_vectors(const Eigen::Matrix3Xf& vectors, Use use, bool bounded) {
  const Index accessor = add_accessor(add_view(bytes_of(vectors), use), component_f32,
                                      static_cast<std::size_t>(vectors.cols()), "VEC3");
  if (bounded) bound(accessors_.back(), vectors);
  return accessor;
}

GlbFile::Json GlbFile::sparse(std::span<const std::uint32_t> places,
                              std::span<const float> values) {
  const auto [indices, component] = add_index_view(places, std::nullopt);
  const Index numbers = add_view(std::as_bytes(values), std::nullopt);
  return {{"count", places.size()},
          {"indices", {{"bufferView", indices}, {"componentType", component}}},
          {"values", {{"bufferView", numbers}}}};
}

GlbFile::Index GlbFile::add_sparse_vectors(const Eigen::Matrix3Xf& vectors) {
  std::vector<std::uint32_t> places;
  std::vector<float> values;
  for (Eigen::Index at = 0; at < vectors.cols(); ++at) {
    const auto vector = vectors.col(at);
    if (vector.isZero(0.0F)) continue;
    places.push_back(static_cast<std::uint32_t>(at));
    values.insert(values.end(), vector.begin(), vector.end());
  }
  const std::size_t index_bytes = are_narrow(places) ? 2 : 4;
  const bool pays =
      places.size() * (12 + index_bytes) < 12 * static_cast<std::size_t>(vectors.cols());
  if (!pays || places.empty()) return add_vectors(vectors, Use::vertices, true);
  Json accessor{{"componentType", component_f32},
                {"count", vectors.cols()},
                {"type", "VEC3"},
                {"sparse", sparse(places, values)}};
  bound(accessor, vectors);
  accessors_.push_back(std::move(accessor));
  return accessors_.size() - 1;
}

GlbFile::Index GlbFile::add_numbers(std::span<const float> numbers, std::size_t width,
                                    std::optional<Use> use) {
  assert(width == 1 || width == 2 || width == 4 || width == 16);
  const char* const type = width == 1   ? "SCALAR"
                           : width == 2 ? "VEC2"
                           : width == 4 ? "VEC4"
                                        : "MAT4";
  return add_accessor(add_view(std::as_bytes(numbers), use), component_f32, numbers.size() / width,
                      type);
}

GlbFile::Index GlbFile::add_scalars(std::span<const float> numbers, bool bounded) {
  const Index accessor = add_numbers(numbers, 1, Use::animation);
  if (bounded) {
    const auto [least, greatest] = std::ranges::minmax_element(numbers);
    accessors_.back()["min"] = {*least};
    accessors_.back()["max"] = {*greatest};
  }
  return accessor;
}

GlbFile::Index GlbFile::add_ones(std::size_t count, std::span<const std::uint32_t> places) {
  const std::vector<float> ones(places.size(), 1.0F);
  Json accessor{{"componentType", component_f32}, {"count", count}, {"type", "SCALAR"}};
  if (!places.empty()) accessor["sparse"] = sparse(places, ones);
  accessors_.push_back(std::move(accessor));
  return accessors_.size() - 1;
}

GlbFile::Index GlbFile::add_indices(std::span<const std::uint32_t> indices, Use use) {
  const auto [view, component] = add_index_view(indices, use);
  return add_accessor(view, component, indices.size(), "SCALAR");
}

GlbFile::Index GlbFile::add_joints(std::span<const std::uint8_t> fours) {
  return add_accessor(add_view(std::as_bytes(fours), Use::vertices), component_u8, fours.size() / 4,
                      "VEC4");
}

GlbFile::Index GlbFile::add_bytes(std::string_view bytes) {
  return add_view(std::as_bytes(std::span(bytes.data(), bytes.size())), std::nullopt);
}

Result<std::uint64_t> GlbFile::write(const std::filesystem::path& path) const {
  Json document = json_;
  document["buffers"] = Json::array({{{"byteLength", bytes_}}});
  document["bufferViews"] = views_;
  document["accessors"] = accessors_;
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  constexpr std::uint64_t heads = 12 + 8 + 8;
  const std::uint64_t total = heads + text.size() + bytes_;
  if (total > max_bytes_) {
    return Error{Errc::failed, path.string() + ": would be larger than 4 GiB, which a GLB file "
                                               "cannot be; export a part with --from and --to, or "
                                               "use a greater --tolerance or a lower --rate"};
  }
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  std::vector<std::byte> head;
  ByteWriter words(head);
  for (const std::uint64_t word : {std::uint64_t{magic}, std::uint64_t{2}, total,
                                   std::uint64_t{text.size()}, std::uint64_t{json_chunk}})
    words.u32_le(static_cast<std::uint32_t>(word));
  if (const auto written = file->write(head); !written) return written.error();
  if (const auto written = file->write(text); !written) return written.error();
  head.clear();
  words.u32_le(static_cast<std::uint32_t>(bytes_));
  words.u32_le(binary_chunk);
  if (const auto written = file->write(head); !written) return written.error();
  for (const auto& part : parts_)
    if (const auto written = file->write(part); !written) return written.error();
  if (const auto finished = file->finish(); !finished) return finished.error();
  return total;
}

} // namespace nendo::exporting
