#pragma once
// Files of tests/driver/captures/, with the bytes that a device sends and what is to be read from
// them.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace nendo::test {

inline std::string read_capture(const std::string& name) {
  const auto path = std::filesystem::path(NENDO_CAPTURES) / name;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace nendo::test
