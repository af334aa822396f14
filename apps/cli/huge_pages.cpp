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

constexpr const char* variable = "GLIBC_TUNABLES";
constexpr const char* tunable = "glibc.malloc.hugetlb";

bool must_be_asked_for() {
  std::string modes; // the one in effect in brackets
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), modes);
  return modes.find("[madvise]") != std::string::npos;
}

void start_again(char** argv) {
  const char* const before = std::getenv(variable);
  const std::string others = before == nullptr ? "" : before;
  if (others.find(tunable) != std::string::npos || !must_be_asked_for()) return;
  // By its own path, and not /proc/self/exe, which would become the process's name.
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string all = (others.empty() ? "" : others + ":") + tunable + "=1";
  ::setenv(variable, all.c_str(), 1);
  ::execv(program.c_str(), argv);
  others.empty() ? ::unsetenv(variable) : ::setenv(variable, others.c_str(), 1);
}

} // namespace

void use_huge_pages(char** argv) noexcept {
  // A program with capabilities of its own starts without that variable, each time.
  if (::getauxval(AT_SECURE) != 0) return;
  try {
    start_again(argv);
  } catch (const std::exception&) { // no /proc, or no memory: the program says so itself
  }
}

} // namespace nendo::cli
