#pragma once
// Which extensions an application enables, which of them the runtime has, and the list that goes
// down to it.

#include <array>
#include <cstddef>
#include <cstdint>

#include <openxr/openxr.h>

namespace nendo::openxr {

/// The extensions that the layer offers in its manifest, and the one that it uses.
enum class Extension : std::uint8_t { hand_tracking, motion_range, data_source, timespec };
inline constexpr std::size_t extension_count = 4;

class ExtensionSet {
public:
  bool has(Extension extension) const noexcept { return has_[static_cast<std::size_t>(extension)]; }
  void add(Extension extension) noexcept { has_[static_cast<std::size_t>(extension)] = true; }

private:
  std::array<bool, extension_count> has_{};
};

/// Returns the extensions of the list of an application.
ExtensionSet enabled_by(const XrInstanceCreateInfo& info) noexcept;

/// A structure of an extension.
struct NamedStructure {
  XrStructureType type;
  const char* name;
  Extension extension;
};
/// Returns a structure of the extensions that the layer offers, or null.
const NamedStructure* structure_of(XrStructureType type) noexcept;

/// Asks the runtime for its extensions. Returns false if it does not answer before there is an
/// instance. Allocates.
bool ask_runtime(PFN_xrGetInstanceProcAddr runtime, ExtensionSet& below) noexcept;

/// The structure that goes down: without extensions that only this layer has, and with
/// XR_KHR_convert_timespec_time if the runtime has that and hands are tracked.
class InfoForBelow {
public:
  InfoForBelow() = default;
  ~InfoForBelow() noexcept;
  InfoForBelow(const InfoForBelow&) = delete;
  InfoForBelow& operator=(const InfoForBelow&) = delete;

  /// Allocates. Returns false if there is no memory.
  bool fill(const XrInstanceCreateInfo& info, const ExtensionSet& below) noexcept;
  const XrInstanceCreateInfo& info() const noexcept { return info_; }

private:
  XrInstanceCreateInfo info_{};
  const char** names_ = nullptr;
};

} // namespace nendo::openxr
