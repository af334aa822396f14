#include <nendo/deform/control_vectors.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/base/table.hpp>

#include "files/text_scanner.hpp"
#include "geometry/usable.hpp"

namespace nendo::deform {

namespace {

/// Far beyond what can be solved for in a minute.
constexpr std::size_t max_rows = 1'000'000;

constexpr std::string_view head_example = "x,y,z,dx,dy,dz or x,y,z,dx,dy,dz,radius";
constexpr std::array<std::string_view, 7> column_names{"x", "y", "z", "dx", "dy", "dz", "radius"};
constexpr std::size_t radius_at = 6;

class VectorTable {
public:
  VectorTable(std::string_view text, std::string_view name)
      : table_(text, std::string(name)), name_(name) {}

  Result<ControlVectors> parse();

private:
  Result<void> find_columns();
  Result<void> read_row();
  Result<void> read_radius(std::size_t column);
  ControlVectors vectors() const;

  TableReader table_;
  std::string_view name_;
  std::array<std::optional<std::size_t>, 7> columns_; ///< in the order of column_names
  std::vector<double> numbers_;                       ///< six a row
  std::vector<OwnSupport> own_;
};

Result<ControlVectors> VectorTable::parse() {
  if (auto fine = find_columns(); !fine) return fine.error();
  for (;;) {
    const auto any = table_.next();
    if (!any) return any.error();
    if (!*any) break;
    if (auto fine = read_row(); !fine) return fine.error();
  }
  if (numbers_.empty())
    return Error{Errc::bad_input,
                 std::string(name_) + ": has no control vectors; add a row for each"};
  ControlVectors result = vectors();
  result.columns_not_read = table_.columns_not_read();
  return result;
}

Result<void> VectorTable::find_columns() {
  if (auto fine = table_.read_head(head_example); !fine) return fine;
  for (std::size_t at = 0; at < column_names.size(); ++at) {
    const std::string name(column_names[at]);
    columns_[at] = table_.find(name);
    if (table_.is_double(name))
      return table_.bad("there are two columns " + name + "; leave one out");
    if (!columns_[at] && at != radius_at)
      return table_.bad("there is no column " + name +
                        "; name the columns in the first line, like " + std::string(head_example));
  }
  return {};
}

Result<void> VectorTable::read_row() {
  if (numbers_.size() / 6 == max_rows)
    return table_.bad("more than " + std::to_string(max_rows) + " control vectors");
  for (std::size_t at = 0; at < radius_at; ++at) {
    const auto number = table_.number(*columns_[at]);
    if (!number || !is_usable(*number))
      return table_.bad_cell(*columns_[at], "is not a finite number of at most 1e100; fix it, or "
                                            "leave the row out");
    numbers_.push_back(*number);
  }
  return columns_[radius_at] ? read_radius(*columns_[radius_at]) : Result<void>();
}

Result<void> VectorTable::read_radius(std::size_t column) {
  std::string cell(table_.cell(column));
  std::replace(cell.begin(), cell.end(), ',', '.'); // a decimal comma, as one radius has no other
  const auto supports = parse_supports(cell);
  if (!supports) return table_.bad_cell(column, "is not a radius > 0, or several like 10+40:0.5");
  const auto row = static_cast<Eigen::Index>(numbers_.size() / 6) - 1;
  for (const Support& support : *supports)
    own_.push_back({row, support});
  return {};
}

ControlVectors VectorTable::vectors() const {
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
  return VectorTable(text, name).parse();
}

Result<ControlVectors> read_control_vectors(const std::filesystem::path& path) {
  const auto text = read_file(path, max_file_bytes, "control vector");
  if (!text) return text.error();
  return parse_control_vectors(*text, path.string());
}

} // namespace nendo::deform
