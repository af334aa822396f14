#pragma once
// What a glTF has that a model here does not have.

#include <nendo/deform/read_notes.hpp>

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// Notes what is not read of the document: what moves it, further scenes, variants, textures that
/// are not of the base colour, further colours of vertices, points and lines, unknown
/// extensions. It looks at all meshes, also at those that no scene has.
void note_left_out(const GltfDocument& document, NoteSum& notes);

} // namespace nendo::deform
