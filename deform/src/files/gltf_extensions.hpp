#pragma once
// Extensions of glTF: which a model may need, and what is said of those that it may not.

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// Throws GltfRefusal, with the extension's name and the remedy, if the document needs one that is
/// not known here.
void require_readable(const GltfDocument::Json& root);
/// The refusals of the two extensions that compress the numbers of a model.
[[noreturn]] void refuse_meshopt(const std::string& extension);
[[noreturn]] void refuse_draco();

/// Returns the extension of an item of the document, or null.
const GltfDocument::Json* gltf_extension(const GltfDocument::Json& item, const char* name);

/// Returns whether a model loses nothing here without this extension, or another note says what.
bool is_harmless_extension(std::string_view name) noexcept;

} // namespace nendo::deform
