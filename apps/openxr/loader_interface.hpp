#pragma once
// What OpenXR's loader and an API layer pass to each other, by the chapter on loaders of OpenXR's
// registry (xr.xml). Khronos' header openxr_loader_negotiation.h came after the version 1.0.20 of
// Debian 12, so these are declared here. Also the structures of XR_EXT_hand_tracking_data_source,
// which is also newer.

#include <cstddef>
#include <cstdint>

#include <openxr/openxr.h>

namespace nendo::openxr {

/// The first three members of each structure, with these values.
enum class LoaderStructure : std::uint32_t {
  loader_info = 1,
  layer_request = 2,
  create_info = 4,
  next_info = 5
};
inline constexpr std::uint32_t loader_structure_version = 1;
inline constexpr std::uint32_t layer_interface_version = 1;

struct LoaderInfo {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t min_interface_version;
  std::uint32_t max_interface_version;
  XrVersion min_api_version;
  XrVersion max_api_version;
};

struct CreateInfo;
using CreateApiLayerInstance = XrResult(XRAPI_PTR*)(const XrInstanceCreateInfo* info,
                                                    const CreateInfo* layer_info,
                                                    XrInstance* instance);

struct LayerRequest { ///< the layer fills in what follows the size
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get_instance_proc_addr;
  CreateApiLayerInstance create_api_layer_instance;
};

/// The functions of the next layer, or of the loader's end of the chain, which calls the runtime.
struct NextInfo {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  char layer_name[XR_MAX_API_LAYER_NAME_SIZE]; ///< the layer that gets this structure
  PFN_xrGetInstanceProcAddr next_get_instance_proc_addr;
  CreateApiLayerInstance next_create_api_layer_instance;
  NextInfo* next; ///< what the next layer gets
};

struct CreateInfo {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  void* loader_instance;
  char settings_file_location[512];
  NextInfo* next_info;
};

inline constexpr const char* data_source_extension = "XR_EXT_hand_tracking_data_source";
inline constexpr auto data_source_info_type = static_cast<XrStructureType>(1'000'428'000);
inline constexpr auto data_source_state_type = static_cast<XrStructureType>(1'000'428'001);
enum class DataSource : std::int32_t { unobstructed = 1, controller = 2 };

/// In the chain of XrHandTrackerCreateInfoEXT.
struct DataSourceInfo {
  XrStructureType type;
  const void* next;
  std::uint32_t count;
  DataSource* sources; ///< those that the application wants
};

/// In the chain of XrHandJointLocationsEXT.
struct DataSourceState {
  XrStructureType type;
  void* next;
  XrBool32 is_active;
  DataSource source;
};

} // namespace nendo::openxr
