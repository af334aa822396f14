// Whatever the text is, parse_control_vectors gives an error or vectors that a solver takes.

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/deform/control_vectors.hpp>

#include "laws.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  const auto vectors = nendo::deform::parse_control_vectors(text, "fuzz");
  if (!vectors) {
    require_one_line(vectors.error(), "");
    return 0;
  }
  require(vectors->starts.cols() > 0 && vectors->starts.cols() == vectors->displacements.cols());
  require(vectors->starts.allFinite() && vectors->displacements.allFinite());
  const auto rows = static_cast<std::size_t>(vectors->starts.cols());
  require(vectors->own.empty() || vectors->own.size() >= rows);
  for (const auto& own : vectors->own)
    require(own.point >= 0 && own.point < vectors->starts.cols());
  if (!vectors->own.empty()) require(nendo::deform::with_common(vectors->own).are_usable());
  return 0;
}
