#include "sample_table.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/table.hpp>
#include <nendo/base/units.hpp>

namespace nendo::recording {
namespace {

constexpr double max_count = 65535.0;
constexpr double max_time_s = 4.5e9;           // 142 years: differences fit into nanoseconds
constexpr std::size_t max_samples = 5'000'000; // 15 hours of a CyberGlove; some 160 bytes each
constexpr std::uint64_t max_bytes = std::uint64_t{1} << 30;
constexpr std::string_view count_ending = "_count";
constexpr std::string_view head_example = "time_s,thumb_roll,thumb_mcp";

struct TimeUnit {
  std::string_view ending;
  std::string_view word;
  int digits; ///< after the point, for nanoseconds
};
constexpr std::array<TimeUnit, 4> time_units{{{"s", "seconds", 9},
                                              {"ms", "milliseconds", 6},
                                              {"us", "microseconds", 3},
                                              {"ns", "nanoseconds", 0}}};
constexpr std::array<std::string_view, 3> time_words{"time", "timestamp", "t"};

std::optional<Sensor> sensor_of(std::string_view name) {
  if (name.ends_with(count_ending)) name.remove_suffix(count_ending.size());
  return sensor_named(name);
}

/// What `nendo export` writes beside counts and times: known, and not needed.
bool is_exported_beside(std::string_view name) {
  if (name.ends_with("_deg")) return sensor_named(name.substr(0, name.size() - 4)).has_value();
  return name == "measured_s" || name == "device_time_s" || name == "switch" ||
         name == "calibrated";
}

std::optional<Side> side_of(std::string_view cell) {
  const std::string word = to_lower(std::string(cell));
  if (word == "left" || word == "l") return Side::left;
  if (word == "right" || word == "r") return Side::right;
  return std::nullopt;
}

/// Which column has what.
struct Columns {
  std::optional<std::size_t> time, hand, sequence;
  TimeUnit unit{};
  std::vector<std::pair<std::size_t, Sensor>> sensors;
};

class SampleReader {
public:
  SampleReader(std::string_view text, std::string name, const TableWishes& wishes)
      : table_(text, name), name_(std::move(name)), wishes_(wishes) {}

  Result<SampleTable> read() {
    if (auto fine = read_head(); !fine) return fine.error();
    for (;;) {
      const auto any = table_.next();
      if (!any) return any.error();
      if (!*any) break;
      if (auto fine = read_row(); !fine) return fine.error();
      if (rows_.size() > max_samples) return table_.bad("there are more than 5 million rows");
    }
    return finish();
  }

private:
  Result<void> read_head() {
    if (auto fine = table_.read_head(head_example); !fine) return fine;
    if (auto fine = find_sensors(); !fine) return fine;
    if (auto fine = find_time(); !fine) return fine;
    for (const std::string name : {"hand", "sequence"})
      if (table_.is_double(name)) return two_columns(name);
    columns_.hand = table_.find("hand");
    columns_.sequence = table_.find("sequence");
    return {};
  }

  Error two_columns(std::string_view name) const {
    return table_.bad("there are two columns of " + std::string(name) + "; leave one out");
  }

  Result<void> find_sensors() {
    SensorMask seen;
    for (std::size_t column = 0; column < table_.names().size(); ++column) {
      const std::string& name = table_.names()[column];
      if (is_exported_beside(name)) table_.mark_as_read(column);
      const auto sensor = sensor_of(name);
      if (!sensor) continue;
      if (seen.has(*sensor)) return two_columns(name);
      seen.add(*sensor);
      table_.mark_as_read(column);
      columns_.sensors.emplace_back(column, *sensor);
    }
    if (!columns_.sensors.empty()) return {};
    return table_.bad("no column is a sensor's; name them thumb_roll, thumb_mcp, ... as `nendo "
                      "monitor --raw` does");
  }

  Result<void> find_time() {
    std::string without_unit;
    for (const std::string_view word : time_words) {
      for (const TimeUnit& unit : time_units) {
        const std::string name = std::string(word) + "_" + std::string(unit.ending);
        const auto column = table_.find(name);
        if (!column) continue;
        if (columns_.time || table_.is_double(name))
          return table_.bad("there are two columns of times, the second one " + name +
                            "; leave one out");
        columns_.time = column;
        columns_.unit = unit;
      }
      const auto& names = table_.names();
      if (std::ranges::find(names, word) != names.end()) without_unit = word;
    }
    if (columns_.time || wishes_.rate_hz) return {};
    if (!without_unit.empty())
      return table_.bad("column " + without_unit +
                        " has no unit in its name; name it time_s, time_ms, "
                        "time_us or time_ns, or add ?rate=HZ, the rows per second");
    return table_.bad(
        "there is no column time_s (or time_ms, time_us, time_ns), so add ?rate=HZ, the "
        "rows per second");
  }

  Result<void> read_row() {
    GloveSample sample;
    if (auto fine = read_counts(sample); !fine) return fine.error();
    if (auto fine = read_hand(sample); !fine) return fine.error();
    if (sample.present.bits == 0) return {};
    if (auto fine = read_time(sample); !fine) return fine.error();
    rows_.push_back(sample);
    return {};
  }

  Result<void> read_counts(GloveSample& sample) {
    for (const auto& [column, sensor] : columns_.sensors) {
      if (table_.is_missing(column)) continue;
      const auto count = table_.number(column);
      if (!count || !(*count >= 0.0 && *count <= max_count))
        return table_.bad_cell(column, "is no count; use 0 to 65535, or leave the cell empty");
      sample.set(sensor, RawCount{static_cast<std::uint16_t>(std::lround(*count))});
    }
    return {};
  }

  Result<void> read_hand(GloveSample& sample) {
    if (!columns_.hand) {
      sample.side = wishes_.hand.value_or(wishes_.side.value_or(Side::right));
      return {};
    }
    auto side = side_of(table_.cell(*columns_.hand));
    const auto code = table_.number(*columns_.hand);
    if (code && (*code == 0.0 || *code == 1.0)) side = *code == 0.0 ? Side::left : Side::right;
    if (!side)
      return table_.bad_cell(*columns_.hand,
                             "is no hand; use left or right, or 0 (left) or 1 (right)");
    sample.side = *side;
    return {};
  }

  Result<void> read_time(GloveSample& sample) {
    auto& before = latest_[sample.side == Side::left ? 0 : 1];
    if (columns_.time) {
      const TimeUnit& unit = columns_.unit;
      const auto time_ns =
          table_.scaled(*columns_.time, unit.digits, max_time_s * std::pow(10.0, 9 - unit.digits));
      if (!time_ns)
        return table_.bad_cell(*columns_.time, "is no time; use " + std::string(unit.word) +
                                                   ", counted from any moment");
      sample.arrival = HostTime(std::chrono::nanoseconds(*time_ns));
      if (before && sample.arrival < *before)
        return table_.bad_cell(*columns_.time,
                               "is less than in the row before of this hand; sort the "
                               "rows by time");
    } else {
      sample.arrival = HostTime(from_seconds(static_cast<double>(rows_.size()) / *wishes_.rate_hz));
    }
    before = sample.measured = sample.arrival;
    return read_sequence(sample);
  }

  Result<void> read_sequence(GloveSample& sample) {
    if (!columns_.sequence) return {};
    const auto sequence = table_.scaled(*columns_.sequence, 0, 9e18);
    const auto number = table_.number(*columns_.sequence);
    if (!sequence || *sequence < 0 || *number != static_cast<double>(*sequence))
      return table_.bad_cell(*columns_.sequence,
                             "is no whole number from 0; leave the column out if "
                             "you do not have it");
    sample.sequence = static_cast<std::uint64_t>(*sequence);
    return {};
  }

  bool has(Side side) const {
    return std::ranges::find(rows_, side, &GloveSample::side) != rows_.end();
  }

  Result<SampleTable> finish() {
    if (rows_.empty()) return table_.bad("there is no row with a count; add one for each sample");
    if (wishes_.hand && !has(*wishes_.hand))
      return Error{Errc::no_device, name_ + ": has no row of a " +
                                        std::string(name_of(*wishes_.hand)) +
                                        " hand; leave hand= out, or choose the other"};
    Side side = rows_.front().side;
    for (const auto& wished : {wishes_.side, wishes_.hand})
      if (wished && has(*wished)) side = *wished;
    std::erase_if(rows_, [&](const GloveSample& row) { return row.side != side; });
    SampleTable table;
    table.info.side = side;
    for (std::size_t at = 0; at < rows_.size(); ++at) {
      GloveSample& row = rows_[at];
      if (!columns_.sequence) row.sequence = at;
      if (at > 0 && row.sequence <= rows_[at - 1].sequence)
        return Error{Errc::bad_input,
                     name_ + ": sequence does not rise from row to row; sort the rows, "
                             "or leave the column out"};
      table.info.sensors.bits |= row.present.bits;
      for (const RawCount& count : row.raw)
        while (count.value > table.info.counts.max_count)
          table.info.counts.max_count =
              static_cast<std::uint16_t>(table.info.counts.max_count * 16 + 15);
    }
    const double span_s = to_seconds(rows_.back().arrival - rows_.front().arrival);
    table.info.rate_hz = span_s > 0.0 ? static_cast<double>(rows_.size() - 1) / span_s : 0.0;
    table.info.kind = driver::SourceKind::recorded;
    table.info.source = name_;
    table.info.model = "a table of " + std::to_string(columns_.sensors.size()) + " sensors";
    if (const std::string others = table_.columns_not_read(); !others.empty())
      table.info.facts.push_back({std::string(columns_not_read_fact), others});
    table.samples = std::move(rows_);
    return table;
  }

  TableReader table_;
  std::string name_;
  TableWishes wishes_;
  Columns columns_;
  std::array<std::optional<HostTime>, 2> latest_; ///< the left hand's and the right hand's
  std::vector<GloveSample> rows_;
};

} // namespace

Result<SampleTable> parse_sample_table(std::string_view text, const std::string& name,
                                       const TableWishes& wishes) {
  return SampleReader(text, name, wishes).read();
}

Result<SampleTable> read_sample_table(const std::filesystem::path& path,
                                      const TableWishes& wishes) {
  const auto text = read_file(path, max_bytes, "table");
  if (!text) return text.error();
  return parse_sample_table(*text, path.string(), wishes);
}

} // namespace nendo::recording
