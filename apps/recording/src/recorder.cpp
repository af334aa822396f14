#include <nendo/recording/recorder.hpp>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <unistd.h>

#include <nendo/flow/wrist.hpp>

#include "last_minute.hpp"
#include "take_file.hpp"

namespace nendo::recording {
namespace {

constexpr std::size_t largest_payload = std::size_t{1} << 18;
/// How often the input log is emptied.
constexpr std::chrono::milliseconds drain_time{20};

/// Returns how many bytes of memory a span may take. Gloves are counted as twice as fast as they
/// say, and as sending at least 250 samples per second.
std::size_t memory_for(const Setup& setup, HostClock::duration span) {
  constexpr double sample_entry_bytes = 88.0;
  constexpr double pose_entry_bytes = 95.0;
  constexpr double tick_entry_bytes = 26.0;
  constexpr double min_rate_hz = 250.0;
  double bytes_s = 1000.0;
  for (const auto& glove : setup.gloves)
    bytes_s += sample_entry_bytes * std::max(2.0 * glove.rate_hz, min_rate_hz);
  for (const auto& tracker : setup.trackers)
    bytes_s += pose_entry_bytes * std::max(2.0 * tracker.info.rate_hz, min_rate_hz);
  if (setup.loop) bytes_s += tick_entry_bytes * setup.loop->options.rate_hz;
  constexpr double max_bytes = 1e9;
  return static_cast<std::size_t>(std::min(max_bytes, bytes_s * (to_seconds(span) + 2.0)));
}

class InputLogRecorder final : public Recorder {
public:
  InputLogRecorder(flow::InputLog& input_log, RecorderOptions options, std::optional<TakeFile> file,
                   std::unique_ptr<LastMinute> last_minute)
      : input_log_(input_log), options_(std::move(options)), file_(std::move(file)),
        last_minute_(std::move(last_minute)) {
    payload_.reserve(2 * largest_payload);
    if (!last_minute_) return;
    auto crash_path = options_.kept_stem;
    crash_handler_.emplace(*last_minute_, crash_path += ".crash.nendo");
  }
  ~InputLogRecorder() override { (void)InputLogRecorder::end({}); }

  void start() {
    thread_ = std::jthread([this](const std::stop_token& stop) { record(stop); });
  }

  void save_last_minute() noexcept override { saves_.fetch_add(1, std::memory_order_relaxed); }

  void add_puppet(std::uint32_t number, RecordedPuppet puppet) override {
    const std::scoped_lock lock(puppets_mutex_);
    puppets_[number] = std::make_shared<const RecordedPuppet>(std::move(puppet));
  }

  Result<Recorded> end(const std::optional<ShapeSum>& shape) override {
    if (!std::exchange(ended_, true)) {
      thread_.request_stop();
      if (thread_.joinable()) thread_.join();
      finish(shape);
    }
    if (failure_) return *failure_;
    return recorded_;
  }

private:
  void record(const std::stop_token& stop) {
    std::mutex mutex; // only the wait needs it
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    HostTime next_chunk = HostClock::now() + options_.chunk_time;
    HostTime next_sent = HostClock::now() + options_.sent_time;
    while (!stop.stop_requested()) {
      wake.wait_until(lock, stop, std::min(next_chunk, HostClock::now() + drain_time),
                      [] { return false; });
      drain();
      const HostTime now = HostClock::now();
      if (now >= next_chunk || payload_.size() >= largest_payload) {
        write_chunk();
        next_chunk = now + options_.chunk_time;
      }
      if (now >= next_sent) {
        write_sent();
        next_sent = now + options_.sent_time;
      }
      if (last_minute_ && saves_.exchange(0, std::memory_order_relaxed) > 0) write_last_minute();
    }
  }

  void drain() {
    input_log_.drain([this](const flow::InputLogEntry& entry) noexcept {
      std::visit([this](const auto& taken) { add(taken); }, entry);
      if (payload_.size() >= largest_payload) write_chunk();
    });
  }

  void add(const flow::TakenSample& taken) {
    put({RecordedSample{taken.hand, taken.sample}});
    ++recorded_.samples;
    auto& edge = switches_[taken.hand % switches_.size()];
    if (options_.keep_on_switch && edge.turned_on(taken.sample.wrist_switch, taken.sample.arrival))
      save_last_minute();
  }
  void add(const flow::TakenPose& taken) { put({RecordedPose{taken.side, taken.pose}}); }
  void add(const flow::Command& command) {
    std::visit([this](const auto& one) { add_one(one); }, command);
  }
  void add_one(const flow::ChangeSettings& change) {
    put(change.settings);
    settings_ = change.settings;
  }
  /// The chunk with the puppet precedes the entry.
  void add_one(const flow::ChangePuppet& change) {
    puppet_ = PuppetChange{change.number, puppet_numbered(change.number)};
    if (puppet_->puppet && written_puppets_.insert(change.number).second) {
      write_chunk();
      ByteWriter writer(payload_);
      put_puppet_version(writer, change.number, *puppet_->puppet);
      append(puppet_version_chunk);
      if (last_minute_) last_minute_->add_chunk(puppet_version_chunk, payload_);
      payload_.clear();
    }
    put(*puppet_);
  }
  std::shared_ptr<const RecordedPuppet> puppet_numbered(std::uint32_t number) {
    const std::scoped_lock lock(puppets_mutex_);
    const auto known = puppets_.find(number);
    return known == puppets_.end() ? nullptr : known->second;
  }
  /// What decides a shape, and marks, are entries; others do not come from a loop.
  template <class Command>
  void add_one(const Command& command) {
    if constexpr (std::is_same_v<Command, flow::Request>) ++recorded_.requests;
    if constexpr (is_entry<Command>) put(command);
  }
  void add(const flow::LoggedTick& tick) {
    note_lost(tick.lost);
    put(tick);
    ++recorded_.ticks;
  }
  void put(const Entry& entry) {
    ByteWriter writer(payload_);
    if (std::exchange(settings_due_, false)) put_entry(writer, *settings_);
    if (std::exchange(puppet_due_, false)) put_entry(writer, *puppet_);
    put_entry(writer, entry);
    ++entries_;
  }
  void note_lost(std::uint64_t lost) {
    if (lost == recorded_.lost) return;
    put(Gap{lost - recorded_.lost});
    if (recorded_.lost == 0)
      report("the recorder cannot keep up; what is missing is marked in the recording");
    recorded_.lost = lost;
  }

  void write_chunk() {
    if (payload_.empty()) return;
    if (last_minute_) last_minute_->push(payload_, entries_, HostClock::now());
    append(log_chunk);
    payload_.clear();
    entries_ = 0;
    // A chunk may be the first that is kept, so each has the settings, if they have changed.
    settings_due_ = settings_.has_value();
    puppet_due_ = puppet_.has_value();
  }
  void write_sent() {
    if (!options_.sent) return;
    write_chunk(); // it follows the samples that it counts
    recorded_.sent = options_.sent();
    ByteWriter writer(payload_);
    put_sent(writer, recorded_.sent);
    append(sent_chunk);
    payload_.clear();
  }
  void append(ChunkType type) {
    if (!file_) return;
    if (const auto written = file_->append(type, payload_); !written) fail(written.error());
    recorded_.bytes = file_->bytes();
  }

  void write_last_minute() {
    write_chunk();
    std::filesystem::path path;
    for (;;) { // names that are taken by earlier runs stay
      path = options_.kept_stem;
      path += ".kept-" + std::to_string(++kept_number_) + ".nendo";
      std::error_code ignored;
      if (!std::filesystem::exists(path, ignored)) break;
    }
    auto file = NewFile::create(path);
    if (!file) return fail(file.error());
    if (!last_minute_->write(file->fd()) || ::fdatasync(file->fd()) != 0 || !file->close()) {
      const std::string why = std::generic_category().message(errno);
      return fail({Errc::failed, path.string() + ": cannot be kept: " + why + "; free some space"});
    }
    file->make_permanent();
    ++recorded_.kept;
    report("kept as " + path.string());
  }

  void finish(const std::optional<ShapeSum>& shape) {
    drain();
    note_lost(input_log_.lost());
    write_chunk();
    write_sent();
    if (last_minute_ && saves_.exchange(0, std::memory_order_relaxed) > 0) write_last_minute();
    ByteWriter writer(payload_);
    put_ending(writer, {HostClock::now(), recorded_.samples, recorded_.requests, recorded_.ticks,
                        recorded_.lost, shape});
    append(ending_chunk);
    payload_.clear();
  }

  void fail(const Error& error) {
    if (!failure_) failure_ = error;
    report(error.message);
  }
  void report(std::string_view line) const {
    if (options_.report) options_.report(line);
  }

  flow::InputLog& input_log_;
  RecorderOptions options_;
  std::optional<TakeFile> file_;
  std::unique_ptr<LastMinute> last_minute_;
  std::optional<CrashHandler> crash_handler_;
  std::vector<std::byte> payload_;
  std::uint64_t entries_ = 0;                  ///< in the payload
  std::optional<flow::LoopSettings> settings_; ///< nothing: those of the setup
  bool settings_due_ = false;                  ///< at the beginning of the next chunk
  std::optional<PuppetChange> puppet_;         ///< nothing: that of the setup
  bool puppet_due_ = false;                    ///< as settings_due_
  std::set<std::uint32_t> written_puppets_;
  std::mutex puppets_mutex_;
  std::map<std::uint32_t, std::shared_ptr<const RecordedPuppet>>
      puppets_; ///< indexed by their numbers
  std::array<flow::WristSwitchEdge, flow::max_inputs> switches_{};
  Recorded recorded_;
  std::optional<Error> failure_; ///< the first one
  unsigned kept_number_ = 0;
  bool ended_ = false;
  std::atomic<unsigned> saves_{0}; ///< asked for, and not begun
  std::jthread thread_;            // last: joined before what it uses is gone
};

} // namespace

Result<std::unique_ptr<Recorder>> Recorder::begin(const Setup& setup, flow::InputLog& input_log,
                                                  RecorderOptions options) {
  std::uint32_t chunks = 0;
  auto bytes = setup_bytes(setup, chunks);
  if (const auto fine = check_readable(setup, bytes); !fine) return fine.error();
  std::optional<TakeFile> file;
  if (!options.file.empty()) {
    auto created = TakeFile::create(options.file, bytes, chunks, TakeFile::Kind::live);
    if (!created) return created.error();
    file.emplace(*std::move(created));
  }
  std::unique_ptr<LastMinute> last_minute;
  if (options.keep_last > HostClock::duration::zero()) {
    last_minute = std::make_unique<LastMinute>(std::move(bytes), chunks, options.keep_last,
                                               memory_for(setup, options.keep_last));
  }
  auto recorder = std::make_unique<InputLogRecorder>(input_log, std::move(options), std::move(file),
                                                     std::move(last_minute));
  try {
    recorder->start();
  } catch (const std::system_error& error) {
    return Error{Errc::failed, std::string("no thread for the recorder: ") + error.what()};
  }
  return std::unique_ptr<Recorder>(std::move(recorder));
}

} // namespace nendo::recording
