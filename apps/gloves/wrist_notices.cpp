#include "gloves/wrist_notices.hpp"

#include <utility>

#include "gloves/tracker_text.hpp"

namespace nendo::gloves {

std::vector<std::string> WristNotices::changes(Side side, const flow::HandFrame& hand,
                                               HostTime now) {
  std::vector<std::string> sentences;
  if (!hand.tracked) return sentences;
  const std::string wrist = "the " + std::string(name_of(side)) + " wrist";
  if (!hand.lost) {
    lost_since_.reset();
    if (std::exchange(is_loss_reported_, false)) sentences.push_back(wrist + " is back");
  } else if (!lost_since_) {
    lost_since_ = now;
  } else if (!is_loss_reported_ && now - *lost_since_ >= min_loss) {
    is_loss_reported_ = true;
    sentences.push_back("no good pose of " + wrist + " comes: the hand stays where it is");
  }
  if (hand.pose_counts.flips > 0 && !std::exchange(is_flip_reported_, true))
    sentences.emplace_back(hemisphere_advice);
  return sentences;
}

} // namespace nendo::gloves
