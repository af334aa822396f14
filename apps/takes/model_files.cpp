#include "takes/model_files.hpp"

#include <vector>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/side_by_side.hpp>

#include "cli/model_files.hpp"

namespace nendo::takes {

Result<deform::Mesh> read_models(const std::string& name) {
  std::vector<deform::Mesh> models;
  for (const std::string& file : cli::files_of_name(name)) {
    auto model = deform::read_mesh(file);
    if (!model) return model;
    models.push_back(*std::move(model));
  }
  if (models.size() == 1) return std::move(models.front());
  auto both = deform::side_by_side(models);
  if (!both) return Error{both.error().code, name + ": " + both.error().message};
  return both;
}

} // namespace nendo::takes
