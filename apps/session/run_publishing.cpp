#include "session/run_publishing.hpp"

#include <algorithm>
#include <utility>

#include "publish/target.hpp"

namespace nendo::session {
namespace {

publish::LoopOutline outline_of(const PlacedLoop& placed, const deform::Mesh& model,
                                const deform::BlockLayout& layout) {
  const auto& options = placed.setup.options;
  const flow::FrameCapacity capacity = frame_capacity(placed);
  publish::LoopOutline outline{&model,
                               &layout,
                               options.sculptor.mode,
                               options.rate_hz,
                               placed.setup.placement.units_per_metre,
                               capacity.fields,
                               capacity.functions};
  for (const flow::HandInput& input : placed.setup.inputs) {
    if (input.layer) continue; // played over another input's bones
    outline.skeletons[flow::Placement::index_of(input.side)] = input.skeleton(input.first.side);
  }
  return outline;
}

publish::LoopOutline outline_of(const LoopStart& start) {
  return outline_of(start.placed, start.model, start.placed.loop->changes().layout());
}

// Each version of the model has a segment, and the name goes from one to the next.
class SegmentSink final : public PublishingSink {
public:
  SegmentSink(std::string text, publish::SegmentTarget target)
      : text_(std::move(text)), target_(std::move(target)) {}

  Result<void> begin(const LoopStart& start) override {
    placed_ = &start.placed;
    segments_.begin(new_segment());
    return segments_.now()->begin(outline_of(start));
  }
  Result<void> prepare(const flow::ModelVersion& version) override {
    auto next = new_segment();
    const auto laid = next->lay_out(outline_of(*placed_, version.mesh, version.layout()));
    if (laid) segments_.prepare(std::move(next));
    return laid;
  }
  Result<void> settle() override {
    const auto before = segments_.settle();
    if (!before) return {};
    end(*before);
    return segments_.now()->announce();
  }
  void show(const flow::Frame& frame) noexcept override { segments_.of(frame).show(frame); }
  PublishedTo end() override {
    if (segments_.now()) end(*segments_.now());
    segments_.begin(nullptr);
    return {text_, done_};
  }

private:
  std::shared_ptr<publish::SegmentPublisher> new_segment() const {
    return std::make_shared<publish::SegmentPublisher>(target_.name, target_.group);
  }
  void end(publish::SegmentPublisher& segment) {
    segment.end();
    const auto counts = segment.counts();
    done_.records += counts.records;
    done_.shape_changes += counts.shape_changes;
    done_.bytes = counts.bytes;
    done_.is_locked = counts.is_locked;
  }

  std::string text_;
  publish::SegmentTarget target_;
  const PlacedLoop* placed_ = nullptr;
  VersionTarget<publish::SegmentPublisher> segments_;
  publish::SegmentCounts done_; ///< the counts of all segments
};

// A publisher of hands over a network, which has nothing to do with the model's versions.
template <class Publisher>
class NetworkSink final : public PublishingSink {
public:
  template <class Target>
  NetworkSink(std::string text, const Target& target)
      : text_(std::move(text)), publisher_(text_, target) {}

  Result<void> begin(const LoopStart& start) override {
    return publisher_.begin(outline_of(start));
  }
  Result<void> prepare(const flow::ModelVersion&) override { return {}; } // it has no vertices
  void show(const flow::Frame& frame) noexcept override { publisher_.show(frame); }
  PublishedTo end() override {
    publisher_.end();
    return {text_, publisher_.counts()};
  }

private:
  std::string text_;
  Publisher publisher_;
};

} // namespace

void add_publish_option(cli::Command& command, std::vector<std::string>& targets) {
  command
      .add_option("--to,--publish", targets,
                  "Pass every tick to other programs: shm:NAME (hands, CSRBF update and vertices "
                  "in /dev/shm/nendo-NAME; ?group=GROUP lets a group read it), "
                  "osc:[ADDRESS:]PORT (hands as OSC messages), vmc:[ADDRESS:]PORT (bones of an "
                  "avatar, by the VMC protocol), vrpn[:[ADDRESS:]PORT] (a VRPN server); all three "
                  "with ?rate=HZ. May be repeated")
      .once_each("TARGET");
}

Result<std::vector<std::unique_ptr<PublishingSink>>>
publish_to(const std::vector<std::string>& targets) {
  std::vector<std::unique_ptr<PublishingSink>> sinks;
  std::vector<publish::Target> places;
  for (const auto& text : targets) {
    const auto target = publish::parse_target(text);
    if (!target) return Error{Errc::usage, "--to " + target.error().message};
    const auto same = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return publish::is_same_place(place, *target);
    });
    if (same != places.end())
      return Error{Errc::usage, "--to " + text + ": is the same target as " +
                                    targets[static_cast<std::size_t>(same - places.begin())] +
                                    "; give it once"};
    places.push_back(*target);
    if (const auto* segment = std::get_if<publish::SegmentTarget>(&*target)) {
      sinks.push_back(std::make_unique<SegmentSink>(text, *segment));
    } else if (const auto* osc = std::get_if<publish::OscTarget>(&*target)) {
      sinks.push_back(std::make_unique<NetworkSink<publish::OscPublisher>>(text, *osc));
    } else if (const auto* vrpn = std::get_if<publish::VrpnTarget>(&*target)) {
      sinks.push_back(std::make_unique<NetworkSink<publish::VrpnPublisher>>(text, *vrpn));
    }
  }
  return sinks;
}

} // namespace nendo::session
