#include <nendo/recording/take_input.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <nendo/recording/loop_replay.hpp>

namespace nendo::recording {
namespace {

/// Gathers the entries of each tick, and gives them the tick's time.
class ScriptMaker {
public:
  void add(const Entry& entry) {
    std::visit([this](const auto& one) { add_one(one); }, entry);
  }
  bool has_ticks() const noexcept { return ticks_ > 0; }
  bool is_exact() const noexcept { return exact_; }
  auto& puppets() noexcept { return puppets_; }
  std::uint64_t samples_of(std::size_t glove) const { return samples_[glove]; }

  std::unique_ptr<flow::InputScript> finish() {
    events_.resize(timed_); // what no tick took decides nothing
    return std::make_unique<flow::InputScript>(std::move(events_), first_, latest_);
  }

private:
  void add_one(const RecordedSample& recorded) {
    if (recorded.glove >= samples_.size()) {
      exact_ = false;
      return;
    }
    ++samples_[recorded.glove];
    put(flow::TakenSample{recorded.glove, recorded.sample});
  }
  // Recorders repeat what is in effect, also while an undo waits for something else.
  void add_one(const flow::LoopSettings& settings) {
    if (std::exchange(settings_, settings) == settings) return;
    put(flow::Command(flow::ChangeSettings{settings}));
  }
  void add_one(const flow::ChangeModel& change) {
    // A cut is asked for by the wire, which the loop is given.
    if (change.is_new() && change.source != flow::ModelSource::cut) put(flow::asking_for(change));
  }
  void add_one(const flow::HoldStill&) {}
  void add_one(const PuppetChange& change) {
    if (std::exchange(puppet_, change.number) == change.number) return;
    if (change.puppet) puppets_[change.number] = change.puppet;
    put(flow::Command(flow::ChangePuppet{change.number}));
  }
  void add_one(const Gap&) { exact_ = false; }
  void add_one(const flow::LoggedTick& tick) {
    if (ticks_++ == 0) first_ = tick.scheduled;
    latest_ = std::max(latest_, tick.scheduled - first_); // whatever a hostile file says
    for (; timed_ < events_.size(); ++timed_)
      events_[timed_].at = latest_;
  }
  template <class One>
  void add_one(const One& command) {
    put(flow::Command(command));
  }
  void put(flow::InputLogEntry entry) { events_.push_back({{}, std::move(entry)}); }

  std::vector<flow::InputScript::Event> events_;
  std::size_t timed_ = 0; ///< so many have their times
  HostTime first_{};
  HostClock::duration latest_{};
  std::uint64_t ticks_ = 0;
  std::array<std::uint64_t, flow::max_inputs> samples_{};
  bool exact_ = true;
  std::optional<flow::LoopSettings> settings_; ///< the last entry's
  std::optional<std::uint32_t> puppet_;        ///< the last entry's
  decltype(TakeInput::puppets) puppets_;
};

} // namespace

Result<TakeInput> read_take_input(const std::filesystem::path& path) {
  auto reader = TakeReader::open(path);
  if (!reader) return reader.error();
  ScriptMaker script;
  while (const auto entry = reader->next())
    script.add(*entry);
  TakeInput input{reader->setup(), nullptr, std::move(script.puppets()), reader->sent()};
  if (!input.setup.loop || !script.has_ticks())
    return Error{Errc::bad_input, path.string() + ": " + std::string(without_loop)};
  if (input.sent.size() != input.setup.gloves.size()) { // only the arrived samples are known
    input.sent.clear();
    for (std::size_t at = 0; at < std::min(input.setup.gloves.size(), flow::max_inputs); ++at)
      input.sent.push_back({script.samples_of(at)});
  }
  input.is_exact = script.is_exact() && reader->chunks().damage_count() == 0;
  input.script = script.finish();
  return input;
}

} // namespace nendo::recording
