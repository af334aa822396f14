#include "bench/text_table.hpp"

#include <cstdio>

namespace nendo::bench {

void print_row(std::string_view about, std::span<const std::string> cells, bool markdown) {
  std::printf("%s%-16s", markdown ? "| " : "", std::string(about).c_str());
  for (const std::string& cell : cells)
    std::printf("%s%13s", markdown ? " | " : "  ", cell.c_str());
  std::puts(markdown ? " |" : "");
}

void print_head(std::string_view about, std::span<const std::string> cells, bool markdown) {
  print_row(about, cells, markdown);
  if (!markdown) return;
  std::string rule = "|---|";
  for (std::size_t column = 0; column < cells.size(); ++column)
    rule += "---:|";
  std::puts(rule.c_str());
}

} // namespace nendo::bench
