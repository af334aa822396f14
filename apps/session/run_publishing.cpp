#include "session/run_publishing.hpp"

#include <algorithm>
#include <utility>

#include "publish/datagrams.hpp"
#include "publish/segment.hpp"
#include "publish/target.hpp"

namespace nendo::session {
namespace {

publish::LoopOutline outline_of(const LoopStart& start) {
  const PlacedLoop& placed = start.placed;
  const auto& options = placed.setup.options;
  const FrameCapacity most = frame_capacity(placed);
  publish::LoopOutline outline;
  outline.model = &start.model;
  outline.layout = &placed.loop->layout();
  outline.mode = options.sculptor.mode;
  outline.rate_hz = options.rate_hz;
  outline.units_per_metre = placed.setup.placement.units_per_metre;
  outline.most_fields = most.fields;
  outline.functions = most.functions;
  return outline;
}

class SegmentSink final : public PublishingSink {
public:
  SegmentSink(std::string text, const publish::SegmentTarget& target)
      : text_(std::move(text)), segment_(target.name, target.group) {}

  Result<void> begin(const LoopStart& start) override { return segment_.begin(outline_of(start)); }
  void show(const flow::Frame& frame) noexcept override { segment_.show(frame); }
  PublishedTo end() override {
    segment_.end();
    const auto counts = segment_.counts();
    PublishedTo result{.target = text_, .records = counts.records};
    result.shape_changes = counts.shape_changes;
    result.bytes = counts.bytes;
    result.is_segment = true;
    result.is_locked = counts.is_locked;
    return result;
  }

private:
  std::string text_;
  publish::SegmentPublisher segment_;
};

class DatagramSink final : public PublishingSink {
public:
  DatagramSink(std::string text, const publish::DatagramTarget& target)
      : text_(std::move(text)), datagrams_(text_, target) {}

  Result<void> begin(const LoopStart& start) override {
    return datagrams_.begin(outline_of(start));
  }
  void show(const flow::Frame& frame) noexcept override { datagrams_.show(frame); }
  PublishedTo end() override {
    datagrams_.end();
    const auto counts = datagrams_.counts();
    PublishedTo result{.target = text_, .records = counts.records};
    result.bytes = counts.bytes;
    result.datagrams = counts.datagrams;
    result.lost_records = counts.lost;
    result.refused_datagrams = counts.refused;
    return result;
  }

private:
  std::string text_;
  publish::DatagramPublisher datagrams_;
};

} // namespace

void add_publish_option(cli::Command& command, std::vector<std::string>& targets) {
  command
      .add_option("--publish", targets,
                  "Shows every tick to other programs: shm:NAME (hands, CSRBF update and vertices "
                  "in /dev/shm/nendo-NAME; ?group=GROUP may read it, too), udp:PORT or "
                  "udp:ADDRESS:PORT (hands and update). May be given several times")
      .once_each("TARGET");
}

Result<std::vector<std::unique_ptr<PublishingSink>>>
publish_to(const std::vector<std::string>& targets) {
  std::vector<std::unique_ptr<PublishingSink>> sinks;
  std::vector<publish::Target> places;
  for (const auto& text : targets) {
    const auto target = publish::parse_target(text);
    if (!target) return Error{Errc::usage, "--publish " + target.error().message};
    const auto same = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return publish::is_same_place(place, *target);
    });
    if (same != places.end())
      return Error{Errc::usage, "--publish " + text + ": is where --publish " +
                                    targets[static_cast<std::size_t>(same - places.begin())] +
                                    " leads; give it once"};
    places.push_back(*target);
    if (const auto* segment = std::get_if<publish::SegmentTarget>(&*target)) {
      sinks.push_back(std::make_unique<SegmentSink>(text, *segment));
    } else if (const auto* datagrams = std::get_if<publish::DatagramTarget>(&*target)) {
      sinks.push_back(std::make_unique<DatagramSink>(text, *datagrams));
    }
  }
  return sinks;
}

} // namespace nendo::session
