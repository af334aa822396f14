#pragma once
// The rest shape (undeformed geometry) of a model that was made of a deformed shape. Hands leave
// their work in the shape, so that the shape is the new model's rest. A puppet's shape is what it
// does at that moment, and its rest stays.

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::flow {

/// Returns the rest of `made`, which was made of a mesh with these vertices and this rest (3 by
/// #vertices each). A vertex of the shape, which is known by its number and place, or by its place
/// where its number has changed, gets its rest; by the others the way from the shape to the rest is
/// spread evenly, each being the mean of its neighbours', and a part without any vertex of the
/// shape rests where it is. Takes up to twice as long as a cut, and allocates. The same bits for
/// the same arguments.
NENDO_API deform::Points kept_rest(const deform::Mesh& made, const deform::Points& shape,
                                   const deform::Points& rest);

} // namespace nendo::flow
