#include "cyberglove/cyberglove_driver.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/driver/glove_options.hpp>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_identity.hpp"
#include "cyberglove/cyberglove_options.hpp"
#include "cyberglove/cyberglove_parser.hpp"
#include "cyberglove/cyberglove_protocol.hpp"
#include "cyberglove/record_check.hpp"
#include "stream/device_clock.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto state_answer = 300ms; ///< the unit has just answered other queries
constexpr int tries_at_start = 4;    ///< to ask for the state before the stream begins
constexpr int answers_at_start = 4;  ///< two tries, each as long as one and a half of the slowest
constexpr auto pause_answer = 150ms;
constexpr auto control_answer = 100ms; ///< while the stream waits

class CyberGloveProtocol final : public GloveProtocol {
public:
  explicit CyberGloveProtocol(const Options& options)
      : options_(options), baud_(options.baud.value_or(usual_bauds.front())) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source, IdentifyReason reason,
                             const ReplyDeadline& limit) override {
    Dialogue dialogue(transport, limit.deadline, limit.cancelled);
    auto identity = ask(transport, dialogue, source, reason);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) {
      begin_records();
      return identity.error();
    }
    identity_ = *std::move(identity);
    slowest_answer_ = dialogue.slowest_answer();
    begin_records();
    if (reason == IdentifyReason::opening) {
      for (const std::string& note : identity_.notes)
        spdlog::warn("device: {}: {}", source, note);
    }
    GloveInfo info;
    info.model = identity_.model;
    info.side = identity_.side;
    info.sensors = identity_.channels.sensors();
    info.rate_hz = identity_.rate_hz;
    if (identity_.hires) info.counts.max_count = hi_res_max;
    info.abilities = identity_.abilities;
    info.facts = identity_.facts;
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) override {
    Dialogue dialogue(transport, limit.deadline, limit.cancelled);
    dialogue.expect_late_answers(slowest_answer_);
    dialogue.prolong(HostClock::now() + answers_at_start * slowest_answer_);
    dialogue.stop_stream();
    Commands commands(dialogue, state_answer);
    Reply<GloveState> state = commands.ask(ask_state);
    // Noise on the line, or a unit or a host that was held up for a moment.
    for (int tries = 1; tries < tries_at_start && !state && state.answer != Answer::gone; ++tries)
      state = commands.ask(ask_state);
    const auto ready = check_state(source, state, "?G");
    const Answer answer = ready ? begin(dialogue) : Answer::silent;
    parser_.count_discarded(dialogue.bytes_received());
    begin_records();
    if (!ready) return ready.error();
    return answer == Answer::good ? Result<void>() : went_away(source);
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    Dialogue dialogue(transport, limit.deadline, limit.cancelled);
    dialogue.stop_stream();
    if (identity_.sync) Commands(dialogue, control_answer).send(set_sync, 0);
    parser_.count_discarded(dialogue.bytes_received());
  }

  void set_feedback(Transport& transport, const Feedback& feedback,
                    const ReplyDeadline& limit) noexcept override {
    const Abilities& can = identity_.abilities;
    if (!can.light && !can.vibration) return;
    Dialogue dialogue(transport, limit.deadline, limit.cancelled);
    Commands commands(dialogue, control_answer);
    dialogue.pause_stream(pause_answer);
    // From now on the program controls the light: the switch would change it.
    if (std::exchange(identity_.switch_drives_light, false))
      commands.set(Setting::switch_drives_light, false);
    if (can.light) commands.set(Setting::light, feedback.light);
    if (can.vibration) commands.set_vibration(feedback.vibration);
    begin(dialogue);
    parser_.count_discarded(dialogue.bytes_received());
    begin_records();
    same_clock_ = true;
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    // After eg another glove may be in the unit: its sensors are unknown until the unit was asked.
    const auto check = [&](Record& record) {
      if (!glove_removed_) return identity_.hires ? hires_check_(record, arrival) : check_(record);
      is_doubtful_ = true;
      return Verdict{false, 0};
    };
    parser_.push(chunk, check,
                 FindingSink{[&](const Record& record) { deliver(record, arrival, sink); },
                             [&](BadRecord) { sink.reject(); },
                             [&](Unplugged) { glove_removed_ = true; }});
  }

  bool is_doubtful() const noexcept override { return is_doubtful_; }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

  bool counts_missed() const noexcept override {
    if (identity_.hires) return hires_check_.counts_missed();
    return identity_.shape.time_stamp && check_.trusts_stamps();
  }

private:
  /// Greets the unit, at another line rate if needed, identifies the glove and sets it up.
  Result<Identity> ask(Transport& transport, Dialogue& dialogue, const std::string& source,
                       IdentifyReason reason) {
    if (reason == IdentifyReason::damaged || answered_without_glove_ || glove_removed_) {
      transport.set_baud(baud_);
      if (dialogue.stop_stream() != Answer::gone)
        Commands(dialogue, control_answer).send(reread_glove); // it may be another one
    }
    const Greeting greeting =
        greet(transport, dialogue, bauds_to_try(baud_, !options_.baud.has_value()));
    if (auto state = check_state(source, greeting.reply, greeting.query); !state) {
      const Reply<GloveState>& reply = greeting.reply;
      if (reply.answer == Answer::no_glove || (reply && !reply.value.connected))
        answered_without_glove_ = true;
      return state.error();
    }
    answered_without_glove_ = glove_removed_ = is_doubtful_ = false;
    baud_ = greeting.baud;
    return cyberglove::identify(dialogue, source, {options_, baud_, identity_.word_order});
  }

  /// The last step: sync mode may send records at once.
  Answer begin(Dialogue& dialogue) const noexcept {
    if (identity_.sync) {
      const Answer answer = Commands(dialogue, control_answer).send(set_sync, 1);
      if (answer == Answer::gone) return answer;
    }
    return dialogue.start_stream(identity_.hires ? third_stream : stream_command);
  }

  /// The next records have nothing to do with the previous ones.
  void begin_records() noexcept {
    parser_.reset(identity_.shape);
    const bool keeps_period = identity_.rate_hz > 0.0 && !identity_.sync;
    const double period = keeps_period ? clock_hz / identity_.rate_hz : 0.0;
    check_ = RecordCheck(static_cast<std::uint64_t>(std::llround(period)));
    hires_check_ = HiResCheck(identity_.rate_hz);
    same_clock_ = false;
  }

  void set_time(const Record& record, HostTime arrival, GloveSample& sample) noexcept {
    if (record.stamp == Stamp::none) return;
    if (record.stamp == Stamp::begins && !std::exchange(same_clock_, false)) {
      ticks_.reset();
      clock_.reset();
    }
    sample.has_device_time = true;
    sample.device_time = ticks_.unwrap(record.ticks);
    sample.measured = clock_.to_host(sample.device_time, arrival);
  }

  void deliver(const Record& record, HostTime arrival, Sink& sink) noexcept {
    GloveSample sample;
    const ChannelMap& channels = identity_.channels;
    for (std::size_t k = 0; k < channels.count; ++k) {
      sample.raw[channels.slot[k]] = RawCount{record.values[k]};
    }
    sample.present = channels.sensors();
    set_time(record, arrival, sample);
    sample.sampled_too_fast = record.sampled_too_fast;
    sample.wrist_switch = wrist_switch_of(record.status);
    sample.side = identity_.side;
    sink.deliver(sample);
  }

  const Options options_;
  int baud_; ///< the rate at which the unit answered last
  std::chrono::milliseconds slowest_answer_{0};
  bool answered_without_glove_ = false; ///< the unit's last answer said so
  Identity identity_;
  Parser parser_{RecordShape{}};
  RecordCheck check_;
  HiResCheck hires_check_;
  TickUnwrapper ticks_;
  DeviceClock clock_;
  bool same_clock_ = false;    ///< the stream paused, but the glove's clock continued
  bool glove_removed_ = false; ///< a record said so, and the unit was not asked since
  bool is_doubtful_ = false;   ///< records came since then
};

} // namespace

Result<std::unique_ptr<Glove>> open_cyberglove(const std::string& source, OpenPort open_port,
                                               const Options& options, HostTime deadline) {
  return open_stream_glove(source, std::move(open_port),
                           std::make_unique<CyberGloveProtocol>(options), deadline);
}

Result<std::unique_ptr<Glove>> open_serial_by(const DeviceSpec& spec, HostTime deadline) {
  const auto options = read_options(spec);
  if (!options) return options.error();
  if (auto named = require_port(spec, "serial:/dev/ttyUSB0"); !named) return named.error();
  const int baud = options->baud.value_or(usual_bauds.front());
  return open_cyberglove(spec.text, follow_port(spec.target, baud), *options, deadline);
}

Result<std::unique_ptr<Glove>> open_serial(const DeviceSpec& spec, std::optional<Side> /*side*/) {
  return open_serial_by(spec, HostClock::now() + open_budget);
}

} // namespace nendo::driver::cyberglove
