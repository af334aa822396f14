// nendo serve: hands without a model.

#include <cmath>
#include <csignal>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <nendo_publish.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"
#include "support/runtime_folder.hpp"

namespace serve_command_test {

using namespace nendo;
using namespace nendo::test;
using nlohmann::json;

namespace {

/// A mapped segment, read by nendo_publish.h alone.
class Segment {
public:
  explicit Segment(const std::string& name) {
    const UniqueFd file(::open(("/dev/shm/nendo-" + name).c_str(), O_RDONLY | O_CLOEXEC));
    struct stat status{};
    REQUIRE(::fstat(file.get(), &status) == 0);
    bytes_ = static_cast<std::size_t>(status.st_size);
    base_ = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file.get(), 0);
    REQUIRE(base_ != MAP_FAILED);
    REQUIRE(nendo_publish_is_usable(base_, bytes_) == 1);
  }
  ~Segment() { ::munmap(base_, bytes_); }
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  std::uint32_t vertices() const {
    return static_cast<const nendo_publish_header*>(base_)->vertices;
  }
  nendo_publish_record newest() const {
    for (;;) {
      nendo_publish_record record{};
      if (nendo_publish_read(base_, nendo_publish_newest(base_), &record, nullptr, 0) == 1)
        return record;
    }
  }

private:
  void* base_ = nullptr;
  std::size_t bytes_ = 0;
};

} // namespace

TEST_SUITE("serve") {
  TEST_CASE("two gloves become hands in a segment without vertices, tick by tick with samples") {
    const RuntimeFolder runtime;
    const std::string name = "serve-" + std::to_string(::getpid());
    Program serving(
        {"serve", "sim:grasp?hand=left", "sim:pinch?hand=right", "--to", "shm:" + name, "--json"});
    REQUIRE(appears("/dev/shm/nendo-" + name));
    const Segment segment(name);
    CHECK(segment.vertices() == 0);
    const auto first = segment.newest();
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const auto second = segment.newest();
    serving.signal(SIGINT);
    const Finished done = serving.wait();
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    for (const auto& hand : second.hands)
      CHECK((hand.flags & NENDO_PUBLISH_PRESENT) != 0);
    CHECK(second.hands[0].samples > first.hands[0].samples);
    CHECK(second.hands[0].joints[1].position[0] < second.hands[1].joints[1].position[0]);
    const json summary = last_object(done);
    CHECK(summary["event"] == "summary");
    // Each sample of either glove begins a tick, or is taken by the tick of another one.
    const int samples =
        summary["left"]["samples"].get<int>() + summary["right"]["samples"].get<int>();
    CHECK(summary["ticks"].get<int>() <= samples + 20);
    CHECK(summary["ticks"].get<int>() > samples / 3);
    CHECK(summary["published"][0]["records"] == summary["ticks"]);
  }

  TEST_CASE("a tracker moves a served hand") {
    const RuntimeFolder runtime;
    const std::string name = "served-wrist-" + std::to_string(::getpid());
    Program serving(
        {"serve", "sim:rest?hand=right", "--right-wrist", "sim:orbit", "--to", "shm:" + name});
    REQUIRE(appears("/dev/shm/nendo-" + name));
    const Segment segment(name);
    const auto first = segment.newest();
    double path_m = 0.0;
    auto before = first;
    for (int step = 0; step < 20; ++step) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      const auto now = segment.newest();
      const float* const from = before.hands[1].joints[1].position;
      const float* const to = now.hands[1].joints[1].position;
      path_m += static_cast<double>(std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
      before = now;
    }
    serving.signal(SIGINT);
    CHECK(serving.wait().exit_code == 0);
    CHECK(path_m > 0.05);
  }

  TEST_CASE("a glove that is served is a glove of several programs at once") {
    const RuntimeFolder runtime;
    Program serving({"serve", "sim:grasp?hand=left", "sim:pinch?hand=right", "--right-wrist",
                     "sim:orbit", "--name", "lab"});
    REQUIRE(appears(runtime.path() / "nendo" / "lab.sock"));
    Program monitored({"monitor", "serve:lab?hand=left", "--json", "--raw", "--count", "50"});
    const TemporaryFolder folder;
    const Finished run = nendo::test::nendo({"run", "--left", "serve:lab?hand=left", "--right",
                                             "serve:lab?hand=right", "--right-wrist",
                                             "serve:lab?hand=right", "--duration", "1", "--json",
                                             "--out", (folder.path() / "shape.obj").string()});
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    const json summary = last_object(run);
    CHECK(summary["left"]["samples"].get<int>() > 45);
    CHECK(summary["right"]["samples"].get<int>() > 45);
    CHECK(summary["right"]["wrist"]["poses"].get<int>() > 45);
    const Finished seen = monitored.wait();
    CHECK(seen.exit_code == 0);
    CHECK(lines_of(seen.out).size() >= 50);
    const Finished which = nendo::test::nendo({"info", "serve:lab"});
    CHECK(which.exit_code == 2);
    CHECK_MESSAGE(is_one_line_about(which.err, "?hand=left"), which.err);
    const Finished second = nendo::test::nendo({"serve", "sim", "--name", "lab"});
    CHECK(second.exit_code == 1);
    serving.signal(SIGINT);
    CHECK(serving.wait().exit_code == 0);
    const Finished none = nendo::test::nendo({"info", "serve:lab"});
    CHECK(none.exit_code == 3);
    CHECK_MESSAGE(is_one_line_about(none.err, "serve:lab"), none.err);
  }

  TEST_CASE("what serve cannot do is wrong usage, in one line") {
    const RuntimeFolder runtime;
    for (const auto& [arguments, about] :
         {std::pair{std::vector<std::string>{"serve", "sim", "sim", "sim"}, "GLOVE"},
          {{"serve", "sim", "--to", "tcp:9000"}, "--to tcp:9000"},
          {{"serve", "sim", "--policy", "late"}, "late"}}) {
      const Finished done = nendo::test::nendo(arguments);
      CHECK(done.exit_code == 2);
      CHECK_MESSAGE(is_one_line_about(done.err, about), done.err);
    }
  }
}

} // namespace serve_command_test
