#include "takes/model_files.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <nendo/base/text.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/side_by_side.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"

namespace nendo::takes {
namespace {

double size_of(const deform::Mesh& model) {
  const deform::Box box = deform::finite_box_of(model.vertices);
  return (box.highest - box.lowest).maxCoeff();
}

/// One in millimetres beside one in metres is not to be seen.
void note_other_units(const std::vector<std::string>& files,
                      const std::vector<deform::Mesh>& models) {
  constexpr double too_many = 30.0;
  const auto [least, most] =
      std::minmax_element(models.begin(), models.end(),
                          [](const auto& a, const auto& b) { return size_of(a) < size_of(b); });
  const double times = size_of(*most) / size_of(*least);
  if (!(times > too_many) || !std::isfinite(times)) return;
  const auto name = [&](auto model) {
    return printable(files[static_cast<std::size_t>(model - models.begin())]);
  };
  cli::note(name(most) + " is " + std::to_string(std::lround(times)) + " times as large as " +
            name(least) + ", which is a speck beside it; if their units differ, scale one of them");
}

void count_from_usual(deform::Mesh& mesh) {
  deform::count_from(deform::usual_offset(mesh), mesh);
}

Result<deform::ReadModel> read_from_zero(const std::string& file,
                                         const deform::ReadOptions& options) {
  auto model = deform::read_model(file, options);
  if (!model) return model;
  for (const std::string& what : model->notes)
    cli::note(file + ": " + printable(what));
  if (const auto remark = deform::remark_on(model->mesh); !remark.empty())
    cli::note(file + ": " + std::string(remark));
  return model;
}

} // namespace

Result<deform::ReadModel> read_model(const std::string& file, const deform::ReadOptions& options) {
  auto model = read_from_zero(file, options);
  if (model) count_from_usual(model->mesh);
  return model;
}

Result<deform::ReadModel> read_models(const std::string& name, const deform::ReadOptions& options) {
  auto model = read_models_from_zero(name, options);
  if (model) count_from_usual(model->mesh);
  return model;
}

Result<deform::ReadModel> read_models_from_zero(const std::string& name,
                                                const deform::ReadOptions& options) {
  std::vector<deform::Mesh> models;
  deform::ReadModel all;
  const std::vector<std::string> files = cli::files_of_name(name);
  for (const std::string& file : files) {
    auto model = read_from_zero(file, options);
    if (!model) return model;
    models.push_back(std::move(model->mesh));
    for (const std::string& what : model->notes)
      all.notes.push_back(files.size() == 1 ? what : file + ": " + what);
  }
  if (models.size() == 1) {
    all.mesh = std::move(models.front());
    return all;
  }
  note_other_units(files, models);
  auto both = deform::side_by_side(models);
  if (!both) return Error{both.error().code, name + ": " + both.error().message};
  all.mesh = *std::move(both);
  return all;
}

} // namespace nendo::takes
