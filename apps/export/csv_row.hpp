#pragma once
// A row of a CSV table, cell by cell.

#include <cstdint>
#include <string>
#include <string_view>

namespace nendo::exporting {

class CsvRow {
public:
  void put(std::string_view text);
  /// An empty cell if the number is not finite. The decimal point is a point in every locale.
  void put(double value, int decimals);
  void put(std::uint64_t count);
  void put_nothing() { put(std::string_view()); }

  /// Returns the row with its line end, and begins the next one.
  std::string take();

private:
  std::string text_;
  bool begun_ = false;
};

} // namespace nendo::exporting
