#pragma once
// A table of counts in a text file, as `nendo export` writes it and as other laboratories keep
// theirs: a head with the names of the columns, and then a row for each sample.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>

namespace nendo::recording {

struct SampleTable {
  driver::GloveInfo info; ///< as the columns and the times imply
  std::vector<GloveSample> samples;
};

/// What the user says of a table.
struct TableWishes {
  std::optional<Side> hand{};      ///< only rows of that hand
  std::optional<Side> side{};      ///< that, if there are some
  std::optional<double> rate_hz{}; ///< rate of a table without times
};

/// The fact of a table's GloveInfo that names the columns which were not read.
inline constexpr std::string_view columns_not_read_fact = "columns_not_read";

/// A table (nendo/base/table.hpp) with a row for each sample. Its columns are, in any order:
/// SENSOR_count or SENSOR, for any of sensor_names, counts from 0 to 65535, rounded, a missing one
/// being none; time_s, time_ms, time_us or time_ns (also timestamp_, t_); hand, left (0) or right
/// (1); sequence. Others are named in a fact, unless `nendo export` writes them. Rows without any
/// count are passed over. Times may begin anywhere, also with the epoch of Unix, are read to the
/// nanosecond, and do not fall from row to row of one hand; without them there must be a rate, and
/// without hands it is a right one. Errors call the text by `name`: bad_input, with the line and
/// what is wrong there; no_device (no row of that hand).
Result<SampleTable> parse_sample_table(std::string_view text, const std::string& name,
                                       const TableWishes& wishes);
/// Does the same with a file of at most 1 GiB.
Result<SampleTable> read_sample_table(const std::filesystem::path& path, const TableWishes& wishes);

} // namespace nendo::recording
