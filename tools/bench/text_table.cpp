#include "bench/text_table.hpp"

#include "cli/print.hpp"

namespace nendo::bench {

void print_row(std::string_view about, std::span<const std::string> cells, bool markdown) {
  cli::print("{}{:16}", markdown ? "| " : "", about);
  for (const std::string& cell : cells)
    cli::print("{}{:>13}", markdown ? " | " : "  ", cell);
  cli::print("{}\n", markdown ? " |" : "");
}

void print_head(std::string_view about, std::span<const std::string> cells, bool markdown) {
  print_row(about, cells, markdown);
  if (!markdown) return;
  std::string rule = "|---|";
  for (std::size_t column = 0; column < cells.size(); ++column)
    rule += "---:|";
  cli::print("{}\n", rule);
}

} // namespace nendo::bench
