#include <nendo/recording/replay_driver.hpp>

#include <algorithm>
#include <filesystem>
#include <vector>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/glove_options.hpp>

#include "replay_stream.hpp"
#include "sample_table.hpp"

namespace nendo::recording {

Error replay_error(const driver::DeviceSpec& spec, Errc code, const std::string& what) {
  return Error{code, spec.text + ": " + what};
}

Result<ReplayOptions> replay_options(const driver::DeviceSpec& spec) {
  constexpr double min_speed = 0.01;
  constexpr double max_speed = 100.0;
  ReplayOptions settings;
  if (const auto option = spec.options.find("speed"); option != spec.options.end()) {
    const auto speed = to_number(option->second);
    if (!speed || !(*speed >= min_speed && *speed <= max_speed))
      return replay_error(spec, Errc::usage, "speed must be a number from 0.01 to 100");
    settings.speed = *speed;
  }
  if (const auto option = spec.options.find("loop"); option != spec.options.end()) {
    if (option->second != "yes" && option->second != "no")
      return replay_error(spec, Errc::usage, "loop is yes or no");
    settings.loops = option->second == "yes";
  }
  if (const auto option = spec.options.find("end"); option != spec.options.end()) {
    if (option->second != "stop" && option->second != "hold")
      return replay_error(spec, Errc::usage, "end is stop or hold");
    if (settings.loops)
      return replay_error(spec, Errc::usage, "with loop=yes there is no end; leave end= out");
    settings.holds = option->second == "hold";
  }
  return settings;
}

namespace {

class TableSamples final : public SampleSource<GloveSample> {
public:
  explicit TableSamples(std::shared_ptr<const std::vector<GloveSample>> samples)
      : samples_(std::move(samples)) {}

  std::optional<GloveSample> next() override {
    if (at_ == samples_->size()) return std::nullopt;
    return (*samples_)[at_++];
  }

private:
  std::shared_ptr<const std::vector<GloveSample>> samples_;
  std::size_t at_ = 0;
};

class ReplayedGlove final : public driver::Glove {
public:
  ReplayedGlove(const driver::DeviceSpec& spec, const ReplayOptions& options,
                driver::GloveInfo info, OpenSource<GloveSample> open)
      : info_(std::move(info)), stream_(options, options.speed * info_.rate_hz, std::move(open)) {
    info_.facts.push_back({"recorded_from", info_.source});
    info_.kind = driver::SourceKind::recorded;
    info_.recording = spec.target;
    info_.source = spec.text;
    info_.rate_hz *= options.speed;
    info_.abilities = {.wrist_switch = info_.abilities.wrist_switch};
  }

  const driver::GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& ring) override {
    return stream_.start(info_.source,
                         [&ring](const GloveSample& sample) { return ring.try_push(sample); });
  }
  void stop() noexcept override { stream_.stop(); }
  driver::StreamStats stats() const noexcept override { return stream_.stats(); }
  bool has_ended() const noexcept override { return stream_.has_ended(); }
  void set_feedback(const driver::Feedback& /*feedback*/) noexcept override {} // there is no glove

private:
  driver::GloveInfo info_;
  ReplayStream<GloveSample> stream_;
};

std::vector<RecordedGlove> gloves_of(ChunkReader reader) {
  std::vector<RecordedGlove> gloves;
  while (const auto chunk = reader.next()) {
    if (chunk->type == log_chunk) break; // the gloves come before their samples
    if (chunk->type != glove_chunk) continue;
    if (auto glove = glove_of(chunk->payload)) gloves.push_back(*std::move(glove));
  }
  return gloves;
}

Result<RecordedGlove> choose(const driver::DeviceSpec& spec, std::vector<RecordedGlove> gloves,
                             std::optional<Side> asked, std::optional<Side> wanted) {
  if (gloves.empty())
    return replay_error(spec, Errc::bad_input,
                        "no glove was recorded, or its description is damaged");
  const std::optional<Side> side = asked ? asked : wanted;
  const auto found = std::ranges::find(
      gloves, side, [](const auto& glove) { return std::optional(glove.info.side); });
  if (found != gloves.end()) return std::move(*found);
  if (asked)
    return replay_error(spec, Errc::no_device,
                        "no " + std::string(name_of(*asked)) +
                            "-hand glove was recorded; leave hand= out, or choose the other");
  if (!side && gloves.size() > 1)
    return replay_error(spec, Errc::usage,
                        "several gloves were recorded; add ?hand=left or ?hand=right");
  return std::move(gloves.front());
}

Result<std::unique_ptr<driver::Glove>> open_recording(const driver::DeviceSpec& spec,
                                                      const ReplayOptions& settings,
                                                      std::optional<Side> asked,
                                                      std::optional<Side> side) {
  if (spec.options.contains("rate"))
    return replay_error(spec, Errc::usage,
                        "rate is for tables (.csv, .tsv, .txt); a recording has its times");
  auto reader = ChunkReader::open(spec.target);
  if (!reader) return reader.error();
  auto glove = choose(spec, gloves_of(*std::move(reader)), asked, side);
  if (!glove) return glove.error();
  const OpenSource<GloveSample> open =
      [path = spec.target, number = glove->number]() -> std::unique_ptr<SampleSource<GloveSample>> {
    auto again = ChunkReader::open(path);
    if (!again) return nullptr;
    return std::make_unique<RecordedSource<GloveSample>>(
        *std::move(again), [number](const LogEntry& entry) -> std::optional<GloveSample> {
          const auto recorded = sample_of(entry);
          if (!recorded || recorded->glove != number) return std::nullopt;
          return recorded->sample;
        });
  };
  if (const auto source = open(); source == nullptr || !source->next())
    return replay_error(spec, Errc::bad_input, "holds no sample of this glove");
  return std::unique_ptr<driver::Glove>(
      std::make_unique<ReplayedGlove>(spec, settings, std::move(glove->info), open));
}

bool is_table(const std::string& name) {
  const std::string ending = to_lower(std::filesystem::path(name).extension().string());
  return ending == ".csv" || ending == ".tsv" || ending == ".txt";
}

Result<std::unique_ptr<driver::Glove>>
open_table(const driver::DeviceSpec& spec, const ReplayOptions& settings, TableWishes wishes) {
  if (const auto option = spec.options.find("rate"); option != spec.options.end()) {
    const auto rate_hz = to_number(option->second);
    if (!rate_hz || !(*rate_hz >= 1.0 && *rate_hz <= 1e4))
      return replay_error(spec, Errc::usage,
                          "rate must be a number from 1 to 10000, rows per second");
    wishes.rate_hz = rate_hz;
  }
  auto table = read_sample_table(spec.target, wishes);
  if (!table) return table.error();
  const auto samples = std::make_shared<const std::vector<GloveSample>>(std::move(table->samples));
  return std::unique_ptr<driver::Glove>(
      std::make_unique<ReplayedGlove>(spec, settings, std::move(table->info), [samples] {
        return std::make_unique<TableSamples>(samples);
      }));
}

Result<std::unique_ptr<driver::Glove>> open_replay(const driver::DeviceSpec& spec,
                                                   std::optional<Side> side) {
  if (const auto fine = driver::allow_options(spec, {"hand", "speed", "loop", "end", "rate"});
      !fine)
    return fine.error();
  if (spec.target.empty())
    return replay_error(spec, Errc::usage, "name the recording, e.g. replay:take1.nendo");
  const auto settings = replay_options(spec);
  if (!settings) return settings.error();
  const auto asked = driver::hand_option(spec);
  if (!asked) return asked.error();
  return is_table(spec.target) ? open_table(spec, *settings, {*asked, side, std::nullopt})
                               : open_recording(spec, *settings, *asked, side);
}

} // namespace

driver::GloveDriver replay_driver() noexcept {
  return {"replay", "replay:FILE[?hand=left|right&speed=X&loop=yes|end=hold&rate=HZ]",
          "a glove as `nendo record` or `nendo run --record` recorded it, or a table of counts "
          "(.csv, .tsv, .txt)",
          [](const driver::DeviceSpec& spec, std::optional<Side> side,
             const driver::GloveContext& /*context*/) { return open_replay(spec, side); }};
}

} // namespace nendo::recording
