// Gloves shape a model for two seconds, or until a recording ends, while this program looks on.
//   live_loop MODEL OUT.obj [LEFT [RIGHT]]    gloves as in `nendo run`; without any: those of this
//                                             machine, or simulated hands; "" is no such hand

#include <chrono>
#include <cstdint>
#include <iostream>
#include <thread>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/sculpting/live_loop.hpp>

namespace {

int fail(const nendo::Error& error) {
  std::cerr << "live_loop: " << error.message << "\n";
  return static_cast<int>(error.code);
}

void print(const nendo::flow::Frame& frame) {
  std::cout << "tick " << frame.tick << ":";
  for (const auto& hand : frame.hands)
    if (hand.present)
      std::cout << " index finger at "
                << hand.pose[nendo::hand::Joint::index_tip].translation().transpose() << " m";
  std::cout << "\n";
}

} // namespace

int main(int argc, char** argv) {
  using namespace nendo;
  if (argc < 3) return fail({Errc::usage, "usage: live_loop MODEL OUT.obj [LEFT [RIGHT]]"});
  sculpting::LiveOptions options;
  if (argc > 3) options.left = argv[3];
  if (argc > 4) options.right = argv[4];
  auto live = sculpting::LiveLoop::begin(argv[1], options);
  if (!live) return fail(live.error());
  for (const auto& note : live->notes())
    std::cerr << "live_loop: " << note << "\n";

  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  std::uint64_t next = 0;
  while (std::chrono::steady_clock::now() < end && !live->has_ended()) {
    if (live->update() && live->frame().tick >= next) {
      print(live->frame());
      next = live->frame().tick + 45;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const auto written = deform::write_mesh(argv[2], live->finish());
  if (!written) return fail(written.error());
  std::cout << live->stats().ticks << " ticks, the shape: " << argv[2] << "\n";
  return 0;
}
