#pragma once
// Reads text tables: CSV with commas, semicolons or tabs, and the output of numpy.savetxt(). All
// table readers in Nendo use these rules.
//
// * Cells are separated by tabs, semicolons or commas, in that order of preference, else by blanks.
//   The first line decides. A line `sep=;` before it, as Excel writes it, sets the separator.
// * A cell may be in double quotes; "" in it is a quote, and it may contain line ends.
// * A cell that is a number may have a decimal comma, if commas do not separate the cells.
// * Skipped: a byte-order mark, blank lines, lines that begin with #, and surplus empty cells at
//   the end of a line. A line ends with \n, \r\n or \r.
// * Names of columns are compared without regard to case and blanks: "Time (s)" is time_s. If the
//   first row has only numbers, the comment before it may name the columns.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo {

/// Reads one table row by row, with memory for one row. Errors are bad_input, in one line:
/// "NAME:LINE: what; remedy", with "column N (name)" if they concern one cell. `text` must outlive
/// the reader.
class NENDO_API TableReader {
public:
  TableReader(std::string_view text, std::string name);

  /// Reads the header row. Messages show `example` as a valid header, e.g. "x,y,z". Error: there is
  /// no header, or the input is not text (UTF-16, an archive).
  Result<void> read_head(std::string_view example);
  /// Begins a table without header: each row has `columns` cells, which blanks may separate. A
  /// first row of `columns` cells without any number is skipped as a header. Error: as in
  /// read_head(), but an empty text is valid.
  Result<void> begin_without_head(std::size_t columns);

  /// Returns the index of a column, or nullopt, and marks it as read. `name` is in plain() form.
  std::optional<std::size_t> find(std::string_view name);
  /// Returns whether two columns have this name.
  bool is_double(std::string_view name) const;
  /// Returns the column names in plain() form, in order; empty for empty header cells.
  const std::vector<std::string>& names() const noexcept { return names_; }
  void mark_as_read(std::size_t column) { is_read_[column] = true; }
  /// Lists the columns that were not read, e.g. "note, weight and 3 more"; empty if none.
  std::string columns_not_read() const;

  /// Reads the next row; returns false at the end. Error: the number of cells differs from the
  /// number of columns, or a quote is not closed.
  Result<bool> next();
  std::size_t line() const noexcept { return line_; } ///< the row's first line, from 1
  /// Returns the cell without surrounding blanks and quotes. Valid until next().
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  /// Returns whether the cell is empty, nan, na, n/a, null or none.
  bool is_missing(std::size_t column) const;
  /// Parses the cell as a finite number; nullopt if it is none.
  std::optional<double> number(std::size_t column) const;
  /// Returns cell * 10^`digits`, rounded to the nearest integer; computed exactly if the cell is a
  /// decimal number without exponent. Returns nullopt beyond +-`max` or if it is no number.
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
  bool is_padding(char c) const noexcept; ///< a blank that is no separator

  std::string_view rest_;
  std::string name_;
  std::string_view comment_; ///< the latest comment, without #
  char separator_ = '\0';    ///< '\0' until it is known
  bool blanks_too_ = false;  ///< blanks also separate cells
  bool is_pending_ = false;  ///< next() has not returned the row in `cells_`
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
  std::vector<std::string_view> cells_;
  std::vector<std::string> names_;
  std::vector<bool> is_read_;
};

} // namespace nendo
