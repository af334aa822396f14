// Carries bytes and time between an emulated unit and its pseudo-terminal, and lets the faults
// happen.

#include <nendo/emulator/emulator.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "line/fault.hpp"
#include "line/fault_injector.hpp"
#include "line/traffic_log.hpp"
#include "units/emulated_kinds.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::emulator {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Time = EmulatedUnit::Time;

constexpr HostClock::duration max_wait = 20ms; // between two checks of `stop`

// Max bytes that wait for the terminal beyond the unit's own output, so that writes are large
// enough.
constexpr std::size_t wire_full = 4096;

// Max records between two checks of faults, `stop` and the host, at the host's pace.
constexpr int max_records_per_turn = 256;

// Max wait at the end for a host that reads nothing.
constexpr auto max_last_wait = 300ms;

/// Returns the rate that a terminal's speed stands for; 0 if no emulated unit has it.
unsigned baud_of(speed_t speed) noexcept {
  constexpr std::array<std::pair<speed_t, unsigned>, 7> speeds{{{B2400, 2400},
                                                                {B4800, 4800},
                                                                {B9600, 9600},
                                                                {B19200, 19200},
                                                                {B38400, 38400},
                                                                {B57600, 57600},
                                                                {B115200, 115200}}};
  const auto* const found = std::find_if(speeds.begin(), speeds.end(),
                                         [speed](const auto& s) { return s.first == speed; });
  return found == speeds.end() ? 0 : found->second;
}

/// A symbolic link. The destructor removes it, unless it leads elsewhere by then.
class SymbolicLink {
public:
  /// Makes the link. It replaces an old link in one step, so that a host sees the old target or the
  /// new one, and never replaces anything but a link. Error: failed.
  static Result<SymbolicLink> make(const std::string& where, const std::string& target) {
    const auto failed = [&where](const std::string& why) {
      return Error{Errc::failed, "link " + where + ": cannot make it: " + why};
    };
    std::error_code error;
    const fs::path path = fs::absolute(where, error);
    if (error) return failed(error.message());
    if (!fs::is_directory(path.parent_path(), error)) {
      return failed("there is no folder " + path.parent_path().string());
    }
    const fs::file_status old = fs::symlink_status(path, error);
    if (fs::exists(old) && !fs::is_symlink(old)) {
      return failed(
          "its place is taken by something that is not a link; remove that or choose another path");
    }
    const fs::path temporary = path.string() + "." + std::to_string(::getpid());
    fs::create_symlink(target, temporary, error);
    if (error) return failed(error.message());
    fs::rename(temporary, path, error);
    if (error) {
      const std::string why = error.message();
      fs::remove(temporary, error);
      return failed(why);
    }
    return SymbolicLink(path, target);
  }
  SymbolicLink(SymbolicLink&& other) noexcept
      : path_(std::exchange(other.path_, {})), target_(std::move(other.target_)) {}
  SymbolicLink& operator=(SymbolicLink&&) = delete;
  ~SymbolicLink() {
    if (path_.empty()) return;
    std::error_code error;
    if (fs::read_symlink(path_, error) == target_ && !error) fs::remove(path_, error);
  }

private:
  SymbolicLink(std::filesystem::path path, std::string target)
      : path_(std::move(path)), target_(std::move(target)) {}

  std::filesystem::path path_;
  std::string target_;
};

/// A pseudo-terminal in raw mode at 115200 baud. When this is destroyed, hosts see a hang-up. The
/// link is removed before that, because the system may give the terminal's number to another
/// program at once.
class PseudoTerminal {
public:
  /// Makes the terminal, and the link unless `link`, its path, is empty. Error: failed.
  static Result<PseudoTerminal> make(const std::string& link) {
    const auto failed = [] {
      return Error{Errc::failed,
                   "cannot make a pseudo-terminal: " + std::generic_category().message(errno)};
    };
    PseudoTerminal terminal(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    const int fd = terminal.fd();
    std::array<char, 64> name{};
    termios raw{};
    if (fd < 0 || ::grantpt(fd) != 0 || ::unlockpt(fd) != 0 ||
        ::ptsname_r(fd, name.data(), name.size()) != 0 || ::tcgetattr(fd, &raw) != 0) {
      return failed();
    }
    ::cfmakeraw(&raw);
    ::cfsetspeed(&raw, B115200);
    if (::tcsetattr(fd, TCSANOW, &raw) != 0) return failed();
    // Only a terminal that was opened once makes poll() report that no host has it open.
    const int once = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (once < 0) return failed();
    ::close(once);
    terminal.path_ = name.data();
    if (!link.empty()) {
      auto made = SymbolicLink::make(link, terminal.path_);
      if (!made) return made.error();
      terminal.link_.emplace(*std::move(made));
    }
    return terminal;
  }
  /// Returns the device's end, which is non-blocking. poll() reports POLLHUP as long as no host has
  /// the other end open.
  int fd() const noexcept { return device_.get(); }
  const std::string& path() const noexcept { return path_; } ///< path of the host's end

private:
  explicit PseudoTerminal(int fd) noexcept : device_(fd) {}

  UniqueFd device_;
  std::string path_;
  std::optional<SymbolicLink> link_; ///< last, so that it is removed first
};

struct Parts {
  EmulatorOptions options;
  std::unique_ptr<EmulatedUnit> unit;
  std::vector<Fault> faults;
  TrafficLog log;
  PseudoTerminal terminal;
};

class PtyEmulator final : public DeviceEmulator {
public:
  explicit PtyEmulator(Parts parts)
      : options_(std::move(parts.options)), unit_(std::move(parts.unit)),
        injector_(parts.faults, options_.seed), log_(std::move(parts.log)),
        first_path_(parts.terminal.path()) {
    terminal_.emplace(std::move(parts.terminal));
    for (const Fault& fault : parts.faults) {
      if (std::find(asked_.begin(), asked_.end(), fault.kind) == asked_.end()) {
        asked_.push_back(fault.kind);
      }
    }
    publish();
  }

  const std::string& tty_path() const noexcept override { return first_path_; }

  Result<void> serve(const std::atomic<bool>& stop) override {
    last_turn_ = HostClock::now();
    while (!stop) {
      advance_clock();
      if (auto injected = inject_due_faults(); !injected) return injected;
      run_unit();
      write();
      publish();
      if (auto logged = log_.flush(); !logged) return logged;
      if (auto waited = wait(); !waited) return waited;
    }
    empty_wire();
    publish();
    return {};
  }

  EmulatorStats stats() const override {
    const std::lock_guard lock(stats_mutex_);
    return stats_;
  }

private:
  bool at_hosts_pace() const noexcept { return options_.pace == EmulatorPace::host; }
  bool host_present() const noexcept { return terminal_ && host_present_; }

  // At the host's pace the unit's clock goes from record to record; it follows the host's clock
  // only while nothing is due.
  void advance_clock() {
    const HostTime host_now = HostClock::now();
    if (!at_hosts_pace() || !unit_->next_due()) now_ += host_now - last_turn_;
    last_turn_ = host_now;
  }

  Result<void> inject_due_faults() {
    if (!terminal_ && HostClock::now() >= replugged_at_) {
      auto made = PseudoTerminal::make(options_.link);
      if (!made) return made.error();
      terminal_.emplace(*std::move(made));
      log_.event(now_, "plugged in again");
    }
    while (const auto event = injector_.next_event(now_))
      inject(event->fault, event->over);
    if (junk_waits_ && host_present()) {
      junk_waits_ = false;
      const std::size_t before = wire_.size();
      injector_.pass_junk(wire_);
      log_.sent(now_, "junk", std::span(wire_).subspan(before));
    }
    return {};
  }

  void inject(const Fault& fault, bool over) {
    log_.event(now_, std::string(name_of(fault.kind)) + (over ? " over" : ""));
    if (const auto incident = incident_of(fault, over)) unit_->inject(*incident, now_);
    if (fault.kind == FaultKind::junk) junk_waits_ = true;
    if (fault.kind != FaultKind::unplug) return;
    terminal_.reset();
    host_present_ = false;
    replugged_at_ = HostClock::now() + fault.lasting;
    if (!fault.value.empty()) options_.link = fault.value;
  }

  void run_unit() {
    if (!at_hosts_pace()) {
      unit_->advance(now_);
      collect();
      return;
    }
    collect();
    for (int n = 0; n < max_records_per_turn && host_present() && wire_.size() < wire_full; ++n) {
      const auto due = unit_->next_due();
      if (!due) return;
      now_ = std::max(now_, *due);
      if (injector_.next_due().value_or(Time::max()) <= now_) return; // the fault comes first
      unit_->advance(now_);
      collect();
    }
  }

  // Moves the unit's output to the wire, through the faults. Bytes beyond the wire's capacity wait
  // in the unit, which refuses whole messages when it is full. Without a host the bytes are lost,
  // as on a cable that ends in the air.
  void collect() {
    auto output = unit_->output();
    if (!host_present()) {
      lost_ += output.size() + wire_.size();
      wire_.clear();
      unit_->take(output.size());
      return;
    }
    if (wire_.size() >= wire_full) return;
    const std::size_t bytes = output.size();
    const bool garbled = bytes > 0 && rates_differ();
    for (const UnitMessage& message : unit_->messages()) {
      const std::size_t before = wire_.size();
      injector_.pass(output.first(message.bytes), message.record, now_, wire_);
      output = output.subspan(message.bytes);
      if (wire_.size() == before) continue;
      if (garbled) garble(std::span(wire_).subspan(before));
      log_.sent(now_, message.record ? "record" : "reply", std::span(wire_).subspan(before));
    }
    unit_->take(bytes);
  }

  // Returns whether the host has set its end to another rate than the unit's. Both then see bytes
  // without a stop bit in its place.
  bool rates_differ() const {
    const unsigned baud = unit_->baud();
    termios host{};
    if (baud == 0 || !terminal_ || ::tcgetattr(terminal_->fd(), &host) != 0) return false;
    return baud_of(::cfgetospeed(&host)) != baud;
  }

  void garble(std::span<std::byte> bytes) {
    for (std::byte& byte : bytes)
      byte = static_cast<std::byte>(garbage_() & 0xFFU);
  }

  void write() {
    if (!host_present() || wire_.empty()) return;
    const ssize_t count = ::write(terminal_->fd(), wire_.data(), wire_.size());
    stuck_ = count <= 0;
    if (count <= 0) return;
    sent_ += static_cast<std::uint64_t>(count);
    wire_.erase(wire_.begin(), wire_.begin() + count);
  }

  // Writes the bytes that count as sent, for as long as the host takes any.
  void empty_wire() {
    HostTime until = HostClock::now() + max_last_wait;
    while (host_present() && !wire_.empty() && HostClock::now() < until) {
      const std::uint64_t before = sent_;
      write();
      if (sent_ == before) {
        std::this_thread::sleep_for(1ms);
      } else {
        until = HostClock::now() + max_last_wait;
      }
    }
  }

  // Returns when the unit or a fault has something to do, or `stop` must be checked. A host that
  // writes, or reads waiting bytes, ends the wait earlier.
  HostTime wake_up() const {
    const HostTime latest = HostClock::now() + max_wait;
    if (!terminal_) return std::min(latest, replugged_at_);
    const auto due = unit_->next_due();
    if (at_hosts_pace() && due && host_present()) return wire_.empty() ? last_turn_ : latest;
    const auto next = std::min(at_hosts_pace() ? Time::max() : due.value_or(Time::max()),
                               injector_.next_due().value_or(Time::max()));
    return std::min(latest, last_turn_ + std::min<Time>(next - now_, 1h));
  }

  Result<void> wait() {
    const HostTime until = wake_up();
    if (!terminal_) {
      std::this_thread::sleep_until(until);
      return {};
    }
    const auto left = std::max<Time>(until - HostClock::now(), 0ns);
    const timespec timeout{0, static_cast<long>(std::min<Time>(left, max_wait).count())};
    pollfd line{terminal_->fd(), POLLIN, 0};
    if (!wire_.empty()) line.events |= POLLOUT;
    if (::ppoll(&line, 1, &timeout, nullptr) < 0 && errno != EINTR) {
      return failed("poll");
    }
    if ((line.revents & POLLIN) != 0) {
      host_present_ = true;
      return receive();
    }
    host_present_ = (line.revents & POLLHUP) == 0;
    // While no host has the terminal open, poll() returns at once, and the loop would spin. It
    // would also spin with a terminal that reports space and takes nothing.
    if (!host_present_) {
      std::this_thread::sleep_until(std::max(until, HostClock::now() + 1ms));
    } else if (stuck_ && (line.revents & POLLOUT) != 0) {
      std::this_thread::sleep_for(1ms);
    }
    return {};
  }

  Result<void> receive() {
    std::array<std::byte, 256> buffer;
    const ssize_t count = ::read(terminal_->fd(), buffer.data(), buffer.size());
    if (count > 0) {
      const auto bytes = std::span(buffer).first(static_cast<std::size_t>(count));
      received_ += bytes.size();
      advance_clock();
      log_.received(now_, bytes);
      if (!rates_differ()) unit_->receive(bytes, now_); // else it finds errors of framing only
      return {};
    }
    // EIO: the host has closed the terminal. There will be another.
    if (count == 0 || errno == EAGAIN || errno == EINTR || errno == EIO) return {};
    return failed("read");
  }

  Error failed(const char* what) const {
    return {Errc::failed,
            terminal_->path() + ": " + what + ": " + std::generic_category().message(errno)};
  }

  void publish() {
    const std::lock_guard lock(stats_mutex_);
    stats_.bytes_received = received_;
    stats_.bytes_sent = sent_;
    stats_.records_sent = injector_.records();
    stats_.records_faulted = injector_.records_faulted();
    stats_.bytes_refused = unit_->counters().bytes_refused + lost_;
    stats_.faults.resize(asked_.size());
    for (std::size_t k = 0; k < asked_.size(); ++k) {
      stats_.faults[k].name = name_of(asked_[k]);
      stats_.faults[k].done = injector_.done(asked_[k]);
    }
  }

  EmulatorOptions options_;
  std::unique_ptr<EmulatedUnit> unit_;
  FaultInjector injector_;
  TrafficLog log_;
  std::string first_path_;
  std::optional<PseudoTerminal> terminal_; ///< empty: unplugged
  HostTime replugged_at_{};
  std::vector<FaultKind> asked_;
  FaultInjector::Wire wire_; ///< what the terminal has not taken yet
  std::minstd_rand garbage_; ///< what a host at another rate receives
  Time now_{};               ///< the unit's time
  HostTime last_turn_{};
  bool host_present_ = false;
  bool junk_waits_ = false;
  bool stuck_ = false; ///< the last write took nothing
  std::uint64_t received_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t lost_ = 0; ///< bytes that came out while no host was there
  mutable std::mutex stats_mutex_;
  EmulatorStats stats_;
};

Result<void> check_faults(const EmulatorOptions& options, const EmulatedKind& kind,
                          const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    const std::string name = "fault " + std::string(name_of(fault.kind)) + ": ";
    const auto incident = incident_of(fault, false);
    const bool is_swap = fault.kind == FaultKind::swap && kind.type != DeviceType::glove;
    if (incident && (is_swap || !kind.incidents.has(incident->kind))) {
      return Error{Errc::usage, name + "an emulated " + std::string(kind.name) + " has none"};
    }
    if (fault.kind == FaultKind::unplug && options.link.empty()) {
      return Error{Errc::usage, name + "give a link, or no host finds the new terminal"};
    }
  }
  return {};
}

} // namespace

Result<std::unique_ptr<DeviceEmulator>> DeviceEmulator::open(const EmulatorOptions& options) {
  const auto kind = find_emulated_kind(options.device);
  if (!kind) return kind.error();
  auto faults = parse_faults(options.faults);
  if (!faults) return faults.error();
  if (auto fit = check_faults(options, *kind, *faults); !fit) return fit.error();
  auto unit = kind->make(options);
  if (!unit) return unit.error();
  auto log = options.log.empty() ? Result<TrafficLog>(TrafficLog()) : TrafficLog::open(options.log);
  if (!log) return log.error();
  auto terminal = PseudoTerminal::make(options.link);
  if (!terminal) return terminal.error();
  return std::unique_ptr<DeviceEmulator>(std::make_unique<PtyEmulator>(
      Parts{options, *std::move(unit), *std::move(faults), *std::move(log), *std::move(terminal)}));
}

} // namespace nendo::emulator
