#include <nendo/deform/control_vectors.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "text_scanner.hpp"
#include "usable.hpp"

namespace nendo::deform {

namespace {

/// Far beyond what can be solved for in a minute.
constexpr std::size_t most_rows = 1'000'000;

constexpr std::array<std::string_view, 7> column_names{"x", "y", "z", "dx", "dy", "dz", "radius"};

class CsvParser {
public:
  CsvParser(std::string_view text, std::string_view name) : lines_(text), name_(name) {}

  Result<ControlVectors> parse();

private:
  Result<void> header(std::string_view row);
  Result<void> numbers(std::string_view row);
  ControlVectors vectors() const;

  Error bad(const std::string& what) const { return bad_line(name_, lines_.line(), what); }

  LineReader lines_;
  std::string_view name_;
  std::size_t columns_ = 0;     ///< 6 or 7; 0 before the header
  std::vector<double> numbers_; ///< six a row
  std::vector<OwnSupport> own_;
};

Result<ControlVectors> CsvParser::parse() {
  while (const auto row = lines_.next()) {
    if (row->front() == '#') continue;
    const auto done = columns_ == 0 ? header(*row) : numbers(*row);
    if (!done) return done.error();
  }
  if (numbers_.empty())
    return Error{Errc::bad_input, std::string(name_) + ": has no control vectors"};
  return vectors();
}

Result<void> CsvParser::header(std::string_view row) {
  std::size_t column = 0;
  while (!row.empty()) {
    const std::string_view name = trimmed(cut(row, ','));
    if (column == column_names.size() || name != column_names[column])
      return bad("column " + std::to_string(column + 1) + ": " + in_quotes(name) +
                 ", but the header must be x,y,z,dx,dy,dz or x,y,z,dx,dy,dz,radius");
    ++column;
  }
  if (column < 6)
    return bad("column " + std::to_string(column + 1) +
               ": missing, the header must be x,y,z,dx,dy,dz or x,y,z,dx,dy,dz,radius");
  columns_ = column;
  return {};
}

Result<void> CsvParser::numbers(std::string_view row) {
  const std::size_t rows = numbers_.size() / 6;
  if (rows == most_rows) return bad("more than " + std::to_string(most_rows) + " control vectors");
  const auto fields = static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
  if (fields != columns_)
    return bad("column " + std::to_string(std::min(fields, columns_) + 1) + ": has " +
               std::to_string(fields) + " columns, the header " + std::to_string(columns_));
  for (std::size_t column = 0; column < columns_; ++column) {
    const std::string_view field = trimmed(cut(row, ','));
    const std::string place =
        "column " + std::to_string(column + 1) + " (" + std::string(column_names[column]) + "): ";
    if (column == 6) {
      const auto supports = parse_supports(field);
      if (!supports)
        return bad(place + in_quotes(field) + " is not a radius > 0, or several like 10+40:0.5");
      for (const Support& support : *supports)
        own_.push_back({static_cast<Eigen::Index>(rows), support});
      continue;
    }
    const auto number = to_number(field);
    if (!number || !is_usable(*number))
      return bad(place + in_quotes(field) + " is not a finite number of at most 1e100");
    numbers_.push_back(*number);
  }
  return {};
}

ControlVectors CsvParser::vectors() const {
  const Eigen::Map<const Eigen::MatrixXd> table(numbers_.data(), 6,
                                                static_cast<Eigen::Index>(numbers_.size()) / 6);
  ControlVectors result;
  result.starts = table.topRows<3>();
  result.displacements = table.bottomRows<3>();
  result.own = own_;
  return result;
}

} // namespace

Result<ControlVectors> parse_control_vectors(std::string_view text, std::string_view name) {
  return CsvParser(text, name).parse();
}

Result<ControlVectors> read_control_vectors(const std::filesystem::path& path) {
  const auto text = read_file(path, most_file_bytes, "control vector");
  if (!text) return text.error();
  return parse_control_vectors(*text, path.string());
}

} // namespace nendo::deform
