#pragma once
// Sends hands and CSRBF updates as UDP datagrams on a thread of its own. The loop puts each frame
// into a ring. Neither thread waits for the other.

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nendo/base/unique_fd.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo_publish.h>

#include "publish/frame_record.hpp"
#include "publish/target.hpp"

namespace nendo::publish {

/// After DatagramPublisher::end(), records = sent + lost.
struct DatagramCounts {
  std::uint64_t records = 0; ///< frames shown
  std::uint64_t sent = 0;    ///< records that the sending thread has processed
  std::uint64_t lost = 0;    ///< records that were overwritten before the sending thread read them
  std::uint64_t datagrams = 0; ///< that the system accepted
  std::uint64_t refused = 0;   ///< that the system did not accept; those are lost
  std::uint64_t bytes = 0;     ///< all bytes of the accepted datagrams
};

class DatagramPublisher final : public flow::FrameSink {
public:
  /// name: the target as the user wrote it, for error messages.
  DatagramPublisher(std::string name, const DatagramTarget& target)
      : name_(std::move(name)), target_(target) {}
  ~DatagramPublisher() override { end(); }

  /// Begins to send. To be called before each loop's first tick, while no loop runs. The first call
  /// opens the socket. Errors: failed (no way to that address), no_permission.
  Result<void> begin(const LoopOutline& outline);
  /// Puts the frame into the ring. Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Sends the remaining records and joins the thread. To be called while no loop runs.
  void end();

  /// Returns the counts. To be called after end().
  DatagramCounts counts() const noexcept { return counts_; }

private:
  Result<void> open();
  void send_until_over() noexcept;
  void send_new() noexcept;
  void send_record() noexcept;
  void send_update(const nendo_publish_record& record, nendo_publish_datagram head) noexcept;
  void send(const nendo_publish_datagram& head, const std::byte* payload,
            std::size_t payload_bytes) noexcept;

  std::string name_;
  DatagramTarget target_;
  UniqueFd socket_;
  // Used by the loop's thread.
  FrameRecord record_;
  std::unique_ptr<AtomicWord[]> memory_;
  RecordRing ring_;
  std::uint64_t shown_ = 0;
  std::uint64_t generation_ = 0;
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> newest_{0};
  std::atomic<bool> over_{false};
  // Used by the sending thread.
  alignas(2 * cache_line_bytes) std::uint64_t next_ = 1;
  std::uint64_t session_ = 0;
  std::vector<std::uint64_t> words_; ///< the present record, as nendo_publish_record
  std::vector<std::byte> update_;
  std::vector<std::byte> datagram_;
  DatagramCounts counts_;
  std::thread thread_;
};

} // namespace nendo::publish
