#include "cyberglove/cyberglove_identity.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto first_answer =
    1000ms; ///< what the drivers with the manual at hand allow for a command
constexpr auto next_answer = 400ms;
constexpr int tries = 2;

Error no_device(const std::string& source, const std::string& what) {
  return {Errc::no_device, source + ": " + what};
}

Error bad_answer(const std::string& source, Answer answer, const std::string& question) {
  switch (answer) {
  case Answer::silent:
    return no_device(source,
                     "no answer to " + question +
                         "; is the glove's interface unit switched on, and is this its port?");
  case Answer::gone:
    return no_device(source, "the port went away at " + question + "; is the cable loose?");
  case Answer::no_glove:
    return no_device(source, "the interface unit answers, but no glove is plugged into it");
  default:
    return no_device(source, "what is there does not answer " + question +
                                 " like a CyberGlove; is this its port, and the baud rate right?");
  }
}

/// Tries again after anything that noise on the line explains.
Answer ask_again(Dialogue& dialogue, const Query& query, std::span<std::byte> data,
                 std::chrono::milliseconds timeout) {
  Answer answer = Answer::silent;
  for (int k = 0; k < tries; ++k) {
    answer = dialogue.ask(query, data, timeout);
    if (answer == Answer::good || answer == Answer::gone || answer == Answer::no_glove) break;
  }
  return answer;
}

std::string question(const Query& query) {
  return std::string("?") + query.letter;
}

/// The number that the unit answers; `otherwise` if it does not know the question.
Result<std::uint32_t> number(Dialogue& dialogue, const std::string& source, const Query& query,
                             std::optional<std::uint32_t> otherwise) {
  std::array<std::byte, 4> data{};
  const auto used = std::span(data).first(query.data_bytes);
  const Answer answer = ask_again(dialogue, query, used, next_answer);
  if (answer == Answer::unknown && otherwise) return *otherwise;
  if (answer != Answer::good) return bad_answer(source, answer, question(query));
  return ByteReader(data).u32_le();
}

/// True if the unit accepted the setting, false if it does not know it.
Result<bool> switch_on(Dialogue& dialogue, const std::string& source, char letter) {
  Answer answer = Answer::silent;
  for (int k = 0; k < tries && answer != Answer::good && answer != Answer::gone; ++k) {
    answer = dialogue.set(letter, true, next_answer);
  }
  if (answer == Answer::good) return true;
  if (answer == Answer::unknown || answer == Answer::bad_number) return false;
  return bad_answer(source, answer, std::string("the setting ") + letter);
}

Result<ChannelMap> ask_channels(Dialogue& dialogue, const std::string& source) {
  const auto count = number(dialogue, source, ask_sensor_count, std::nullopt);
  if (!count) return count.error();
  if (*count == 0 || *count > sensor_slots) {
    return no_device(source,
                     "says that it has " + std::to_string(*count) + " sensors; no CyberGlove has");
  }
  const std::uint32_t usual = (*count == 18 ? sensors_18 : sensors_22).bits;
  const auto hardware = number(dialogue, source, ask_hardware_mask, usual);
  if (!hardware) return hardware.error();
  const auto software = number(dialogue, source, ask_software_mask, 0xFFFFFFU);
  if (!software) return software.error();
  const auto values = number(dialogue, source, ask_value_count, sensor_slots);
  if (!values) return values.error();
  const ChannelMap map = make_channel_map({*hardware}, {*software}, *values);
  if (map.count == 0) {
    return no_device(source,
                     "all its sensors are masked off; switch its interface unit off and on");
  }
  return map;
}

/// The first line that has something to say, without what could disturb a terminal.
std::string model_line(const std::string& text) {
  constexpr std::size_t most_characters = 60;
  std::string line;
  for (const char c : text) {
    const bool printable = c >= 0x20 && c < 0x7F;
    if (c == '\n' && !line.empty()) break;
    if (printable && (c != ' ' || !line.empty())) line.push_back(c);
    if (line.size() == most_characters) break;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line.empty() ? "CyberGlove" : line;
}

double plausible_rate(unsigned count, unsigned times) {
  constexpr double most_hz = 1000.0;
  if (count == 0 || times == 0) return 0.0;
  const double rate_hz = clock_hz / (static_cast<double>(count) * times);
  return rate_hz <= most_hz ? rate_hz : 0.0;
}

/// What is good to know, but not needed to understand the records.
void ask_details(Dialogue& dialogue, Identity& identity) {
  std::array<std::byte, 4> words{};
  if (dialogue.ask(ask_period, words, next_answer) == Answer::good) {
    identity.rate_hz = rate_of_period(words);
  }
  std::string text;
  if (dialogue.ask_text(ask_information, text, first_answer) != Answer::good) text.clear();
  identity.model = model_line(text) + ", " + std::to_string(identity.channels.count) + " sensors";
}

} // namespace

double rate_of_period(std::span<const std::byte, 4> words) noexcept {
  const auto byte = [&](std::size_t k) { return std::to_integer<unsigned>(words[k]); };
  return std::max(plausible_rate(byte(0) | byte(1) << 8U, byte(2) | byte(3) << 8U),
                  plausible_rate(byte(1) | byte(0) << 8U, byte(3) | byte(2) << 8U));
}

Result<void> check_state(Dialogue& dialogue, const std::string& source) {
  std::array<std::byte, 1> data{};
  const Answer answer = ask_again(dialogue, ask_state, data, first_answer);
  if (answer != Answer::good) return bad_answer(source, answer, "?G within 2 s");
  const auto state = std::to_integer<unsigned>(data[0]);
  if ((state & state_connected) == 0) return bad_answer(source, Answer::no_glove, "?G");
  if ((state & state_initialised) == 0) {
    return no_device(source,
                     "the glove is plugged in but not ready; switch its interface unit off and on");
  }
  return {};
}

Result<Identity> identify(Dialogue& dialogue, const std::string& source) {
  // A babbling line is not yet a reason to give up: what is asked for may be among the babble.
  if (dialogue.stop_stream() == Answer::gone) return bad_answer(source, Answer::gone, "the start");
  if (auto state = check_state(dialogue, source); !state) return state.error();
  auto channels = ask_channels(dialogue, source);
  if (!channels) return channels.error();
  const auto right = number(dialogue, source, ask_right_hand, 1U);
  if (!right) return right.error();
  const auto time_stamp = switch_on(dialogue, source, set_time_stamp);
  if (!time_stamp) return time_stamp.error();
  const auto status = switch_on(dialogue, source, set_status);
  if (!status) return status.error();

  Identity identity;
  identity.side = *right == 0 ? Side::left : Side::right;
  identity.channels = *channels;
  identity.shape = {channels->count, *time_stamp, *status};
  ask_details(dialogue, identity);
  return identity;
}

} // namespace nendo::driver::cyberglove
