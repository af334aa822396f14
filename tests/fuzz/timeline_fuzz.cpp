// Whatever the text is, parse_timeline gives an error or a timeline that can be written, reads back
// to the same text, and plays to finite shapes.

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <variant>

#include "laws.hpp"
#include "support/test_meshes.hpp"
#include "timeline/player.hpp"
#include "timeline/timeline.hpp"

namespace {

void play(nendo::timeline::Timeline timeline) {
  constexpr int max_frames = 12;
  static const nendo::deform::Mesh model = nendo::test::sphere(6, 8, 1.0);
  auto& deformer = timeline.sculptor.deformer; // time is not what is looked for here
  if (deformer.injective)
    deformer.injective->max_links = std::min(deformer.injective->max_links, 8);
  int finer = 0; // nor memory
  std::erase_if(timeline.events, [&](const auto& event) {
    return std::holds_alternative<nendo::flow::Subdivide>(event.command) && ++finer > 3;
  });
  const auto player = nendo::timeline::Player::make(std::move(timeline), model);
  if (!player) return;
  for (int frame = 0; frame < max_frames && (*player)->next(); ++frame) {
  }
  require((*player)->final_shape().allFinite());
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::timeline;
  const std::string_view text = text_of(data, size);
  auto timeline = parse_timeline(text, "fuzz");
  if (!timeline) {
    require_one_line(timeline.error());
    return 0;
  }
  const auto written = timeline_text(*timeline);
  require(static_cast<bool>(written));
  const auto back = parse_timeline(*written, "back");
  require(static_cast<bool>(back));
  const auto again = timeline_text(*back);
  require(again && *again == *written);
  play(*std::move(timeline));
  return 0;
}
