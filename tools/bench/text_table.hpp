#pragma once
// Tables of figures as benchmarks print them: for people, or as Markdown.

#include <span>
#include <string>
#include <string_view>

namespace nendo::bench {

/// Prints a row to standard output: what it is about, and its cells, to the right of their columns.
void print_row(std::string_view about, std::span<const std::string> cells, bool markdown);
/// Prints the first row, and in Markdown the line below it.
void print_head(std::string_view about, std::span<const std::string> cells, bool markdown);

} // namespace nendo::bench
