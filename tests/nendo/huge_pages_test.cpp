// The program's large memory is in huge pages where the kernel gives them to those who ask.

#include <cstdlib>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/eventually.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/text_files.hpp"

namespace huge_pages_test {

using namespace nendo;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What the system reports about a program while it runs.
struct Seen {
  bool asks = false;       ///< for huge pages, at any time
  std::string environment; ///< at the end
  std::string name;        ///< likewise
  bool has(const std::string& tunable) const { return contains(environment, tunable); }
};
Seen look_until_end(const test::Program& program) {
  const std::string process = "/proc/" + std::to_string(program.id());
  Seen seen;
  test::eventually([&] {
    if (contains(test::contents(process + "/stat"), ") Z "))
      return true; // ended, and not waited for
    const std::string environment = test::contents(process + "/environ");
    seen.name = test::contents(process + "/comm");
    if (environment.empty()) return false; // it is being replaced
    seen.asks = seen.asks || contains(environment, "glibc.malloc.hugetlb=1");
    seen.environment = environment;
    return false;
  });
  return seen;
}

/// Sets the variable for programs that are started meanwhile.
class Tunables {
public:
  explicit Tunables(const std::string& text) { set(text); }
  ~Tunables() { set(before_); }
  Tunables(const Tunables&) = delete;
  Tunables& operator=(const Tunables&) = delete;

private:
  static void set(const std::string& text) {
    text.empty() ? ::unsetenv("GLIBC_TUNABLES") : ::setenv("GLIBC_TUNABLES", text.c_str(), 1);
  }
  const std::string before_ = std::getenv("GLIBC_TUNABLES") ? std::getenv("GLIBC_TUNABLES") : "";
};

} // namespace

TEST_SUITE("huge_pages") {
  TEST_CASE(
      "commands without a clock ask for huge pages where that is needed, and keep their name") {
    const bool are_asked_for =
        contains(test::contents("/sys/kernel/mm/transparent_hugepage/enabled"), "[madvise]");
    const test::TemporaryFolder folder;
    const std::string ball = (folder.path() / "ball.obj").string();
    REQUIRE(deform::write_mesh(ball, test::sphere(300, 600, 1.0))); // reading it takes a moment
    const std::string parts = (folder.path() / "part-%d.obj").string();
    const std::vector<std::string> cut{"cut", ball, "--plane", "0,0,0,0,1,0", "--out", parts};
    const std::string out = (folder.path() / "out.obj").string();
    const std::vector<std::string> run{"run", "--left", "sim:sculpt", "--duration",
                                       "0.5", "--out",  out};
    for (const auto& command : {cut, run})
      for (const std::string given :
           {"", "glibc.malloc.check=0", "glibc.malloc.hugetlb=0", "glibc.malloc.hugetlb=2"}) {
        CAPTURE(command.front());
        CAPTURE(given);
        const Tunables tunables(given);
        test::Program program(command);
        const Seen seen = look_until_end(program);
        CHECK(program.wait().exit_code == 0);
        CHECK(seen.asks == (are_asked_for && command == cut && !contains(given, "hugetlb")));
        CHECK(seen.has(given));
        CHECK(seen.name == "nendo\n");
      }
  }
}

} // namespace huge_pages_test
