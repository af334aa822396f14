#include "export/gltf_take.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace nendo::exporting {
namespace {

Error not_finite(double time_s) {
  return {Errc::bad_input, "at " + std::to_string(time_s) +
                               " s there are numbers that 32-bit floats cannot hold; scale the "
                               "model down, or leave the hands out with --no-hands"};
}

/// Moves the nodes of the scene there. A node's place is a decimal number, so the floats of
/// vertices need not hold it. A skin is where its joints are.
void put_at(const Eigen::Vector3d& place_m, const GlbFile::Json& roots, GlbFile& file) {
  if (place_m.isZero(0.0)) return;
  for (const auto& root : roots) {
    auto& node = file["nodes"][root.get<GlbFile::Index>()];
    if (!node.contains("skin")) node["translation"] = {place_m.x(), place_m.y(), place_m.z()};
  }
}

bool follow_hands(const flow::Frame& frame, Played& played) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const flow::HandFrame& hand = frame.hands[slot];
    if (played.times_s.size() == 1 && hand.present) played.hands[slot].emplace(side);
    if (played.hands[slot] && !played.hands[slot]->add(hand.pose)) return false;
  }
  return true;
}

/// Shows each model in its time only. A node whose scale is 0 is hidden (glTF 2.0, 3.5.3).
void show_one_by_one(const std::vector<MovingModel>& models, double units_per_metre,
                     GltfTake& document) {
  if (models.size() < 2) return;
  const auto scale = static_cast<float>(1.0 / units_per_metre);
  for (std::size_t at = 0; at < models.size(); ++at) {
    std::vector<float> times_s{0.0F};
    std::vector<float> scales{at == 0 ? scale : 0.0F};
    const auto change = [&](float time_s, float to) {
      times_s.push_back(time_s);
      scales.push_back(to);
    };
    if (at > 0) change(models[at].times_s.front(), scale);
    if (at + 1 < models.size()) change(models[at + 1].times_s.front(), 0.0F);
    Eigen::Matrix3Xf vectors(3, static_cast<Eigen::Index>(scales.size()));
    for (std::size_t key = 0; key < scales.size(); ++key)
      vectors.col(static_cast<Eigen::Index>(key)).setConstant(scales[key]);
    document.animate(models[at].model.node(), "scale", "STEP",
                     document.file.add_scalars(times_s, true),
                     document.file.add_vectors(vectors, GlbFile::Use::animation, false));
  }
}

} // namespace

Result<Played> play_frames(const GltfJob& job, const AddFrame& add) {
  ChosenFrames& frames = job.frames;
  Played played;
  deform::Points vertices;
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) return played;
    const auto time_s = static_cast<float>(frames.time_s() - frames.first_s());
    // Ticks that followed each other at once; a player wants times that rise.
    if (!played.times_s.empty() && !(time_s > played.times_s.back())) continue;
    const flow::Frame& frame = frames.frame();
    frames.vertices(vertices);
    played.times_s.push_back(time_s);
    if (!vertices.cast<float>().allFinite() || (job.options.hands && !follow_hands(frame, played)))
      return not_finite(frames.time_s());
    if (const auto added = add(frame, time_s, vertices); !added) return added.error();
    played.units_per_metre = frame.units_per_metre;
    played.last_s = frames.time_s();
  }
}

Result<Exported> finish_models(const GltfJob& job, const Played& played,
                               const std::vector<MovingModel>& models, MorphReport report,
                               GltfTake& document) {
  const takes::FrameSource& source = job.frames.source();
  const double diagonal = source.layout(models.front().version).diagonal();
  std::vector<const deform::Appearance*> looks;
  for (const MovingModel& one : models)
    looks.push_back(&source.model(one.version).look);
  const GltfMaterials materials(richest_of(looks), document.file);
  report.models = models.size();
  report.diagonal_m = diagonal / played.units_per_metre;
  GlbFile::Json roots = GlbFile::Json::array();
  for (const MovingModel& one : models) {
    if (one.model.target_count() > 0) {
      const auto times = document.file.add_scalars(one.times_s, true);
      document.animate(one.model.node(), "weights", "LINEAR", times,
                       one.weights.empty() ? one.model.add_key_weights(document.file)
                                           : document.file.add_scalars(one.weights, false));
      report.keys += one.times_s.size();
    }
    MorphReport own = report;
    own.greatest_error = one.greatest_error / diagonal;
    one.model.add_to(document.file, materials, played.units_per_metre, own);
    report.targets += one.model.target_count();
    report.greatest_error = std::max(report.greatest_error, own.greatest_error);
    roots.push_back(one.model.node());
  }
  show_one_by_one(models, played.units_per_metre, document);
  auto done = finish_take(job, played, std::move(roots), document);
  if (done) done->morphs = report;
  return done;
}

Result<Exported> finish_take(const GltfJob& job, const Played& played, GlbFile::Json roots,
                             GltfTake& document) {
  GlbFile& file = document.file;
  GlbFile::Index times = 0;
  const bool has_hands = played.hands[0] || played.hands[1];
  if (has_hands) times = file.add_scalars(played.times_s, true);
  for (const auto& hand : played.hands)
    if (hand) add_hand(*hand, times, file, document.animation, roots);
  const takes::FrameSource& source = job.frames.source();
  put_at(source.model(0).offset / played.units_per_metre, roots, file);
  file["scene"] = 0;
  file.add("scenes", {{"name", "stage"}, {"nodes", std::move(roots)}});
  if (!document.animation["channels"].empty())
    file.add("animations", std::move(document.animation));
  const auto bytes = file.write(job.path);
  if (!bytes) return bytes.error();
  Exported done{
      {job.path.string()}, played.times_s.size(), job.frames.first_s(), played.last_s, *bytes};
  done.rate_hz = job.frames.rate_hz();
  done.exact = source.is_exact();
  return done;
}

} // namespace nendo::exporting
