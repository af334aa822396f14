// How an emulated CyberGlove's interface unit makes commands of the bytes that it hears.

#include "units/cyberglove_unit.hpp"

#include <chrono>
#include <cstddef>
#include <string_view>

namespace nendo::emulator {

using namespace unit;

namespace {

using namespace std::chrono_literals;

// A choice of ours, sources are silent: a command that stays incomplete is forgotten, so that a
// host that died in its middle (or a modem probe: the T of "AT" takes four bytes) does not swallow
// the next host's first bytes.
constexpr auto max_command_time = 1s;

// The longest text form that makes sense, "ca" with two numbers a sensor, and some blanks.
constexpr std::size_t max_text = 255;

} // namespace

// While an external sync drives the records the unit still listens, or no host could switch it off:
// a choice of ours. In a stream it is deaf to all but 0x03.
void CyberGloveUnit::handle(Byte byte, Time now) {
  if (restart_ends_) return; // the firmware is not up yet
  const bool synced = to_upper(stream_.header) == 'Y';
  if (stream_.header != 0 && !synced) {
    if (byte == stop_byte) stop();
    return;
  }
  if (command_ != 0 && now - command_since_ > max_command_time) command_ = 0;
  if (command_ == 0) {
    begin(byte, now);
  } else if (command_ == '?') {
    command_ = 0;
    answer(byte);
  } else if (command_ == three_prefix) {
    collect_three(byte, now);
  } else if (is_lower(command_)) {
    collect_text(byte, now);
  } else {
    collect_binary(byte, now); // 0x03 included: it is a legal mask byte and a legal count
  }
}

// Programs that read 12-bit records of a CyberGlove III get one byte when they end the stream.
void CyberGloveUnit::stop() {
  const bool bare = stream_.header == three_prefix && !options_.hires_terminated;
  stream_ = {};
  settings_.binary_sync = settings_.text_sync = false;
  reply(bare ? Message{stop_byte} : Message{stop_byte, 0});
}

void CyberGloveUnit::begin(Byte letter, Time now) {
  const bool three = options_.model == 3;
  switch (letter) {
  case stop_byte:
    stop();
    return;
  case reread_byte:
    read_glove();
    reply({letter, 0});
    return;
  case restart_byte:
    begin_restart(true, now);
    return;
  case 'G':
  case 'g':
    poll(letter, now);
    return;
  case 'S':
  case 's':
    start_stream(letter, now);
    return;
  case ' ':
  case '\r':
  case '\n':
    return; // between text commands
  default:
    break;
  }
  if (letter == 0 && three) return; // one program ends its commands with NUL
  const bool known =
      letter == '?' || (letter == three_prefix && three) ||
      (to_upper(letter) == 'A' ? options_.touch : argument_bytes(to_upper(letter), {}, 0) != 0);
  if (!known) {
    reply({'e', '?', 0});
    return;
  }
  command_ = letter;
  command_since_ = now;
  argument_.clear();
}

void CyberGloveUnit::collect_binary(Byte byte, Time now) {
  argument_.push_back(byte);
  const auto wanted = argument_bytes(command_, argument_, known_.sensors());
  if (wanted && argument_.size() < *wanted) return;
  if (wanted) {
    set(command_, argument_, now);
  } else {
    reply({'e', 'n', 0});
  }
  command_ = 0;
}

void CyberGloveUnit::collect_text(Byte byte, Time now) {
  if (byte == stop_byte) {
    command_ = 0;
    reply({stop_byte, 0});
    return;
  }
  if (byte != '\r') {
    if (argument_.size() <= max_text) argument_.push_back(byte);
    return;
  }
  const Byte letter = to_upper(command_);
  std::string_view text(reinterpret_cast<const char*>(argument_.data()), argument_.size());
  Message argument;
  if (letter == 'C' && !text.empty()) { // ca, co, cg
    argument.push_back(to_upper(argument_[0]));
    text.remove_prefix(1);
  }
  const Message numbers =
      argument_.size() > max_text ? Message{} : read_numbers(text, number_width(letter));
  argument.insert(argument.end(), numbers.begin(), numbers.end());
  const auto wanted = argument_bytes(letter, argument, known_.sensors());
  // Text numbers are read high byte first, whatever the order of the binary form.
  if (!numbers.empty() && wanted == argument.size()) {
    set(command_, argument, now);
  } else {
    reply({'e', 'n', 0});
  }
  command_ = 0;
}

void CyberGloveUnit::collect_three(Byte byte, Time now) {
  argument_.push_back(byte);
  const auto wanted = three_bytes(argument_);
  if (wanted && argument_.size() < *wanted) return;
  command_ = 0;
  if (!wanted) {
    reply({'e', '?', 0});
  } else if (!unit::apply(three_, argument_)) {
    reply({'e', 'n', 0});
  } else {
    Message echo{three_prefix};
    echo.insert(echo.end(), argument_.begin(), argument_.end());
    // Programs that were written for the hardware read two bytes and then records.
    const bool starts = argument_[0] == 'S';
    if (!starts || options_.hires_terminated) echo.push_back(0);
    reply(echo);
    if (starts) start_three(now);
  }
}

void CyberGloveUnit::set(Byte letter, const Message& argument, Time now) {
  const bool text = is_lower(letter);
  const Settings before = settings_;
  if (!unit::apply(settings_, letter == 'y' ? letter : to_upper(letter), argument,
                   !text && options_.period_low_first, known_)) {
    reply({'e', 'n', 0});
    return;
  }
  if (!start_sync(now)) {
    settings_ = before;
    reply({'e', 'y', 0});
    return;
  }
  confirm(letter, argument);
}

// A text is answered by a line: a program that sets up a real unit in text waits for more than a
// letter and NUL, and does not continue before.
void CyberGloveUnit::confirm(Byte letter, const Message& argument) {
  const bool text = is_lower(letter);
  Message echo{letter};
  if (to_upper(letter) == 'C') { // has its second letter anyway
    echo.push_back(text ? to_lower(argument[0]) : argument[0]);
  } else if (options_.reply_bytes == 3 && !text) {
    echo.push_back('\r'); // the vendor's library skips a byte here, whatever it is
  }
  if (text) append(echo, "\r\n");
  echo.push_back(0);
  reply(echo);
}

} // namespace nendo::emulator
