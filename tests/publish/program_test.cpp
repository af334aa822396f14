// nendo run --to, and readers that were written from the document alone.

#include <array>
#include <cstring>
#include <list>
#include <map>
#include <set>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>

#include <nendo/base/endpoint.hpp>

#include "support/program.hpp"
#include "support/shell.hpp"

namespace program_test {

using namespace nendo::test;
using nlohmann::json;

namespace {

std::string name_for(const std::string& what) {
  return "test-" + std::to_string(::getpid()) + "-" + what;
}
std::filesystem::path segment_path(const std::string& name) {
  return "/dev/shm/nendo-" + name;
}

std::vector<std::string> run_of(const TemporaryFolder& folder, const std::string& duration,
                                std::vector<std::string> more) {
  std::vector<std::string> arguments{"run",
                                     "--left",
                                     "sim:sculpt?seed=3",
                                     "--right",
                                     "sim:sculpt?seed=4",
                                     "--mesh",
                                     NENDO_MODELS "/head.obj",
                                     "--duration",
                                     duration,
                                     "--json",
                                     "--out",
                                     (folder.path() / "shape.obj").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

json summary_of(const Finished& done) {
  const auto lines = lines_of(done.out);
  REQUIRE_FALSE(lines.empty());
  return json::parse(lines.back());
}

std::vector<json> objects_in(const std::string& text) {
  std::vector<json> objects;
  for (const auto& line : lines_of(text))
    objects.push_back(json::parse(line));
  return objects;
}

/// The coordinates of an OBJ file's vertices, one after another.
std::vector<double> coordinates_in(const std::string& obj) {
  std::vector<double> numbers;
  for (const auto& line : lines_of(obj)) {
    if (!line.starts_with("v ")) continue;
    std::istringstream words(line.substr(2));
    for (double number = 0.0; words >> number;)
      numbers.push_back(number);
  }
  return numbers;
}

double furthest(const std::vector<double>& one, const std::vector<double>& other) {
  REQUIRE(one.size() == other.size());
  double most = 0.0;
  for (std::size_t at = 0; at < one.size(); ++at)
    most = std::max(most, std::abs(one[at] - other[at]));
  return most;
}

std::uint64_t number_at(const std::string& bytes, std::size_t at) {
  std::uint64_t number = 0;
  REQUIRE(at + sizeof number <= bytes.size());
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

template <class Condition>
bool comes_true(const Condition& condition) {
  for (int turn = 0; turn < 6000; ++turn) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Other programs, by the shell, each with its output in a file of `folder`. Killed at the end.
class Reader {
public:
  Reader(const TemporaryFolder& folder, const std::string& name, const std::string& command)
      : out_(folder.path() / name), id_(::fork()) {
    if (id_ != 0) return;
    const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    ::execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
    ::_exit(127);
  }
  ~Reader() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  void signal(int number) const { ::kill(id_, number); }
  /// Waits until it has mapped this segment; false if it does not within a minute.
  bool attaches_to(const std::string& name) const {
    const auto maps = "/proc/" + std::to_string(id_) + "/maps";
    return comes_true([&] { return contents(maps).find("/nendo-" + name) != std::string::npos; });
  }
  bool says_lines(std::size_t count) const {
    return comes_true([&] { return lines_of(contents(out_)).size() >= count; });
  }
  const std::filesystem::path& out() const { return out_; }
  /// Its exit code; -1 if it does not end within a minute.
  int wait() {
    int status = -1;
    const bool ended = id_ > 0 && comes_true([&] { return ::waitpid(id_, &status, WNOHANG) != 0; });
    if (ended) id_ = 0;
    return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

private:
  std::filesystem::path out_;
  pid_t id_;
};

/// A port of TCP and UDP that was free just now.
std::string free_port() {
  for (int attempt = 0; attempt < 20; ++attempt) {
    nendo::Endpoint endpoint;
    const auto stream = nendo::open_at(endpoint, SOCK_STREAM);
    if (stream && nendo::open_at(endpoint, SOCK_DGRAM)) return std::to_string(endpoint.port);
  }
  FAIL("no port");
  return {};
}

/// Where the index fingertips were in each tick, by number and side.
using Tips = std::map<std::pair<std::uint64_t, std::string>, std::vector<double>>;

} // namespace

TEST_SUITE("publish_program") {
  TEST_CASE("readers in C and Python, of the segment and of OSC, see one and the same run") {
    for (const std::string mode : {"type1", "type2"}) {
      const TemporaryFolder folder;
      const std::string name = name_for(mode);
      const auto port_file = folder.path() / "port";
      Reader osc(folder, "osc", std::string("python3 -u " NENDO_READ_OSC " ") + port_file.string());
      REQUIRE(appears(port_file));
      Program run(
          run_of(folder, "0",
                 {"--mode", mode, "--to", "shm:" + name, "--to", "osc:" + contents(port_file)}));
      REQUIRE(appears(segment_path(name)));
      Reader shape(folder, "shape", "python3 " NENDO_READ_SHAPE " " + name + " --at-end");
      REQUIRE(shape.attaches_to(name));
      Reader hands(folder, "hands", NENDO_READ_HANDS " " + name);
      Reader all(folder, "all", "python3 -u " NENDO_READ_SEGMENT " " + name);
      REQUIRE(all.says_lines(60));
      REQUIRE(hands.says_lines(60));
      REQUIRE(osc.says_lines(60));
      run.signal(SIGINT);
      const Finished done = run.wait(std::chrono::seconds(110));
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const json summary = summary_of(done);
      CHECK(hands.wait() == 0);
      CHECK(shape.wait() == 0);
      const int all_code = all.wait();
      REQUIRE_MESSAGE(all_code == 0, contents(all.out()));
      const int osc_code = osc.wait();
      REQUIRE_MESSAGE(osc_code == 0, contents(osc.out()));
      CHECK_FALSE(std::filesystem::exists(segment_path(name)));

      auto records = objects_in(contents(all.out()));
      const json last = records.back();
      records.pop_back();
      CHECK(last["newest"] == summary["ticks"]);
      CHECK(last["seen"] == records.size());
      REQUIRE_FALSE(records.empty());
      CHECK(records.back()["rest_changes"] == summary["commits"]);
      CHECK(records.back()["mode"] == (mode == "type1" ? 1 : 2));
      const auto& to = summary["published"];
      CHECK(to[0]["target"] == "shm:" + name);
      CHECK(to[0]["records"] == summary["ticks"]);
      CHECK(to[1]["records"] == summary["ticks"]);
      CHECK(to[1]["refused_datagrams"] == 0);

      // One tick is one tick, in each reader.
      Tips tips;
      for (const auto& record : records) {
        tips[{record["number"], "left"}] =
            record["hands"][0]["index_tip"].get<std::vector<double>>();
        tips[{record["number"], "right"}] =
            record["hands"][1]["index_tip"].get<std::vector<double>>();
      }
      std::size_t compared = 0;
      const auto compare = [&](std::uint64_t number, const std::string& side, const json& tip) {
        const auto found = tips.find({number, side});
        if (found == tips.end()) return;
        CHECK(furthest(found->second, tip.get<std::vector<double>>()) < 1e-7);
        ++compared;
      };
      for (const auto& line : objects_in(contents(hands.out())))
        for (const std::string side : {"left", "right"})
          compare(line["number"], side, line[side]);
      CHECK(compared > 0);
      std::set<std::array<float, 3>> sent_tips;
      std::size_t received = 0;
      for (const auto& message : objects_in(contents(osc.out()))) {
        if (message["address"] != "/nendo/right/index/tip") continue;
        ++received;
        sent_tips.insert(message["arguments"].get<std::array<float, 3>>());
      }
      CHECK(received <= to[1]["records"]);
      std::size_t known = 0, right_tips = 0;
      for (const auto& [key, tip] : tips) {
        if (key.second != "right") continue;
        ++right_tips;
        known += sent_tips.count(
            {static_cast<float>(tip[0]), static_cast<float>(tip[1]), static_cast<float>(tip[2])});
      }
      CHECK(known > 9 * right_tips / 10); // the network of this machine may lose some

      // And the shape is the file's; type 2 leaves a little of its last strokes waiting until then.
      const auto written = coordinates_in(contents(folder.path() / "shape.obj"));
      const auto read = coordinates_in(contents(shape.out()));
      const auto rest = last["rest"].get<std::vector<double>>();
      CHECK(furthest(read, last["shape"].get<std::vector<double>>()) < 1e-9);
      CHECK(furthest(rest, coordinates_in(contents(NENDO_MODELS "/head.obj"))) < 1e-5);
      CHECK(furthest(written, rest) > 1e-3);
      if (mode == "type1") CHECK(furthest(read, written) < 1e-5);
      if (mode == "type2") CHECK(furthest(read, written) < 0.5 * furthest(written, rest));
    }
  }

  TEST_CASE(
      "clients of VRPN get the hands of the segment at its rate, also if another one stalls") {
    const TemporaryFolder folder;
    const std::string name = name_for("vrpn");
    const std::string port = free_port();
    Program run(run_of(folder, "0", {"--to", "shm:" + name, "--to", "vrpn:" + port}));
    REQUIRE(appears(segment_path(name)));
    const std::string client = "python3 -u " NENDO_VRPN_CLIENT " " + port;
    Reader stalled(folder, "stalled", client);
    REQUIRE(stalled.says_lines(1));
    stalled.signal(SIGSTOP);
    Reader all(folder, "all", "python3 -u " NENDO_READ_SEGMENT " " + name);
    REQUIRE(all.says_lines(20));
    // 54 messages each tick; the second one asks to be connected to, as VRPN's own client does.
    std::list<Reader> readers;
    for (const std::string how : {"--ping Hand0", "--ask", ""})
      readers.emplace_back(folder, "client" + std::to_string(readers.size()),
                           client + " --messages " + std::to_string(54 * 90) + " " + how);
    for (Reader& reader : readers) {
      const int code = reader.wait();
      REQUIRE_MESSAGE(code == 0, contents(reader.out()));
    }
    // The driver for trackers understands it as well.
    const Finished info =
        nendo::test::nendo({"info", "vrpn:Hand1@127.0.0.1:" + port + "?sensor=1", "--json"});
    CHECK_MESSAGE(info.exit_code == 0, info.err);
    run.signal(SIGINT);
    const Finished done = run.wait(std::chrono::seconds(110));
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const json to = summary_of(done)["published"][1];
    CHECK(to["clients"] == 5);
    CHECK(to["refused_clients"] == 0);
    CHECK(to["records"] == summary_of(done)["ticks"]);
    REQUIRE(all.wait() == 0);
    std::set<std::array<float, 3>> tips; // of both index fingers
    for (const json& record : objects_in(contents(all.out())))
      if (record.contains("hands"))
        for (const json& hand : record["hands"])
          tips.insert(hand["index_tip"].get<std::array<float, 3>>());
    for (const Reader& reader : readers) {
      std::map<std::string, std::vector<double>> times; // of one sensor each
      std::size_t known = 0, seen = 0;
      for (const json& message : objects_in(contents(reader.out()))) {
        if (message["type"] != "vrpn_Tracker Pos_Quat" || message["sensor"] != 10) continue;
        times[message["sender"]].push_back(message["time"]);
        ++seen;
        known += tips.count(message["position"].get<std::array<float, 3>>());
      }
      CHECK(known > 9 * seen / 10);
      for (const std::string hand : {"Hand0", "Hand1"}) {
        const auto& of_hand = times[hand];
        REQUIRE(of_hand.size() >= 80);
        CHECK(std::is_sorted(of_hand.begin(), of_hand.end()));
      }
    }
    CHECK(contents(readers.front().out()).find("pong_message") != std::string::npos);
  }

  TEST_CASE("readers that stop, are killed, or would write, disturb no other") {
    const TemporaryFolder folder;
    const std::string name = name_for("readers");
    Program run(run_of(folder, "0", {"--to", "shm:" + name}));
    REQUIRE(appears(segment_path(name)));
    Reader stalled(folder, "stalled", NENDO_READ_HANDS " " + name);
    Reader killed(folder, "killed", NENDO_READ_HANDS " " + name);
    Reader honest(folder, "honest", "python3 -u " NENDO_READ_SEGMENT " " + name);
    REQUIRE(stalled.says_lines(1));
    REQUIRE(killed.says_lines(1));
    stalled.signal(SIGSTOP);
    killed.signal(SIGKILL);
    // Who may not write cannot; root may, and is not kept out.
    if (::geteuid() != 0) CHECK(::open(segment_path(name).c_str(), O_RDWR | O_CLOEXEC) < 0);
    const int locking = ::open(segment_path(name).c_str(), O_RDONLY | O_CLOEXEC);
    CHECK(locking >= 0);
    CHECK(::flock(locking, LOCK_EX | LOCK_NB) == 0);
    const Finished second = nendo::test::nendo(run_of(folder, "1", {"--to", "shm:" + name}));
    CHECK(second.exit_code == 1);
    CHECK(is_one_line_about(second.err.substr(second.err.rfind("nendo: ")), "another run"));
    REQUIRE(honest.says_lines(30)); // all the while
    run.signal(SIGINT);
    const Finished done = run.wait(std::chrono::seconds(110));
    ::close(locking);
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const json summary = summary_of(done);
    CHECK(summary["published"][0]["records"] == summary["ticks"]);
    const int honest_code = honest.wait();
    REQUIRE_MESSAGE(honest_code == 0, contents(honest.out()));
    CHECK(objects_in(contents(honest.out())).back()["newest"] == summary["ticks"]);
    CHECK_FALSE(std::filesystem::exists(segment_path(name)));
  }

  TEST_CASE("a run that is killed ends its readers, and what it left is taken over by the next") {
    const TemporaryFolder folder;
    const std::string name = name_for("killed");
    Program run(run_of(folder, "0", {"--to", "shm:" + name}));
    REQUIRE(appears(segment_path(name)));
    Reader shape(folder, "shape", "python3 " NENDO_READ_SHAPE " " + name + " --at-end");
    REQUIRE(shape.attaches_to(name));
    Reader hands(folder, "hands", NENDO_READ_HANDS " " + name);
    REQUIRE(hands.says_lines(30));
    run.signal(SIGKILL);
    CHECK(run.wait().exit_code == 128 + SIGKILL);
    CHECK(hands.wait() == 0);
    CHECK(shape.wait() == 0);
    CHECK(coordinates_in(contents(shape.out())).size() ==
          coordinates_in(contents(NENDO_MODELS "/head.obj")).size());
    // With the setup of a loop made again, of which there is no tick yet, the same shape is none.
    std::string reopened = contents(segment_path(name));
    const auto setup = number_at(reopened, 48);
    for (const std::uint64_t at : {setup, setup + 8}) { // stage, 2 g + 2, and generation g
      const std::uint64_t next = number_at(reopened, at) + (at == setup ? 2 : 1);
      std::memcpy(reopened.data() + at, &next, sizeof next);
    }
    write_file(segment_path(name + "-reopened"), reopened);
    Reader reader(folder, "reopened", "python3 " NENDO_READ_SHAPE " " + name + "-reopened");
    CHECK(reader.wait() == 1);
    CHECK(contents(reader.out()) == "the run ended without a whole shape\n");
    std::filesystem::remove(segment_path(name + "-reopened"));

    CHECK(std::filesystem::exists(segment_path(name)));
    const Finished next = nendo::test::nendo(run_of(folder, "0.5", {"--to", "shm:" + name}));
    CHECK_MESSAGE(next.exit_code == 0, next.err);
    CHECK_FALSE(std::filesystem::exists(segment_path(name)));
  }

  TEST_CASE("wrong targets are wrong usage, before any glove is opened") {
    const TemporaryFolder folder;
    for (const std::string target : {"", "shm:a/b", "osc:example.org:9000", "udp:9000", "tcp:1"}) {
      const Finished done = nendo::test::nendo(run_of(folder, "1", {"--to", target}));
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, "--to"));
    }
    for (const std::string other :
         {"shm:run", "shm", "shm?group=0"}) { // one place, however it is written
      const Finished twice =
          nendo::test::nendo(run_of(folder, "1", {"--to", "shm:run", "--to", other}));
      CHECK(twice.exit_code == 2);
      CHECK(is_one_line_about(twice.err, "--to " + other + ": "));
    }
    CHECK_FALSE(std::filesystem::exists(folder.path() / "shape.obj"));
  }

  TEST_CASE("an address to which there is no way is an error that says so") {
    const TemporaryFolder folder;
    const Finished done =
        nendo::test::nendo(run_of(folder, "1", {"--to", "osc:255.255.255.255:9000"}));
    CHECK(done.exit_code != 0);
    CHECK(done.exit_code != 2);
    CHECK(is_one_line_about(done.err.substr(done.err.rfind("nendo: ")),
                            "osc:255.255.255.255:9000: no way to that address: "));
  }
}

} // namespace program_test
