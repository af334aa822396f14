#pragma once
// SHA-256 by coreutils, for tests that compute hashes.

#include <string>

#include <doctest/doctest.h>

#include "support/shell.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace nendo::test {

/// Returns 64 hexadecimal digits.
inline std::string sha256(const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "text").string();
  write_file(file, text);
  const Spoken spoken = shell("sha256sum <'" + file + "'");
  REQUIRE(spoken.exit_code == 0);
  return spoken.out.substr(0, 64);
}

} // namespace nendo::test
