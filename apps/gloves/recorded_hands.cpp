#include "gloves/recorded_hands.hpp"

#include <nendo/driver/open_glove.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::gloves {

std::optional<recording::HandSetup> recorded_hand(const driver::GloveInfo& glove, Side side) {
  const auto spec = driver::parse_glove_spec(glove.source);
  if (!spec || spec->kind != "replay") return std::nullopt;
  const auto reader = recording::TakeReader::open(spec->target);
  if (!reader) return std::nullopt;
  for (const auto& hand : reader->setup().hands) {
    if (hand.first.side == side) return hand;
  }
  return std::nullopt;
}

} // namespace nendo::gloves
