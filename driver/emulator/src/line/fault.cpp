#include "line/fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <nendo/base/number_in.hpp>
#include <nendo/emulator/emulator.hpp>

namespace nendo::emulator {
namespace {

using Nanoseconds = std::chrono::nanoseconds;

enum class Part : std::uint8_t { none, optional, required };

struct Row {
  std::string_view name;
  std::string_view form;
  std::string_view effect;
  bool by_chance;
  Part lasting;
  Part value;
};

// In the order of FaultKind.
constexpr std::array<Row, fault_kinds> rows{{
    {"drop", "drop=RATE%", "a byte vanishes, RATE per byte", true, {}, {}},
    {"flip", "flip=RATE%", "one bit of a byte turns over, RATE per byte", true, {}, {}},
    {"insert", "insert=RATE%", "a random byte comes in, RATE per byte", true, {}, {}},
    {"lose", "lose=RATE%", "a whole record vanishes, RATE per record", true, {}, {}},
    {"burst", "burst=RATE%", "1 to 64 random bytes before a record, RATE per record", true, {}, {}},
    {"silence", "silence@5s+3s", "nothing arrives from 5 s on, for 3 s", false, Part::required, {}},
    {"junk",
     "junk@5s",
     "echoes of a modem probe's AT commands; at 0s they await the first host",
     false,
     {},
     {}},
    {"unplug", "unplug@5s+2s[=LINK]",
     "the terminal vanishes; 2 s later there is another, at LINK or the same link", false,
     Part::required, Part::optional},
    {"eg",
     "eg@5s+2s",
     "the glove, or a tracker's receivers, are pulled out of the unit for 2 s",
     false,
     Part::required,
     {}},
    {"swap", "swap@5s[+2s]=WHAT",
     "the glove is pulled and after 2 s (0.5 s) another plugged in: 18, 22, left or right", false,
     Part::optional, Part::required},
    {"restart",
     "restart@5s",
     "the unit loses its power for a moment, and with it all settings",
     false,
     {},
     {}},
    {"stick", "stick@5s[+2s]=SENSOR[:COUNT]",
     "a sensor, by its name or slot, stops (for 2 s) at a count, or at its own", false,
     Part::optional, Part::required},
    {"press",
     "press@5s+2s",
     "no fault: the switch at the wrist, or a stylus' button, is on for 2 s",
     false,
     Part::required,
     {}},
    {"error",
     "error@5s=[STATION:]LETTER",
     "a tracker's records of a station, or of all, carry this error letter until its test",
     false,
     {},
     Part::required},
}};

std::optional<double> number(std::string_view text) {
  const auto value = number_in<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> rate(std::string_view text) {
  if (!text.ends_with('%')) return {};
  const auto percent = number(text.substr(0, text.size() - 1));
  if (!percent || !(*percent > 0.0 && *percent <= 100.0)) return {};
  return *percent / 100.0;
}

std::optional<Nanoseconds> time(std::string_view text) {
  using Seconds = std::chrono::duration<double>;
  constexpr Seconds most(1e7); // nearly four months
  const bool milliseconds = text.ends_with("ms");
  if (!text.ends_with('s')) return {};
  const auto value = number(text.substr(0, text.size() - (milliseconds ? 2 : 1)));
  if (!value) return {};
  const Seconds given =
      milliseconds ? Seconds(std::chrono::duration<double, std::milli>(*value)) : Seconds(*value);
  if (!(given.count() >= 0.0 && given <= most)) return {};
  return std::chrono::duration_cast<Nanoseconds>(given);
}

bool fits(Part part, bool given) noexcept {
  return part == Part::optional || given == (part == Part::required);
}

// TIME[+TIME][=VALUE]
std::optional<Fault> timed(const Row& row, std::string_view text) {
  Fault fault;
  const std::size_t equals = text.find('=');
  if (equals != std::string_view::npos) fault.value = text.substr(equals + 1);
  if (!fits(row.value, equals != std::string_view::npos && !fault.value.empty())) return {};
  if (equals != std::string_view::npos && fault.value.empty()) return {};
  const std::string_view times = text.substr(0, equals);
  const std::size_t plus = times.find('+');
  if (!fits(row.lasting, plus != std::string_view::npos)) return {};
  const auto at = time(times.substr(0, plus));
  if (!at) return {};
  fault.at = *at;
  if (plus == std::string_view::npos) return fault;
  const auto lasting = time(times.substr(plus + 1));
  if (!lasting) return {};
  fault.lasting = *lasting;
  return fault;
}

/// Reads SENSOR[:COUNT].
std::optional<Incident> stuck_sensor(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  Incident incident{Incident::Kind::sensor_stuck};
  if (const auto named = sensor_named(name)) {
    incident.sensor = *named;
  } else {
    const auto slot = number(name);
    if (!slot || *slot < 0.0 || *slot >= static_cast<double>(sensor_slots) ||
        *slot != std::floor(*slot))
      return std::nullopt;
    incident.sensor = static_cast<Sensor>(*slot);
  }
  if (colon == std::string_view::npos) return incident;
  const auto count = number(text.substr(colon + 1));
  if (!count || *count < 0.0 || *count > 255.0 || *count != std::floor(*count)) return std::nullopt;
  incident.count = static_cast<std::uint16_t>(*count);
  return incident;
}

/// Reads [STATION:]LETTER.
std::optional<Incident> tracker_error(std::string_view text) {
  Incident incident{Incident::Kind::tracker_error};
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const auto station = number_in<unsigned>(text.substr(0, colon));
    if (!station || *station == 0) return std::nullopt;
    incident.station = *station;
    text.remove_prefix(colon + 1);
  }
  const bool is_letter = text.size() == 1 &&
                         ((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z'));
  if (!is_letter) return std::nullopt;
  incident.letter = text[0];
  return incident;
}

} // namespace

std::string_view name_of(FaultKind kind) noexcept {
  return rows[static_cast<std::size_t>(kind)].name;
}

std::optional<Incident> incident_of(const Fault& fault, bool over) {
  using Kind = Incident::Kind;
  if (fault.kind == FaultKind::restart) return Incident{Kind::power_cycle};
  if (fault.kind == FaultKind::stick) {
    auto stuck = stuck_sensor(fault.value);
    if (stuck && over) stuck->kind = Kind::sensor_free;
    return stuck;
  }
  if (fault.kind == FaultKind::error) return tracker_error(fault.value);
  if (fault.kind == FaultKind::press) return Incident{over ? Kind::switch_off : Kind::switch_on};
  if (fault.kind != FaultKind::eg && fault.kind != FaultKind::swap) return std::nullopt;
  Incident incident{over ? Kind::glove_in : Kind::glove_out};
  if (!over || fault.kind == FaultKind::eg) return incident;
  if (fault.value == "18") incident.sensors = 18;
  if (fault.value == "22") incident.sensors = 22;
  if (const auto side = side_named(fault.value)) incident.side = *side;
  return incident;
}

std::vector<FaultForm> fault_forms() {
  std::vector<FaultForm> forms;
  for (const Row& row : rows)
    forms.push_back({row.form, row.effect});
  return forms;
}

Result<Fault> parse_fault(std::string_view text) {
  const auto wrong = [text](const std::string& remedy) {
    return Error{Errc::usage, "fault \"" + std::string(text) + "\": " + remedy};
  };
  const std::size_t name_size = std::min(text.find_first_of("=@"), text.size());
  const std::string_view name = text.substr(0, name_size);
  const auto row =
      std::find_if(rows.begin(), rows.end(), [name](const Row& r) { return r.name == name; });
  if (row == rows.end()) {
    std::string names;
    for (const Row& known : rows)
      names.append(names.empty() ? "" : ", ").append(known.name);
    return wrong("there is no such fault; there are " + names);
  }
  const std::string_view rest = text.substr(std::min(name_size + 1, text.size()));
  std::optional<Fault> fault;
  if (row->by_chance) {
    const auto chance =
        name_size < text.size() && text[name_size] == '=' ? rate(rest) : std::nullopt;
    if (!chance) {
      return wrong("write " + std::string(row->form) + ", RATE above 0 and at most 100");
    }
    fault = Fault{.rate = *chance};
  } else {
    if (name_size < text.size() && text[name_size] == '@') fault = timed(*row, rest);
    if (!fault) return wrong("write it like " + std::string(row->form) + ", times in s or ms");
  }
  fault->kind = static_cast<FaultKind>(row - rows.begin());
  if (fault->kind == FaultKind::swap) {
    constexpr std::array<std::string_view, 4> gloves{"18", "22", "left", "right"};
    if (std::find(gloves.begin(), gloves.end(), fault->value) == gloves.end()) {
      return wrong("swap for 18, 22, left or right");
    }
    if (fault->lasting == Nanoseconds{}) fault->lasting = std::chrono::milliseconds(500);
  }
  if (fault->kind == FaultKind::stick && !stuck_sensor(fault->value))
    return wrong("stick=SENSOR[:COUNT]: a sensor's name, as index_pip, or its slot, 0 to 23, and a "
                 "count of 0 to 255");
  if (fault->kind == FaultKind::error && !tracker_error(fault->value))
    return wrong("error=[STATION:]LETTER: a letter, and a station from 1, as in error@5s=2:k");
  return *fault;
}

Result<std::vector<Fault>> parse_faults(const std::vector<std::string>& strings) {
  std::vector<Fault> faults;
  for (const std::string& text : strings) {
    auto fault = parse_fault(text);
    if (!fault) return fault.error();
    const bool twice = std::any_of(faults.begin(), faults.end(), [&](const Fault& other) {
      return other.kind == fault->kind && fault->rate > 0.0;
    });
    if (twice) {
      return Error{Errc::usage, "fault \"" + text + "\": its rate is given twice; keep one"};
    }
    faults.push_back(*std::move(fault));
  }
  return faults;
}

} // namespace nendo::emulator
