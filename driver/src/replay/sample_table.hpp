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

namespace nendo::driver {

struct SampleTable {
  GloveInfo info; ///< what the columns and the times tell
  std::vector<GloveSample> samples;
};

/// What the user says of a table.
struct TableWishes {
  std::optional<Side> hand{};      ///< only rows of that hand
  std::optional<Side> side{};      ///< that, if there are some
  std::optional<double> rate_hz{}; ///< of a table without times
};

/// Columns are parted by commas, semicolons or tabs, and cells may stand in quotes. They are:
/// SENSOR_count or SENSOR, for any of sensor_names, counts from 0 to 65535, rounded, an empty cell
/// being none; time_s; hand, left or right; sequence. Others are passed over, as are rows without
/// any count. Times may begin anywhere, and do not fall; without them there must be a rate, and
/// without hands it is a right one. Errors call the text by `name`: bad_input, with the line and
/// what is wrong there; no_device (no row of that hand).
Result<SampleTable> parse_sample_table(std::string_view text, const std::string& name,
                                       const TableWishes& wishes);
/// Does the same with a file of at most 1 GiB.
Result<SampleTable> read_sample_table(const std::filesystem::path& path, const TableWishes& wishes);

} // namespace nendo::driver
