#include "takes/recorded_model.hpp"

#include <array>
#include <span>

#include <nendo/base/text.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "cli/cli.hpp"
#include "takes/model_files.hpp"

namespace nendo::takes {
namespace {

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

void note_missing(const std::string& file) {
  cli::note(file + ": something is missing in it, so the shape may be another");
}

} // namespace nendo::takes
