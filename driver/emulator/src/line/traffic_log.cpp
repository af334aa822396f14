#include "line/traffic_log.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>

namespace nendo::emulator {
namespace {

Error cannot_write(const std::string& path) {
  return {Errc::failed, "log " + path + ": cannot write it: " +
                            std::generic_category().message(errno != 0 ? errno : EIO)};
}

} // namespace

Result<TrafficLog> TrafficLog::open(const std::string& path) {
  TrafficLog log;
  errno = 0;
  log.file_.open(path, std::ios::trunc);
  if (!log.file_) return cannot_write(path);
  log.path_ = path;
  return log;
}

void TrafficLog::received(Time now, std::span<const std::byte> bytes) {
  if (!*this) return;
  begin(now, '<');
  end(bytes);
}

void TrafficLog::sent(Time now, std::string_view kind, std::span<const std::byte> bytes) {
  if (!*this) return;
  begin(now, '>');
  line_.append(" ").append(kind);
  end(bytes);
}

void TrafficLog::event(Time now, std::string_view what) {
  if (!*this) return;
  begin(now, '!');
  file_ << line_ << ' ' << what << '\n';
}

void TrafficLog::begin(Time now, char direction) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.6f %c", std::chrono::duration<double>(now).count(),
                direction);
  line_ = text.data();
  fresh_ = true;
}

void TrafficLog::end(std::span<const std::byte> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  for (const std::byte byte : bytes) {
    const auto value = std::to_integer<unsigned>(byte);
    line_.append({' ', digits[value >> 4U], digits[value & 15U]});
  }
  line_ += " |";
  for (const std::byte byte : bytes) {
    const char c = static_cast<char>(byte);
    line_ += c >= ' ' && c <= '~' ? c : '.';
  }
  file_ << line_ << "|\n";
}

Result<void> TrafficLog::flush() {
  if (!fresh_) return {};
  fresh_ = false;
  errno = 0;
  if (!file_.flush()) return cannot_write(path_);
  return {};
}

} // namespace nendo::emulator
