// The checks of nendo-openxr: whether OpenXR's loader finds the manifest of the layer, and can load
// it. The folders are those of the loader's documentation.

#include "doctor/doctor.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

#include <dlfcn.h>

#include <nlohmann/json.hpp>

#include <nendo/base/shared_name.hpp>
#include <nendo/base/text.hpp>

namespace nendo::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view layer_name = "XR_APILAYER_NENDO_hand_tracking";
constexpr const char* negotiation = "xrNegotiateLoaderApiLayerInterface";

std::string variable(const char* name, const std::string& otherwise) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

/// Returns the folders in which the loader looks for layers that need not be named, with those of
/// the user first.
std::vector<fs::path> loader_folders() {
  std::istringstream all(variable("XDG_DATA_HOME", variable("HOME", "") + "/.local/share") + ":" +
                         variable("XDG_CONFIG_DIRS", "/etc/xdg") +
                         ":/etc:" + variable("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
  std::vector<fs::path> folders;
  for (std::string folder; std::getline(all, folder, ':');)
    if (!folder.empty()) folders.push_back(fs::path(folder) / "openxr/1/api_layers/implicit.d");
  return folders;
}

/// Returns a string of a JSON object, or an empty one.
std::string text_of(const nlohmann::json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Returns what is wrong with a library, or an empty string.
std::string load_error(const fs::path& library) {
  void* const loaded = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded == nullptr) return ::dlerror();
  const bool negotiates = ::dlsym(loaded, negotiation) != nullptr;
  ::dlclose(loaded);
  return negotiates ? "" : library.string() + ": has no function " + negotiation;
}

/// Reads a manifest, if it is that of Nendo's layer.
std::optional<LayerManifest> read_manifest(const fs::path& path) {
  constexpr std::size_t max_bytes = 65'536;
  std::string text(max_bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    if (path.filename().string().find("nendo") == std::string::npos) return std::nullopt;
    return LayerManifest{path, "is not JSON"};
  }
  const auto layer = json.is_object() ? json.find("api_layer") : json.end();
  if (layer == json.end() || text_of(*layer, "name") != layer_name) return std::nullopt;
  // A name without a folder is one in the system's search path.
  fs::path library = text_of(*layer, "library_path");
  if (library.has_parent_path()) library = path.parent_path() / library;
  if (library.empty()) return LayerManifest{path, "names no library"};
  return LayerManifest{path, load_error(library)};
}

} // namespace

OpenXrFacts read_openxr(const std::vector<fs::path>& folders) {
  OpenXrFacts facts;
  for (const fs::path& folder : folders) {
    std::vector<fs::path> files;
    std::error_code failed;
    for (fs::directory_iterator file(folder, failed), end; !failed && file != end;
         file.increment(failed))
      if (file->path().extension() == ".json" && file->is_regular_file(failed))
        files.push_back(file->path());
    std::sort(files.begin(), files.end());
    for (const fs::path& path : files)
      if (auto manifest = read_manifest(path)) facts.manifests.push_back(*std::move(manifest));
  }
  if (const char* const name = std::getenv("NENDO_XR")) facts.segment = name;
  facts.is_disabled = std::getenv("DISABLE_NENDO_XR") != nullptr;
  return facts;
}

std::vector<Finding> diagnose_openxr(const OpenXrFacts& facts) {
  std::vector<Finding> found;
  const std::string reinstall = "install the package nendo-openxr again";
  for (const LayerManifest& manifest : facts.manifests)
    if (!manifest.problem.empty())
      found.push_back({Severity::failure, "openxr", manifest.path.string(),
                       "OpenXR's loader cannot load the layer: " + printable(manifest.problem),
                       reinstall});
  if (!facts.segment) return found; // this shell starts no application with gloves
  const auto warn = [&found](const std::string& what, const std::string& remedy) {
    found.push_back({Severity::warning, "openxr", "NENDO_XR", what, remedy});
  };
  if (facts.manifests.empty())
    warn("is set, but OpenXR's loader finds no layer of Nendo", "install the package nendo-openxr");
  if (facts.is_disabled)
    warn("is set, but DISABLE_NENDO_XR disables the layer", "unset DISABLE_NENDO_XR");
  if (!is_shared_name(*facts.segment))
    warn("is no name of a segment, so applications get no hands",
         "give it the NAME of `nendo run --to shm:NAME`; " + std::string(shared_name_rule));
  return found;
}

Examination check_openxr() {
  const OpenXrFacts facts = read_openxr(loader_folders());
  return {diagnose_openxr(facts),
          {facts.manifests.empty() ? "layer of OpenXR (none)" : "layer of OpenXR"}};
}

} // namespace nendo::doctor
