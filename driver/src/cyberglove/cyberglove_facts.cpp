#include "cyberglove/cyberglove_identity.hpp"

#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

/// Longer than a Bluetooth link or an adapter's latency timer delays a reply.
constexpr auto optional_answer = 250ms;
/// A unit that is late with each answer receives only some of the queries.
constexpr auto max_interview = 2s;
constexpr std::size_t max_fact_characters = 200;

/// Printable characters only; the end of a line becomes a slash, blanks become one.
std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    if (line.size() >= max_fact_characters) break;
    const bool printable = c > 0x20 && c < 0x7F;
    if (printable) line.push_back(c);
    if (c == ' ' && !line.empty() && line.back() != ' ') line.push_back(' ');
    if (c == '\n' && !line.empty() && !line.ends_with("/ ")) {
      line += line.back() == ' ' ? "/ " : " / ";
    }
  }
  line.erase(line.find_last_not_of(" /") + 1);
  return line;
}

/// Asks until two queries got silence or nonsense, or the time is over.
class Inquiry {
public:
  template <class Ask>
  auto operator()(Ask&& ask) -> decltype(ask()) {
    constexpr int max_unanswered = 2;
    if (unanswered_ >= max_unanswered || HostClock::now() >= until_) return {};
    auto reply = ask();
    if (!reply && reply.answer != Answer::unknown) ++unanswered_;
    return reply;
  }

private:
  const HostTime until_ = HostClock::now() + max_interview;
  int unanswered_ = 0;
};

/// The first line that is not empty, without characters that could disturb a terminal.
std::string model_line(std::string_view text) {
  constexpr std::size_t max_characters = 60;
  std::string line;
  for (const char c : text) {
    const bool printable = c >= 0x20 && c < 0x7F;
    if (c == '\n' && !line.empty()) break;
    if (printable && (c != ' ' || !line.empty())) line.push_back(c);
    if (line.size() == max_characters) break;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line.empty() ? "CyberGlove" : line;
}

class Interview {
public:
  Interview(Dialogue& dialogue, Identity& identity)
      : commands_(dialogue, optional_answer), identity_(identity) {}

  void ask_descriptions() {
    const auto information = inquire_([this] { return commands_.information(); });
    if (information) {
      identity_.model = model_line(information.value);
      add("information", one_line(information.value));
    }
    identity_.model += ", " + std::to_string(identity_.channels.count) + " sensors";
    if (const auto text = inquire_([this] { return commands_.firmware_text(); })) {
      add("firmware", one_line(text.value));
    } else if (const auto bytes = inquire_([this] { return commands_.ask(ask_firmware); })) {
      // No source says what the four bytes mean.
      const auto& [a, b, c, d] = bytes.value;
      add("firmware", fmt::format("{}.{}.{}.{}", a, b, c, d));
    }
  }

  /// All at once by ?P, or one by one.
  void ask_settings() {
    struct Known {
      const char* name;
      Setting setting;
      unsigned flag;
    };
    constexpr std::array settings{
        Known{"filter", Setting::filter, flag_filter},
        Known{"time_stamp", Setting::time_stamp, flag_time_stamp},
        Known{"status_byte", Setting::status_byte, flag_status_byte},
        Known{"switch_drives_light", Setting::switch_drives_light, flag_switch_drives_light},
        Known{"quantised", Setting::quantised, flag_quantised},
        Known{"wrist_switch", Setting::wrist_switch, flag_wrist_switch},
        Known{"light", Setting::light, flag_light},
    };
    Abilities& abilities = identity_.abilities;
    abilities.wrist_switch = identity_.shape.status;
    const auto flags = inquire_([this] { return commands_.ask(ask_parameters); });
    const auto flag = [&](unsigned bit) { return (flags.value >> bit & 1U) != 0; };
    for (const Known& known : settings) {
      const Reply<bool> reply = flags ? Reply<bool>{Answer::good, flag(known.flag)}
                                      : inquire_([&] { return commands_.get(known.setting); });
      if (!reply) continue;
      add(known.name, reply.value ? "on" : "off");
      if (known.setting == Setting::light) abilities.light = true;
      if (known.setting == Setting::switch_drives_light)
        identity_.switch_drives_light = reply.value;
    }
    if (!flags) return;
    abilities.vibration = flag(flag_cybertouch);
    add("cybertouch", abilities.vibration ? "yes" : "no");
  }

  void ask_vibration() {
    if (!identity_.abilities.vibration) return;
    if (const auto reply = inquire_([this] { return commands_.ask(cyberglove::ask_vibration); }))
      add("vibration", fmt::format("{}", fmt::join(reply.value, " ")));
  }

  void ask_baud_register() {
    const auto reply = inquire_([this] { return commands_.ask(ask_baud); });
    if (!reply) return;
    const auto baud = baud_of_register(reply.value);
    add("baud_register", baud ? fmt::format("0x{:02X} ({} baud)", reply.value, *baud)
                              : fmt::format("0x{:02X}", reply.value));
  }

  void ask_calibration() {
    const auto reply =
        inquire_([this] { return commands_.hardware_calibration(identity_.sensors); });
    if (!reply) return;
    const auto& [sensors, offsets, gains] = reply.value;
    add("hardware_calibration",
        fmt::format("offsets {}, gains {}", fmt::join(std::span(offsets).first(sensors), " "),
                    fmt::join(std::span(gains).first(sensors), " ")));
  }

private:
  void add(const char* name, std::string value) {
    if (!value.empty()) identity_.facts.push_back({name, std::move(value)});
  }

  Commands commands_;
  Identity& identity_;
  Inquiry inquire_;
};

} // namespace

void ask_facts(Dialogue& dialogue, const Request& request, Identity& identity) {
  const std::size_t bytes = identity.shape.bytes();
  identity.facts.push_back({"baud", std::to_string(request.baud)});
  identity.facts.push_back({"record_bytes", std::to_string(bytes)});
  identity.facts.push_back(
      {"line_limit_hz", fmt::format("{:.1f}", line_limit_hz(request.baud, bytes))});
  Interview interview(dialogue, identity);
  interview.ask_descriptions();
  interview.ask_settings();
  interview.ask_vibration();
  interview.ask_baud_register();
  interview.ask_calibration(); // last: the size of its reply is the least certain
}

} // namespace nendo::driver::cyberglove
