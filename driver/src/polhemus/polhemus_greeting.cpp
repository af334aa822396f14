#include "polhemus/polhemus_greeting.hpp"

#include <chrono>

#include "polhemus/polhemus_options.hpp"

namespace nendo::driver::polhemus {
namespace {

using namespace std::chrono_literals;

constexpr auto quiet_time = 60ms; ///< longer than a record of text at 9600 baud, 49 ms
constexpr auto max_drain = 250ms;
constexpr auto answer_time = 250ms; ///< FASTRAK's 55 bytes take 57 ms at 9600 baud
constexpr auto single_answer_time = 1000ms;
constexpr auto pace = 10ms;

} // namespace

std::string station_command(char letter, std::uint16_t station, std::string_view parameters) {
  return std::string{letter, "0123456789ABC"[station]}.append(parameters);
}

void send_slowly(TextDialogue& dialogue, std::string_view command) {
  dialogue.send(command);
  dialogue.hear(pace);
}

std::optional<int> greet(Transport& transport, TextDialogue& dialogue,
                         const std::vector<int>& bauds,
                         const std::function<bool(const std::string&)>& is_status) {
  for (const std::string& begin : {std::string(stop_command), "\r" + std::string(stop_command)}) {
    for (const int baud : bauds) {
      if (!transport.set_baud(baud) && baud != bauds.front()) break;
      dialogue.forget();
      dialogue.send(begin);
      dialogue.fall_quiet(quiet_time, max_drain);
      dialogue.send(status_command);
      if (dialogue.hear(bauds.size() == 1 ? single_answer_time : answer_time, is_status))
        return baud;
      if (dialogue.is_over()) return std::nullopt;
    }
  }
  return std::nullopt;
}

Error stranger(const std::string& source, const std::string& name, const std::vector<int>& bauds,
               bool is_silent) {
  return {
      Errc::no_device,
      source +
          (is_silent ? ": nothing comes from it" : ": what is there is no " + name + ", or busy") +
          "; is the tracker switched on, is this its port, and is its line set to 8 bits and a "
          "baud rate of " +
          listed(bauds) +
          "? If so, restart it: switch it off and on, or send it ^Y, and wait 10 s"};
}

Error not_plugged_in(const std::string& source, std::uint16_t station, const std::string& others) {
  return {Errc::no_device, source + ": no receiver is plugged in at station " +
                               std::to_string(station) +
                               (others.empty() ? "; no station is" : "; plugged in: " + others)};
}

} // namespace nendo::driver::polhemus
