#include "files/gltf_document.hpp"

#include <algorithm>
#include <array>

#include <nendo/base/text.hpp>

#include "files/binary_numbers.hpp"
#include "geometry/usable.hpp"

namespace nendo::deform {

using Json = GltfDocument::Json;

namespace {

constexpr std::string_view draco = "KHR_draco_mesh_compression";

bool is_meshopt(std::string_view name) noexcept {
  return name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression" ||
         name == "MESHOPT_compression";
}

/// What is read here, or is a picture or a light that a model can do without.
bool is_known(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 8> known{
      "KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing",
      "KHR_texture_basisu",    "EXT_texture_webp",      "EXT_texture_avif",
      "MSFT_texture_dds",      "KHR_xmp_json_ld"};
  return std::find(known.begin(), known.end(), name) != known.end() ||
         name.starts_with("KHR_materials_") || name.starts_with("KHR_lights_") ||
         name.starts_with("EXT_lights_");
}

constexpr std::string_view binary_magic = "glTF";
constexpr std::uint32_t json_chunk = 0x4E4F534A;
constexpr std::uint32_t binary_chunk = 0x004E4942;
constexpr std::size_t header_bytes = 12;
constexpr std::size_t chunk_header_bytes = 8;
constexpr int max_depth = 64; // of JSON; extras may be deep, glTF itself is not
constexpr std::size_t max_json_bytes = std::size_t{128} << 20;
constexpr std::uint64_t max_numbers = std::uint64_t{1} << 28; // of one accessor
constexpr std::uint64_t max_buffer_bytes = std::uint64_t{4} << 30;

[[noreturn]] void refuse(std::string what) {
  throw GltfRefusal{std::move(what)};
}

NumberType type_of_component(std::uint64_t component) {
  // In the order of NumberType; 0: glTF does not have that type.
  constexpr std::array<std::uint64_t, 7> components{5120, 5121, 5122, 5123, 0, 5125, 5126};
  const auto* const found = std::find(components.begin(), components.end(), component);
  if (component == 0 || found == components.end())
    refuse("an accessor has a componentType " + std::to_string(component) +
           ", which glTF does not know");
  return static_cast<NumberType>(found - components.begin());
}

double decoded(NumberType type, const char* bytes, bool normalized) noexcept {
  constexpr std::array<double, 4> greatest{127.0, 255.0, 32767.0, 65535.0};
  const auto at = static_cast<std::size_t>(type);
  const double value = number_from(type, bytes);
  return normalized && at < greatest.size() ? std::max(value / greatest[at], -1.0) : value;
}

std::size_t width_of(const std::string& type) {
  for (const auto& [known, width] :
       {std::pair{"SCALAR", 1U}, {"VEC2", 2U}, {"VEC3", 3U}, {"VEC4", 4U}, {"MAT4", 16U}})
    if (type == known) return width;
  refuse("an accessor is of a type that no model's numbers have");
}

/// The elements of an accessor, or of a part of a sparse one, in their view.
struct Elements {
  NumberType type;
  const char* first;
  std::size_t stride; ///< of a row

  double number(std::size_t row, std::size_t column, bool normalized) const {
    return decoded(type, first + row * stride + column * size_of(type), normalized);
  }
};

Elements elements_in(std::string_view view, std::uint64_t component, std::size_t width,
                     std::uint64_t offset, std::uint64_t stride, std::uint64_t count) {
  const NumberType type = type_of_component(component);
  const std::size_t element = width * size_of(type);
  if (stride == 0) stride = element;
  if (stride < element) refuse("a bufferView has a byteStride that is too small for its numbers");
  // No product may overflow: the count is compared with the capacity of the view.
  const bool fits = offset <= view.size() && view.size() - offset >= element &&
                    count - 1 <= (view.size() - offset - element) / stride;
  if (!fits) refuse("an accessor reaches beyond the end of its bufferView");
  return {type, view.data() + offset, stride};
}

} // namespace

bool is_gltf(std::string_view file) noexcept {
  if (file.starts_with(binary_magic)) return true;
  const std::size_t first = file.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && file[first] == '{';
}

const Json* gltf_member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

std::uint64_t gltf_count(const Json& object, const char* name, std::uint64_t otherwise) {
  const Json* const member = gltf_member(object, name);
  if (member == nullptr) return otherwise;
  if (!member->is_number_unsigned())
    refuse(std::string("\"") + name + "\" is not a whole number from 0 on");
  return member->get<std::uint64_t>();
}

std::vector<double> gltf_numbers(const Json& object, const char* name, std::size_t count) {
  const Json* const member = gltf_member(object, name);
  if (member == nullptr) return {};
  std::vector<double> numbers;
  if (member->is_array() && member->size() == count)
    for (const Json& number : *member)
      if (number.is_number() && is_usable(number.get<double>()))
        numbers.push_back(number.get<double>());
  if (numbers.size() != count)
    refuse(std::string("\"") + name + "\" is not a list of " + std::to_string(count) +
           " finite numbers");
  return numbers;
}

std::string gltf_text(const Json& object, const char* name) {
  const Json* const member = gltf_member(object, name);
  return member != nullptr && member->is_string() ? member->get<std::string>() : std::string();
}

const Json::array_t& gltf_list(const Json& object, const char* name) {
  static const Json::array_t none;
  const Json* const member = gltf_member(object, name);
  return member != nullptr && member->is_array() ? member->get_ref<const Json::array_t&>() : none;
}

bool gltf_flag(const Json& object, const char* name) {
  const Json* const member = gltf_member(object, name);
  return member != nullptr && *member == true;
}

namespace {

/// What JSON without an asset is, which each glTF has.
std::string foreign_json(const Json& root) {
  constexpr const char* in_its_program =
      "; open it in the program that made it, and export it as glTF (.glb), OBJ, PLY or STL";
  const std::string type = gltf_text(root, "type");
  if (type == "CityJSON") return std::string("is a CityJSON file") + in_its_program;
  if (type.starts_with("Feature")) return std::string("is a map (GeoJSON)") + in_its_program;
  if (gltf_member(root, "metadata") != nullptr &&
      (gltf_member(root, "geometries") != nullptr || gltf_member(root, "vertices") != nullptr ||
       gltf_member(root, "data") != nullptr))
    return "is a model in the JSON of three.js; load it in the editor of three.js, and export it "
           "as GLB there";
  return "is JSON, but no glTF, because it has no \"asset\"; give the file of a model (.obj, .ply, "
         ".stl, .glb, .gltf)";
}

[[noreturn]] void refuse_version(const std::string& version) {
  if (version.empty()) refuse("does not say its version of glTF; export it once more as glTF 2");
  refuse("is glTF of version " + in_quotes(version) +
         ", and only version 2 is read; export it once more as glTF 2");
}

[[noreturn]] void refuse_meshopt(const std::string& extension) {
  refuse("is compressed by meshopt (" + extension.substr(0, 60) +
         "), which is not read; export it without compression (gltfpack without -c and -cc), or "
         "run: gltf-transform copy IN.glb OUT.glb");
}

/// Refuses a document that needs an extension that is not known here.
void require_readable(const Json& root) {
  for (const Json& extension : gltf_list(root, "extensionsRequired")) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
    if (is_known(name)) continue;
    if (is_meshopt(name)) refuse_meshopt(name);
    if (name == draco) refuse_draco();
    refuse("needs glTF's extension '" + name.substr(0, 60) +
           "', which is not known here; export the model without it");
  }
}

} // namespace

GltfDocument::GltfDocument(std::string_view file, const ModelFolder* folder) : folder_(folder) {
  if (file.starts_with(binary_magic))
    read_binary(file);
  else
    read_json(file);
  const Json* const asset = gltf_member(root_, "asset");
  if (asset == nullptr && !file.starts_with(binary_magic)) refuse(foreign_json(root_));
  const std::string version = asset == nullptr ? std::string() : gltf_text(*asset, "version");
  if (!version.starts_with("2.")) refuse_version(version);
  require_readable(root_);
  read_buffers();
}

void GltfDocument::read_binary(std::string_view file) {
  if (file.size() < header_bytes + chunk_header_bytes) refuse("the file is cut off");
  const auto word_at = [&](std::size_t at) { return number_from<std::uint32_t>(file.data() + at); };
  if (word_at(4) != 2) refuse_version(std::to_string(word_at(4)));
  const std::size_t length = word_at(8);
  if (length > file.size() || length < header_bytes + chunk_header_bytes)
    refuse("the file is cut off");
  std::size_t at = header_bytes;
  for (int chunk = 0; chunk < 2 && length - at >= chunk_header_bytes; ++chunk) {
    const std::size_t size = word_at(at);
    const std::uint32_t type = word_at(at + 4);
    at += chunk_header_bytes;
    if (size > length - at) refuse("byte " + std::to_string(at) + ": the file is cut off");
    if (chunk == 0 && type != json_chunk) refuse("byte 16: the first chunk is not JSON");
    if (chunk == 0) read_json(file.substr(at, size));
    if (chunk == 1 && type == binary_chunk) binary_ = file.substr(at, size);
    at += size;
  }
}

void GltfDocument::read_json(std::string_view text) {
  if (text.size() > max_json_bytes) refuse("has more than 128 MiB of JSON");
  bool too_deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > max_depth;
    return !too_deep;
  };
  root_ = Json::parse(text.begin(), text.end(), watch, false);
  if (too_deep) refuse("has JSON of more than " + std::to_string(max_depth) + " levels");
  if (root_.is_discarded() || !root_.is_object())
    refuse("has damaged JSON, so it is no glTF model; export it once more");
}

const Json& GltfDocument::item(const char* list, std::uint64_t index) const {
  const Json::array_t& items = gltf_list(root_, list);
  if (index >= items.size())
    refuse(std::string("names number ") + std::to_string(index) + " of \"" + list + "\", of " +
           std::to_string(items.size()));
  return items[index];
}

std::size_t GltfDocument::size_of(const char* list) const {
  return gltf_list(root_, list).size();
}

FolderFile GltfDocument::file_named(const std::string& uri, std::uint64_t max_bytes) const {
  if (folder_ == nullptr) return {{}, {}, ": no other file is read here"};
  return folder_->find(percent_decoded(uri), max_bytes);
}

void GltfDocument::read_buffers() {
  const std::size_t count = size_of("buffers");
  own_.resize(count); // so that its strings stay in their places
  std::uint64_t left = max_buffer_bytes;
  for (std::size_t at = 0; at < count; ++at) {
    const Json& buffer = item("buffers", at);
    const std::uint64_t length = gltf_count(buffer, "byteLength", 0);
    const std::string uri = gltf_text(buffer, "uri");
    std::string_view bytes = at == 0 && uri.empty() ? binary_ : std::string_view();
    if (is_data_uri(uri)) {
      auto data = data_of_uri(uri);
      if (!data) refuse("has a buffer with a damaged data URI");
      own_[at] = *std::move(data);
    } else if (!uri.empty()) {
      own_[at] = file_named(uri, left).contents.value_or(std::string());
    }
    if (!uri.empty()) bytes = own_[at];
    left -= own_[at].size();
    if (bytes.size() < length && !uri.empty() && !is_data_uri(uri))
      refuse("needs the file '" + printable(uri.substr(0, 40)) + "' of " + std::to_string(length) +
             " bytes beside it");
    for (const char* const meshopt : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (bytes.size() < length && gltf_extension(buffer, meshopt) != nullptr)
        refuse_meshopt(meshopt);
    if (bytes.size() < length) refuse("has fewer bytes than its buffers should have");
    buffers_.push_back(bytes.substr(0, length));
  }
}

std::string_view GltfDocument::view(std::uint64_t buffer_view) const {
  const Json& view = item("bufferViews", buffer_view);
  const std::uint64_t buffer = gltf_count(view, "buffer", 0);
  item("buffers", buffer);
  const std::string_view bytes = buffers_[buffer];
  const std::uint64_t offset = gltf_count(view, "byteOffset", 0);
  const std::uint64_t length = gltf_count(view, "byteLength", 0);
  if (offset > bytes.size() || length > bytes.size() - offset)
    refuse("a bufferView reaches beyond the end of its buffer");
  return bytes.substr(offset, length);
}

GltfNumbers GltfDocument::numbers(std::uint64_t index) const {
  const Json& accessor = item("accessors", index);
  GltfNumbers numbers;
  numbers.width = width_of(gltf_text(accessor, "type"));
  const std::uint64_t count = gltf_count(accessor, "count", 0);
  if (count == 0 || count > max_numbers / numbers.width)
    refuse("an accessor has " + std::to_string(count) +
           " elements; from 1 to 2^28 numbers can be "
           "read");
  numbers.count = count;
  if (gltf_member(accessor, "bufferView") == nullptr) {
    // Zeros cost a file nothing, so they are bounded by what it has otherwise.
    std::uint64_t bytes = 0;
    for (const std::string_view buffer : buffers_)
      bytes += buffer.size();
    if (count > bytes) refuse("an accessor has more zeros than the file has bytes");
    numbers.values.resize(numbers.count * numbers.width, 0.0);
  } else {
    fill(accessor, numbers);
  }
  if (gltf_member(accessor, "sparse") != nullptr) fill_sparse(accessor, numbers);
  for (const double value : numbers.values)
    if (!is_usable(value)) refuse("a number of an accessor is not finite");
  return numbers;
}

void GltfDocument::fill(const Json& accessor, GltfNumbers& numbers) const {
  const std::uint64_t number = gltf_count(accessor, "bufferView", 0);
  const std::string_view bytes = view(number);
  const Elements elements =
      elements_in(bytes, gltf_count(accessor, "componentType", 0), numbers.width,
                  gltf_count(accessor, "byteOffset", 0),
                  gltf_count(item("bufferViews", number), "byteStride", 0), numbers.count);
  const bool is_normalized = gltf_flag(accessor, "normalized");
  numbers.values.reserve(numbers.count * numbers.width);
  for (std::size_t row = 0; row < numbers.count; ++row)
    for (std::size_t column = 0; column < numbers.width; ++column)
      numbers.values.push_back(elements.number(row, column, is_normalized));
}

void GltfDocument::fill_sparse(const Json& accessor, GltfNumbers& numbers) const {
  const Json& sparse = *gltf_member(accessor, "sparse");
  const Json* const indices = gltf_member(sparse, "indices");
  const Json* const values = gltf_member(sparse, "values");
  const std::uint64_t count = gltf_count(sparse, "count", 0);
  if (indices == nullptr || values == nullptr || count == 0 || count > numbers.count)
    refuse("a sparse accessor is not whole");
  const auto part = [&](const Json& of, std::uint64_t component, std::size_t width) {
    const std::string_view bytes = view(gltf_count(of, "bufferView", 0));
    return elements_in(bytes, component, width, gltf_count(of, "byteOffset", 0), 0, count);
  };
  const Elements places = part(*indices, gltf_count(*indices, "componentType", 0), 1);
  const Elements elements = part(*values, gltf_count(accessor, "componentType", 0), numbers.width);
  const bool normalized = gltf_flag(accessor, "normalized");
  for (std::size_t k = 0; k < count; ++k) {
    const double place = places.number(k, 0, false);
    if (!(place >= 0.0 && place < static_cast<double>(numbers.count)) ||
        places.type == NumberType::float32)
      refuse("a sparse accessor names an element that is not there");
    const std::size_t row = static_cast<std::size_t>(place) * numbers.width;
    for (std::size_t column = 0; column < numbers.width; ++column)
      numbers.values[row + column] = elements.number(k, column, normalized);
  }
}

FolderFile GltfDocument::image(const Json& image) const {
  const std::string uri = gltf_text(image, "uri");
  if (!uri.empty() && !is_data_uri(uri)) return file_named(uri, ModelFolder::max_texture_bytes);
  FolderFile file;
  if (is_data_uri(uri)) {
    file.contents = data_of_uri(uri);
  } else if (gltf_member(image, "bufferView") != nullptr) {
    file.contents.emplace(view(gltf_count(image, "bufferView", 0)));
  }
  if (!file.contents || file.contents->empty()) {
    file.contents.reset();
    file.lack = ": has no data in the file; export the model once more";
  }
  return file;
}

void refuse_draco() {
  refuse(
      "is compressed by Draco (KHR_draco_mesh_compression), which is not read; export it without "
      "compression, or run: gltf-transform copy IN.glb OUT.glb");
}

const Json* gltf_extension(const Json& item, const char* name) {
  const Json* const extensions = gltf_member(item, "extensions");
  return extensions == nullptr ? nullptr : gltf_member(*extensions, name);
}

bool is_harmless_extension(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 3> harmless{"KHR_xmp", "KHR_animation_pointer",
                                                     "KHR_accessor_float64"};
  return is_known(name) || is_meshopt(name) || name == draco ||
         std::find(harmless.begin(), harmless.end(), name) != harmless.end();
}

} // namespace nendo::deform
