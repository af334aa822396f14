#include <nendo/sculpting/live_loop.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/recording/replay_driver.hpp>
#include <nendo/sculpting/loop_thread.hpp>
#include <nendo/sculpting/placing.hpp>

namespace nendo::sculpting {

// In the order of construction: later members use earlier ones.
struct LiveLoop::Parts {
  Parts(deform::Mesh mesh, const LiveOptions& wanted)
      : model(std::move(mesh)), options(wanted), process(wanted.realtime) {}
  ~Parts() { stop(); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void note(std::string_view text) { notes.emplace_back(text); }
  void note_refusals(const std::vector<flow::Grant>& grants) {
    for (const std::string& line : flow::refusals(grants))
      note(line);
  }

  Result<OpenHand> open(const std::string& glove, Side side) {
    driver::GloveContext context = options.context;
    context.drivers.push_back(recording::replay_driver());
    auto opened = driver::open_glove(glove, side, context);
    if (!opened) return opened.error();
    const bool is_woken = options.pace.policy == flow::OverrunPolicy::sample;
    return hand_of(*std::move(opened), side, is_woken ? &event_count : nullptr,
                   [this](std::string_view text) { note(text); });
  }
  Result<void> open_hands() {
    const Note noted = [this](std::string_view text) { note(text); };
    const auto open_one = [this](const std::string& glove, Side side) { return open(glove, side); };
    if (options.left.empty() && options.right.empty()) {
      auto found = open_found(std::array{Side::left, Side::right}, "sim", open_one, noted);
      if (!found) return found.error();
      hands = *std::move(found);
    }
    for (const Side side : {Side::left, Side::right}) {
      const std::string& glove = side == Side::left ? options.left : options.right;
      if (glove.empty()) continue;
      auto hand = open(glove, side);
      if (!hand) return hand.error();
      hands.push_back(*std::move(hand));
    }
    const flow::InheritedPriority readers(flow::reader_priority(options.realtime.priority));
    if (const auto started = start(hands); !started) return started;
    if (const auto come = wait_for_samples(hands); !come) return come;
    return find_wearers(hands, options.calibration, noted);
  }
  Result<void> place_loop() {
    std::vector<flow::HandInput> inputs;
    for (const OpenHand& hand : hands) {
      inputs.push_back(input_of(hand));
      inputs.back().filter = options.filter;
    }
    const double size_m = options.model_size_m.value_or(usual_size_m(options.mode));
    const auto placement = place(model, inputs, {options.mode, size_m});
    flow::LoopOptions made;
    static_cast<flow::PaceOptions&>(made) = options.pace;
    made.commands = &commands;
    if (options.pace.policy == flow::OverrunPolicy::sample) made.event_count = &event_count;
    made.sculptor.mode = options.mode;
    set_supports(options.radius_m
                     ? deform::one_radius(*options.radius_m * placement.units_per_metre)
                     : usual_supports(model, options.mode),
                 made.sculptor);
    set_undo_space(model, options.undo_bytes.value_or(deform::half_of_memory()), made);
    auto ready = make_loop(model, placement, inputs, made);
    if (!ready) return ready.error();
    loop = *std::move(ready);
    return {};
  }
  Result<void> run() {
    {
      const flow::InheritedPriority readers(flow::reader_priority(options.realtime.priority));
      if (const auto begun = begin_again(hands); !begun) return begun;
    }
    note_refusals(process.grants());
    thread = std::make_unique<LoopThread>(*loop, options.realtime);
    note_refusals(thread->grants());
    return {};
  }
  void stop() {
    thread.reset();
    for (const OpenHand& hand : hands)
      hand.glove->stop();
  }

  deform::Mesh model;
  LiveOptions options;
  std::vector<std::string> notes;
  flow::RealtimeProcess process;
  EventCount event_count;
  flow::CommandRing commands{256};
  std::vector<OpenHand> hands;
  std::unique_ptr<flow::DeformLoop> loop;
  deform::Points vertices;
  std::unique_ptr<LoopThread> thread;
};

namespace {

Result<void> check(const LiveOptions& options) {
  constexpr flow::Range rate_hz{flow::TickGrid::min_rate_hz, flow::TickGrid::max_rate_hz};
  const flow::FingersSetting& radius = flow::setting::radius;
  const auto check_one = [](std::string_view name, std::optional<double> value, flow::Range range,
                            std::string_view unit) -> Result<void> {
    if (!value || range.has(*value)) return {};
    return Error{Errc::usage, std::string(name) + ": use " + flow::in_words(range, unit)};
  };
  if (auto fine = check_one("model_size_m", options.model_size_m, model_size_range_m, "m"); !fine)
    return fine;
  if (auto fine = check_one(radius.name, options.radius_m, radius.range, radius.unit); !fine)
    return fine;
  return check_one("pace.rate_hz", options.pace.rate_hz, rate_hz, "Hz");
}

} // namespace

Result<LiveLoop> LiveLoop::begin(deform::Mesh model, const LiveOptions& options) {
  if (const auto fine = check(options); !fine) return fine.error();
  auto parts = std::make_unique<Parts>(std::move(model), options);
  if (const auto opened = parts->open_hands(); !opened) return opened.error();
  if (const auto placed = parts->place_loop(); !placed) return placed.error();
  if (const auto running = parts->run(); !running) return running.error();
  return LiveLoop(std::move(parts));
}

Result<LiveLoop> LiveLoop::begin(const std::string& model_file, const LiveOptions& options) {
  auto model = deform::read_mesh(model_file);
  if (!model) return model.error();
  deform::count_from(deform::usual_offset(*model), *model);
  return begin(*std::move(model), options);
}

LiveLoop::LiveLoop(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
LiveLoop::~LiveLoop() = default;
LiveLoop::LiveLoop(LiveLoop&& other) noexcept = default;
LiveLoop& LiveLoop::operator=(LiveLoop&& other) noexcept = default;

bool LiveLoop::update() {
  flow::DeformLoop& loop = *parts_->loop;
  loop.changes().refill_undo();
  if (!loop.frames().update()) return false;
  // Only this thread can make what an undo of settings needs; later frames ask again.
  if (frame().awaited && !loop.changes().is_changing())
    static_cast<void>(loop.changes().change_to(*frame().awaited));
  return true;
}

const flow::Frame& LiveLoop::frame() const noexcept {
  return parts_->loop->frames().front();
}

const deform::Points& LiveLoop::vertices() {
  if (frame().ticks_run == 0) return parts_->model.vertices;
  parts_->loop->changes().layout(frame().model).unpack(frame().shape, parts_->vertices);
  return parts_->vertices;
}

const deform::Mesh& LiveLoop::model() const noexcept {
  return parts_->model;
}

Result<void> LiveLoop::ask(const flow::Command& command) {
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
    return parts_->loop->changes().change_settings(change->settings);
  if (!flow::is_for_loop(command))
    return Error{Errc::usage, "this command is for a session, not for a loop; nothing changed"};
  if (parts_->commands.try_push(command)) return {};
  return Error{Errc::failed, "the loop is too far behind, so the command was dropped"};
}

const flow::LoopSettings& LiveLoop::settings() const noexcept {
  return std::as_const(*parts_->loop).changes().settings();
}

bool LiveLoop::has_ended() const noexcept {
  return have_ended(parts_->hands) && frame().ticks_run > 0 &&
         std::all_of(parts_->hands.begin(), parts_->hands.end(),
                     [](const OpenHand& hand) { return hand.ring->size() == 0; });
}

std::span<const OpenHand> LiveLoop::hands() const noexcept {
  return parts_->hands;
}

const std::vector<std::string>& LiveLoop::notes() const noexcept {
  return parts_->notes;
}

deform::Mesh LiveLoop::finish() {
  parts_->stop();
  parts_->loop->frames().update();
  return parts_->loop->final_mesh();
}

const flow::LoopStats& LiveLoop::stats() const noexcept {
  return parts_->loop->stats();
}

} // namespace nendo::sculpting
