// Where a hand's fingertips are for a second, in metres from the wrist: x to the right, y out of
// the back of the hand, z to the elbow.
//   hand_pose [GLOVE]    GLOVE is as in `nendo run`: sim:grasp (the default), serial:/dev/ttyUSB0

#include <chrono>
#include <iostream>
#include <optional>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include <nendo/hand/skeleton.hpp>
#include <nendo/sculpting/open_hand.hpp>

namespace {

void note(std::string_view text) {
  std::cerr << "hand_pose: " << text << "\n";
}

int fail(const nendo::Error& error) {
  note(error.message);
  return static_cast<int>(error.code);
}

} // namespace

int main(int argc, char** argv) {
  using namespace nendo;
  auto glove = driver::open_glove(argc > 1 ? argv[1] : "sim:grasp");
  if (!glove) return fail(glove.error());
  auto open = sculpting::hand_of(*std::move(glove), std::nullopt, nullptr, note);
  const std::span<sculpting::OpenHand> hands(&open, 1);
  if (const auto started = sculpting::start(hands); !started) return fail(started.error());
  if (const auto come = sculpting::wait_for_samples(hands); !come) return fail(come.error());
  // The calibration that `nendo calibrate` has stored, or an average hand's.
  if (const auto found = sculpting::find_wearers(hands, {}, note); !found)
    return fail(found.error());
  const hand::WearerHand& own = open.wearer.of(open.first.side);
  const hand::HandSkeleton skeleton(open.side, own.size);

  GloveSample sample = open.first;
  for (int line = 0; line < 10; ++line) {
    open.ring->drain([&](const GloveSample& newer) noexcept { sample = newer; });
    const auto angles = hand::joint_angles(sample, own.calibration, own.left_out);
    const auto pose = skeleton.pose(angles, Eigen::Isometry3d::Identity());
    std::cout << "thumb " << pose.fingertip_positions().col(0).transpose() << ", index finger "
              << pose.fingertip_positions().col(1).transpose() << "\n";
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  open.glove->stop();
  return 0;
}
