#pragma once
// A glove or a tracker that Python reads. Both start, stop and count in the same way.

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include <nendo/driver/stream_stats.hpp>

#include "python/arrays.hpp"
#include "python/samples.hpp"
#include "python/stream.hpp"

namespace nendo::python {

/// The max number of samples that wait for Python: at 500 Hz, of two minutes.
inline constexpr std::int64_t usual_capacity = std::int64_t{1} << 16;

/// `Driver` is shared, because a tracker has several stations. Thread-safe.
template <class Driver, class Sample>
class Device {
public:
  Device(std::shared_ptr<Driver> driver, std::size_t capacity)
      : driver_(std::move(driver)), stream_(capacity) {}
  ~Device() {
    const WithoutGil released;
    close_now();
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// `start_driver` passes the ring to the driver. Does nothing if the stream runs already.
  template <class Start>
  void start(Start start_driver) {
    check(without_gil(control_, [&]() -> Result<void> {
      if (!driver_) return Error{Errc::failed, "it is closed; open it again"};
      if (is_started_) return {};
      if (auto started = start_driver(*driver_, stream_.ring()); !started) return started;
      stream_.begin([driver = driver_.get()] { return driver->has_ended(); });
      is_started_ = true;
      return {};
    }));
  }
  void close() {
    without_gil(control_, [this] { close_now(); });
  }

  py::array read(double timeout_s) {
    wait(timeout_s);
    return array_of(stream_.take());
  }
  /// Takes all samples that wait; before that, waits as long for the first one.
  std::vector<Sample> take(double timeout_s) {
    wait(timeout_s);
    return stream_.take();
  }

  py::dict stats() {
    const driver::StreamStats stats = without_gil(control_, [this] {
      if (driver_) last_ = driver_->stats();
      return last_;
    });
    py::dict counts;
    counts["records"] = stats.records;
    counts["missed"] = stats.counts_missed ? py::object(py::int_(stats.missed)) : py::none();
    counts["bad_records"] = stats.bad_records;
    counts["clamped"] = stats.clamped;
    counts["refused"] = stats.ring_refused;
    counts["dropped"] = stream_.dropped();
    counts["silences"] = stats.silences;
    counts["reopened"] = stats.reopened;
    counts["rate_hz"] = stats.rate_hz;
    return counts;
  }

private:
  void wait(double timeout_s) {
    if (!is_started_)
      raise({Errc::failed, "the stream was not started; call start(), or use `with`"});
    if (timeout_s != 0.0) // a caller who does not wait keeps the GIL
      wait_for(timeout_s, [this](HostTime until) { return stream_.wait(until); });
  }
  void close_now() {
    if (!driver_) return;
    driver_->stop();
    last_ = driver_->stats();
    stream_.end();
    driver_.reset();
  }

  std::mutex control_;             ///< guards all but `stream_`
  std::shared_ptr<Driver> driver_; ///< null: closed
  Stream<Sample> stream_;
  driver::StreamStats last_{};
  std::atomic<bool> is_started_{false};
};

} // namespace nendo::python
