#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "liberty/liberty_parser.hpp"
#include "liberty/liberty_protocol.hpp"
#include "polhemus/polhemus_greeting.hpp"
#include "polhemus/polhemus_options.hpp"
#include "stream/device_clock.hpp"
#include "stream/line_times.hpp"
#include "stream/stream_tracker.hpp"
#include "stream/text_dialogue.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::liberty {
namespace {

using namespace std::chrono_literals;
using polhemus::Options;

constexpr auto quiet_time = 60ms;
constexpr auto max_drain = 250ms;
constexpr auto answer_time = 350ms; ///< the longest answer takes 257 ms at 9600 baud
constexpr auto end_of_answer = 80ms;

/// What the tracker answered.
struct Identity {
  int baud = 0;
  std::string who;
  std::vector<std::uint16_t> stations; ///< those that are plugged in and active
  std::size_t model = 0;
  std::size_t record_bytes = full_bytes;
  std::int32_t distortion = 0; ///< the first record's
};

/// Returns the answer to ^V in text form, which begins with a `0` [V], or nothing.
std::optional<std::string> who_in(std::string_view heard) {
  if (!heard.starts_with('0') || heard.size() < min_who_bytes || heard.size() > max_who_bytes)
    return std::nullopt;
  const auto is_text = [](char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\n'; };
  const auto others = std::count_if(heard.begin(), heard.end(), std::not_fn(is_text));
  if (others > 4) return std::nullopt; // the header repeats the command
  std::string who;
  for (const std::string_view word : fields_of(heard, 64))
    who += (who.empty() ? "" : " ") + printable(word);
  return who;
}

/// Returns the stations of the answer to stations_query, if there is one.
std::optional<std::vector<std::uint16_t>> stations_in(std::string_view heard) {
  std::vector<std::uint16_t> stations;
  for (std::size_t at = 0; at + header_bytes + 4 <= heard.size(); ++at) {
    const auto answer = heard.substr(at, header_bytes + 4);
    const bool is_model = std::any_of(models.begin(), models.end(), [&](const Model& model) {
      return answer[0] == model.letters[0] && answer[1] == model.letters[1];
    });
    if (!is_model || static_cast<std::uint8_t>(answer[3]) != stations_answer) continue;
    ByteReader maps(std::as_bytes(std::span(answer.substr(header_bytes))));
    const unsigned detected = maps.u16_le();
    const unsigned usable = detected & maps.u16_le();
    for (std::uint16_t station = 1; station <= max_stations; ++station)
      if ((usable >> (station - 1U) & 1U) != 0) stations.push_back(station);
    return stations;
  }
  return std::nullopt;
}

class Conversation {
public:
  Conversation(Transport& transport, TextDialogue& dialogue, const std::string& source,
               const Options& options)
      : transport_(transport), dialogue_(dialogue), source_(source), options_(options) {}

  Result<Identity> identify(int first_baud) {
    greet(polhemus::bauds_to_try(options_, first_baud, bauds));
    if (dialogue_.is_gone()) return went_away(source_);
    if (identity_.who.empty()) return stranger();
    if (auto known = know_stations(); !known) return known.error();
    for (const std::string_view record : {full_records, short_records}) {
      identity_.record_bytes = record == full_records ? full_bytes : short_bytes;
      if (auto polled = poll(record); !polled) return polled.error();
      const auto why = too_slow();
      if (!why) return identity_;
      if (record == short_records) return Error{Errc::no_device, source_ + ": " + *why};
    }
    return identity_;
  }

private:
  void command(std::string_view text) { polhemus::send_slowly(dialogue_, text); }

  void greet(const std::vector<int>& order) {
    for (int tries = 0; tries < 2; ++tries) {
      for (const int baud : order) {
        if (!transport_.set_baud(baud) && baud != order.front()) break;
        dialogue_.forget();
        dialogue_.send("\r"); // it may wait for the rest of a command
        dialogue_.send(poll_command);
        const bool is_quiet = dialogue_.fall_quiet(quiet_time, max_drain);
        if (dialogue_.is_over()) return;
        if (!is_quiet) continue; // a tracker would be
        command(text_command);
        dialogue_.forget();
        dialogue_.send(who_query);
        if (dialogue_.hear(answer_time, [](const std::string&) { return true; })) hear_to_end();
        if (auto who = who_in(dialogue_.heard())) {
          identity_.who = *std::move(who);
          identity_.baud = baud;
          return;
        }
        if (dialogue_.is_over()) return;
      }
    }
  }
  void hear_to_end() {
    while (dialogue_.heard().size() <= max_who_bytes &&
           dialogue_.hear(end_of_answer, [](const std::string&) { return true; })) {
    }
  }

  Result<void> know_stations() {
    command(binary_command);
    dialogue_.forget();
    std::optional<std::vector<std::uint16_t>> stations;
    const auto is_answered = [&](const std::string& heard) {
      stations = stations_in(heard);
      return stations.has_value();
    };
    if (!dialogue_.ask(stations_query, answer_time, is_answered))
      return Error{Errc::no_device, source_ + ": the tracker does not answer which stations it has "
                                              "(^U); switch it off and on"};
    identity_.stations = *std::move(stations);
    for (const std::uint16_t station : options_.stations) {
      const auto& there = identity_.stations;
      if (std::find(there.begin(), there.end(), station) != there.end()) continue;
      return polhemus::not_plugged_in(source_, station, polhemus::listed(there));
    }
    return {};
  }

  /// Sets the tracker up, and asks for a record of each station.
  Result<void> poll(std::string_view records) {
    command(centimetres_command);
    command("H*" + polhemus::hemisphere_parameters(options_.hemisphere) + "\r");
    for (const std::string_view filter : options_.is_filtered ? filters_on : filters_off)
      command(filter);
    command(records);
    dialogue_.forget();
    std::optional<Record> first;
    const auto is_answered = [&](const std::string& heard) {
      Parser parser;
      parser.reset(identity_.record_bytes);
      parser.push(std::as_bytes(std::span(heard)), [&](const Record& record) { first = record; });
      return parser.counters().records >= identity_.stations.size();
    };
    if (!dialogue_.ask(poll_command, answer_time, is_answered))
      return Error{Errc::no_device, source_ +
                                        ": the tracker answers, but does not send the records "
                                        "that it is asked for; switch it off and on"};
    identity_.model = first->model;
    identity_.distortion = first->distortion;
    return {};
  }

  std::optional<std::string> too_slow() const {
    const double rate_hz =
        models[identity_.model].rate_hz * static_cast<double>(identity_.stations.size());
    auto why = polhemus::too_slow(identity_.baud, identity_.record_bytes, rate_hz);
    if (why) *why += "; set its line to 115200 baud, and unplug receivers that are not needed";
    return why;
  }
  Error stranger() const {
    const bool is_silent = dialogue_.bytes_received() == 0;
    return {Errc::no_device,
            source_ +
                (is_silent ? ": nothing comes from it"
                           : ": what is there is no LIBERTY or PATRIOT, or busy") +
                "; is the tracker switched on, is this its port, and is its baud rate one of " +
                polhemus::listed(polhemus::bauds_to_try(options_, bauds.front(), bauds)) + "?"};
  }

  Transport& transport_;
  TextDialogue& dialogue_;
  const std::string& source_;
  const Options& options_;
  Identity identity_;
};

class LibertyProtocol final : public TrackerProtocol {
public:
  explicit LibertyProtocol(Options options)
      : options_(std::move(options)), baud_(options_.baud.value_or(bauds.front())) {}

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    const auto identity = Conversation(transport, dialogue, source, options_).identify(baud_);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) return identity.error();
    baud_ = identity->baud;
    record_bytes_ = identity->record_bytes;
    source_ = source;
    return describe(*identity);
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    dialogue.send(binary_command);
    dialogue.send(zero_clock_command);
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset(record_bytes_);
    clock_.reset();
    frames_.fill(std::nullopt);
    times_ = LineTimes(baud_, record_bytes_, 0.0);
    dialogue.send(stream_command);
    return dialogue.is_gone() ? Result<void>(went_away(source)) : Result<void>();
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    TextDialogue dialogue(transport, limit);
    dialogue.send(poll_command);
    dialogue.fall_quiet(quiet_time, max_drain);
    dialogue.send(text_command);
    parser_.count_discarded(dialogue.bytes_received());
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const std::uint64_t end = parser_.counters().bytes + chunk.size();
    const auto take = [&](const Record& record) {
      count_frame(record);
      PoseSample sample;
      sample.station = record.station;
      sample.position_m = record.position_m;
      sample.turn_xyzw = record.turn_xyzw;
      sample.error = error_of(record);
      sample.has_device_time = true;
      sample.device_time = std::chrono::milliseconds(record.time_ms);
      sample.measured = clock_.to_host(
          sample.device_time, times_.record_begin(arrival, end - parser_.counters().bytes));
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }
  bool counts_missed() const noexcept override { return true; }

private:
  TrackerInfo describe(const Identity& identity) const {
    const Model& model = models[identity.model];
    TrackerInfo info;
    info.model = "Polhemus " + std::string(model.name);
    info.stations = options_.stations;
    info.rate_hz = model.rate_hz * static_cast<double>(identity.stations.size());
    info.stage_from_tracker_xyzw = stage_from_z_down_xyzw;
    info.is_filtered = options_.is_filtered;
    info.facts = {{"identification", identity.who},
                  {"stations_plugged_in", polhemus::listed(identity.stations)},
                  {"baud", std::to_string(identity.baud)},
                  {"filter", options_.is_filtered ? "on" : "off"}};
    if (identity.record_bytes == full_bytes)
      info.facts.push_back({"distortion_raw", std::to_string(identity.distortion)});
    return info;
  }

  /// All stations of a frame have its number. One that is far off is that of a new count.
  void count_frame(const Record& record) noexcept {
    constexpr std::uint32_t max_missed = 10'000;
    auto& last = frames_[record.station];
    const std::uint32_t step = last ? record.frame - *last : 1;
    if (step > 1 && step <= max_missed) parser_.count_missed(step - 1);
    last = record.frame;
  }

  /// Reports each error of a station once, until it has another one.
  char error_of(const Record& record) noexcept {
    const bool is_letter = record.error > ' ' && record.error <= '~';
    const char error = is_letter ? record.error : record.distortion != 0 ? distorted : ' ';
    if (error == std::exchange(errors_[record.station], error)) return error;
    if (error == distorted)
      spdlog::warn(
          "device: {}: station {} reports distortion ({}): metal, or another field, is near",
          source_, record.station, record.distortion);
    else if (error != ' ')
      spdlog::warn("device: {}: station {} reports the error {}", source_, record.station, error);
    return error;
  }

  static std::array<char, max_stations + 1> no_errors() noexcept {
    std::array<char, max_stations + 1> blanks{};
    blanks.fill(' ');
    return blanks;
  }

  const Options options_;
  std::string source_;
  int baud_; ///< the one that was answered, or the first to try
  std::size_t record_bytes_ = full_bytes;
  Parser parser_;
  LineTimes times_;
  DeviceClock clock_;
  std::array<std::optional<std::uint32_t>, max_stations + 1> frames_; ///< the last ones
  std::array<char, max_stations + 1> errors_ = no_errors();
};

} // namespace

Result<std::unique_ptr<Tracker>> open_liberty(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations) {
  auto options = polhemus::options_of(spec, stations, {115'200, 57'600, 38'400, 19'200, 9'600});
  if (!options) return options.error();
  const int baud = options->baud.value_or(bauds.front());
  return open_stream_tracker(spec.text, follow_port(spec.target, baud),
                             std::make_unique<LibertyProtocol>(*std::move(options)),
                             HostClock::now() + open_budget);
}

} // namespace nendo::driver::liberty
