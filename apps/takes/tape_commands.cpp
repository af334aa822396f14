#include "takes/tape_commands.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <nendo/base/units.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::takes {
namespace {

/// Converts entries of a recording to commands.
class TapeCommands {
public:
  template <class One>
  std::optional<flow::Command> operator()(const One& one) {
    if constexpr (std::is_constructible_v<flow::Command, const One&>)
      return flow::Command(one);
    else
      return std::nullopt; // samples, poses, ticks, gaps
  }
  std::optional<flow::Command> operator()(const flow::WristMove&) { return std::nullopt; }
  std::optional<flow::Command> operator()(const flow::HoldStill&) { return std::nullopt; }
  std::optional<flow::Command> operator()(const flow::LoopSettings& settings) {
    if (std::exchange(settings_, settings) == settings) return std::nullopt;
    return flow::ChangeSettings{settings};
  }
  std::optional<flow::Command> operator()(const recording::PuppetChange& change) {
    if (std::exchange(puppet_, change.number) == change.number) return std::nullopt;
    return flow::ChangePuppet{change.number};
  }
  std::optional<flow::Command> operator()(const flow::ChangeModel& change) {
    if (!change.is_new() || change.source == flow::ModelSource::cut) return std::nullopt;
    return flow::asking_for(change);
  }

private:
  std::optional<flow::LoopSettings> settings_;
  std::uint32_t puppet_ = 0;
};

} // namespace

Result<std::vector<timeline::Event>> recorded_commands(const std::filesystem::path& path) {
  auto reader = recording::TakeReader::open(path);
  if (!reader) return reader.error();
  std::vector<timeline::Event> events;
  std::size_t timed = 0; // events before it have times
  double time_s = 0.0;
  TapeCommands commands;
  while (const auto entry = reader->next()) {
    if (const auto command = std::visit(commands, *entry)) events.push_back({time_s, *command});
    const auto* const tick = std::get_if<flow::LoggedTick>(&*entry);
    if (tick == nullptr) continue;
    time_s = std::max(time_s, seconds_between(reader->setup().begun_host, tick->woke));
    for (; timed < events.size(); ++timed)
      events[timed].time_s = time_s;
  }
  return events;
}

} // namespace nendo::takes
