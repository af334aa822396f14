#include "gloves/recorded_hands.hpp"

#include <nendo/recording/take_reader.hpp>

namespace nendo::gloves {

std::optional<hand::Wearer> recorded_wearer(const driver::GloveInfo& glove, Side side) {
  if (glove.kind != driver::GloveKind::recorded) return std::nullopt;
  const auto reader = recording::TakeReader::open(glove.recording);
  if (!reader) return std::nullopt;
  for (const auto& hand : reader->setup().hands) {
    if (hand.first.side == side) return hand::Wearer{hand.wearer.left, hand.wearer.right};
  }
  return std::nullopt;
}

} // namespace nendo::gloves
