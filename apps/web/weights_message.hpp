#pragma once
// The message with which a client can follow what moves along the surface (PROTOCOL.md).

#include <cstddef>
#include <vector>

#include <nendo/deform/surface_field.hpp>

namespace nendo::web {

/// Returns the message with the field's terms, in the order of the model message. They stay in
/// float, because a smaller type would move vertices by more than clients may be off. Allocates.
std::vector<std::byte> weights_message(const deform::SurfaceField& field);

} // namespace nendo::web
