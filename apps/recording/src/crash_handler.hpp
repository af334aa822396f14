#pragma once
// Writes the last minute to a file when the process crashes.

#include <filesystem>

#include "last_minute.hpp"

namespace nendo::recording {

/// While this object exists, SIGSEGV, SIGBUS, SIGILL, SIGFPE and SIGABRT write `ring` to `path`,
/// unless that file exists already, and then take their default action. Other threads that crash
/// meanwhile wait for at most 30 s. Nothing is written if a stack has overflowed, because the
/// handler has no other stack. The destructor restores the previous handlers. Only one object at a
/// time is active; a second one does nothing.
class CrashHandler {
public:
  CrashHandler(LastMinute& ring, const std::filesystem::path& path);
  ~CrashHandler();
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;

private:
  bool armed_ = false;
};

} // namespace nendo::recording
