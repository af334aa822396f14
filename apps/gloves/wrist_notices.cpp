#include "gloves/wrist_notices.hpp"

#include <utility>

#include "gloves/tracker_text.hpp"

namespace nendo::gloves {

std::vector<std::string> WristNotices::changes(Side side, const flow::HandFrame& hand, HostTime now,
                                               const driver::TrackerStation& station) {
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
    const bool came = hand.pose_counts.poses > 0;
    sentences.push_back("no " + std::string(came ? "good " : "") + "pose of " + wrist +
                        " comes: the hand stays where it is" +
                        (came ? "" : "; " + no_pose_advice(station)));
  }
  if (hand.pose_counts.flips > 0 && !std::exchange(is_flip_reported_, true))
    sentences.emplace_back(hemisphere_advice);
  return sentences;
}

} // namespace nendo::gloves
