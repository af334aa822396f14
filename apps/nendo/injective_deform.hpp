#pragma once
// nendo deform --injective, which deforms without folding and reports how.

#include <string>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::app {

struct InjectiveDeformation {
  deform::FieldStatus status = deform::FieldStatus::ok;
  std::string report; ///< one line: links, bound, least determinant at the vertices, held pairs
};

/// Deforms the vertices in place. `name` is what messages call the vectors. Error: bad_input if the
/// vectors have no usable solution, or are too long; the vertices are then undefined.
Result<InjectiveDeformation> deform_injectively(deform::Points& vertices,
                                                const deform::ControlVectors& vectors,
                                                const deform::Supports& supports,
                                                const deform::CsrbfOptions& csrbf,
                                                const std::string& name);

} // namespace nendo::app
