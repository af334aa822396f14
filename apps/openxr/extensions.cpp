#include "openxr/extensions.hpp"

#include <cstdlib>
#include <cstring>
#include <optional>

#include "openxr/loader_interface.hpp"

namespace nendo::openxr {
namespace {

constexpr std::array<const char*, extension_count> names{
    XR_EXT_HAND_TRACKING_EXTENSION_NAME, XR_EXT_HAND_JOINTS_MOTION_RANGE_EXTENSION_NAME,
    data_source_extension, "XR_KHR_convert_timespec_time"};

#define NENDO_NAMED(type) type, #type
constexpr std::array structures{
    NamedStructure{NENDO_NAMED(XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT),
                   Extension::hand_tracking},
    NamedStructure{NENDO_NAMED(XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT), Extension::hand_tracking},
    NamedStructure{NENDO_NAMED(XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT), Extension::hand_tracking},
    NamedStructure{NENDO_NAMED(XR_TYPE_HAND_JOINT_LOCATIONS_EXT), Extension::hand_tracking},
    NamedStructure{NENDO_NAMED(XR_TYPE_HAND_JOINT_VELOCITIES_EXT), Extension::hand_tracking},
    NamedStructure{NENDO_NAMED(XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT), Extension::motion_range},
    NamedStructure{data_source_info_type, "XR_TYPE_HAND_TRACKING_DATA_SOURCE_INFO_EXT",
                   Extension::data_source},
    NamedStructure{data_source_state_type, "XR_TYPE_HAND_TRACKING_DATA_SOURCE_STATE_EXT",
                   Extension::data_source}};
#undef NENDO_NAMED

std::optional<Extension> extension_named(const char* name) noexcept {
  for (std::size_t n = 0; n < extension_count; ++n)
    if (std::strcmp(name, names[n]) == 0) return static_cast<Extension>(n);
  return std::nullopt;
}

} // namespace

ExtensionSet enabled_by(const XrInstanceCreateInfo& info) noexcept {
  ExtensionSet enabled;
  for (std::uint32_t n = 0; n < info.enabledExtensionCount; ++n)
    if (const auto extension = extension_named(info.enabledExtensionNames[n]))
      enabled.add(*extension);
  return enabled;
}

const NamedStructure* structure_of(XrStructureType type) noexcept {
  for (const NamedStructure& structure : structures)
    if (structure.type == type) return &structure;
  return nullptr;
}

bool ask_runtime(PFN_xrGetInstanceProcAddr runtime, ExtensionSet& below) noexcept {
  PFN_xrVoidFunction function = nullptr;
  if (XR_FAILED(runtime(XR_NULL_HANDLE, "xrEnumerateInstanceExtensionProperties", &function)) ||
      function == nullptr)
    return false;
  const auto enumerate = reinterpret_cast<PFN_xrEnumerateInstanceExtensionProperties>(function);
  std::uint32_t count = 0;
  if (XR_FAILED(enumerate(nullptr, 0, &count, nullptr))) return false;
  auto* const properties = static_cast<XrExtensionProperties*>(
      std::calloc(count + std::size_t{1}, sizeof(XrExtensionProperties)));
  if (properties == nullptr) return false;
  for (std::uint32_t n = 0; n < count; ++n)
    properties[n].type = XR_TYPE_EXTENSION_PROPERTIES;
  const bool is_answered = XR_SUCCEEDED(enumerate(nullptr, count, &count, properties));
  for (std::uint32_t n = 0; is_answered && n < count; ++n)
    if (const auto extension = extension_named(properties[n].extensionName)) below.add(*extension);
  std::free(properties);
  return is_answered;
}

InfoForBelow::~InfoForBelow() noexcept {
  std::free(names_);
}

bool InfoForBelow::fill(const XrInstanceCreateInfo& info, const ExtensionSet& below) noexcept {
  info_ = info;
  std::free(names_);
  names_ = static_cast<const char**>(
      std::calloc(info.enabledExtensionCount + std::size_t{1}, sizeof(const char*)));
  if (names_ == nullptr) return false;
  const ExtensionSet enabled = enabled_by(info);
  std::uint32_t count = 0;
  for (std::uint32_t n = 0; n < info.enabledExtensionCount; ++n) {
    const char* const name = info.enabledExtensionNames[n];
    const auto extension = extension_named(name);
    if (!extension || *extension == Extension::timespec || below.has(*extension))
      names_[count++] = name;
  }
  if (enabled.has(Extension::hand_tracking) && below.has(Extension::timespec) &&
      !enabled.has(Extension::timespec))
    names_[count++] = names[static_cast<std::size_t>(Extension::timespec)];
  info_.enabledExtensionCount = count;
  info_.enabledExtensionNames = names_;
  return true;
}

} // namespace nendo::openxr
