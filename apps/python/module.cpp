// The extension module nendo._nendo, of which the package nendo shows all names.

#include <nendo/version.hpp>

#include "python/bind.hpp"

namespace nendo::python {

PYBIND11_MODULE(_nendo, module) {
  module.attr("__version__") = py::str(NENDO_VERSION);
  add_errors(module);
  add_samples(module);
  add_hands(module);
  add_calibrations(module);
  add_gloves(module);
  add_trackers(module);
  add_frames(module);
  add_meshes(module);
  add_fields(module);
  add_deformers(module);
  add_clay(module);
  add_recordings(module);
  add_session(module);
  add_segment(module);
}

} // namespace nendo::python
