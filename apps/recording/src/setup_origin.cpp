// How the model came from the file's before a recording began.

#include <algorithm>

#include "setup_parts.hpp"

namespace nendo::recording {

using deform::EdgeOperation;
using flow::ModelOrigin;
using flow::ModelSource;

namespace {

constexpr std::size_t operation_bytes = 9;

} // namespace

std::size_t plain_origins(const LoopSetup& loop) noexcept {
  const auto most = std::min(loop.origins.size(), most_plain_origins);
  const auto first = loop.origins.begin();
  const auto end = first + static_cast<std::ptrdiff_t>(most);
  return static_cast<std::size_t>(
      std::find_if(first, end,
                   [](const auto& origin) { return origin->source != ModelSource::subdivided; }) -
      first);
}

void put_origin(ByteWriter& writer, ModelSource source, bool goes_on,
                std::span<const EdgeOperation> operations) {
  writer.u8(static_cast<std::uint8_t>(source));
  writer.u8(static_cast<std::uint8_t>(goes_on));
  for (const EdgeOperation& operation : operations) {
    writer.u8(static_cast<std::uint8_t>(operation.kind));
    writer.u32_le(operation.from);
    writer.u32_le(operation.to);
  }
}

bool read_origin(std::span<const std::byte> payload, std::optional<LoopSetup>& loop) {
  ByteReader reader(payload);
  CheckedReader checked(reader);
  const auto source = checked.one_of(ModelSource::refined);
  const bool goes_on = reader.u8() != 0;
  if (!loop || !checked.fine() || source == ModelSource::kept) return false;
  if (reader.remaining() % operation_bytes != 0) return false;
  if (goes_on && (loop->origins.empty() || loop->origins.back()->source != source)) return false;
  ModelOrigin origin = goes_on ? *loop->origins.back() : ModelOrigin{source, {}};
  while (reader.remaining() > 0) {
    EdgeOperation& operation = origin.refining.emplace_back();
    operation.kind = checked.one_of(EdgeOperation::Kind::flip);
    operation.from = reader.u32_le();
    operation.to = reader.u32_le();
  }
  if (!checked.fine()) return false;
  if (goes_on) loop->origins.pop_back();
  loop->origins.push_back(std::make_shared<const ModelOrigin>(std::move(origin)));
  return true;
}

} // namespace nendo::recording
