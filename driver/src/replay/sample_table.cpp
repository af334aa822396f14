#include "replay/sample_table.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>

#include "spec/number_in.hpp"

namespace nendo::driver {
namespace {

constexpr double most_count = 65535.0;
constexpr double most_time_s = 1e9;             // 30 years
constexpr std::size_t most_samples = 5'000'000; // 15 hours of a CyberGlove; some 160 bytes each
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
constexpr std::string_view count_ending = "_count";

/// What stands in a cell, in quotes or not.
std::string_view content_of(std::string_view cell) {
  cell = trimmed(cell);
  const bool is_quoted = cell.size() > 1 && cell.starts_with('"') && cell.ends_with('"');
  return is_quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (bool is_last = false; !is_last;) {
    is_last = line.find(separator) == std::string_view::npos;
    cells.push_back(content_of(cut(line, separator)));
  }
  return cells;
}

std::optional<Sensor> sensor_of(std::string_view name) {
  if (name.ends_with(count_ending)) name.remove_suffix(count_ending.size());
  return sensor_named(name);
}

/// Which column has what.
struct Columns {
  char separator = ',';
  std::size_t count = 0;
  std::optional<std::size_t> time, hand, sequence;
  std::vector<std::pair<std::size_t, Sensor>> sensors;
};

class TableReader {
public:
  TableReader(std::string name, const TableWishes& wishes)
      : name_(std::move(name)), wishes_(wishes) {}

  Result<SampleTable> read(std::string_view text) {
    text = without_mark(text);
    if (text.empty()) return Error{Errc::bad_input, name_ + ": is empty"};
    if (auto fine = read_head(cut(text, '\n')); !fine) return fine.error();
    while (!text.empty()) {
      const std::string_view line = cut(text, '\n');
      ++line_;
      if (trimmed(line).empty()) continue;
      if (auto fine = read_row(line); !fine) return fine.error();
      if (rows_.size() > most_samples) return wrong("there are more than 5 million rows");
    }
    return finish();
  }

private:
  Error wrong(const std::string& what) const { return bad_line(name_, line_, what); }

  Result<void> read_head(std::string_view line) {
    for (const char separator : {',', ';', '\t'})
      if (line.find(separator) != std::string_view::npos) {
        columns_.separator = separator;
        break;
      }
    std::set<std::string_view> seen;
    for (const std::string_view name : cells_of(line, columns_.separator)) {
      const std::size_t column = columns_.count++;
      const auto sensor = sensor_of(name);
      const bool is_known = sensor || name == "time_s" || name == "hand" || name == "sequence";
      if (is_known && !seen.insert(sensor ? name_of(*sensor) : name).second)
        return wrong("there are two columns of " + std::string(name));
      if (sensor) columns_.sensors.emplace_back(column, *sensor);
      if (name == "time_s") columns_.time = column;
      if (name == "hand") columns_.hand = column;
      if (name == "sequence") columns_.sequence = column;
    }
    if (columns_.sensors.empty())
      return wrong("no column is a sensor's; name them thumb_roll, thumb_mcp, ... as `nendo "
                   "monitor --raw` does");
    if (!columns_.time && !wishes_.rate_hz)
      return wrong("there is no column time_s, so add ?rate=HZ, the rows a second");
    return {};
  }

  Result<void> read_row(std::string_view line) {
    const auto cells = cells_of(line, columns_.separator);
    if (cells.size() != columns_.count)
      return wrong("has " + std::to_string(cells.size()) + " cells, and the head " +
                   std::to_string(columns_.count));
    GloveSample sample;
    if (auto fine = read_counts(cells, sample); !fine) return fine.error();
    if (auto fine = read_hand(cells, sample); !fine) return fine.error();
    if (auto fine = read_time(cells, sample); !fine) return fine.error();
    if (sample.present.bits != 0) rows_.push_back(sample);
    return {};
  }

  Result<void> read_counts(const std::vector<std::string_view>& cells, GloveSample& sample) {
    for (const auto& [column, sensor] : columns_.sensors) {
      if (cells[column].empty()) continue;
      const auto count = number_in<double>(cells[column]);
      if (!count || !(*count >= 0.0 && *count <= most_count))
        return wrong(std::string(name_of(sensor)) + " is " + in_quotes(cells[column]) +
                     "; use a count from 0 to 65535, or nothing");
      sample.set(sensor, RawCount{static_cast<std::uint16_t>(std::lround(*count))});
    }
    return {};
  }

  Result<void> read_hand(const std::vector<std::string_view>& cells, GloveSample& sample) {
    if (!columns_.hand) {
      sample.side = wishes_.hand.value_or(wishes_.side.value_or(Side::right));
      return {};
    }
    const std::string_view word = cells[*columns_.hand];
    if (word != "left" && word != "right")
      return wrong("hand is " + in_quotes(word) + "; use left or right");
    sample.side = word == "left" ? Side::left : Side::right;
    return {};
  }

  Result<void> read_time(const std::vector<std::string_view>& cells, GloveSample& sample) {
    double time_s = columns_.time ? 0.0 : static_cast<double>(rows_.size()) / *wishes_.rate_hz;
    if (columns_.time) {
      const auto told = number_in<double>(cells[*columns_.time]);
      if (!told || !(std::abs(*told) <= most_time_s))
        return wrong("time_s is " + in_quotes(cells[*columns_.time]) + "; use seconds");
      time_s = *told;
    }
    sample.arrival = sample.measured = HostTime(from_seconds(time_s));
    if (!rows_.empty() && sample.arrival < rows_.back().arrival)
      return wrong("time_s is less than in the row before");
    if (columns_.sequence) {
      const std::string_view text = cells[*columns_.sequence];
      const auto sequence = number_in<std::uint64_t>(text);
      if (!sequence) return wrong("sequence is " + in_quotes(text) + "; use a whole number");
      sample.sequence = *sequence;
    }
    return {};
  }

  bool has(Side side) const {
    return std::any_of(rows_.begin(), rows_.end(),
                       [&](const GloveSample& row) { return row.side == side; });
  }

  Result<SampleTable> finish() {
    if (rows_.empty()) return wrong("there is no row with a count");
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
        return Error{Errc::bad_input, name_ + ": sequence does not rise from row to row"};
      table.info.sensors.bits |= row.present.bits;
      for (const RawCount& count : row.raw)
        while (count.value > table.info.counts.most)
          table.info.counts.most = static_cast<std::uint16_t>(table.info.counts.most * 16 + 15);
    }
    const double span_s = to_seconds(rows_.back().arrival - rows_.front().arrival);
    table.info.rate_hz = span_s > 0.0 ? static_cast<double>(rows_.size() - 1) / span_s : 0.0;
    table.info.kind = GloveKind::recorded;
    table.info.source = name_;
    table.info.model = "a table of " + std::to_string(columns_.sensors.size()) + " sensors";
    table.samples = std::move(rows_);
    return table;
  }

  std::string name_;
  TableWishes wishes_;
  Columns columns_;
  std::size_t line_ = 1;
  std::vector<GloveSample> rows_;
};

} // namespace

Result<SampleTable> parse_sample_table(std::string_view text, const std::string& name,
                                       const TableWishes& wishes) {
  return TableReader(name, wishes).read(text);
}

Result<SampleTable> read_sample_table(const std::filesystem::path& path,
                                      const TableWishes& wishes) {
  const auto text = read_file(path, most_bytes, "table");
  if (!text) return text.error();
  return parse_sample_table(*text, path.string(), wishes);
}

} // namespace nendo::driver
