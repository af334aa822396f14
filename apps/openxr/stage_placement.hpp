#pragma once
// Where Nendo's stage is in the space of an application: NENDO_XR_STAGE.

#include <openxr/openxr.h>

namespace nendo::openxr {

struct StagePlacement {
  XrReferenceSpaceType space = XR_REFERENCE_SPACE_TYPE_LOCAL;
  /// Of the stage's middle, where models are. By default, on a table before a seated person, whose
  /// head is at the origin of LOCAL.
  XrPosef pose{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, -0.4F, -0.6F}};
};

/// How to write a placement, for messages.
inline constexpr const char* stage_placement_rule =
    "use SPACE:X,Y,Z or SPACE:X,Y,Z,TURN, with the space local or stage, metres and degrees, as in "
    "local:0,-0.4,-0.6";

/// Reads SPACE:X,Y,Z[,TURN]: `local` or `stage`, up to 100 metres, and up to 360 degrees to the
/// left about the vertical. Whatever the locale, the decimal point is a point. Returns false, and
/// leaves `placement` as it is, if the text is none.
bool read_placement(const char* text, StagePlacement& placement) noexcept;

} // namespace nendo::openxr
