#include "cyberglove/cyberglove_driver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_identity.hpp"
#include "cyberglove/cyberglove_parser.hpp"
#include "glove_spec.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;
using namespace cyberglove;

constexpr auto open_budget = 4s;
constexpr auto start_budget = 900ms;
constexpr auto stop_budget = 400ms;
constexpr auto read_timeout = 100ms; ///< also how soon the reader notices that it is to stop
constexpr auto longest_silence = 1500ms;
constexpr auto retry_interval = 500ms;

/// GloveStats, written by the reader thread and read by any.
struct SharedStats {
  std::atomic<std::uint64_t> bytes{0}, record_bytes{0}, discarded_bytes{0}, records{0},
      bad_records{0}, ring_refused{0}, silences{0}, reopened{0};

  void store(const ParserCounters& counters) noexcept {
    bytes = counters.bytes;
    record_bytes = counters.record_bytes;
    discarded_bytes = counters.discarded_bytes;
    records = counters.records;
    bad_records = counters.bad_records;
  }
  void clear() noexcept {
    store({});
    ring_refused = silences = reopened = 0;
  }
};

class CyberGloveDriver final : public Glove {
public:
  CyberGloveDriver(std::string source, OpenPort open_port, std::unique_ptr<Transport> transport,
                   Identity identity)
      : info_{std::move(source), identity.model, identity.side, identity.channels.sensors(),
              identity.rate_hz},
        open_port_(std::move(open_port)), transport_(std::move(transport)),
        identity_(std::move(identity)), parser_(identity_.shape) {}
  ~CyberGloveDriver() override { CyberGloveDriver::stop(); }

  const GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& ring) override;
  void stop() noexcept override;
  GloveStats stats() const noexcept override;

private:
  enum class StreamEnd { stopped, silent, gone };

  void run(const std::stop_token& token, SampleRing& ring);
  StreamEnd stream(const std::stop_token& token, SampleRing& ring);
  void deliver(const Record& record, HostTime arrival, SampleRing& ring);
  void revive(const std::stop_token& token);
  void reopen(const std::stop_token& token);
  std::optional<Error> restart(const std::stop_token& token, bool swapped);
  void end_stream() noexcept;
  void wait(const std::stop_token& token, std::chrono::milliseconds time);

  const GloveInfo info_;
  const OpenPort open_port_;
  SharedStats stats_;
  std::jthread reader_;

  // Used by the reader thread only, while it runs.
  std::unique_ptr<Transport> transport_; ///< null while the device is away
  Identity identity_;
  Parser parser_;
  std::uint64_t sequence_ = 0;
  bool outage_ = false;          ///< no record since the stream broke off
  std::uint64_t bad_before_ = 0; ///< bad records at the time of the last good one
};

Result<void> CyberGloveDriver::start(SampleRing& ring) {
  if (reader_.joinable()) return Error{Errc::failed, info_.source + " is streaming already"};
  if (!transport_) return Error{Errc::no_device, info_.source + " went away; open it again"};
  Dialogue dialogue(*transport_, HostClock::now() + start_budget);
  dialogue.stop_stream();
  if (auto state = check_state(dialogue, info_.source); !state) return state.error();
  if (dialogue.start_stream() != Answer::good) {
    return Error{Errc::no_device, info_.source + " went away; is the cable loose?"};
  }
  parser_ = Parser(identity_.shape);
  stats_.clear();
  sequence_ = 0;
  bad_before_ = 0;
  outage_ = false;
  reader_ = std::jthread([this, &ring](const std::stop_token& token) { run(token, ring); });
  return {};
}

void CyberGloveDriver::stop() noexcept {
  if (!reader_.joinable()) return;
  reader_.request_stop();
  reader_.join();
}

GloveStats CyberGloveDriver::stats() const noexcept {
  GloveStats stats;
  // `bytes` last: read while the stream runs, it is never less than its parts.
  stats.record_bytes = stats_.record_bytes;
  stats.discarded_bytes = stats_.discarded_bytes;
  stats.records = stats_.records;
  stats.bad_records = stats_.bad_records;
  stats.ring_refused = stats_.ring_refused;
  stats.silences = stats_.silences;
  stats.reopened = stats_.reopened;
  stats.bytes = stats_.bytes;
  return stats;
}

void CyberGloveDriver::run(const std::stop_token& token, SampleRing& ring) {
  for (;;) {
    switch (stream(token, ring)) {
    case StreamEnd::stopped:
      end_stream();
      return;
    case StreamEnd::silent:
      revive(token);
      break;
    case StreamEnd::gone:
      reopen(token);
      break;
    }
  }
}

CyberGloveDriver::StreamEnd CyberGloveDriver::stream(const std::stop_token& token,
                                                     SampleRing& ring) {
  std::array<std::byte, 1024> buffer{};
  HostTime last_record = HostClock::now();
  while (!token.stop_requested()) {
    if (!transport_) return StreamEnd::gone;
    const auto [status, count] = transport_->read_some(buffer, read_timeout);
    const HostTime now = HostClock::now();
    if (status == IoStatus::gone) return StreamEnd::gone;
    parser_.push(std::span(buffer).first(count), [&](const Record& record) {
      last_record = now;
      deliver(record, now, ring);
    });
    stats_.store(parser_.counters());
    if (now - last_record > longest_silence) return StreamEnd::silent;
  }
  return StreamEnd::stopped;
}

void CyberGloveDriver::deliver(const Record& record, HostTime arrival, SampleRing& ring) {
  GloveSample sample;
  sample.arrival = arrival;
  sample.sequence = sequence_++;
  const ChannelMap& channels = identity_.channels;
  for (std::size_t k = 0; k < channels.count; ++k) {
    sample.raw[channels.slot[k]] = RawCount{record.values[k]};
  }
  sample.present = channels.sensors();
  sample.device_ticks = record.ticks;
  sample.has_device_time = identity_.shape.time_stamp;
  sample.side = identity_.side;
  if (!ring.try_push(sample)) ++stats_.ring_refused;
  bad_before_ = parser_.counters().bad_records;
  if (std::exchange(outage_, false)) spdlog::warn("device: {} streams again", info_.source);
}

/// The unit fell silent, or sends nothing usable: it may have been switched off and on, or its
/// glove swapped.
void CyberGloveDriver::revive(const std::stop_token& token) {
  if (!std::exchange(outage_, true)) {
    ++stats_.silences;
    spdlog::warn("device: {} sent no good record for 1.5 s; starting its stream again",
                 info_.source);
  }
  const bool swapped = parser_.counters().bad_records != bad_before_;
  if (restart(token, swapped)) wait(token, retry_interval);
}

void CyberGloveDriver::reopen(const std::stop_token& token) {
  // At once: while the old handle is open, a device that is plugged in again gets another name.
  transport_.reset();
  if (!std::exchange(outage_, true)) {
    spdlog::warn("device: {} went away; looking for it every 0.5 s", info_.source);
  }
  while (!token.stop_requested()) {
    wait(token, retry_interval);
    if (token.stop_requested()) return;
    auto transport = open_port_();
    if (!transport) continue;
    transport_ = *std::move(transport);
    if (!restart(token, false)) {
      ++stats_.reopened;
      return;
    }
    transport_.reset();
  }
}

/// Asks anew who is there and starts the stream.
std::optional<Error> CyberGloveDriver::restart(const std::stop_token& token, bool swapped) {
  Dialogue dialogue(*transport_, HostClock::now() + open_budget, token);
  if (swapped && dialogue.stop_stream() != Answer::gone) dialogue.reread_glove();
  auto identity = identify(dialogue, info_.source);
  parser_.count_discarded(dialogue.bytes_received());
  if (!identity) {
    parser_.reset(identity_.shape);
    stats_.store(parser_.counters());
    return identity.error();
  }
  if (!(identity->channels == identity_.channels) || identity->side != identity_.side) {
    spdlog::warn("device: {} is another glove now: {} hand, {}", info_.source,
                 name_of(identity->side), identity->model);
  }
  identity_ = *std::move(identity);
  parser_.reset(identity_.shape);
  stats_.store(parser_.counters());
  dialogue.start_stream(); // a failure shows itself as silence or as a lost device
  return std::nullopt;
}

void CyberGloveDriver::end_stream() noexcept {
  if (!transport_) return;
  Dialogue dialogue(*transport_, HostClock::now() + stop_budget);
  dialogue.stop_stream();
  parser_.count_discarded(dialogue.bytes_received());
  stats_.store(parser_.counters());
}

/// Sleeps, but wakes up when it is to stop.
void CyberGloveDriver::wait(const std::stop_token& token, std::chrono::milliseconds time) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_for(lock, token, time, [] { return false; });
}

Result<int> baud_of(const GloveSpec& spec) {
  constexpr std::array known{115'200, 57'600, 38'400, 19'200, 9'600};
  const auto option = spec.options.find("baud");
  if (option == spec.options.end()) return known.front();
  for (const int baud : known) {
    if (option->second == std::to_string(baud)) return baud;
  }
  return Error{Errc::usage, spec.text + ": baud=" + option->second +
                                " is none of 115200, 57600, 38400, 19200, 9600"};
}

} // namespace

Result<std::unique_ptr<Glove>> open_cyberglove(const std::string& source, OpenPort open_port,
                                               HostTime deadline) {
  auto transport = open_port();
  if (!transport) return transport.error();
  (*transport)->discard_input();
  Dialogue dialogue(**transport, deadline);
  auto identity = identify(dialogue, source);
  if (!identity) return identity.error();
  return std::unique_ptr<Glove>(std::make_unique<CyberGloveDriver>(
      source, std::move(open_port), *std::move(transport), *std::move(identity)));
}

Result<std::unique_ptr<Glove>> open_serial_by(const GloveSpec& spec, HostTime deadline) {
  if (auto allowed = allow_options(spec, {"baud"}); !allowed) return allowed.error();
  const auto baud = baud_of(spec);
  if (!baud) return baud.error();
  if (spec.target.empty()) {
    return Error{Errc::usage, spec.text + ": name the port, e.g. serial:/dev/ttyUSB0"};
  }
  const auto open_port = [path = spec.target, rate = *baud] { return open_transport(path, rate); };
  return open_cyberglove(spec.text, open_port, deadline);
}

Result<std::unique_ptr<Glove>> open_serial(const GloveSpec& spec, std::optional<Side> /*side*/) {
  return open_serial_by(spec, HostClock::now() + open_budget);
}

} // namespace nendo::driver
