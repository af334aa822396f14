#include "publish/osc_packer.hpp"

#include <array>

#include <lo/lo.h>

namespace nendo::publish {
namespace {

constexpr lo_timetag immediately{0U, 1U};
constexpr std::size_t element_head_bytes = 4; ///< the length of a message in its bundle

void put_numbers(lo_message message, std::span<const float> numbers) {
  for (const float number : numbers)
    lo_message_add_float(message, number);
}

} // namespace

void OscPacker::add(const char* address, int number) {
  lo_message message = lo_message_new();
  lo_message_add_int32(message, number);
  add_message(address, message);
}

void OscPacker::add(const char* address, std::span<const float> numbers) {
  lo_message message = lo_message_new();
  put_numbers(message, numbers);
  add_message(address, message);
}

void OscPacker::add(const char* address, const char* text, std::span<const float> numbers) {
  lo_message message = lo_message_new();
  lo_message_add_string(message, text);
  put_numbers(message, numbers);
  add_message(address, message);
}

// Handles are void* until liblo 0.31, and pointers to structs of their own since 0.32.
void OscPacker::add_message(const char* address, void* untyped) {
  const auto message = static_cast<lo_message>(untyped);
  const std::size_t more = element_head_bytes + lo_message_length(message, address);
  if (bundle_ != nullptr &&
      lo_bundle_length(static_cast<lo_bundle>(bundle_)) + more > max_datagram_bytes)
    flush();
  if (bundle_ == nullptr) bundle_ = lo_bundle_new(immediately);
  lo_bundle_add_message(static_cast<lo_bundle>(bundle_), address, message); // which owns it then
}

void OscPacker::flush() {
  if (bundle_ == nullptr) return;
  const auto bundle = static_cast<lo_bundle>(bundle_);
  std::array<std::byte, max_datagram_bytes> datagram;
  std::size_t bytes = lo_bundle_length(bundle);
  if (bytes <= datagram.size()) {
    lo_bundle_serialise(bundle, datagram.data(), &bytes);
    send_(std::span(datagram).first(bytes));
  }
  lo_bundle_free_recursive(bundle);
  bundle_ = nullptr;
}

} // namespace nendo::publish
