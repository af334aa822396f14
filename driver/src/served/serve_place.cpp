#include <nendo/driver/serve_place.hpp>

#include <cstdlib>

namespace nendo::driver {

ServeFolders serve_folders() {
  ServeFolders folders;
  const char* const runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime == '/') // the standard ignores relative paths
    folders.own = std::string(runtime) + "/nendo";
  return folders;
}

std::string serve_socket(const std::string& folder, std::string_view name) {
  return folder + "/" + std::string(name) + ".sock";
}

} // namespace nendo::driver
