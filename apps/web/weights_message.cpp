#include "web/weights_message.hpp"

#include "web/wire.hpp"

namespace nendo::web {

std::vector<std::byte> weights_message(const deform::SurfaceField& field) {
  const deform::SurfaceField::Terms terms = field.terms();
  WeightsHead head;
  head.vectors = static_cast<std::uint16_t>(field.vector_count());
  head.number = static_cast<std::uint32_t>(field.number());
  head.vertices = static_cast<std::uint32_t>(terms.starts.size() - 1);
  head.terms = static_cast<std::uint32_t>(terms.values.size());
  std::vector<std::byte> message(sizeof head + 6 * terms.values.size() + 2 * head.vertices);
  WireWriter out(message);
  out.put(head);
  for (const float value : terms.values)
    out.put(value);
  for (std::size_t vertex = 0; vertex < head.vertices; ++vertex)
    out.put(static_cast<std::uint16_t>(terms.starts[vertex + 1] - terms.starts[vertex]));
  for (const std::uint32_t vector : terms.of_vector)
    out.put(static_cast<std::uint16_t>(vector));
  return message;
}

} // namespace nendo::web
