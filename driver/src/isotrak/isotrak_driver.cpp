#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/base/text.hpp>

#include "drivers.hpp"
#include "fastrak/fastrak_protocol.hpp"
#include "isotrak/isotrak_parser.hpp"
#include "isotrak/isotrak_protocol.hpp"
#include "polhemus/pose_stream.hpp"
#include "stream/stream_tracker.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::isotrak {
namespace {

using namespace std::chrono_literals;
using polhemus::Options;
using polhemus::send_slowly;
using polhemus::station_command;

// A cycle of two stations is 33 ms, and their records take 21 ms at 19200 baud.
constexpr auto poll_time = 250ms;
constexpr auto other_record_time = 60ms;

/// What the tracker answered.
struct Identity {
  int baud = 0;
  std::string status;
  std::vector<std::uint16_t> stations; ///< those that send records
  std::string refusals;                ///< commands that it does not have
};

/// Finds a status anywhere in what was heard.
std::optional<std::string> find_status(std::string_view heard) {
  constexpr std::string_view line_end = "\r\n";
  for (std::size_t at = 0; (at = heard.find('2', at)) != std::string_view::npos; ++at) {
    const std::size_t end = heard.find(line_end, at);
    if (end == std::string_view::npos) break;
    const std::size_t size = end + line_end.size() - at;
    if (size >= min_status_bytes && size <= max_status_bytes && heard[at + 2] == 'S')
      return printable(trimmed(heard.substr(at, end - at)));
  }
  return std::nullopt;
}

bool has(const std::vector<std::uint16_t>& stations, std::uint16_t station) {
  return std::find(stations.begin(), stations.end(), station) != stations.end();
}

std::vector<std::uint16_t> stations_in(const std::string& heard) {
  std::vector<std::uint16_t> stations;
  Parser parser;
  parser.push(std::as_bytes(std::span(heard)), [&](const Record& record) {
    if (!has(stations, record.station)) stations.push_back(record.station);
  });
  std::sort(stations.begin(), stations.end());
  return stations;
}

std::optional<std::string> too_slow(int baud) {
  auto why = polhemus::too_slow(baud, record_bytes, records_per_second);
  if (why) *why += "; set the tracker's line to 19200 baud or more";
  return why;
}

class Conversation {
public:
  Conversation(TextDialogue& dialogue, const std::string& source, const Options& options)
      : dialogue_(dialogue), source_(source), options_(options) {}

  Result<Identity> identify(Transport& transport, int first_baud) {
    const auto order = polhemus::bauds_to_try(options_, first_baud, bauds);
    const auto baud = polhemus::greet(transport, dialogue_, order, [&](const std::string& heard) {
      const auto status = find_status(heard);
      if (status) identity_.status = *status;
      return status.has_value();
    });
    if (dialogue_.is_gone()) return went_away(source_);
    if (!baud)
      return polhemus::stranger(source_, "ISOTRAK II", order, dialogue_.bytes_received() == 0);
    identity_.baud = *baud;
    if (const auto why = too_slow(*baud)) return Error{Errc::no_device, source_ + ": " + *why};
    set_up();
    if (auto chosen = choose_stations(); !chosen) return chosen.error();
    return identity_;
  }

private:
  void set_up() {
    dialogue_.forget();
    send_slowly(dialogue_, record_items);
    for (std::uint16_t station = 1; station <= max_stations; ++station)
      send_slowly(dialogue_, station_command('l', station, ",1\r")); // an earlier program's choice
    for (const std::uint16_t station : options_.stations) {
      // Another program's frame and boresight would turn all poses.
      send_slowly(dialogue_, station_command('R', station, "\r"));
      send_slowly(dialogue_, station_command('b', station, "\r"));
      send_slowly(dialogue_,
                  station_command('H', station,
                                  polhemus::hemisphere_parameters(options_.hemisphere) + "\r"));
    }
    for (const std::string_view filter :
         options_.is_filtered ? polhemus::filters_on : polhemus::filters_off)
      send_slowly(dialogue_, filter);
    send_slowly(dialogue_, polhemus::centimetres_command);
    identity_.refusals = fastrak::find_refusals(dialogue_.heard());
  }

  /// Takes a record of each station, and switches off those that are not wanted.
  Result<void> choose_stations() {
    const auto& wanted = options_.stations;
    auto& there = identity_.stations;
    const auto are_wanted_there = [&](const std::string& heard) {
      there = stations_in(heard);
      return std::all_of(wanted.begin(), wanted.end(),
                         [&](std::uint16_t station) { return has(there, station); });
    };
    send_slowly(dialogue_, polhemus::binary_command);
    dialogue_.forget();
    dialogue_.ask(poll_command, poll_time, are_wanted_there);
    dialogue_.hear(other_record_time);
    there = stations_in(dialogue_.heard());
    if (dialogue_.is_gone()) return went_away(source_);
    if (there.empty())
      return Error{Errc::no_device, source_ +
                                        ": the tracker answers, but does not send the records that "
                                        "it is asked for; is a receiver plugged in? If so, switch "
                                        "the tracker off and on"};
    for (const std::uint16_t station : wanted)
      if (!has(there, station))
        return polhemus::not_plugged_in(source_, station, polhemus::listed(there));
    for (const std::uint16_t station : there)
      if (!has(wanted, station)) send_slowly(dialogue_, station_command('l', station, ",0\r"));
    return {};
  }

  TextDialogue& dialogue_;
  const std::string& source_;
  const Options& options_;
  Identity identity_;
};

class IsotrakProtocol final : public polhemus::PoseStream<Parser> {
public:
  explicit IsotrakProtocol(Options options)
      : PoseStream(std::move(options), bauds.front(), {record_bytes, records_per_second}) {}

  Result<TrackerInfo> identify(Transport& transport, const std::string& source,
                               IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    const auto identity = Conversation(dialogue, source, options_).identify(transport, baud_);
    parser_.count_discarded(dialogue.bytes_received());
    if (!identity) return identity.error();
    baud_ = identity->baud;
    source_ = source;
    return describe(*identity);
  }

private:
  std::string_view meaning_of(char /*letter*/) const noexcept override {
    return "see the tracker's manual";
  }
  TrackerInfo describe(const Identity& identity) const {
    TrackerInfo info;
    info.model = "Polhemus ISOTRAK II";
    info.stations = options_.stations;
    info.rate_hz = records_per_second;
    info.stage_from_tracker_xyzw = stage_from_z_down_xyzw; // as FASTRAK's [?]
    info.is_filtered = options_.is_filtered;
    info.facts = {{"status", identity.status},
                  {"stations_plugged_in", polhemus::listed(identity.stations)},
                  {"baud", std::to_string(identity.baud)},
                  {"filter", options_.is_filtered ? "on" : "off"}};
    if (!identity.refusals.empty()) info.facts.push_back({"refused_commands", identity.refusals});
    return info;
  }
};

} // namespace

Result<std::unique_ptr<Tracker>> open_isotrak(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations) {
  auto options = polhemus::options_of(spec, stations, {115'200, 57'600, 38'400, 19'200, 9'600});
  if (!options) return options.error();
  if (*std::max_element(stations.begin(), stations.end()) > max_stations)
    return Error{Errc::usage, spec.text + ": option station must be 1 or 2"};
  if (const auto why = options->baud ? too_slow(*options->baud) : std::nullopt)
    return Error{Errc::usage, spec.text + ": " + *why};
  const int baud = options->baud.value_or(bauds.front());
  return open_stream_tracker(spec.text, follow_port(spec.target, baud),
                             std::make_unique<IsotrakProtocol>(*std::move(options)),
                             HostClock::now() + open_budget);
}

} // namespace nendo::driver::isotrak
