#include "export/gltf_take.hpp"

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

} // namespace

Result<Played> play_frames(ChosenFrames& frames, bool hands, const See& see) {
  Played played;
  deform::Points vertices;
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) break;
    const auto time_s = static_cast<float>(frames.time_s() - frames.first_s());
    // Ticks that followed each other at once; a player wants times that rise.
    if (!played.times_s.empty() && !(time_s > played.times_s.back())) continue;
    const flow::Frame& frame = frames.frame();
    frames.vertices(vertices);
    played.times_s.push_back(time_s);
    if (!vertices.cast<float>().allFinite() || (hands && !follow_hands(frame, played)))
      return not_finite(frames.time_s());
    if (!see(frame, time_s, vertices)) return played;
    played.units_per_metre = frame.units_per_metre;
    played.last_s = frames.time_s();
  }
  played.to_the_end = true;
  return played;
}

Result<Exported> finish_take(GltfTake& document, GlbFile::Json roots, const Played& played,
                             const ChosenFrames& frames, const std::optional<double>& rate_hz,
                             const std::filesystem::path& path) {
  GlbFile& file = document.file;
  GlbFile::Index times = 0;
  const bool has_hands = played.hands[0] || played.hands[1];
  if (has_hands) times = file.add_scalars(played.times_s, true);
  for (const auto& hand : played.hands)
    if (hand) add_hand(*hand, times, file, document.animation, roots);
  put_at(frames.source().model(0).offset / played.units_per_metre, roots, file);
  file["scene"] = 0;
  file.add("scenes", {{"name", "stage"}, {"nodes", std::move(roots)}});
  if (!document.animation["channels"].empty())
    file.add("animations", std::move(document.animation));
  const auto bytes = file.write(path);
  if (!bytes) return bytes.error();
  Exported done{{path.string()}, played.times_s.size(), frames.first_s(), played.last_s, *bytes};
  done.rate_hz = rate_hz;
  done.exact = frames.source().is_exact();
  return done;
}

void show_one_by_one(const std::vector<Shown>& models, double units_per_metre, GltfTake& document) {
  if (models.size() < 2) return;
  const auto scale = static_cast<float>(1.0 / units_per_metre);
  for (std::size_t at = 0; at < models.size(); ++at) {
    std::vector<float> times_s{0.0F};
    std::vector<float> scales{at == 0 ? scale : 0.0F};
    const auto change = [&](float time_s, float to) {
      times_s.push_back(time_s);
      scales.push_back(to);
    };
    if (at > 0) change(models[at].begin_s, scale);
    if (at + 1 < models.size()) change(models[at + 1].begin_s, 0.0F);
    Eigen::Matrix3Xf vectors(3, static_cast<Eigen::Index>(scales.size()));
    for (std::size_t key = 0; key < scales.size(); ++key)
      vectors.col(static_cast<Eigen::Index>(key)).setConstant(scales[key]);
    document.animate(models[at].node, "scale", "STEP", document.file.add_scalars(times_s, true),
                     document.file.add_vectors(vectors, GlbFile::Use::animation, false));
  }
}

} // namespace nendo::exporting
