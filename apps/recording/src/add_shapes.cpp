#include <cmath>

#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>

#include "take_copy.hpp"

namespace nendo::recording {
namespace {

// Ticks from shape to shape.
std::uint64_t stride(double loop_hz, double wanted_hz) {
  return static_cast<std::uint64_t>(std::max(1.0, std::round(loop_hz / wanted_hz)));
}

} // namespace

Result<NewTake> add_shapes(const std::filesystem::path& from, const std::filesystem::path& to,
                           const deform::Mesh& model, double rate_hz) {
  if (static_cast<std::size_t>(model.vertices.cols()) > most_recorded_vertices)
    return Error{Errc::bad_input, from.string() + ": a shape in a recording has at most " +
                                      std::to_string(most_recorded_vertices) + " vertices"};
  auto reader = TakeReader::open(from);
  if (!reader) return reader.error();
  auto replay = LoopReplay::make(reader->setup(), model);
  if (!replay) return Error{replay.error().code, from.string() + ": " + replay.error().message};
  flow::DeformLoop& loop = (*replay)->loop();
  auto copy = TakeCopy::create(to, reader->setup());
  if (!copy) return copy.error();
  const std::uint64_t every = stride(reader->setup().loop->options.rate_hz, rate_hz);
  HostTime ended = reader->setup().begun_host;
  deform::Points vertices;
  while (const auto entry = reader->next()) {
    if (const auto put = copy->put(*entry); !put) return put.error();
    if (!(*replay)->feed(*entry)) continue;
    ended = std::get<flow::LoggedTick>(*entry).woke;
    if ((loop.stats().ticks - 1) % every != 0 || !loop.frames().update()) continue;
    const flow::Frame& frame = loop.frames().front();
    loop.layout().unpack(frame.shape, vertices);
    if (const auto put = copy->put(shape_of(frame.tick, vertices)); !put) return put.error();
  }
  return copy->end(reader->ending() ? reader->ending()->host : ended, reader->ending());
}

} // namespace nendo::recording
