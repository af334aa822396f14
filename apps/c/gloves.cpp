// Gloves and their hands.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <nendo/driver/devices.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/recording/replay_driver.hpp>
#include <nendo/sculpting/open_hand.hpp>

#include "c/boundary.hpp"

namespace nendo::c {
namespace {

/// An open glove, whose samples pass the gate and the filter of a loop.
struct OpenGlove {
  explicit OpenGlove(sculpting::OpenHand opened)
      : open(std::move(opened)), hand(sculpting::input_of(open), flow::Placement{}, false) {}
  ~OpenGlove() { open.glove->stop(); }
  OpenGlove(const OpenGlove&) = delete;
  OpenGlove& operator=(const OpenGlove&) = delete;

  sculpting::OpenHand open;
  flow::GloveHand hand;
  std::uint64_t samples = 1; ///< with the first one, which wait_for_samples() took
};

Result<std::unique_ptr<OpenGlove>> open_glove(const char* name, const char* user) {
  driver::GloveContext context;
  context.drivers.push_back(recording::replay_driver());
  auto glove = driver::open_glove(name, std::nullopt, context);
  if (!glove) return glove.error();
  const sculpting::Note ignore = [](std::string_view) {};
  auto open = sculpting::hand_of(*std::move(glove), std::nullopt, nullptr, ignore);
  const std::span<sculpting::OpenHand> one(&open, 1);
  if (const auto started = sculpting::start(one); !started) return started.error();
  if (const auto come = sculpting::wait_for_samples(one); !come) return come.error();
  sculpting::CalibrationOptions options;
  if (user != nullptr) options.user = user;
  if (const auto found = sculpting::find_wearers(one, options, ignore); !found)
    return found.error();
  return std::make_unique<OpenGlove>(std::move(open));
}

} // namespace
} // namespace nendo::c

using namespace nendo;
using c::OpenGlove;

extern "C" {

int nendo_find_gloves(void (*found)(void*, const char*, const char*), void* context) {
  return c::guarded([&]() -> Result<void> {
    if (found == nullptr) return c::is_null("found");
    for (const driver::DeviceCandidate& device : driver::find_devices())
      if (!device.spec.empty()) found(context, device.spec.c_str(), device.description.c_str());
    return {};
  });
}

int nendo_glove_open(const char* glove, const char* user, nendo_glove** opened) {
  return c::guarded([&]() -> Result<void> {
    if (glove == nullptr) return c::is_null("glove");
    if (opened == nullptr) return c::is_null("opened");
    auto made = c::open_glove(glove, user);
    if (!made) return made.error();
    *opened = c::object_of<nendo_glove>(*std::move(made));
    return {};
  });
}

void nendo_glove_close(nendo_glove* glove) {
  delete c::own<OpenGlove>(glove);
}

const char* nendo_glove_model(const nendo_glove* glove) {
  return glove == nullptr ? "" : c::own<const OpenGlove>(glove)->open.glove->info().model.c_str();
}

int nendo_glove_hand(nendo_glove* glove, struct nendo_hand* hand) {
  if (glove == nullptr || hand == nullptr)
    return c::fail(Errc::usage, glove == nullptr ? "glove: is null" : "hand: is null");
  OpenGlove& own = *c::own<OpenGlove>(glove);
  own.open.ring->drain([&own](const GloveSample& sample) noexcept {
    own.hand.update(sample);
    ++own.samples;
  });
  const GloveSample& latest = own.hand.latest;
  const bool is_silent = HostClock::now() - latest.arrival > flow::LoopOptions{}.silent_after;
  hand->flags = NENDO_PRESENT | (is_silent ? std::uint32_t{NENDO_SILENT} : 0U);
  hand->side = latest.side == Side::left ? NENDO_LEFT : NENDO_RIGHT;
  hand->samples = own.samples;
  hand->time_s = to_seconds(latest.time().time_since_epoch());
  c::write_pose(own.hand.angles,
                own.hand.skeleton().pose(own.hand.angles, Eigen::Isometry3d::Identity()), *hand);
  return NENDO_OK;
}
}
