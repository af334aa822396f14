#pragma once
// Hands and CSRBF updates as UDP datagrams, sent by a thread of their own: the loop leaves each
// frame in a ring, and neither waits for the other.

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nendo/base/descriptor.hpp>
#include <nendo/flow/frame_sink.hpp>
#include <nendo/publish/frame_record.hpp>
#include <nendo/publish/record_ring.hpp>
#include <nendo/publish/target.hpp>

namespace nendo::publish {

/// records = sent + lost, once ended.
struct DatagramCounts {
  std::uint64_t records = 0;   ///< frames shown
  std::uint64_t sent = 0;      ///< of those, taken by the sender
  std::uint64_t lost = 0;      ///< of those, overwritten before it came to them
  std::uint64_t datagrams = 0; ///< that the system took
  std::uint64_t refused = 0;   ///< that it did not take; those are lost
  std::uint64_t bytes = 0;     ///< of the datagrams taken
};

class DatagramPublisher final : public flow::FrameSink {
public:
  /// name: the target as it was asked for, for errors.
  DatagramPublisher(std::string name, const DatagramTarget& target)
      : name_(std::move(name)), target_(target) {}
  ~DatagramPublisher() override { end(); }

  /// Before each loop's first tick, while no loop runs: opens the socket, once, and begins to send.
  /// Errors: failed (no way to that address), no_permission.
  Result<void> begin(const LoopOutline& outline);
  /// Wait-free: no allocation, lock or system call.
  void show(const flow::Frame& frame) noexcept override;
  /// Sends what is left. No loop runs.
  void end();

  /// After end().
  DatagramCounts counts() const noexcept { return counts_; }

private:
  Result<void> open();
  void send_until_over() noexcept;
  void send_new() noexcept;
  void send_record() noexcept;
  void send_hand(unsigned side) noexcept;
  void send_update() noexcept;
  void send(std::size_t payload_bytes) noexcept;

  std::string name_;
  DatagramTarget target_;
  Descriptor socket_;
  // The loop's:
  FrameRecord record_;
  std::unique_ptr<AtomicWord[]> memory_;
  RecordRing ring_;
  std::uint64_t shown_ = 0;
  std::uint64_t generation_ = 0;
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> newest_{0};
  std::atomic<bool> over_{false};
  // The sender's:
  alignas(2 * cache_line_bytes) std::uint64_t next_ = 1;
  std::uint64_t session_ = 0;
  std::vector<std::uint64_t> words_; ///< the record under way, as nendo_publish_record
  std::vector<std::byte> update_;
  std::vector<std::byte> datagram_;
  DatagramCounts counts_;
  std::thread thread_;
};

} // namespace nendo::publish
