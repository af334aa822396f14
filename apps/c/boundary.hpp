#pragma once
// What all functions of the C interface do at its boundary: errors become a status and a message of
// the thread, and no exception leaves.

#include <exception>
#include <memory>
#include <string>

#include <nendo.h>

#include <nendo/base/result.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::c {

/// Sets the message of this thread, and returns the status. Does not throw.
int fail(Errc code, const char* message) noexcept;

/// Calls `act`, which returns a Result<void>.
template <class Act>
int guarded(Act act) noexcept {
  try {
    fail(Errc::failed, "");
    const Result<void> done = act();
    return done ? int{NENDO_OK} : fail(done.error().code, done.error().message.c_str());
  } catch (const std::exception& error) { // out of memory, mostly
    return fail(Errc::failed, error.what());
  }
}

// nendo.h declares the types of its objects, and nothing defines them, so that abidiff sees that no
// program can depend on their contents. Each is one of ours.
template <class Own, class Object>
Own* own(Object* object) noexcept {
  return reinterpret_cast<Own*>(object);
}
template <class Object, class Own>
Object* object_of(std::unique_ptr<Own> made) noexcept {
  return reinterpret_cast<Object*>(made.release());
}

/// Returns an error that names the argument, which is null.
inline Error is_null(const char* argument) {
  return {Errc::usage, std::string(argument) + ": is null"};
}

/// Writes angles and joints, in metres.
void write_pose(const hand::JointAngles& angles, const hand::HandPose& pose,
                nendo_hand& hand) noexcept;

} // namespace nendo::c
