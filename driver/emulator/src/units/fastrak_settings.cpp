// Chosen where the manual's facts say nothing: a command whose values are all left out reads them
// back as `l` and `O` do, with the form Sxxx.xx or, for whole numbers, in two columns; a station
// without a receiver cannot be turned on; a boresight turns the receiver's own axes; positions,
// fields and stations of an error answer count from 0.

#include "units/fastrak_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>

#include <nendo/base/text.hpp>

#include "units/fastrak_records.hpp"

namespace nendo::emulator::fastrak {
namespace {

/// The forms of commands that set or read back a list of numbers.
struct NumbersForm {
  char letter;
  bool has_station;
  bool is_length;
  bool is_whole;
  double min;
  double max;
};
constexpr double max_length = 999.99; // the largest number of a record in text
constexpr std::array number_forms{NumbersForm{'H', true, false, false, -max_length, max_length},
                                  NumbersForm{'A', true, true, false, -max_length, max_length},
                                  NumbersForm{'G', true, false, false, -180.0, 180.0},
                                  NumbersForm{'r', true, false, false, -180.0, 180.0},
                                  NumbersForm{'N', true, true, false, -max_length, max_length},
                                  NumbersForm{'I', true, true, false, 0.0, max_length},
                                  NumbersForm{'e', true, false, true, 0.0, 1.0},
                                  NumbersForm{'x', false, false, false, 0.0, 1.0},
                                  NumbersForm{'v', false, false, false, 0.0, 1.0},
                                  NumbersForm{'y', false, false, true, 0.0, 2.0}};

const NumbersForm* numbers_form(char letter) noexcept {
  const auto* const found =
      std::find_if(number_forms.begin(), number_forms.end(),
                   [letter](const NumbersForm& form) { return form.letter == letter; });
  return found == number_forms.end() ? nullptr : found;
}

std::span<double> numbers_of(char letter, Settings& settings, std::size_t station) noexcept {
  StationSettings& own = settings.stations[station];
  switch (letter) {
  case 'H':
    return own.hemisphere;
  case 'A':
    return own.alignment_cm;
  case 'G':
    return own.reference_deg;
  case 'r':
    return own.mounting_deg;
  case 'N':
    return own.tip_cm;
  case 'I':
    return own.increment_cm;
  case 'e':
    return own.button_output;
  case 'x':
    return settings.position_filter;
  case 'v':
    return settings.attitude_filter;
  default:
    return settings.synchronisation;
  }
}

struct Problem {
  Wrong wrong = Wrong::unknown;
  std::size_t field = 0;
};

/// A command's parts.
struct Line {
  std::string_view text;
  char letter = ' ';
  std::vector<std::string_view> fields{};
  std::vector<std::size_t> positions{};
  std::size_t station = 0;

  explicit Line(std::string_view command) : text(command), letter(command.front()) {
    command.remove_prefix(1);
    if (command.empty()) return;
    for (ItemReader items(command, ','); !items.has_ended();) {
      const std::string_view item = items.next();
      positions.push_back(static_cast<std::size_t>(item.data() - text.data()));
      fields.push_back(trimmed(item));
    }
  }
  std::size_t position(std::size_t field) const noexcept {
    return field < positions.size() ? positions[field] : text.size();
  }
};

/// Reads a field as a whole number from `min` to `max`.
std::optional<Problem> read_whole(const Line& line, std::size_t field, unsigned min, unsigned max,
                                  unsigned& value) {
  if (field >= line.fields.size() || line.fields[field].empty())
    return Problem{Wrong::field_missing, field};
  const auto number = to_finite_number(line.fields[field]);
  if (!number) return Problem{Wrong::no_number, field};
  if (*number < min || *number > max || *number != std::floor(*number))
    return Problem{Wrong::out_of_range, field};
  value = static_cast<unsigned>(*number);
  return std::nullopt;
}

std::optional<Problem> read_station(Line& line) {
  unsigned station = 0;
  if (const auto problem = read_whole(line, 0, 1, max_stations, station)) return problem;
  line.station = station - 1;
  return std::nullopt;
}

std::string read_back(const Line& line, bool has_station) {
  std::string text = "2";
  text += has_station ? static_cast<char>('1' + line.station) : ' ';
  return text + line.letter;
}

/// Appends a whole number in two columns, or another one as Sxxx.xx.
void append_number(std::string& text, double number, bool is_whole) {
  std::array<char, 32> digits{};
  if (is_whole) {
    std::snprintf(digits.data(), digits.size(), "%2.0f", number);
  } else {
    std::snprintf(digits.data(), digits.size(), "%7.2f", number);
  }
  text += digits.data();
}

std::string read_back_numbers(const Line& line, const NumbersForm& form,
                              std::span<const double> numbers, double unit) {
  std::string text = read_back(line, form.has_station);
  for (const double number : numbers)
    append_number(text, number / unit, form.is_whole);
  return text + "\r\n";
}

/// Sets numbers, of which those that are left out keep their values.
std::optional<Problem> change_numbers(Line& line, const NumbersForm& form, Settings& settings,
                                      std::string& answer) {
  if (form.has_station)
    if (const auto problem = read_station(line)) return problem;
  const std::size_t first = form.has_station ? 1 : 0;
  const std::span<double> stored = numbers_of(line.letter, settings, line.station);
  const double unit = form.is_length ? settings.unit_cm() : 1.0;
  if (line.fields.size() <= first) {
    answer = read_back_numbers(line, form, stored, unit);
    return std::nullopt;
  }
  if (line.fields.size() > first + stored.size())
    return Problem{Wrong::too_long, first + stored.size()};
  std::vector<double> numbers(stored.begin(), stored.end());
  for (std::size_t field = first; field < line.fields.size(); ++field) {
    if (line.fields[field].empty()) continue;
    const auto number = to_finite_number(line.fields[field]);
    if (!number) return Problem{Wrong::no_number, field};
    if (*number < form.min || *number > form.max ||
        (form.is_whole && *number != std::floor(*number)))
      return Problem{Wrong::out_of_range, field};
    numbers[field - first] = *number * unit;
  }
  std::copy(numbers.begin(), numbers.end(), stored.begin());
  return std::nullopt;
}

/// A tracked hemisphere begins with the solution that the unit reports now.
std::optional<Problem> change_hemisphere(Line& line, Settings& settings, const Receivers& receivers,
                                         std::string& answer) {
  const Settings before = settings;
  if (const auto problem = change_numbers(line, *numbers_form('H'), settings, answer))
    return problem;
  const Vector3 position_cm = receivers.pose(line.station).position_cm;
  settings.stations[line.station].tracked_sign =
      before.stations[line.station].is_flipped(position_cm) ? -1.0 : 1.0;
  return std::nullopt;
}

std::optional<Problem> change_station_state(Line& line, Settings& settings,
                                            const Receivers& receivers, std::string& answer) {
  if (const auto problem = read_station(line)) return problem;
  if (line.fields.size() > 2) return Problem{Wrong::too_long, 2};
  if (line.fields.size() == 2) {
    unsigned on = 0;
    if (const auto problem = read_whole(line, 1, 0, 1, on)) return problem;
    settings.stations[line.station].on = on == 1 && receivers.plugged[line.station];
    return std::nullopt;
  }
  answer = read_back(line, true);
  for (const StationSettings& station : settings.stations)
    answer += station.on ? '1' : '0';
  answer += "\r\n";
  return std::nullopt;
}

std::optional<Problem> change_output(Line& line, Settings& settings, std::string& answer) {
  if (const auto problem = read_station(line)) return problem;
  std::vector<unsigned>& items = settings.stations[line.station].items;
  if (line.fields.size() == 1) {
    answer = read_back(line, true);
    for (const unsigned item : items)
      append_number(answer, item, true);
    answer += "\r\n";
    return std::nullopt;
  }
  if (line.fields.size() > 1 + max_items) return Problem{Wrong::too_long, 1 + max_items};
  std::vector<unsigned> wanted;
  std::size_t bytes = header_bytes;
  for (std::size_t field = 1; field < line.fields.size(); ++field) {
    unsigned item = 0;
    constexpr unsigned max_item = 99;
    if (const auto problem = read_whole(line, field, 0, max_item, item)) return problem;
    const auto more = item_bytes(item, settings.binary);
    if (!more) return Problem{Wrong::out_of_range, field};
    bytes += *more;
    if (bytes > max_record_bytes) return Problem{Wrong::too_long, field};
    wanted.push_back(item);
  }
  items = std::move(wanted);
  return std::nullopt;
}

std::optional<Problem> change_frames(Line& line, Settings& settings, const Receivers& receivers) {
  if (const auto problem = read_station(line)) return problem;
  if (line.fields.size() > 1) return Problem{Wrong::too_long, 1};
  StationSettings& station = settings.stations[line.station];
  if (line.letter == 'R') station.alignment_cm = StationSettings{}.alignment_cm;
  if (line.letter == 'R') return std::nullopt;
  station.boresight = no_rotation;
  if (line.letter == 'b') return std::nullopt;
  const Rotation now = station.reported(receivers.pose(line.station)).attitude;
  station.boresight = product(inverse(now), from_euler_deg(station.reference_deg));
  return std::nullopt;
}

std::optional<Problem> carry_out_line(Line& line, Settings& settings, const Receivers& receivers,
                                      std::string& answer) {
  switch (line.letter) {
  case 'l':
    return change_station_state(line, settings, receivers, answer);
  case 'O':
    return change_output(line, settings, answer);
  case 'H':
    return change_hemisphere(line, settings, receivers, answer);
  case 'R':
  case 'B':
  case 'b':
    return change_frames(line, settings, receivers);
  default:
    return change_numbers(line, *numbers_form(line.letter), settings, answer);
  }
}

/// Returns the rotation from the transmitter's axes to those of the alignment frame; none if its
/// three points are no triangle.
Rotation alignment_rotation(const std::array<double, 9>& points) noexcept {
  const Vector3 origin{points[0], points[1], points[2]};
  const Vector3 x = difference({points[3], points[4], points[5]}, origin);
  const Vector3 y = difference({points[6], points[7], points[8]}, origin);
  const Vector3 z = cross(x, y);
  const double x_length = std::sqrt(dot(x, x));
  const double z_length = std::sqrt(dot(z, z));
  if (!(x_length > 0.0 && z_length > 0.0)) return no_rotation;
  const Vector3 x_axis = scaled(x, 1.0 / x_length);
  const Vector3 z_axis = scaled(z, 1.0 / z_length);
  return {x_axis, cross(z_axis, x_axis), z_axis};
}

} // namespace

bool StationSettings::is_flipped(const Vector3& position_cm) const noexcept {
  if (hemisphere == Vector3{}) return tracked_sign < 0.0;
  return dot(hemisphere, position_cm) < 0.0;
}

StationPose StationSettings::reported(const StationPose& receiver) const noexcept {
  const double sign = is_flipped(receiver.position_cm) ? -1.0 : 1.0;
  const Rotation mounted = from_euler_deg(mounting_deg);
  const Rotation aligned = alignment_rotation(alignment_cm);
  const Vector3 in_mounting = rotated(mounted, scaled(receiver.position_cm, sign));
  const Vector3 origin{alignment_cm[0], alignment_cm[1], alignment_cm[2]};
  const Rotation attitude = product(aligned, product(mounted, receiver.attitude));
  const Vector3 position = rotated(aligned, difference(in_mounting, origin));
  return {sum(position, rotated(attitude, tip_cm)), product(attitude, boresight)};
}

bool takes_parameters(unit::Byte letter) noexcept {
  const char as_char = static_cast<char>(letter);
  return numbers_form(as_char) != nullptr ||
         std::string_view("lORBb").find(as_char) != std::string_view::npos;
}

std::string carry_out(std::string_view command, Settings& settings, const Receivers& receivers) {
  Line line(command);
  std::string answer;
  const auto problem = carry_out_line(line, settings, receivers, answer);
  if (!problem) return answer;
  return error_answer(command, problem->wrong, line.position(problem->field), problem->field,
                      line.station);
}

std::string error_answer(std::string_view command, Wrong wrong, std::size_t position,
                         std::size_t field, std::size_t station) {
  std::string text = "2 E*ERROR*";
  text.append(command).append("*ERROR* EC ").append(std::to_string(static_cast<int>(wrong)));
  text.append(" *PS ").append(std::to_string(position));
  text.append(" *FL ").append(std::to_string(field));
  return text.append(" *ST ").append(std::to_string(station)).append("\r\n");
}

} // namespace nendo::emulator::fastrak
