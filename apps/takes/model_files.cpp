#include "takes/model_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/text.hpp>
#include <nendo/deform/edit_part.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/read_notes.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "render/texture_image.hpp"

namespace nendo::takes {
namespace {

double size_of(const deform::Mesh& model) {
  const deform::Box box = deform::box_of_faces(model);
  return (box.highest - box.lowest).maxCoeff();
}

/// One in millimetres beside one in metres is not to be seen.
void add_other_units(const std::vector<std::string>& files, const std::vector<deform::Mesh>& models,
                     std::vector<std::string>& notes) {
  constexpr double too_many = 30.0;
  const auto [least, most] =
      std::minmax_element(models.begin(), models.end(),
                          [](const auto& a, const auto& b) { return size_of(a) < size_of(b); });
  const double times = size_of(*most) / size_of(*least);
  if (!(times > too_many) || !std::isfinite(times)) return;
  const auto name = [&](auto model) {
    return printable(files[static_cast<std::size_t>(model - models.begin())]);
  };
  notes.push_back(name(most) + " is " + std::to_string(std::lround(times)) + " times as large as " +
                  name(least) +
                  ", which can hardly be seen beside it; if their units differ, scale one of them");
}

/// Notes textures that cannot be shown, as they are: in one line each for what is alike.
void note_pictures(deform::ReadModel& model) {
  deform::NoteSum sum;
  for (const deform::Texture& texture : model.mesh.look.textures)
    if (texture.contents)
      if (const std::string fault = render::fault_of_picture(*texture.contents); !fault.empty())
        sum.add("texture", texture.file, ": " + fault);
  sum.append_to(model.notes);
  deform::bound_notes(model.notes);
}

/// One file, with all that is to be said of it as notes.
Result<deform::ReadModel> read_alone(const std::string& file, const deform::ReadOptions& options) {
  auto model = deform::read_model(file, options);
  if (!model) return model;
  note_pictures(*model);
  if (const auto remark = deform::warning_about(model->mesh); !remark.empty())
    model->notes.emplace_back(remark);
  return model;
}

/// Reads the files of a name as read_models() does, but prints nothing.
Result<deform::ReadModel> read_models_silently(const std::string& name,
                                               const deform::ReadOptions& options) {
  std::vector<deform::Mesh> models;
  deform::ReadModel all;
  const std::vector<std::string> files = cli::files_of_name(name);
  for (const std::string& file : files) {
    auto model = read_alone(file, options);
    if (!model) return model;
    models.push_back(std::move(model->mesh));
    for (const std::string& what : model->notes)
      all.notes.push_back(files.size() == 1 ? what : file + ": " + what);
  }
  if (models.size() == 1) {
    all.mesh = std::move(models.front());
  } else {
    add_other_units(files, models, all.notes);
    auto both = deform::side_by_side(models);
    if (!both) return Error{both.error().code, name + ": " + both.error().message};
    all.mesh = *std::move(both);
  }
  deform::count_from(deform::usual_offset(all.mesh), all.mesh);
  return all;
}

/// Says on standard error what the notes say of the model of that name.
void note_all(const std::string& name, const std::vector<std::string>& notes) {
  for (const std::string& what : notes)
    cli::note_model(printable(name + ": " + what));
}

/// The ways to read a file of which a recording does not say which one it was: the usual one first.
/// Each says which axis is up, so no note asks.
constexpr std::array<deform::ReadOptions, 4> readings{{{deform::UpAxis::y, true},
                                                       {deform::UpAxis::z, true},
                                                       {deform::UpAxis::y, false},
                                                       {deform::UpAxis::z, false}}};

/// Returns the model as the first of these ways reads it, or as that which gives the recorded
/// vertices.
Result<deform::ReadModel> read_as_recorded(const std::string& name, const recording::ShapeSum& sum,
                                           RecordedModel& recorded) {
  recorded.reading = readings.front();
  auto usual = read_models_silently(name, recorded.reading);
  if (!usual || recording::sum_of(usual->mesh.vertices) == sum) return usual;
  for (const deform::ReadOptions& other : std::span(readings).subspan(1)) {
    auto model = read_models_silently(name, other);
    if (!model || recording::sum_of(model->mesh.vertices) != sum) continue;
    recorded.reading = other;
    return model;
  }
  recorded.is_recorded = false;
  return usual;
}

Result<RecordedModel> model_of_file(const recording::LoopSetup& loop, const std::string& named) {
  const std::string& name = named.empty() ? loop.mesh : named;
  RecordedModel recorded;
  auto model = read_as_recorded(name, loop.mesh_sum, recorded);
  if (!model) {
    if (!named.empty()) return model.error();
    return Error{Errc::bad_input, printable(model.error().message) +
                                      "; that is the model that was recorded, name it with --mesh"};
  }
  note_all(name, model->notes);
  recorded.mesh = std::move(model->mesh);
  if (recorded.is_recorded) return recorded;
  if (named.empty()) {
    return Error{Errc::bad_input, printable(loop.mesh) +
                                      ": is not as it was when it was recorded; name the model of "
                                      "then with --mesh, or another"};
  }
  cli::note(named + ": another model than was recorded; its shape will be another, too");
  return recorded;
}

} // namespace

Result<deform::ReadModel> read_model(const std::string& file, const deform::ReadOptions& options) {
  auto model = read_alone(file, options);
  if (!model) return model;
  note_all(file, model->notes);
  deform::count_from(deform::usual_offset(model->mesh), model->mesh);
  return model;
}

Result<deform::ReadModel> read_models(const std::string& name, const deform::ReadOptions& options) {
  auto model = read_models_silently(name, options);
  if (model) note_all(name, model->notes);
  return model;
}

Result<void> write_model(const std::string& file, const deform::Mesh& mesh, deform::UpAxis up) {
  if (auto written = deform::write_mesh(file, mesh, {}, up); !written) return written;
  for (const std::string& lost : deform::lost_in_file(file, mesh))
    cli::note(file + ": " + lost);
  return {};
}

void add_up_option(cli::Command& command, std::string& up) {
  command
      .add_option("--up", up,
                  "The model's axis that points up: y, or z as in files of many CAD programs and "
                  "scanners. What is written has the same axes as the model; other options and "
                  "tables of coordinates have y up")
      .one_of({"y", "z"});
}

deform::ReadOptions reading(const std::string& up) {
  deform::ReadOptions options;
  if (!up.empty()) options.up = up == "z" ? deform::UpAxis::z : deform::UpAxis::y;
  return options;
}

Result<RecordedModel> find_recorded_model(const recording::LoopSetup& loop,
                                          const std::string& named) {
  auto model = model_of_file(loop, named);
  if (!model) return model;
  for (const auto& origin : loop.origins) {
    auto made = flow::rebuild(model->mesh, *origin);
    if (!made)
      return Error{Errc::bad_input, printable(named.empty() ? loop.mesh : named) + ": " +
                                        made.error().message +
                                        "; name the model of then with --mesh"};
    model->mesh = *std::move(made);
  }
  return model;
}

Result<RecordedModel> recorded_model(const std::string& file, const recording::Setup& setup,
                                     const std::string& named) {
  if (!setup.loop)
    return Error{Errc::bad_input, file + ": " + std::string(recording::without_loop)};
  return find_recorded_model(*setup.loop, named);
}

Result<bool> begin_with_first_shape(const std::string& file, recording::Setup& setup,
                                    RecordedModel& model) {
  recording::LoopSetup& loop = *setup.loop;
  if (loop.rest.empty() && loop.origins.empty()) return false;
  if (!loop.rest.empty()) {
    const deform::BlockLayout layout(model.mesh.vertices);
    if (loop.rest.size() != layout.block_count())
      return Error{Errc::bad_input, "the shape at its beginning is not one of this model"};
    layout.unpack(deform::BlockShape(loop.rest), model.mesh.vertices);
  }
  if (const auto written = deform::write_mesh(file, model.mesh, {}, model.up()); !written)
    return written.error();
  auto read = read_models_silently(file, model.reading);
  if (!read) return read.error();
  model.mesh = std::move(read->mesh);
  loop.mesh = std::filesystem::absolute(file).string();
  loop.mesh_sum = recording::sum_of(model.mesh.vertices);
  loop.rest.clear();
  loop.origins.clear();
  return true;
}

void note_missing(const std::string& file) {
  cli::note(file + ": something is missing in it, so the shape may be another");
}

} // namespace nendo::takes
