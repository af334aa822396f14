#pragma once
// Runs programs other than nendo by the shell, which check what nendo wrote.

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace nendo::test {

struct Spoken {
  int exit_code = -1;
  std::string out; ///< standard output and standard error
};

inline Spoken shell(const std::string& command) {
  Spoken done;
  FILE* const pipe = ::popen(("{ " + command + "\n} 2>&1").c_str(), "r");
  if (pipe == nullptr) return done;
  std::array<char, 4096> piece{};
  for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;)
    done.out.append(piece.data(), got);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) done.exit_code = WEXITSTATUS(status);
  return done;
}

} // namespace nendo::test
