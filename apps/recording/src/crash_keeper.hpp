#pragma once
// Writes the last minute to a file when the process crashes.

#include <filesystem>

#include <nendo/recording/kept_ring.hpp>

namespace nendo::recording {

/// While this object exists, SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT write `ring` to `path`,
/// unless that file exists already, and then take their default action. Other threads that crash
/// meanwhile wait for at most 30 s. Nothing is written if a stack has overflowed, because the
/// handler has no other stack. The destructor restores the previous handlers. Only one object at a
/// time is active; a second one does nothing.
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
