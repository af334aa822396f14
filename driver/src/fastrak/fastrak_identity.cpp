#include "fastrak/fastrak_identity.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "polhemus/polhemus_greeting.hpp"

namespace nendo::driver::fastrak {
namespace {

using namespace std::chrono_literals;
using polhemus::not_plugged_in;
using polhemus::send_slowly;
using polhemus::station_command;

constexpr auto setup_time = 400ms;

class Setup {
public:
  Setup(TextDialogue& dialogue, const std::string& source, const Options& options,
        Identity& identity)
      : dialogue_(dialogue), source_(source), options_(options), identity_(identity) {}

  /// Switches the wanted stations on and the others off, which leaves more records to the wanted
  /// ones. They are switched on first, because the last one cannot be switched off [V].
  Result<void> choose_stations() {
    const std::uint16_t last = identity_.status.is_intersense ? max_stations : fastrak_stations;
    for (const std::uint16_t station : options_.stations)
      if (station > last) return no_such_station(station, last);
    for (std::uint16_t station = 1; station <= fastrak_stations; ++station)
      command(station_command('l', station, ",1\r")); // an earlier program's choice
    for (const std::uint16_t station : options_.stations)
      if (station > fastrak_stations) command(station_command('l', station, ",1\r"));
    dialogue_.forget();
    const auto is_answered = [](const std::string& heard) { return bool(find_stations(heard)); };
    dialogue_.ask(stations_query, setup_time, is_answered);
    const auto digits = find_stations(dialogue_.heard());
    if (!digits) return unanswered("l");
    return choose_stations(std::string(*digits));
  }

  /// Sets what the records contain, the units and the filters.
  Result<void> configure() {
    dialogue_.forget();
    for (const std::uint16_t station : options_.stations) {
      command(station_command('O', station, record_items));
      command(station_command('I', station, ",0\r")); // records also while it is at rest [M 53]
      command(station_command('H', station,
                              polhemus::hemisphere_parameters(options_.hemisphere) + "\r"));
    }
    command(polhemus::centimetres_command);
    command(no_stylus_command);
    for (const std::string_view filter :
         options_.is_filtered ? polhemus::filters_on : polhemus::filters_off)
      command(filter);
    const auto is_answered = [](const std::string& heard) { return bool(find_status(heard)); };
    dialogue_.ask(polhemus::status_command, setup_time, is_answered);
    const auto status = find_status(dialogue_.heard());
    if (!status) return unanswered("S");
    if (!status->is_metric())
      return Error{Errc::no_device, source_ + ": the tracker refuses centimetres (u)"};
    identity_.refusals = find_refusals(dialogue_.heard());
    const bool has_records = identity_.refusals.find('O') == std::string::npos;
    if (has_records) return {};
    return Error{Errc::no_device,
                 source_ + ": the tracker refuses the form of its records: " + identity_.refusals};
  }

private:
  void command(std::string_view text) { send_slowly(dialogue_, text); }
  Result<void> choose_stations(const std::string& digits) {
    std::string& plugged_in = identity_.plugged_in;
    const auto last =
        static_cast<std::uint16_t>(std::min<std::size_t>(digits.size(), max_stations));
    const auto is_on = [&](std::uint16_t station) {
      return station <= digits.size() && digits[station - 1U] == '1';
    };
    for (std::uint16_t station = 1; station <= last; ++station)
      if (is_on(station)) plugged_in += (plugged_in.empty() ? "" : ", ") + std::to_string(station);
    for (const std::uint16_t station : options_.stations)
      if (!is_on(station)) return not_plugged_in(source_, station, plugged_in);
    const auto& wanted = options_.stations;
    for (std::uint16_t station = 1; station <= last; ++station)
      if (is_on(station) && std::find(wanted.begin(), wanted.end(), station) == wanted.end())
        command(station_command('l', station, ",0\r"));
    return {};
  }
  Error no_such_station(std::uint16_t station, std::uint16_t last) const {
    return {Errc::usage, source_ + ": there is no station " + std::to_string(station) +
                             "; stations are 1 to " + std::to_string(last)};
  }
  Error unanswered(std::string_view query) const {
    if (dialogue_.is_gone()) return went_away(source_);
    return {Errc::no_device, source_ + ": the tracker answered S, but later not " +
                                 std::string(query) + "; switch it off and on"};
  }

  TextDialogue& dialogue_;
  const std::string& source_;
  const Options& options_;
  Identity& identity_;
};

} // namespace

std::optional<std::string> too_slow(int baud) {
  auto why = polhemus::too_slow(baud, record_bytes, records_per_second);
  if (why) *why += "; set the tracker's switches to 115200 or 57600, then switch it off and on";
  return why;
}

Result<Identity> identify(Transport& transport, TextDialogue& dialogue, const std::string& source,
                          const Options& options, int first_baud) {
  const std::uint64_t before = dialogue.bytes_received();
  const auto order = polhemus::bauds_to_try(options, first_baud, bauds);
  std::optional<Status> status;
  const auto baud = polhemus::greet(transport, dialogue, order, [&](const std::string& heard) {
    status = find_status(heard);
    return status.has_value();
  });
  if (dialogue.is_gone()) return went_away(source);
  if (!baud)
    return polhemus::stranger(source, "FASTRAK", order, dialogue.bytes_received() == before);
  Identity identity;
  identity.baud = *baud;
  identity.status = *std::move(status);
  if (const auto why = too_slow(identity.baud)) return Error{Errc::no_device, source + ": " + *why};
  Setup setup(dialogue, source, options, identity);
  if (auto chosen = setup.choose_stations(); !chosen) return chosen.error();
  if (auto configured = setup.configure(); !configured) return configured.error();
  return identity;
}

} // namespace nendo::driver::fastrak
