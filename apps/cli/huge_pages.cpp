#include "cli/huge_pages.hpp"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include <sys/auxv.h>
#include <unistd.h>

namespace nendo::cli {
namespace {

constexpr const char* tunables_variable = "GLIBC_TUNABLES";
constexpr const char* huge_pages_tunable = "glibc.malloc.hugetlb";

bool needs_request() {
  std::string modes; // the one in effect in brackets
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), modes);
  return modes.find("[madvise]") != std::string::npos;
}

void execute_again(char** argv) {
  const char* const before = std::getenv(tunables_variable);
  const std::string others = before == nullptr ? "" : before;
  if (others.find(huge_pages_tunable) != std::string::npos || !needs_request()) return;
  // By its own path, and not /proc/self/exe, which would become the process's name.
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string all = (others.empty() ? "" : others + ":") + huge_pages_tunable + "=1";
  ::setenv(tunables_variable, all.c_str(), 1);
  ::execv(program.c_str(), argv);
  others.empty() ? ::unsetenv(tunables_variable) : ::setenv(tunables_variable, others.c_str(), 1);
}

} // namespace

void use_huge_pages(char** argv) noexcept {
  // A program with capabilities of its own starts without that variable each time.
  if (::getauxval(AT_SECURE) != 0) return;
  try {
    execute_again(argv);
  } catch (const std::exception&) { // no /proc, or no memory: the program says so itself
  }
}

} // namespace nendo::cli
