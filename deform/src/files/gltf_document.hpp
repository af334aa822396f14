#pragma once
// A glTF 2.0 document (Khronos specification 2.0): its JSON, the bytes of its buffers, and the
// numbers of its accessors. All that a hostile file could say is checked here.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/model_folder.hpp"

namespace nendo::deform {

/// What is wrong with a document, in words that follow its name. It is thrown and caught within
/// the reader of glTF; nothing else sees it.
struct GltfRefusal {
  std::string what;
};

/// Returns whether a file is glTF: binary, or JSON.
bool is_gltf(std::string_view file) noexcept;

/// `count` rows of `width` numbers each.
struct GltfNumbers {
  std::size_t count = 0;
  std::size_t width = 0;
  std::vector<double> values;

  const double* row(std::size_t at) const noexcept { return values.data() + at * width; }
};

class GltfDocument {
public:
  using Json = nlohmann::json;
  /// `file` must outlive the document. Other files that it names are read from `folder`; null:
  /// there are none. Throws GltfRefusal, and std::bad_alloc.
  GltfDocument(std::string_view file, const ModelFolder* folder);

  /// Returns the item of a list of the document, such as "nodes". Throws GltfRefusal if there is
  /// none.
  const Json& item(const char* list, std::uint64_t index) const;
  std::size_t size_of(const char* list) const;
  const Json& root() const noexcept { return root_; }

  /// Returns the numbers of an accessor, of floats or integers, with sparse ones in their places.
  /// All are finite. Throws GltfRefusal.
  GltfNumbers numbers(std::uint64_t accessor) const;
  /// Returns the bytes of a buffer's part, which belong to the document or to its file. Throws
  /// GltfRefusal.
  std::string_view view(std::uint64_t buffer_view) const;
  /// Returns the contents of an image, or why there are none. Throws GltfRefusal.
  FolderFile image(const Json& image) const;

private:
  void read_binary(std::string_view file);
  void read_json(std::string_view text);
  void read_buffers();
  void fill(const Json& accessor, GltfNumbers& numbers) const;
  void fill_sparse(const Json& accessor, GltfNumbers& numbers) const;
  FolderFile file_named(const std::string& uri, std::uint64_t max_bytes) const;

  const ModelFolder* folder_;
  Json root_;
  std::string_view binary_;      ///< the chunk of a binary file
  std::vector<std::string> own_; ///< contents of buffers that are not that chunk
  std::vector<std::string_view> buffers_;
};

/// Returns a member of an object, or null.
const GltfDocument::Json* gltf_member(const GltfDocument::Json& object, const char* name);
/// Returns a member that must be a whole number from 0 on, or `otherwise` if there is none. Throws
/// GltfRefusal.
std::uint64_t gltf_count(const GltfDocument::Json& object, const char* name,
                         std::uint64_t otherwise);
/// Returns a member that must be so many numbers, or nothing if there is none. Throws GltfRefusal.
std::vector<double> gltf_numbers(const GltfDocument::Json& object, const char* name,
                                 std::size_t count);
/// Returns a member if it is a text, or an empty one.
std::string gltf_text(const GltfDocument::Json& object, const char* name);

/// Returns a member if it is a list, or an empty one.
const GltfDocument::Json::array_t& gltf_list(const GltfDocument::Json& object, const char* name);
/// Returns whether a member is true.
bool gltf_flag(const GltfDocument::Json& object, const char* name);

[[noreturn]] void refuse_draco();

/// Returns the extension of an item of the document, or null.
const GltfDocument::Json* gltf_extension(const GltfDocument::Json& item, const char* name);

/// Returns whether a model loses nothing here without this extension, or another note says what.
bool is_harmless_extension(std::string_view name) noexcept;

/// Returns the text with the bytes that %XX stands for. A % without two digits stays.
std::string percent_decoded(std::string_view uri);

bool is_data_uri(std::string_view uri) noexcept;
/// Returns the data of a data URI in base64, or nothing if it is damaged.
std::optional<std::string> data_of_uri(std::string_view uri);

} // namespace nendo::deform
