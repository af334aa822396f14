#include "cyberglove/cyberglove_facts.hpp"

#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "cyberglove/cyberglove_line.hpp"

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

/// Longer than a Bluetooth link or an adapter's latency timer delays a reply.
constexpr auto optional_answer = 250ms;
/// Of a unit that is late with each answer, not all can be asked.
constexpr auto longest_interview = 2s;
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

std::string on_off(bool on) {
  return on ? "on" : "off";
}

/// Asks, until two questions were met with silence or nonsense, or it has taken too long.
class Inquiry {
public:
  template <class Ask>
  auto operator()(Ask&& ask) -> decltype(ask()) {
    constexpr int patience = 2;
    if (unanswered_ >= patience || HostClock::now() >= until_) return {};
    auto reply = ask();
    if (!reply && reply.answer != Answer::unknown) ++unanswered_;
    return reply;
  }

private:
  const HostTime until_ = HostClock::now() + longest_interview;
  int unanswered_ = 0;
};

class Interview {
public:
  Interview(Dialogue& dialogue, Identity& identity)
      : commands_(dialogue, optional_answer), identity_(identity) {}

  void ask_texts();
  void ask_settings();
  void ask_rest();

private:
  void add(const char* name, std::string value) {
    if (!value.empty()) identity_.facts.push_back({name, std::move(value)});
  }
  void add_settings(const Parameters& parameters);
  void ask_setting(const char* name, Setting setting);
  void ask_calibration();

  Commands commands_;
  Identity& identity_;
  Inquiry inquire_;
};

void Interview::ask_texts() {
  const auto information = inquire_([this] { return commands_.information(); });
  if (information) {
    identity_.model = model_line(information.value);
    add("information", one_line(information.value));
  }
  identity_.model += ", " + std::to_string(identity_.channels.count) + " sensors";
  if (const auto text = inquire_([this] { return commands_.firmware_text(); })) {
    add("firmware", one_line(text.value));
  } else if (const auto bytes = inquire_([this] { return commands_.firmware(); })) {
    // What the four bytes mean, nobody tells.
    const auto& [a, b, c, d] = bytes.value;
    add("firmware", fmt::format("{}.{}.{}.{}", a, b, c, d));
  }
}

void Interview::add_settings(const Parameters& parameters) {
  add("filter", on_off(parameters.filter));
  add("time_stamp", on_off(parameters.time_stamp));
  add("status_byte", on_off(parameters.status_byte));
  add("switch_drives_light", on_off(parameters.switch_drives_light));
  add("quantised", on_off(parameters.quantised));
  add("wrist_switch", on_off(parameters.wrist_switch));
  add("light", on_off(parameters.light));
  add("cybertouch", parameters.cybertouch ? "yes" : "no");
  identity_.switch_drives_light = parameters.switch_drives_light;
  identity_.abilities.light = true;
  identity_.abilities.vibration = parameters.cybertouch;
}

void Interview::ask_setting(const char* name, Setting setting) {
  const auto reply = inquire_([&] { return commands_.get(setting); });
  if (!reply) return;
  add(name, on_off(reply.value));
  if (setting == Setting::light) identity_.abilities.light = true;
  if (setting == Setting::switch_drives_light) identity_.switch_drives_light = reply.value;
}

void Interview::ask_settings() {
  identity_.abilities.wrist_switch = identity_.shape.status;
  if (const auto parameters = inquire_([this] { return commands_.parameters(); })) {
    add_settings(parameters.value);
    return;
  }
  ask_setting("filter", Setting::filter);
  ask_setting("time_stamp", Setting::time_stamp);
  ask_setting("status_byte", Setting::status_byte);
  ask_setting("switch_drives_light", Setting::switch_drives_light);
  ask_setting("quantised", Setting::quantised);
  ask_setting("wrist_switch", Setting::wrist_switch);
  ask_setting("light", Setting::light);
}

void Interview::ask_calibration() {
  const auto reply = inquire_([this] { return commands_.hardware_calibration(identity_.sensors); });
  if (!reply) return;
  std::string offsets = "offsets";
  std::string gains = "gains";
  for (std::size_t k = 0; k < reply.value.sensors; ++k) {
    offsets += " " + std::to_string(reply.value.offset[k]);
    gains += " " + std::to_string(reply.value.gain[k]);
  }
  add("hardware_calibration", offsets + ", " + gains);
}

void Interview::ask_rest() {
  if (identity_.abilities.vibration) {
    if (const auto reply = inquire_([this] { return commands_.vibration(); })) {
      std::string strengths;
      for (const unsigned value : reply.value)
        strengths += (strengths.empty() ? "" : " ") + std::to_string(value);
      add("vibration", strengths);
    }
  }
  if (const auto reply = inquire_([this] { return commands_.baud_register(); })) {
    const auto baud = baud_of_register(reply.value);
    add("baud_register", baud ? fmt::format("0x{:02X} ({} baud)", reply.value, *baud)
                              : fmt::format("0x{:02X}", reply.value));
  }
  ask_calibration(); // last: how many values the reply has, is the least certain
}

} // namespace

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

void ask_facts(Dialogue& dialogue, const Request& request, Identity& identity) {
  const std::size_t bytes = identity.hires ? third_record_bytes : identity.shape.bytes();
  identity.facts.push_back({"baud", std::to_string(request.baud)});
  identity.facts.push_back({"record_bytes", std::to_string(bytes)});
  identity.facts.push_back(
      {"line_limit_hz", fmt::format("{:.1f}", line_limit_hz(request.baud, bytes))});
  Interview interview(dialogue, identity);
  interview.ask_texts();
  interview.ask_settings();
  interview.ask_rest();
}

} // namespace nendo::driver::cyberglove
