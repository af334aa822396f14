#include "export/csv_row.hpp"

#include <charconv>
#include <cmath>
#include <utility>

namespace nendo::exporting {

void CsvRow::put(std::string_view text) {
  if (std::exchange(begun_, true)) text_ += ',';
  text_ += text;
}

void CsvRow::put(double value, int decimals) {
  char digits[400]; // the largest double has 309 before the point
  if (!std::isfinite(value)) return put_nothing();
  const char* const end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr;
  put(std::string_view(digits, static_cast<std::size_t>(end - digits)));
}

void CsvRow::put(std::uint64_t count) {
  put(std::string_view(std::to_string(count)));
}

std::string CsvRow::take() {
  begun_ = false;
  text_ += '\n';
  return std::exchange(text_, {});
}

} // namespace nendo::exporting
