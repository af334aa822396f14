#include "fastrak/fastrak_protocol.hpp"

#include <algorithm>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::driver::fastrak {
namespace {

// The status [M 68-69]: `2`, station, `S`, 3 hexadecimal digits of flags, 3 characters of error, a
// blank, `F3`, the map of sensors, 2 blanks, 6 of firmware, 32 of identification, CR LF.
constexpr std::size_t status_bytes = 55;
constexpr std::size_t intersense_status_bytes = 54;
constexpr std::size_t flags_at = 3;
constexpr std::size_t error_at = 6;
constexpr std::size_t firmware_at = 15;
constexpr std::size_t firmware_bytes = 6;
constexpr std::string_view line_end = "\r\n";
constexpr std::string_view error_mark = "*ERROR*";

std::string text_at(std::string_view status, std::size_t at, std::size_t count) {
  return printable(trimmed(status.substr(at, count)));
}

std::optional<Status> status_in(std::string_view text) {
  if (text.size() < intersense_status_bytes || text[0] != '2' || text[2] != 'S')
    return std::nullopt;
  const std::size_t end = text.find(line_end, firmware_at);
  const bool whole =
      end + line_end.size() == status_bytes || end + line_end.size() == intersense_status_bytes;
  const auto flags = number_in<unsigned>(text.substr(flags_at, 3), 16);
  if (end == std::string_view::npos || !whole || !flags) return std::nullopt;
  text = text.substr(0, end);
  Status status;
  status.flags = *flags;
  status.error = text_at(text, error_at, 3);
  status.firmware = text_at(text, firmware_at, firmware_bytes);
  status.identification = text_at(text, firmware_at + firmware_bytes, text.size());
  status.is_intersense = end + line_end.size() == intersense_status_bytes;
  return status;
}

struct Meaning {
  std::string_view letters;
  std::string_view text;
};

} // namespace

std::optional<Status> find_status(std::string_view heard) {
  for (std::size_t at = 0; (at = heard.find('2', at)) != std::string_view::npos; ++at)
    if (auto status = status_in(heard.substr(at))) return status;
  return std::nullopt;
}

std::optional<std::string_view> find_stations(std::string_view heard) noexcept {
  for (std::size_t at = 0; (at = heard.find('2', at)) != std::string_view::npos; ++at) {
    const std::string_view text = heard.substr(at);
    if (text.size() < 4 || text[2] != 'l') continue;
    const std::string_view digits = text.substr(3, text.find_first_not_of("01", 3) - 3);
    if (!digits.empty() && text.substr(3 + digits.size(), 2) == line_end) return digits;
  }
  return std::nullopt;
}

std::string find_refusals(std::string_view heard) {
  std::string refusals;
  for (std::size_t at = 0; (at = heard.find(error_mark, at)) != std::string_view::npos;) {
    const std::size_t command_at = at + error_mark.size();
    const std::size_t end = heard.find(error_mark, command_at);
    if (end == std::string_view::npos) break;
    const std::string_view command = trimmed(heard.substr(command_at, end - command_at));
    at = end + error_mark.size();
    std::string_view rest = heard.substr(at, heard.find('*', at) - at);
    const std::size_t code_at = rest.find("EC");
    const std::string_view code =
        code_at == std::string_view::npos ? "unknown" : trimmed(rest.substr(code_at + 2, 6));
    refusals += (refusals.empty() ? "" : ", ") + printable(command.substr(0, 40)) + " (error " +
                printable(code.substr(0, code.find_first_of(" \r\n"))) + ")";
  }
  return refusals;
}

std::string_view meaning_of_error(char letter) noexcept {
  static constexpr std::array meanings{
      Meaning{"abc", "the transmitter's driver is at its limit"},
      Meaning{"def", "the receiver's gain is at its limit"},
      Meaning{"g", "a coil is faulty"},
      Meaning{"j", "the receiver is saturated; it is too near to the transmitter"},
      Meaning{"k", "the signal is low; the receiver is too far away, or not plugged in"},
      Meaning{"l", "an element of the signal matrix is zero"},
      Meaning{"m", "the EEPROM is faulty"},
      Meaning{"s", "the position was reset"},
      Meaning{"tu", "the compensation map is faulty"},
      Meaning{"v", "the synchronisation with a screen is missing"},
      Meaning{"x", "the receiver is outside of the motion box"},
      Meaning{"y", "the receiver is outside of the angular envelope"},
  };
  for (const Meaning& meaning : meanings)
    if (meaning.letters.find(letter) != std::string_view::npos) return meaning.text;
  return letter >= 'A' && letter <= 'Z' ? "the self-test found a fault" : "an unknown error";
}

} // namespace nendo::driver::fastrak
