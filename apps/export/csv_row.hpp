#pragma once
// A row of a CSV table, cell by cell. All cells are numbers, so that numpy and others read the
// table without options; the columns are described in README.md.

#include <cstdint>
#include <string>
#include <string_view>

namespace nendo::exporting {

class CsvRow {
public:
  void put(std::string_view text);
  /// `nan` if the number is not finite. The decimal point is a point in every locale.
  void put(double value, int decimals);
  void put(std::uint64_t count);
  void put_flag(bool flag) { put(std::string_view(flag ? "1" : "0")); }
  /// The number that is not there: `nan`, which readers of numbers take without any option.
  void put_nothing() { put(std::string_view("nan")); }

  /// Returns the row with its line end, and begins the next one.
  std::string take();

private:
  std::string text_;
  bool begun_ = false;
};

} // namespace nendo::exporting
