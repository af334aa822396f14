#pragma once
// Packs OSC messages into datagrams, by liblo.

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <span>

namespace nendo::publish {

/// OSC messages of one moment. They leave in bundles that receivers execute at once. Not
/// thread-safe; allocates.
class OscPacker {
public:
  /// The max length of a datagram: receivers that read into buffers of one Ethernet frame take it.
  static constexpr std::size_t max_datagram_bytes = 1200;
  /// `send` gets each finished datagram, which is valid during the call.
  using Send = std::function<void(std::span<const std::byte> datagram)>;

  explicit OscPacker(Send send) : send_(std::move(send)) {}
  /// Sends what is left.
  ~OscPacker() { flush(); }
  OscPacker(const OscPacker&) = delete;
  OscPacker& operator=(const OscPacker&) = delete;

  /// Adds a message with a whole number, with floats, or with a text and floats.
  void add(const char* address, int number);
  void add(const char* address, std::span<const float> numbers);
  void add(const char* address, const char* text, std::span<const float> numbers);
  /// Sends the messages that were added since the last flush().
  void flush();

private:
  void add_message(const char* address, void* message);

  Send send_;
  void* bundle_ = nullptr; ///< liblo's lo_bundle
};

} // namespace nendo::publish
