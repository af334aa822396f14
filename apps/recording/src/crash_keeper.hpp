#pragma once
// When the process dies of a crash, the last minute is written first.

#include <filesystem>

#include <nendo/recording/kept_ring.hpp>

namespace nendo::recording {

/// From construction to destruction SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT have `ring` written
/// to `path`, unless that is there already, and then do what they do by default. Threads that crash
/// meanwhile wait, 30 s at most. A stack that has overflowed has no room for a handler, so that
/// nothing is written then. Whoever handled them before does so again afterwards. One at a time: a
/// second one does nothing.
class CrashKeeper {
public:
  CrashKeeper(KeptRing& ring, const std::filesystem::path& path);
  ~CrashKeeper();
  CrashKeeper(const CrashKeeper&) = delete;
  CrashKeeper& operator=(const CrashKeeper&) = delete;

private:
  bool armed_ = false;
};

} // namespace nendo::recording
