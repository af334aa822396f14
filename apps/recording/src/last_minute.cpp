#include "last_minute.hpp"

#include <array>
#include <atomic>
#include <bit>
#include <climits>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <poll.h>
#include <signal.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <nendo/base/crc32c.hpp>
#include <nendo/base/files.hpp>
#include <nendo/recording/chunk_file.hpp>
#include <nendo/recording/sample_record.hpp>

namespace nendo::recording {
namespace {

// Each payload takes a slot. With payloads of a quarter of a second the slots last 17 minutes.
constexpr std::size_t slot_count = 4096;

static_assert(std::atomic<std::uint64_t>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free); // or a signal handler must not touch them
static_assert(std::endian::native == std::endian::little); // numbers are copied into chunks

bool write_chunk(int fd, std::uint32_t number, std::span<const std::byte> payload,
                 std::uint32_t crc) noexcept {
  return write_all(fd, chunk_header(log_chunk, number, payload)) && write_all(fd, payload) &&
         write_all(fd, std::as_bytes(std::span(&crc, 1)));
}

} // namespace

LastMinute::LastMinute(std::vector<std::byte> setup, std::uint32_t setup_chunks,
                       HostClock::duration span, std::size_t bytes)
    : setup_(std::move(setup)), setup_chunks_(setup_chunks), span_(span), memory_(bytes),
      slots_(slot_count) {}

LastMinute::~LastMinute() {
  for (Lasting* at = lasting_.load(); at != nullptr;)
    delete std::exchange(at, at->next.load());
}

void LastMinute::add_chunk(ChunkType type, std::span<const std::byte> payload) {
  auto added = std::make_unique<Lasting>();
  append_chunk(added->bytes, type, setup_chunks_ + lasting_count_, payload);
  ++lasting_count_;
  std::atomic<Lasting*>* end = &lasting_;
  while (Lasting* const there = end->load())
    end = &there->next;
  end->store(added.release(), std::memory_order_release);
}

void LastMinute::drop_oldest() noexcept {
  const std::uint64_t oldest = oldest_.load(std::memory_order_relaxed);
  dropped_.store(dropped_.load(std::memory_order_relaxed) + slot(oldest).entries,
                 std::memory_order_relaxed);
  oldest_.store(oldest + 1, std::memory_order_release);
}

/// Drops the payloads that lie in the way of so many bytes, and returns where these may go.
std::size_t LastMinute::place_for(std::size_t bytes) noexcept {
  const std::size_t begin = next_offset_ + bytes <= memory_.size() ? next_offset_ : 0;
  const auto is_in_the_way = [&](const Slot& there) {
    // When writing continues at the front, the payloads at the end are the oldest.
    const bool passed = begin < next_offset_ && there.offset >= next_offset_;
    return passed || (there.offset < begin + bytes && begin < there.offset + there.bytes);
  };
  while (oldest_.load(std::memory_order_relaxed) != end_.load(std::memory_order_relaxed) &&
         is_in_the_way(slot(oldest_.load(std::memory_order_relaxed))))
    drop_oldest();
  return begin;
}

void LastMinute::push(std::span<const std::byte> payload, std::uint64_t entries,
                      HostTime time) noexcept {
  pushing_.store(true); // in one order with freeze()
  if (!frozen_.load()) {
    const std::uint64_t end = end_.load(std::memory_order_relaxed);
    const auto oldest = [&] { return oldest_.load(std::memory_order_relaxed); };
    while (oldest() != end &&
           (time - slot(oldest()).time > span_ || end - oldest() == slots_.size()))
      drop_oldest();
    if (payload.size() > memory_.size() / 8) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + entries, std::memory_order_relaxed);
    } else {
      const std::size_t offset = place_for(payload.size());
      std::memcpy(memory_.data() + offset, payload.data(), payload.size());
      slots_[end % slots_.size()] = {offset, payload.size(), crc32c(payload), entries, time};
      next_offset_ = offset + payload.size();
      end_.store(end + 1, std::memory_order_release);
    }
  }
  pushing_.store(false);
}

void LastMinute::freeze() noexcept {
  constexpr int max_milliseconds = 100;
  frozen_.store(true);
  for (int waited = 0; pushing_.load() && waited < max_milliseconds; ++waited)
    ::poll(nullptr, 0, 1);
}

bool LastMinute::write(int fd) const noexcept {
  if (!write_all(fd, setup_)) return false;
  std::uint32_t number = setup_chunks_;
  for (const Lasting* at = lasting_.load(std::memory_order_acquire); at != nullptr;
       at = at->next.load(std::memory_order_acquire), ++number)
    if (!write_all(fd, at->bytes)) return false;
  const std::uint64_t dropped = dropped_.load(std::memory_order_acquire);
  if (dropped > 0) {
    std::array<std::byte, 10> gap{}; // an entry's head, and how many entries
    gap[0] = static_cast<std::byte>(EntryKind::gap);
    gap[1] = std::byte{8};
    std::memcpy(gap.data() + 2, &dropped, sizeof dropped);
    if (!write_chunk(fd, number++, gap, crc32c(gap))) return false;
  }
  const std::uint64_t end = end_.load(std::memory_order_acquire);
  // What is left out keeps its number, by which a reader knows that it is missing.
  for (std::uint64_t at = oldest_.load(std::memory_order_acquire); at != end; ++at, ++number) {
    const Slot& kept = slot(at);
    if (kept.bytes > memory_.size() || kept.offset > memory_.size() - kept.bytes) continue;
    const auto payload = std::span(memory_).subspan(kept.offset, kept.bytes);
    if (crc32c(payload) != kept.crc) continue; // its thread died in the middle of it
    if (!write_chunk(fd, number, payload, kept.crc)) return false;
  }
  return true;
}

namespace {

constexpr std::array<int, 5> crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

// A signal handler sees nothing but what has static storage.
std::atomic<LastMinute*> kept{nullptr};
std::array<char, PATH_MAX> kept_path{};
std::array<struct sigaction, crashes.size()> before{};
std::atomic<pid_t> writer{0}; // the thread that writes it now
static_assert(std::atomic<LastMinute*>::is_always_lock_free &&
              std::atomic<pid_t>::is_always_lock_free);

void say(std::string_view text) noexcept {
  write_all(STDERR_FILENO, std::as_bytes(std::span(text)));
}

// From here on only calls that signal-safety(7) lists, and gettid(), which is no more than a system
// call.

void write_last_minute(LastMinute& ring) noexcept {
  ring.freeze();
  const int fd = ::open(kept_path.data(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const bool written = fd >= 0 && ring.write(fd) && ::fsync(fd) == 0;
  say(written ? "nendo: crashed; its last recorded input is in "
              : "nendo: crashed; its last recorded input could not be written to ");
  say(std::string_view(kept_path.data(), ::strlen(kept_path.data())));
  say("\n");
  if (fd >= 0) ::close(fd);
}

// A slow card takes ten seconds for a full ring; a disk that does not answer is no reason to never
// die.
void wait_for_writer() noexcept {
  constexpr int max_milliseconds = 30'000;
  for (int waited = 0; writer.load() != 0 && waited < max_milliseconds; ++waited)
    ::poll(nullptr, 0, 1);
}

extern "C" void on_crash(int signal) {
  // Whichever thread comes first writes; one that crashes meanwhile must not end the process under
  // it. A crash in here finds nothing to do.
  const pid_t self = ::gettid();
  pid_t other = 0;
  if (writer.compare_exchange_strong(other, self)) {
    if (LastMinute* const ring = kept.exchange(nullptr)) write_last_minute(*ring);
    writer.store(0);
  } else if (other != self) {
    wait_for_writer();
  }
  // The default action takes place when this returns.
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

} // namespace

CrashHandler::CrashHandler(LastMinute& ring, const std::filesystem::path& path) {
  const std::string& name = path.native();
  if (kept.load() != nullptr || name.size() >= kept_path.size()) return;
  std::memcpy(kept_path.data(), name.c_str(), name.size() + 1);
  kept.store(&ring);
  armed_ = true;
  struct sigaction action{};
  action.sa_handler = on_crash;
  // Not SA_RESETHAND: a second thread that crashes in the same way would end the process at once.
  sigemptyset(&action.sa_mask);
  for (std::size_t at = 0; at < crashes.size(); ++at)
    ::sigaction(crashes[at], &action, &before[at]);
}

CrashHandler::~CrashHandler() {
  if (!armed_) return;
  for (std::size_t at = 0; at < crashes.size(); ++at)
    ::sigaction(crashes[at], &before[at], nullptr);
  kept.store(nullptr);
}

} // namespace nendo::recording
