#include <nendo/recording/loop_replay.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::recording {
namespace {

// As many as may wait for a live loop, or more.
constexpr std::size_t ring_size = 4096;

bool points_exist(const deform::Supports& supports, Eigen::Index points) {
  return std::ranges::all_of(supports.own, [&](const auto& own) { return own.point < points; });
}

/// Puts the recorded puppet, if there is one, into the options.
Result<void> set_rig(const LoopSetup& loop, const deform::Mesh& model, flow::LoopOptions& options) {
  if (loop.puppet.text.empty()) return {};
  auto rig = rig_of(loop.puppet, model);
  if (!rig) return rig.error();
  options.rig = *std::move(rig);
  if (!flow::is_played(options.rig.get())) return {};
  if (!points_exist(options.sculptor.deformer.supports, options.rig->starts().cols()))
    return Error{Errc::bad_input, std::string(without_loop)};
  auto surface = flow::surface_for(*options.rig, model, deform::BlockLayout(model.vertices),
                                   options.sculptor.deformer);
  if (!surface) return Error{Errc::bad_input, "the recorded puppet: " + surface.error().message};
  options.sculptor.surface = *std::move(surface);
  return {};
}

/// Returns the command that the entry is, if it is one.
std::optional<flow::Command> command_in(const Entry& entry) {
  return std::visit(
      [](const auto& one) -> std::optional<flow::Command> {
        if constexpr (std::is_constructible_v<flow::Command, decltype(one)>)
          return flow::Command(one);
        else
          return std::nullopt;
      },
      entry);
}

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
  void add_one(const RecordedPose& recorded) { put(flow::TakenPose{recorded.pose, recorded.side}); }
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
  void put(const flow::InputLogEntry& entry) { events_.push_back({{}, entry}); }

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

Result<flow::LoopOptions> loop_options_of(const Setup& setup, const deform::Mesh& model) {
  if (!setup.loop || setup.hands.empty()) return Error{Errc::bad_input, std::string(without_loop)};
  if (setup.hands.size() < setup.gloves.size())
    return Error{
        Errc::bad_input,
        "the description of a hand or of a layer is missing, damaged, or not of a hand; record "
        "it again, or cut nothing out of it"};
  if (setup.loop->is_tracked && setup.trackers.empty())
    return Error{
        Errc::bad_input,
        "the description of the trackers that moved the hands is damaged; record it again"};
  flow::LoopOptions options = setup.loop->options;
  if (const auto fine = set_rig(*setup.loop, model, options); !fine) return fine.error();
  const Eigen::Index points = flow::supported_points(
      options.rig.get(), static_cast<Eigen::Index>(flow::count_hands(setup.hands)));
  if (!points_exist(options.sculptor.deformer.supports, points))
    return Error{Errc::bad_input, std::string(without_loop)};
  if (!setup.loop->rest.empty() &&
      setup.loop->rest.size() !=
          deform::block_count_of(static_cast<std::size_t>(model.vertices.cols())))
    return Error{Errc::bad_input, "the shape at its beginning is not one of this model"};
  return options;
}

Result<std::unique_ptr<LoopReplay>> LoopReplay::make(const Setup& setup,
                                                     const deform::Mesh& model) {
  auto made = loop_options_of(setup, model);
  if (!made) return made.error();
  flow::LoopOptions options = *std::move(made);
  std::unique_ptr<LoopReplay> replay(new LoopReplay);
  std::vector<flow::HandInput> inputs = setup.hands;
  for (auto& input : inputs) {
    replay->rings_.push_back(std::make_unique<SampleRing>(ring_size));
    input.ring = replay->rings_.back().get();
    auto& poses = replay->poses_[flow::Placement::index_of(input.side)];
    if (!input.wrist_source || poses != nullptr) continue; // the first input of a side
    poses = std::make_unique<PoseRing>(ring_size);
    input.wrist_source->ring = poses.get();
  }
  options.commands = &replay->commands_;
  options.undo_max_bytes = std::min(options.undo_max_bytes, deform::half_of_memory());
  const deform::BlockShape first(setup.loop->rest);
  const bool has_first = first.block_count() > 0;
  replay->loop_ = std::make_unique<flow::DeformLoop>(
      model, setup.loop->placement, std::move(inputs), options, has_first ? &first : nullptr);
  if (!is_solved(replay->loop_->grab_status()))
    return Error{Errc::bad_input, "the recorded hands cannot grab the model: " +
                                      std::string(describe(replay->loop_->grab_status()))};
  return replay;
}

void LoopReplay::take(const RecordedSample& sample) noexcept {
  exact_ = sample.glove < rings_.size() && rings_[sample.glove]->try_push(sample.sample) && exact_;
}

void LoopReplay::take(const RecordedPose& recorded) noexcept {
  const auto& poses = poses_[flow::Placement::index_of(recorded.side)];
  exact_ = poses != nullptr && poses->try_push(recorded.pose) && exact_;
}

/// Makes that version, or goes back to it. Returns false if the loop cannot have it, as after a
/// gap.
bool LoopReplay::follow(const flow::ChangeModel& change) {
  const bool is_new = change.is_new();
  if (!loop_->changes().is_still()) {
    // What was not made since the recording began is the model with which it began.
    const auto known = versions_.find(change.number);
    const std::uint32_t number = known == versions_.end() ? 0 : known->second;
    return !is_new && loop_->changes().change_to(
                          {loop_->changes().settings(), number, loop_->changes().newest_puppet()});
  }
  if (!is_new) {
    loop_->changes().keep_model();
    return true;
  }
  auto finer = flow::PendingModel::make(loop_->changes().newest_model(), change,
                                        loop_->drawn_wire().places());
  if (!finer) {
    loop_->changes().keep_model();
    return false;
  }
  if (!loop_->changes().change_model(*finer)) return false;
  versions_[change.number] = loop_->changes().newest_model().number;
  return true;
}

/// Makes that puppet, or goes back to it. Returns false if the loop cannot have it.
bool LoopReplay::follow(const PuppetChange& change) {
  const auto known = puppets_.find(change.number);
  if (known != puppets_.end()) return bool(loop_->changes().change_puppet(known->second));
  if (!change.puppet) return bool(loop_->changes().change_puppet(0));
  auto rig = rig_of(*change.puppet, loop_->changes().model(0)->mesh);
  if (!rig) return false;
  puppets_[change.number] = loop_->changes().next_puppet();
  return bool(loop_->changes().change_puppet(*std::move(rig)));
}

bool LoopReplay::feed(const Entry& entry) noexcept {
  if (const auto* sample = std::get_if<RecordedSample>(&entry)) {
    take(*sample);
  } else if (const auto* pose = std::get_if<RecordedPose>(&entry)) {
    take(*pose);
  } else if (const auto* settings = std::get_if<flow::LoopSettings>(&entry)) {
    exact_ = loop_->changes().change_settings(*settings) && exact_;
  } else if (std::holds_alternative<flow::HoldStill>(entry)) {
    exact_ = loop_->changes().hold_still() && exact_;
  } else if (const auto* change = std::get_if<flow::ChangeModel>(&entry)) {
    exact_ = follow(*change) && exact_;
  } else if (const auto* puppet = std::get_if<PuppetChange>(&entry)) {
    exact_ = follow(*puppet) && exact_;
  } else if (const auto* tick = std::get_if<flow::LoggedTick>(&entry)) {
    loop_->changes().refill_undo();
    loop_->tick(tick->number, tick->scheduled, tick->woke);
    return true;
  } else if (const auto command = command_in(entry); command && flow::is_for_loop(*command)) {
    exact_ = commands_.try_push(*command) && exact_;
  } else {
    exact_ = false; // a gap
  }
  return false;
}

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
