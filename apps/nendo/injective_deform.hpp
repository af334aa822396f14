#pragma once
// nendo deform --injective: deforms without folding, and says what it took.

#include <string>

#include <nendo/deform/control_vectors.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::app {

struct InjectiveDeformation {
  deform::FieldStatus status = deform::FieldStatus::ok;
  std::string report; ///< one line: links, bound, least determinant at the vertices, held pairs
};

/// Deforms the vertices in place. Error: bad_input if the vectors
/// have no usable solution, or are too long; the vertices are then spoilt. `name` is what messages
/// call the vectors.
Result<InjectiveDeformation> deform_injectively(deform::Points& vertices,
                                                const deform::ControlVectors& vectors,
                                                const deform::Supports& supports,
                                                const deform::CsrbfOptions& csrbf,
                                                const std::string& name);

} // namespace nendo::app
