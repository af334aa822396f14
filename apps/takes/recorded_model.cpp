#include "takes/recorded_model.hpp"

#include <nendo/base/text.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "cli/cli.hpp"
#include "takes/model_files.hpp"

namespace nendo::takes {
namespace {

Result<RecordedModel> model_of_file(const recording::LoopSetup& loop, const std::string& named) {
  auto model = read_models_from_zero(named.empty() ? loop.mesh : named);
  if (!model) {
    if (!named.empty()) return model.error();
    return Error{Errc::bad_input, printable(model.error().message) +
                                      "; that is the model that was recorded, name it with --mesh"};
  }
  // The loop of an old recording of a model far from zero had it there.
  if (recording::sum_of(model->mesh.vertices) == loop.mesh_sum)
    return RecordedModel{std::move(model->mesh)};
  deform::count_from(deform::usual_offset(model->mesh), model->mesh);
  if (recording::sum_of(model->mesh.vertices) == loop.mesh_sum)
    return RecordedModel{std::move(model->mesh)};
  if (named.empty()) {
    return Error{Errc::bad_input, printable(loop.mesh) +
                                      ": is not as it was when it was recorded; name the model of "
                                      "then with --mesh, or another"};
  }
  cli::note(named + ": another model than was recorded; its shape will be another, too");
  return RecordedModel{std::move(model->mesh), false};
}

} // namespace

Result<RecordedModel> find_recorded_model(const recording::LoopSetup& loop,
                                          const std::string& named) {
  auto model = model_of_file(loop, named);
  if (!model) return model;
  for (const auto& origin : loop.origins) {
    auto made = flow::made_again(model->mesh, *origin);
    if (!made)
      return Error{Errc::bad_input, printable(named.empty() ? loop.mesh : named) + ": " +
                                        made.error().message +
                                        "; name the model of then with --mesh"};
    model->mesh = *std::move(made);
  }
  return model;
}

Result<deform::Mesh> recorded_model(const recording::LoopSetup& loop, const std::string& named) {
  auto model = find_recorded_model(loop, named);
  if (!model) return model.error();
  return std::move(model->mesh);
}

Result<deform::Mesh> recorded_model(const std::string& file, const recording::Setup& setup,
                                    const std::string& named) {
  if (!setup.loop)
    return Error{Errc::bad_input, file + ": " + std::string(recording::without_loop)};
  return recorded_model(*setup.loop, named);
}

void note_missing(const std::string& file) {
  cli::note(file + ": something is missing in it, so the shape may be another");
}

} // namespace nendo::takes
