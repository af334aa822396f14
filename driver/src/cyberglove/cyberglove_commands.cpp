#include "cyberglove/cyberglove_commands.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr auto text_timeout = 1000ms;    ///< of long strings [V]
constexpr auto restart_timeout = 2500ms; ///< the vendor's library; the manual says 1.75 s [V, p.45]

using ThreeBytes = std::array<std::uint8_t, 3>;

ThreeBytes low_first(std::uint32_t bits) noexcept {
  return {static_cast<std::uint8_t>(bits & 0xFFU), static_cast<std::uint8_t>(bits >> 8U & 0xFFU),
          static_cast<std::uint8_t>(bits >> 16U & 0xFFU)};
}

template <class T, std::size_t size, class Decode>
Reply<T> decoded(const Reply<std::array<std::byte, size>>& reply, Decode&& decode) noexcept {
  ByteReader reader(reply.value);
  return {reply.answer, decode(reader)};
}

std::uint8_t one_byte(ByteReader& reader) noexcept {
  return reader.u8();
}
SensorMask mask(ByteReader& reader) noexcept {
  return {reader.u24_le()};
}

} // namespace

template <std::size_t size>
Reply<std::array<std::byte, size>> Commands::ask(const Query& query) noexcept {
  assert(query.data_bytes == size);
  Reply<std::array<std::byte, size>> reply;
  reply.answer = dialogue_.ask(query, reply.value, timeout_);
  return reply;
}

Reply<std::string> Commands::ask_text(char letter, std::chrono::milliseconds timeout) {
  Reply<std::string> reply;
  reply.answer = dialogue_.ask_text(letter, reply.value, timeout);
  return reply;
}

Answer Commands::set(std::string_view head, std::span<const std::uint8_t> arguments) noexcept {
  std::array<std::byte, 2 + 2 * sensor_slots> message{}; // the longest: a whole calibration
  assert(head.size() + arguments.size() <= message.size());
  const auto letters = std::as_bytes(std::span(head));
  const auto numbers = std::as_bytes(arguments);
  const auto end = std::copy(letters.begin(), letters.end(), message.begin());
  std::copy(numbers.begin(), numbers.end(), end);
  const auto bytes = std::span(message).first(letters.size() + numbers.size());
  const Answer answer = dialogue_.command(bytes, head, timeout_);
  // A unit that does not know the command takes what follows it for others: their errors must not
  // be taken for the next replies, nor may one of them wait for an argument.
  if (answer != Answer::good && answer != Answer::gone) dialogue_.stop_stream();
  return answer;
}

Answer Commands::set(std::string_view head, std::uint8_t argument) noexcept {
  return set(head, std::span(&argument, 1));
}

Reply<std::string> Commands::information() {
  return ask_text(ask_information, std::max(timeout_, text_timeout));
}

Reply<std::string> Commands::firmware_text() {
  return ask_text(ask_firmware_text, timeout_);
}

Reply<std::string> Commands::help() {
  return ask_text(ask_help, std::max(timeout_, text_timeout));
}

Reply<std::array<std::uint8_t, 4>> Commands::firmware() noexcept {
  return decoded<std::array<std::uint8_t, 4>>(ask<4>(ask_firmware), [](ByteReader& reader) {
    std::array<std::uint8_t, 4> version{};
    for (std::uint8_t& byte : version)
      byte = reader.u8();
    return version;
  });
}

Reply<GloveState> Commands::state() noexcept {
  return decoded<GloveState>(ask<1>(ask_state), [](ByteReader& reader) {
    const std::uint8_t bits = reader.u8();
    return GloveState{(bits & state_initialised) != 0, (bits & state_connected) != 0};
  });
}

Reply<std::uint8_t> Commands::sensor_count() noexcept {
  return decoded<std::uint8_t>(ask<1>(ask_sensor_count), one_byte);
}

Reply<SensorMask> Commands::hardware_mask() noexcept {
  return decoded<SensorMask>(ask<3>(ask_hardware_mask), mask);
}

Reply<Side> Commands::side() noexcept {
  return decoded<Side>(ask<1>(ask_right_hand), [](ByteReader& reader) {
    return reader.u8() == 0 ? Side::left : Side::right;
  });
}

Reply<bool> Commands::get(Setting setting) noexcept {
  return decoded<bool>(ask<1>({static_cast<char>(setting), 1}),
                       [](ByteReader& reader) { return reader.u8() != 0; });
}

Answer Commands::set(Setting setting, bool on) noexcept {
  const auto letter = static_cast<char>(setting);
  return set({&letter, 1}, on ? 1 : 0);
}

Reply<SensorMask> Commands::software_mask() noexcept {
  return decoded<SensorMask>(ask<3>(ask_software_mask), mask);
}

Answer Commands::set_software_mask(SensorMask mask) noexcept {
  return set(cyberglove::set_software_mask, low_first(mask.bits));
}

Reply<std::uint8_t> Commands::value_count() noexcept {
  return decoded<std::uint8_t>(ask<1>(ask_value_count), one_byte);
}

Answer Commands::set_value_count(std::uint8_t count) noexcept {
  return set(cyberglove::set_value_count, count);
}

Reply<Parameters> Commands::parameters() noexcept {
  return decoded<Parameters>(ask<3>(ask_parameters),
                             [](ByteReader& reader) { return decode_parameters(reader.u24_le()); });
}

Answer Commands::set_parameters(const Parameters& parameters) noexcept {
  return set(cyberglove::set_parameters, low_first(encode_parameters(parameters)));
}

Answer Commands::set_sync(bool on) noexcept {
  return set(cyberglove::set_sync, on ? 1 : 0);
}

Answer Commands::set_text_sync(bool on) noexcept {
  constexpr std::array<std::uint8_t, 3> turn_on{' ', '1', '\r'};
  constexpr std::array<std::uint8_t, 3> turn_off{' ', '0', '\r'};
  return set(set_sync_text, on ? turn_on : turn_off);
}

Reply<std::array<std::byte, 4>> Commands::period_bytes() noexcept {
  return ask<4>(ask_period);
}

Reply<std::optional<WordOrder>> Commands::set_period(Period period) noexcept {
  std::array<char, 16> text{}; // " 65535 65535\r"
  char* end = text.begin();
  for (const unsigned word : {period.ticks, period.times}) {
    *end++ = ' ';
    end = std::to_chars(end, text.end(), word).ptr;
  }
  *end++ = '\r';
  const std::span letters(text.begin(), end);
  std::array<std::uint8_t, 16> bytes{};
  std::copy(letters.begin(), letters.end(), bytes.begin());
  const Answer done = set(set_period_text, std::span(bytes).first(letters.size()));
  // A confirmation that cannot be read is none; what was done shows all the same.
  if (done != Answer::good && done != Answer::nonsense) return {done, std::nullopt};
  const auto said = period_bytes();
  if (said.answer == Answer::unknown) return {done, std::nullopt};
  if (!said) return {said.answer, std::nullopt};
  const auto order = order_of(said.value, period);
  return {order ? Answer::good : Answer::other_value, order};
}

Reply<HardwareCalibration> Commands::hardware_calibration(std::size_t sensors) noexcept {
  assert(sensors <= sensor_slots);
  std::array<std::byte, 2 * sensor_slots> data{};
  const auto used = std::span(data).first(2 * sensors);
  Reply<HardwareCalibration> reply;
  reply.answer = dialogue_.ask({ask_calibration, used.size()}, used, timeout_);
  reply.value.sensors = sensors;
  ByteReader reader(used);
  for (std::size_t k = 0; k < sensors; ++k)
    reply.value.offset[k] = reader.u8();
  for (std::size_t k = 0; k < sensors; ++k)
    reply.value.gain[k] = reader.u8();
  return reply;
}

Answer Commands::set_hardware_calibration(const HardwareCalibration& calibration) noexcept {
  assert(calibration.sensors <= sensor_slots);
  std::array<std::uint8_t, 2 * sensor_slots> bytes{};
  const auto offsets = std::span(calibration.offset).first(calibration.sensors);
  const auto gains = std::span(calibration.gain).first(calibration.sensors);
  const auto end = std::copy(offsets.begin(), offsets.end(), bytes.begin());
  std::copy(gains.begin(), gains.end(), end);
  return set(set_calibration, std::span(bytes).first(2 * calibration.sensors));
}

Answer Commands::set_offset(std::uint8_t sensor, std::uint8_t offset) noexcept {
  return set(cyberglove::set_offset, std::array{sensor, offset});
}

Answer Commands::set_gain(std::uint8_t sensor, std::uint8_t gain) noexcept {
  return set(cyberglove::set_gain, std::array{sensor, gain});
}

Reply<std::uint8_t> Commands::baud_register() noexcept {
  return decoded<std::uint8_t>(ask<1>(ask_baud), one_byte);
}

Answer Commands::set_baud_register(std::uint8_t byte) noexcept {
  return set(set_baud, byte);
}

Reply<Vibration> Commands::vibration() noexcept {
  return decoded<Vibration>(ask<6>(ask_vibration), [](ByteReader& reader) {
    Vibration strength{};
    for (std::uint8_t& value : strength)
      value = reader.u8();
    return strength;
  });
}

Answer Commands::set_vibration(const Vibration& strength) noexcept {
  std::array<std::uint8_t, 1 + std::tuple_size_v<Vibration>> bytes{all_vibrators};
  std::copy(strength.begin(), strength.end(), bytes.begin() + 1);
  return set(cyberglove::set_vibration, bytes);
}

Answer Commands::set_vibrators(std::span<const Vibrator> some) noexcept {
  assert(some.size() <= std::tuple_size_v<Vibration>);
  std::array<std::uint8_t, 1 + 2 * std::tuple_size_v<Vibration>> bytes{};
  std::size_t size = 0;
  bytes[size++] = static_cast<std::uint8_t>(some.size());
  for (const Vibrator& vibrator : some) {
    bytes[size++] = vibrator.index;
    bytes[size++] = vibrator.strength;
  }
  return set(cyberglove::set_vibration, std::span(bytes).first(size));
}

Answer Commands::stop() noexcept {
  return dialogue_.stop_stream();
}

Answer Commands::restart() noexcept {
  return dialogue_.restart(std::max(timeout_, restart_timeout));
}

Answer Commands::reread_glove() noexcept {
  const auto letter = std::to_integer<char>(cyberglove::reread_glove);
  return set({&letter, 1}, std::span<const std::uint8_t>());
}

Reply<RecordBytes> Commands::record(std::size_t min_bytes) noexcept {
  Reply<RecordBytes> reply;
  reply.answer = dialogue_.ask_record(min_bytes, reply.value.bytes, reply.value.size, timeout_);
  return reply;
}

Answer Commands::set_sink(Sink sink, bool on) noexcept {
  const std::string_view command = on ? third_enable : third_disable;
  const std::array head{command[0], command[1], static_cast<char>(sink)};
  return set({head.data(), head.size()}, std::span<const std::uint8_t>());
}

Answer Commands::set_frame_rate(std::uint8_t thirties) noexcept {
  return set(third_frame_rate, thirties);
}

Answer Commands::set_divider(Sink sink, std::uint8_t divider) noexcept {
  const std::array head{third_divider[0], static_cast<char>(sink)};
  return set({head.data(), head.size()}, divider);
}

} // namespace nendo::driver::cyberglove
