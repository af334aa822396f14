#include "takes/timeline_frames.hpp"

#include <utility>

#include "takes/model_files.hpp"
#include "timeline/timeline.hpp"

namespace nendo::takes {

Result<RecordedModel> timeline_model(const timeline::Timeline& timeline, const std::string& mesh) {
  recording::LoopSetup of_take;
  of_take.mesh = timeline.mesh;
  of_take.mesh_sum = timeline.mesh_sum;
  return find_recorded_model(of_take, mesh);
}

Result<std::unique_ptr<TimelineFrames>> TimelineFrames::open(const std::filesystem::path& path,
                                                             const std::string& mesh) {
  auto timeline = timeline::read_timeline(path);
  if (!timeline) return timeline.error();
  auto model = timeline_model(*timeline, mesh);
  if (!model) return model.error();
  auto frames = make(*std::move(timeline), model->mesh);
  if (!frames) return Error{frames.error().code, path.string() + ": " + frames.error().message};
  (*frames)->set_up(model->up());
  return frames;
}

Result<std::unique_ptr<TimelineFrames>> TimelineFrames::make(timeline::Timeline timeline,
                                                             const deform::Mesh& model) {
  auto player = timeline::Player::make(std::move(timeline), model);
  if (!player) return player.error();
  return std::unique_ptr<TimelineFrames>(new TimelineFrames(*std::move(player)));
}

double middle_plane_m(const timeline::Timeline& timeline, const deform::Mesh& model) {
  const auto xs = model.vertices.row(0);
  return (xs.minCoeff() / 2.0 + xs.maxCoeff() / 2.0) / timeline.units_per_metre;
}

} // namespace nendo::takes
