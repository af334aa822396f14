#pragma once
// A folder of its own for the sockets of a test's servers, in place of the user's.

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/temporary_folder.hpp"

namespace nendo::test {

/// Sets XDG_RUNTIME_DIR while it lives. No other thread may read the environment when it begins or
/// ends.
class RuntimeFolder {
public:
  RuntimeFolder() {
    if (const char* const before = std::getenv(variable)) before_ = before;
    ::setenv(variable, folder_.path().c_str(), 1);
  }
  ~RuntimeFolder() {
    if (before_.empty())
      ::unsetenv(variable);
    else
      ::setenv(variable, before_.c_str(), 1);
  }
  RuntimeFolder(const RuntimeFolder&) = delete;
  RuntimeFolder& operator=(const RuntimeFolder&) = delete;

  const std::filesystem::path& path() const { return folder_.path(); }

private:
  static constexpr const char* variable = "XDG_RUNTIME_DIR";
  TemporaryFolder folder_;
  std::string before_;
};

} // namespace nendo::test
