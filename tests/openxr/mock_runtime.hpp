#pragma once
// What a test asks of the mock runtime, and what that notes. The runtime is a library that OpenXR's
// loader loads; the test gets this by loading the same file.

#include <cstdint>

#include <openxr/openxr.h>

namespace nendo::test {

/// A space moves about its place in the world: on a circle about the vertical, and turning.
struct MockMotion {
  XrPosef place{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}};
  double radius_m = 0.0;
  double turns_per_s = 0.0; ///< the place on the circle, and the space about itself
};

struct MockRuntime {
  // What it offers.
  bool has_hand_tracking = false;
  bool has_motion_range = false;
  bool has_data_source = false;
  bool has_timespec = true;
  bool has_stage = true;
  bool has_velocities = true;
  bool answers_before_instance = true; ///< no layer above it could ask for extensions otherwise
  bool lacks_cameras = false;          ///< has the extension, but cannot make trackers
  bool loses_places = false;           ///< no location is valid
  XrSpaceLocationFlags tracked =
      XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
  std::int64_t clock_offset_ns = 0; ///< XrTime minus CLOCK_MONOTONIC
  MockMotion view;
  MockMotion local;
  MockMotion stage;
  MockMotion action;

  // What it was asked for.
  int create_calls = 0;
  int refused_creates = 0;
  int instances = 0;
  int sessions = 0;
  int spaces = 0;
  int trackers = 0;
  int located_hands = 0;
  int foreign_structures = 0; ///< structures of extensions that are not enabled
  std::uint32_t extensions = 0;
  char extension[32][XR_MAX_EXTENSION_NAME_SIZE] = {};
};

/// The name of the function that returns it.
inline constexpr const char* mock_runtime_function = "nendo_mock_runtime";
/// The name of the function that makes a session have this state: void(XrSession, XrSessionState).
/// xrPollEvent returns the event.
inline constexpr const char* mock_event_function = "nendo_mock_event";

} // namespace nendo::test
