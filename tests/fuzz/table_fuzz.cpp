// Any text is a table or an error in one line; each row has a cell for each column.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/base/table.hpp>

#include "laws.hpp"

namespace {

void read(nendo::TableReader& table) {
  std::size_t line = 0;
  for (;;) {
    const auto any = table.next();
    if (!any) return require_one_line(any.error());
    if (!*any) return;
    require(table.line() > line || line == 0);
    line = table.line();
    for (std::size_t column = 0; column < table.names().size(); ++column) {
      (void)table.is_missing(column);
      (void)table.number(column);
      for (const int digits : {0, 3, 9})
        if (const auto scaled = table.scaled(column, digits, 4e9))
          require(*scaled <= 4'000'000'001'000'000'000 && *scaled >= -4'000'000'001'000'000'000);
      require_one_line(table.bad_cell(column, "is wrong"));
    }
  }
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  nendo::TableReader named(text, "fuzz");
  if (const auto fine = named.read_head("a,b"); fine) {
    for (const std::string& name : named.names())
      require(name == nendo::TableReader::plain(name));
    (void)named.columns_not_read();
    read(named);
  } else {
    require_one_line(fine.error());
  }
  nendo::TableReader bare(text, "fuzz");
  if (const auto fine = bare.begin_without_head(6); fine)
    read(bare);
  else
    require_one_line(fine.error());
  return 0;
}
