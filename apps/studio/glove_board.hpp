#pragma once
// The gloves and trackers of the start screen: those that were named or that the machine has, each
// glove read live. Main thread, except for what is noted otherwise.

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nendo/driver/device_watcher.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/flow/hand_input.hpp>

#include "gloves/open_hand.hpp"
#include "render/scene_frame.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

/// What the start screen says about a device.
struct DeviceCard {
  enum class State : std::uint8_t { opening, streaming, silent, refused, tracker };
  State state = State::opening;
  std::string title;            ///< the glove's model and hand, or the device's description
  std::string words;            ///< its state, as a sentence
  std::string remedy;           ///< what the user can do; empty: nothing is to do
  NamedGlove glove;             ///< none: the device is not one
  std::optional<Side> side{};   ///< the side of an open glove
  bool is_uncalibrated = false; ///< a person wears it with an average hand's calibration
  bool is_simulated = false;
};

class GloveBoard {
public:
  using OpenWatcher = std::function<Result<std::unique_ptr<driver::DeviceWatcher>>()>;

  /// Opens the gloves `named` or, if there are none, each glove that is plugged in now or later, as
  /// the watcher reports them. Opening takes seconds and happens in a thread of its own.
  GloveBoard(std::vector<NamedGlove> named, gloves::CalibrationOptions calibration,
             OpenWatcher open_watcher = driver::DeviceWatcher::open);
  /// Closes the gloves, so that a run can open them. Blocks while one is being opened.
  ~GloveBoard();
  GloveBoard(const GloveBoard&) = delete;
  GloveBoard& operator=(const GloveBoard&) = delete;

  /// Reads what the gloves have sent.
  void update();
  const std::vector<DeviceCard>& cards() const noexcept { return cards_; }
  /// Returns whether a person's glove is open.
  bool has_gloves() const noexcept;
  /// Puts the hands into a scene in metres, side by side, upright, with their backs to the viewer.
  void pose(render::SceneFrame& scene_frame) const;

private:
  /// A device between the thread that finds and opens it and the main thread.
  struct Device {
    driver::DeviceCandidate candidate;
    NamedGlove glove;
    std::optional<gloves::OpenHand> hand; ///< open and started
    std::optional<Error> error;
    bool is_gone = false;
  };
  struct Live {
    std::shared_ptr<Device> device;
    std::optional<flow::GloveHand> hand; ///< since its first sample
    std::string calibration;
  };

  void watch(); ///< the thread's work
  void add(NamedGlove glove, const driver::DeviceCandidate& candidate);
  void remove(const driver::DeviceCandidate& candidate);
  void take_found();
  void read(Live& live);
  DeviceCard card_of(Live& live) const;

  gloves::CalibrationOptions calibration_;
  std::vector<NamedGlove> named_;
  OpenWatcher open_watcher_;
  std::mutex mutex_; ///< guards found_ and Device::is_gone
  std::vector<std::shared_ptr<Device>> found_;
  std::vector<Live> live_;
  std::vector<DeviceCard> cards_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace nendo::studio
