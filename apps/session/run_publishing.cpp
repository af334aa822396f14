#include "session/run_publishing.hpp"

#include <algorithm>
#include <utility>

#include <nendo/publish/datagrams.hpp>
#include <nendo/publish/segment.hpp>
#include <nendo/publish/target.hpp>

namespace nendo::session {
namespace {

publish::LoopOutline outline_of(const PlacedLoop& placed, const deform::Mesh& model) {
  const auto& options = placed.setup.options;
  const FrameRoom room = room_of_frames(placed);
  publish::LoopOutline outline;
  outline.model = &model;
  outline.layout = &placed.loop->layout();
  outline.mode = options.sculptor.mode;
  outline.rate_hz = options.rate_hz;
  outline.units_per_metre = placed.setup.placement.units_per_metre;
  outline.most_fields = room.fields;
  outline.functions = room.functions;
  return outline;
}

class SegmentOutlet final : public PublishingOutlet {
public:
  SegmentOutlet(std::string text, const publish::SegmentTarget& target)
      : text_(std::move(text)), segment_(target.name, target.group) {}

  Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<gloves::OpenHand>&) override {
    return segment_.begin(outline_of(placed, model));
  }
  void show(const flow::Frame& frame) noexcept override { segment_.show(frame); }
  PublishedTo end() override {
    segment_.end();
    const auto counts = segment_.counts();
    PublishedTo told{.target = text_, .records = counts.records};
    told.shape_changes = counts.shape_changes;
    told.bytes = counts.bytes;
    told.is_segment = true;
    told.is_locked = counts.is_locked;
    return told;
  }

private:
  std::string text_;
  publish::SegmentPublisher segment_;
};

class DatagramOutlet final : public PublishingOutlet {
public:
  DatagramOutlet(std::string text, const publish::DatagramTarget& target)
      : text_(std::move(text)), datagrams_(text_, target) {}

  Result<void> begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<gloves::OpenHand>&) override {
    return datagrams_.begin(outline_of(placed, model));
  }
  void show(const flow::Frame& frame) noexcept override { datagrams_.show(frame); }
  PublishedTo end() override {
    datagrams_.end();
    const auto counts = datagrams_.counts();
    PublishedTo told{.target = text_, .records = counts.records};
    told.bytes = counts.bytes;
    told.datagrams = counts.datagrams;
    told.lost_records = counts.lost;
    told.refused_datagrams = counts.refused;
    return told;
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

Result<std::vector<std::unique_ptr<PublishingOutlet>>>
publish_to(const std::vector<std::string>& targets) {
  std::vector<std::unique_ptr<PublishingOutlet>> outlets;
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
      outlets.push_back(std::make_unique<SegmentOutlet>(text, *segment));
    } else if (const auto* datagrams = std::get_if<publish::DatagramTarget>(&*target)) {
      outlets.push_back(std::make_unique<DatagramOutlet>(text, *datagrams));
    }
  }
  return outlets;
}

} // namespace nendo::session
