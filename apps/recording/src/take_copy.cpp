#include "take_copy.hpp"

namespace nendo::recording {
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 16;

} // namespace

Result<TakeCopy> TakeCopy::create(const std::filesystem::path& path, const Setup& setup) {
  std::uint32_t chunks = 0;
  const auto bytes = setup_bytes(setup, chunks);
  auto file = TakeFile::create(path, bytes, chunks, TakeFile::Kind::copy);
  if (!file) return file.error();
  return TakeCopy(*std::move(file));
}

Result<void> TakeCopy::put(const Entry& entry) {
  ByteWriter writer(payload_);
  put_entry(writer, entry);
  ++entries_;
  if (std::holds_alternative<driver::RecordedSample>(entry)) ++ending_.samples;
  if (std::holds_alternative<flow::Request>(entry)) ++ending_.requests;
  if (std::holds_alternative<flow::LoggedTick>(entry)) ++ending_.ticks;
  return payload_.size() < chunk_bytes ? Result<void>() : flush();
}

Result<void> TakeCopy::put(const RecordedShape& shape) {
  if (auto flushed = flush(); !flushed) return flushed;
  ++shapes_;
  std::vector<std::byte> payload;
  ByteWriter writer(payload);
  put_shape(writer, shape);
  return file_.append(shape_chunk, payload);
}

Result<NewTake> TakeCopy::end(HostTime host, const std::optional<Ending>& of_original) {
  if (const auto flushed = flush(); !flushed) return flushed.error();
  ending_.host = host;
  if (of_original) {
    ending_.lost = of_original->lost;
    ending_.shape = of_original->shape;
  }
  ByteWriter writer(payload_);
  put_ending(writer, ending_);
  if (const auto written = file_.append(ending_chunk, payload_); !written) return written.error();
  if (const auto synced = file_.sync(); !synced) return synced.error();
  NewTake made;
  made.bytes = file_.bytes();
  made.entries = entries_;
  made.shapes = shapes_;
  return made;
}

Result<void> TakeCopy::flush() {
  if (payload_.empty()) return {};
  auto written = file_.append(driver::tape_chunk, payload_);
  payload_.clear();
  return written;
}

} // namespace nendo::recording
