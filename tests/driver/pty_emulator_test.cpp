#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>
#include <nendo/driver/emulator.hpp>

using namespace std::chrono_literals;
using nendo::Errc;
using nendo::driver::EmulatorOptions;
using nendo::driver::GloveEmulator;

TEST_SUITE("pty_emulator") {
  namespace {
  namespace fs = std::filesystem;

  class Folder {
  public:
    Folder() {
      std::string name = (fs::temp_directory_path() / "nendo_pty_XXXXXX").string();
      REQUIRE(::mkdtemp(name.data()) != nullptr);
      path_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
      std::error_code error;
      fs::remove_all(path_, error);
    }
    fs::path operator/(std::string_view name) const { return path_ / name; }

  private:
    fs::path path_;
  };

  std::unique_ptr<GloveEmulator> open_emulator(const EmulatorOptions& options = {}) {
    auto emulator = GloveEmulator::open(options);
    REQUIRE(emulator);
    return *std::move(emulator);
  }

  class Service {
  public:
    explicit Service(GloveEmulator& emulator)
        : thread_([this, &emulator] { good_ = static_cast<bool>(emulator.serve(stop_)); }) {}
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;
    ~Service() {
      stop_ = true;
      thread_.join();
      CHECK(good_);
    }

  private:
    std::atomic<bool> stop_{false};
    std::atomic<bool> good_{false};
    std::thread thread_;
  };

  // A host as plain as can be: open, raw mode, read, write.
  class Host {
  public:
    explicit Host(const std::string& path)
        : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {
      REQUIRE(fd_ >= 0);
      termios line{};
      REQUIRE(::tcgetattr(fd_, &line) == 0);
      ::cfmakeraw(&line);
      REQUIRE(::tcsetattr(fd_, TCSANOW, &line) == 0);
    }
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;
    ~Host() { ::close(fd_); }

    void send(std::string_view bytes) {
      REQUIRE(::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    }
    // `size` bytes, or fewer if they do not come within two seconds.
    std::string receive(std::size_t size) {
      std::string bytes;
      const auto deadline = nendo::HostClock::now() + 2s;
      while (bytes.size() < size && nendo::HostClock::now() < deadline) {
        pollfd line{fd_, POLLIN, 0};
        if (::poll(&line, 1, 50) <= 0) continue;
        std::array<char, 4096> part{};
        const ssize_t count = ::read(fd_, part.data(), std::min(part.size(), size - bytes.size()));
        if (count > 0) bytes.append(part.data(), static_cast<std::size_t>(count));
      }
      return bytes;
    }
    // Reads and drops until it has been quiet for a while.
    void drain() {
      for (pollfd line{fd_, POLLIN, 0}; ::poll(&line, 1, 100) > 0;) {
        std::array<char, 4096> part{};
        if (::read(fd_, part.data(), part.size()) <= 0) break;
      }
    }

  private:
    int fd_;
  };

  const std::string sensors_reply("?S\x16\0", 4);
  } // namespace

  TEST_CASE("a host asks, streams a hundred records, goes, and comes back") {
    const Folder folder;
    EmulatorOptions options;
    options.link = folder / "glove";
    options.rate_hz = 400;
    const auto emulator = open_emulator(options);
    CHECK(fs::read_symlink(options.link) == emulator->tty_path());
    const Service service(*emulator);
    {
      Host host(options.link);
      host.send("?S");
      CHECK(host.receive(4) == sensors_reply);
      host.send("S");
      constexpr std::size_t hundred_records = 2400;
      const std::string stream = host.receive(hundred_records);
      REQUIRE(stream.size() == hundred_records);
      for (std::size_t n = 0; n < 100; ++n) {
        REQUIRE(stream[24 * n] == 'S');
        REQUIRE(stream.find('\0', 24 * n) == 24 * n + 23);
      }
    } // gone without a word: the stream goes on
    std::this_thread::sleep_for(100ms);
    for (int round = 0; round < 3; ++round) {
      Host host(options.link);
      host.send("\x03");
      host.drain();
      host.send("?S");
      CHECK(host.receive(4) == sensors_reply);
    }
    const auto stats = emulator->stats();
    CHECK(stats.bytes_received == 12);
    CHECK(stats.records_sent >= 100);
    CHECK(stats.bytes_sent >= 2400 + 4 * 4);
    CHECK(stats.bytes_refused > 0);
  }

  TEST_CASE("without a host it neither spins nor ends") {
    const auto emulator = open_emulator();
    const Service service(*emulator);
    { Host(emulator->tty_path()).send("S"); }
    const std::clock_t before = std::clock();
    std::this_thread::sleep_for(500ms);
    CHECK(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC < 0.25);
    Host host(emulator->tty_path());
    CHECK(host.receive(24).size() == 24);
  }

  TEST_CASE("a host that does not read costs records, and gets whole ones afterwards") {
    EmulatorOptions options;
    options.rate_hz = 480;
    const auto emulator = open_emulator(options);
    const Service service(*emulator);
    Host host(emulator->tty_path());
    host.send("U\1");
    CHECK(host.receive(2) == std::string("U\0", 2));
    host.send("s"); // text: nearly four times as many bytes
    const auto deadline = nendo::HostClock::now() + 20s;
    while (emulator->stats().bytes_refused == 0 && nendo::HostClock::now() < deadline) {
      std::this_thread::sleep_for(10ms);
    }
    CHECK(emulator->stats().bytes_refused > 0);
    const std::string stream = host.receive(40'000);
    std::size_t begin = 0;
    std::size_t records = 0;
    for (std::size_t end = stream.find('\0'); end != std::string::npos;
         end = stream.find('\0', begin)) {
      const std::string record = stream.substr(begin, end - begin);
      REQUIRE(record.substr(0, 2) == "s ");
      REQUIRE(std::count(record.begin(), record.end(), ' ') == 23);
      REQUIRE(record.substr(record.size() - 2) == "\r\n");
      begin = end + 1;
      ++records;
    }
    CHECK(records > 100);
  }

  TEST_CASE("the link goes with the emulator, unless it was pointed elsewhere") {
    const Folder folder;
    EmulatorOptions options;
    options.link = folder / "glove";
    open_emulator(options);
    CHECK_FALSE(fs::is_symlink(fs::symlink_status(options.link)));

    {
      const auto emulator = open_emulator(options);
      fs::remove(options.link);
      fs::create_symlink("/dev/null", options.link);
    }
    CHECK(fs::read_symlink(options.link) == "/dev/null");
  }

  TEST_CASE("an old link is replaced, dangling or not, and nothing is left beside it") {
    const Folder folder;
    EmulatorOptions options;
    options.link = folder / "glove";
    fs::create_symlink("/dev/nendo-was-here", options.link);
    const auto emulator = open_emulator(options);
    CHECK(fs::read_symlink(options.link) == emulator->tty_path());
    CHECK(std::distance(fs::directory_iterator(folder / ""), fs::directory_iterator()) == 1);
  }

  TEST_CASE("it never replaces a file or a folder") {
    const Folder folder;
    EmulatorOptions options;
    options.link = folder / "file";
    std::ofstream(options.link) << "precious";
    const auto over_file = GloveEmulator::open(options);
    REQUIRE_FALSE(over_file);
    CHECK(over_file.error().code == Errc::failed);
    CHECK(over_file.error().message.find("not a link") != std::string::npos);
    CHECK(fs::file_size(options.link) == 8);

    options.link = folder / "";
    CHECK_FALSE(GloveEmulator::open(options));
    options.link = folder / "missing/glove";
    const auto nowhere = GloveEmulator::open(options);
    REQUIRE_FALSE(nowhere);
    CHECK(nowhere.error().message.find("there is no folder") != std::string::npos);
  }

  TEST_CASE("wrong options are usage errors") {
    const auto code = [](const EmulatorOptions& options) {
      const auto emulator = GloveEmulator::open(options);
      REQUIRE_FALSE(emulator);
      return emulator.error().code;
    };
    EmulatorOptions options;
    options.motion = "dance";
    CHECK(code(options) == Errc::usage);
    options = {};
    options.sensors = 20;
    CHECK(code(options) == Errc::usage);
    options = {};
    options.rate_hz = 0.5;
    CHECK(code(options) == Errc::usage);
    options.rate_hz = 481;
    CHECK(code(options) == Errc::usage);
  }
}
