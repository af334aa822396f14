#pragma once
// The shared tools of the Python module: exceptions, and waits that Ctrl-C ends. Functions that
// Python calls throw, because pybind11 turns C++ exceptions into Python's. No exception reaches the
// libraries.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>

namespace nendo::python {

namespace py = pybind11;

/// Throws nendo.Error with this code and message, or its kind that is also an OSError: AccessError
/// for no_permission, NotFoundError for no_device.
[[noreturn]] void raise(const Error& error);

template <class T>
T value_of(Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}
inline void check(const Result<void>& result) {
  if (!result) raise(result.error());
}

/// Throws NotFoundError or AccessError if the file is missing or must not be read.
void check_readable(const std::filesystem::path& file);

/// Returns the text as a Python string. Bytes that are not UTF-8 are replaced.
py::str to_str(std::string_view text);
/// Issues a UserWarning.
void warn(std::string_view text);

/// Returns the option's side; nullopt if it is None. Throws ValueError.
std::optional<Side> side_of(const std::optional<std::string>& name);
/// Returns `named(name)`. Throws ValueError with the text "WHAT: use CHOICES".
template <class Named>
auto choice_of(const std::string& name, std::string_view what, std::string_view choices,
               Named named) {
  const auto chosen = named(name);
  if (!chosen) throw py::value_error(std::string(what) + ": use " + std::string(choices));
  return *chosen;
}
/// Throws ValueError unless the number is finite, and from `min` to `max`.
double number_in(double number, const char* what, double min, double max);

/// Returns the argument as this type. Throws TypeError with the text "NAME: WANTED is needed".
template <class T>
T argument_as(const py::handle& argument, std::string_view name, const char* wanted) {
  try {
    return argument.cast<T>();
  } catch (const py::cast_error&) {
    throw py::type_error(std::string(name) + ": " + wanted + " is needed");
  }
}

/// Has Python call close() of this object when it ends, if the object still exists then.
void close_at_exit(const py::object& object);

/// Releases the GIL, as py::gil_scoped_release does. But a thread that asks for it when Python has
/// ended sleeps until the process ends; Python would unwind its stack, and so abort the process.
class WithoutGil {
public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil() {
    try {
      PyEval_RestoreThread(state_);
    } catch (...) { // never left
      for (;;)
        ::pause();
    }
  }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

private:
  PyThreadState* state_;
};

/// Calls without the GIL.
template <class Call>
auto without_gil(Call call) {
  const WithoutGil released;
  return call();
}
/// Calls without the GIL, and alone: two threads may use one object, in turn.
template <class Call>
auto without_gil(std::mutex& mutex, Call call) {
  const WithoutGil released;
  const std::lock_guard<std::mutex> alone(mutex);
  return call();
}

/// Waits for up to `timeout_s` seconds, without the GIL, and returns whether `is_ready`, which
/// blocks until the time that it gets at most. Ctrl-C ends the wait within 0.1 s.
template <class Ready>
bool wait_for(double timeout_s, Ready is_ready) {
  constexpr double longest_s = 1e9; // within the range of the clock
  constexpr std::chrono::milliseconds slice{50};
  if (std::isnan(timeout_s) || timeout_s < 0.0)
    throw py::value_error("timeout: use a number of seconds >= 0, or math.inf");
  const HostTime end = HostClock::now() + from_seconds(std::min(timeout_s, longest_s));
  for (;;) {
    const bool done =
        without_gil([&] { return is_ready(std::min(end, HostClock::now() + slice)); });
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (done) return true;
    if (HostClock::now() >= end) return false;
  }
}

inline double seconds_of(HostTime time) noexcept {
  return to_seconds(time.time_since_epoch());
}

// Each adds the classes and functions of one subject to the module.
void add_errors(py::module_& module);
void add_samples(py::module_& module);
void add_hands(py::module_& module);
void add_calibrations(py::module_& module);
void add_gloves(py::module_& module);
void add_trackers(py::module_& module);
void add_frames(py::module_& module);
void add_meshes(py::module_& module);
void add_fields(py::module_& module);
void add_deformers(py::module_& module);
void add_clay(py::module_& module);
void add_recordings(py::module_& module);
void add_session(py::module_& module);
void add_segment(py::module_& module);

} // namespace nendo::python
