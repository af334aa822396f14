#include <algorithm>
#include <array>
#include <atomic>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/base/number_in.hpp>
#include <nendo/driver/reader_thread.hpp>
#include <nendo/driver/simulated_glove.hpp>

#include "drivers.hpp"
#include "simulated/hand_motion.hpp"
#include "simulated/typical_wearer.hpp"

namespace nendo::driver {
namespace {

class SimulatedGlove final : public Glove {
public:
  SimulatedGlove(const SimulatedGloveOptions& options, SensorMotion motion)
      : motion_(std::move(motion)), wearer_(options.seed),
        period_(from_seconds(1.0 / options.rate_hz)) {
    info_.kind = SourceKind::simulated;
    info_.source = options.source;
    info_.model = "simulated glove, " + std::to_string(options.sensors) + " sensors, motion " +
                  options.motion;
    info_.side = options.side;
    info_.sensors = options.sensors == 18 ? sensors_18 : sensors_22;
    info_.rate_hz = options.rate_hz;
  }

  const GloveInfo& info() const noexcept override { return info_; }

  Result<void> start(SampleRing& ring) override {
    return reader_.start(info_.source, [this, &ring](const std::stop_token& stop) {
      records_ = ring_refused_ = 0;
      read(stop, ring);
    });
  }
  void stop() noexcept override { reader_.stop(); }

  StreamStats stats() const noexcept override {
    StreamStats stats;
    stats.records = records_.load(std::memory_order_relaxed);
    stats.ring_refused = ring_refused_.load(std::memory_order_relaxed);
    stats.counts_missed = true; // there is no line on which records get lost
    return stats;
  }

  void set_feedback(const Feedback& /*feedback*/) noexcept override {
  } // it has nothing to show it with

private:
  void read(const std::stop_token& stop, SampleRing& ring) {
    begin_ = HostClock::now();
    for (std::int64_t tick = 0; reader_.wait_until(stop, begin_ + tick * period_); ++tick) {
      tick = std::max(tick, (HostClock::now() - begin_) / period_);
      deliver(tick * period_, ring);
    }
  }

  void deliver(HostClock::duration elapsed, SampleRing& ring) {
    GloveSample sample;
    const auto raw = wearer_.counts(motion_(to_seconds(elapsed)));
    for (std::size_t k = 0; k < sensor_slots; ++k) {
      if (info_.sensors.has(static_cast<Sensor>(k))) sample.raw[k] = raw[k];
    }
    sample.present = info_.sensors;
    sample.side = info_.side;
    sample.sequence = records_.load(std::memory_order_relaxed);
    sample.has_device_time = true;
    sample.device_time = elapsed;
    sample.measured = begin_ + elapsed;
    sample.arrival = HostClock::now();
    if (!ring.try_push(sample)) ring_refused_.fetch_add(1, std::memory_order_relaxed);
    records_.fetch_add(1, std::memory_order_relaxed);
  }

  GloveInfo info_;
  SensorMotion motion_;
  TypicalWearer wearer_;
  HostClock::duration period_;
  HostTime begin_; ///< used by the reader thread only
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> ring_refused_{0};
  ReaderThread reader_; // last: joined before what it uses is gone
};

template <class Number>
bool set_number(Number& number, std::string_view text) noexcept {
  const auto read = number_in<Number>(text);
  if (read) number = *read;
  return read.has_value();
}

struct Option {
  std::string_view key;
  std::string_view allowed;
};
constexpr std::array<Option, 4> known_options{{{"seed", "a whole number from 0 to 4294967295"},
                                               {"rate", "a number from 1 to 1000 (hertz)"},
                                               {"hand", "left or right"},
                                               {"sensors", "18 or 22"}}};

// False: the value is none of those that `known_options` allows for this key.
bool set_option(SimulatedGloveOptions& settings, const std::string& key, const std::string& value) {
  if (key == "seed") return set_number(settings.seed, value);
  if (key == "rate") {
    return set_number(settings.rate_hz, value) && settings.rate_hz >= 1.0 &&
           settings.rate_hz <= 1000.0;
  }
  if (key == "hand") {
    const auto side = side_named(value);
    settings.side = side.value_or(settings.side);
    return side.has_value();
  }
  settings.sensors = value == "18" ? 18 : 22;
  return value == std::to_string(settings.sensors);
}

Error usage(const DeviceSpec& spec, std::string_view what) {
  return Error{Errc::usage, std::string(spec.text).append(": ").append(what)};
}

/// One of this library's motions, or else one that the program adds.
Result<SensorMotion> motion_of(const DeviceSpec& spec, const SimulatedGloveOptions& options,
                               const std::vector<NamedMotion>& added) {
  const auto own = find_motion(options.motion);
  if (own)
    return SensorMotion([hand = HandMotion(*own, options.side, options.seed)](double time_s) {
      return hand.at(time_s);
    });
  std::string what = own.error().message;
  for (const NamedMotion& motion : added) {
    if (motion.name == options.motion) return motion.make(options);
    what.append(", ").append(motion.name);
  }
  return usage(spec, what);
}

} // namespace

Result<SimulatedGloveOptions> simulated_glove_options(const DeviceSpec& spec,
                                                      std::optional<Side> side) {
  SimulatedGloveOptions settings;
  settings.source = spec.text;
  settings.side = side.value_or(Side::right);
  if (!spec.target.empty()) settings.motion = spec.target;
  for (const auto& [key, value] : spec.options) {
    const auto* option = std::find_if(known_options.begin(), known_options.end(),
                                      [&name = key](const Option& o) { return o.key == name; });
    if (option == known_options.end()) {
      return usage(spec, "no option '" + key + "'; there are seed, rate, hand, sensors");
    }
    if (!set_option(settings, key, value)) {
      std::string what = "option " + key;
      what.append(" is '").append(value).append("', but must be ").append(option->allowed);
      return usage(spec, what);
    }
  }
  return settings;
}

std::unique_ptr<Glove> make_simulated_glove(const SimulatedGloveOptions& options,
                                            SensorMotion motion) {
  return std::make_unique<SimulatedGlove>(options, std::move(motion));
}

Result<std::unique_ptr<Glove>> open_simulated(const DeviceSpec& spec, std::optional<Side> side,
                                              const GloveContext& context) {
  const auto options = simulated_glove_options(spec, side);
  if (!options) return options.error();
  auto motion = motion_of(spec, *options, context.motions);
  if (!motion) return motion.error();
  return make_simulated_glove(*options, *std::move(motion));
}

} // namespace nendo::driver
