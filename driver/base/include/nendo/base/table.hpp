#pragma once
// Reads tables of text that people and other programs write: CSV, its German and its tab-separated
// forms, and what numpy.savetxt() writes. All readers of tables in Nendo use these rules.
//
// * Cells are separated by tabs, semicolons or commas, in that order of preference, else by blanks.
//   The first line decides. A line `sep=;` before it, as Excel writes it, sets the separator.
// * A cell may be in double quotes; "" in it is a quote, and it may contain line ends.
// * A cell that is a number may have a decimal comma, if commas do not separate the cells.
// * Skipped: a byte-order mark, blank lines, lines that begin with #, and empty cells at a line's
//   end that are more than there are columns. A line ends with \n, \r\n or \r.
// * Names of columns are compared without regard to case and blanks: "Time (s)" is time_s. If the
//   first row has numbers alone, the comment before it may name the columns.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo {

/// Reads one table, row by row. It needs memory for one row. Errors are bad_input, in one line:
/// "NAME:LINE: what; remedy", and with "column N (name)" where one cell is meant. `text` must
/// outlive the reader.
class NENDO_API TableReader {
public:
  TableReader(std::string_view text, std::string name);

  /// Reads the names of the columns. `example` is a head as messages give it, like "x,y,z". Error:
  /// there is none, or the text is no text (UTF-16, an archive).
  Result<void> read_head(std::string_view example);
  /// Does without names: there are `columns` cells in each row, which blanks may separate. A
  /// first row of as many cells, none of them a number, is taken for names, and skipped. Error: as
  /// read_head(), but for an empty text.
  Result<void> begin_without_head(std::size_t columns);

  /// Returns the index of a column, or nullopt, and marks it as read. `name` is as plain() gives
  /// it.
  std::optional<std::size_t> find(std::string_view name);
  /// Returns whether there are two columns of that name.
  bool is_double(std::string_view name) const;
  /// The names, as plain() gives them, in the order of the columns; empty where a cell is.
  const std::vector<std::string>& names() const noexcept { return names_; }
  void mark_as_read(std::size_t column) { is_read_[column] = true; }
  /// Returns the columns that find() was not called for, such as "note, weight and 3 more"; empty:
  /// none.
  std::string columns_not_read() const;

  /// Reads the next row; false at the end. Error: the row has another number of cells than there
  /// are columns, or a quote is not closed.
  Result<bool> next();
  std::size_t line() const noexcept { return line_; } ///< where the row begins, from 1
  /// The cell without blanks and quotes around it. Valid until the next row.
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  /// The cell is empty, or one of the words for a value that is missing: nan, na, n/a, null, none.
  bool is_missing(std::size_t column) const;
  /// Returns the finite number that the cell is, or nullopt.
  std::optional<double> number(std::size_t column) const;
  /// Returns cell * 10^`digits`, exactly if the cell is a decimal number without an exponent, and
  /// rounded to the nearest whole number; nullopt beyond +-`max` or if it is no number.
  std::optional<std::int64_t> scaled(std::size_t column, int digits, double max) const;

  Error bad(const std::string& what) const;
  /// "NAME:LINE: column 3 (z): 'three' WHAT".
  Error bad_cell(std::size_t column, const std::string& what) const;

  /// Returns the name in lower case, with one '_' for each run of blanks, brackets, slashes and
  /// hyphens between words.
  static std::string plain(std::string_view name);

private:
  Result<bool> read_line();
  Result<void> read_cell(std::size_t& at);
  Result<void> check_is_text() const;
  bool skip_line();
  bool is_separator(char c) const noexcept;
  bool is_padding(char c) const noexcept; ///< a blank that separates nothing by itself

  std::string_view rest_;
  std::string name_;
  std::string_view comment_; ///< the latest, without its #
  char separator_ = '\0';    ///< '\0': not known yet
  bool blanks_too_ = false;  ///< blanks separate cells beside `separator_`
  bool is_pending_ = false;  ///< `cells_` are of a row that next() has not given yet
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
  std::vector<std::string_view> cells_;
  std::vector<std::string> names_;
  std::vector<bool> is_read_;
};

} // namespace nendo
