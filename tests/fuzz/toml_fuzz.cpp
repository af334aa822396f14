// Whatever text find_toml_fault() lets pass, toml++ reads or refuses without a failed assertion and
// without undefined behaviour. toml++ is compiled into this program, with its assertions and under
// the sanitizers, which Debian's library is not.

#include <cstdint>
#include <string>
#include <string_view>

#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

#include <nendo/base/plain_toml.hpp>
#include <nendo/base/text.hpp>

#include "laws.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  if (const auto fault = nendo::find_toml_fault(text)) {
    require(fault->line >= 1 && !fault->what.empty());
    require(nendo::printable(fault->what) == fault->what);
    return 0;
  }
  try {
    const toml::table root = toml::parse(text, std::string_view("fuzz"));
    require(root.size() <= size);
  } catch (const toml::parse_error& error) {
    require(!error.description().empty());
  }
  return 0;
}
