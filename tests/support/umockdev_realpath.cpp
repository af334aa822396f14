// umockdev 0.19 takes the sandbox's folder off whatever realpath() answers, even off a path that
// leads out of the sandbox, as those of emulated ports do, and so destroys memory. libserialport
// 0.1.2 asks for the real path of a port. A port of the sandbox has no better name than its own.

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <dlfcn.h>
#include <unistd.h>

// The name under which fortified libraries, as Debian's are, call realpath(). It is not hidden, so
// that they find it in this program.
extern "C" [[gnu::visibility("default")]] char* __realpath_chk(const char* path, char* resolved,
                                                               std::size_t size);     // NOLINT
extern "C" char* __realpath_chk(const char* path, char* resolved, std::size_t size) { // NOLINT
  using Realpath = char* (*)(const char*, char*, std::size_t);
  const bool in_sandbox =
      std::getenv("UMOCKDEV_DIR") != nullptr && std::string_view(path).starts_with("/dev/");
  if (!in_sandbox) {
    void* const next = ::dlsym(RTLD_NEXT, "__realpath_chk");
    return reinterpret_cast<Realpath>(next)(path, resolved, size);
  }
  if (::access(path, F_OK) != 0) return nullptr;
  return resolved == nullptr ? ::strdup(path) : std::strcpy(resolved, path);
}
