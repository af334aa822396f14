#pragma once
// A reader of BVH files with its own forward kinematics, written from the format's description
// (Biovision, as the course notes of the University of Wisconsin, CS 838, give it) and not from the
// writer: any tree, any channels in any order. It throws if it cannot read a file.

#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

namespace nendo::test {

struct BvhNode {
  std::string name; ///< an End Site's is empty
  int parent = -1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::vector<std::string> channels;
};

class BvhRecording {
public:
  explicit BvhRecording(const std::string& text) : in_(text) {
    expect("HIERARCHY");
    expect("ROOT");
    read_node(-1, word());
    expect("MOTION");
    expect("Frames:");
    declared_frames = static_cast<std::size_t>(std::stoull(word()));
    expect("Frame");
    expect("Time:");
    frame_time_s = number();
    std::string line;
    std::getline(in_, line);
    while (std::getline(in_, line)) {
      torn = in_.eof(); // the last line has no end
      read_frame(line);
    }
  }

  std::size_t declared_frames = 0;
  double frame_time_s = 0.0;
  bool torn = false;
  std::vector<BvhNode> nodes; ///< in the order of the file
  std::vector<std::vector<double>> frames;

  /// Returns the node of that name; throws if there is none.
  std::size_t find(const std::string& name) const {
    for (std::size_t at = 0; at < nodes.size(); ++at)
      if (nodes[at].name == name) return at;
    throw std::runtime_error("no joint " + name);
  }
  /// Returns the End Site on the joint of that name.
  std::size_t find_end_of(const std::string& name) const {
    const auto parent = static_cast<int>(find(name));
    for (std::size_t at = 0; at < nodes.size(); ++at)
      if (nodes[at].name.empty() && nodes[at].parent == parent) return at;
    throw std::runtime_error("no End Site on " + name);
  }

  /// Returns each node's place in the world, in the file's units.
  std::vector<Eigen::Matrix4d> world(std::size_t frame) const {
    std::vector<Eigen::Matrix4d> placed;
    std::size_t at = 0;
    for (const BvhNode& node : nodes) {
      Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
      if (node.parent >= 0) m = placed[static_cast<std::size_t>(node.parent)];
      m = m * shift(node.offset);
      for (const auto& channel : node.channels)
        m = m * applied(channel, frames.at(frame).at(at++));
      placed.push_back(m);
    }
    return placed;
  }
  /// Returns the value of one channel of a frame.
  double channel(std::size_t frame, const std::string& joint, const std::string& name) const {
    std::size_t at = 0;
    for (const BvhNode& node : nodes) {
      for (const auto& channel : node.channels) {
        if (node.name == joint && channel == name) return frames.at(frame).at(at);
        ++at;
      }
    }
    throw std::runtime_error("no channel " + name + " of " + joint);
  }

private:
  std::string word() {
    std::string next;
    if (!(in_ >> next)) throw std::runtime_error("the file ends too early");
    return next;
  }
  void expect(const std::string& what) {
    const std::string found = word();
    if (found != what) throw std::runtime_error("expected " + what + ", not " + found);
  }
  double number() { return to_number(word()); }
  static double to_number(const std::string& text) {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used != text.size() || !std::isfinite(value))
      throw std::runtime_error("not a finite number: " + text);
    return value;
  }

  void read_node(int parent, const std::string& name) {
    const auto self = static_cast<int>(nodes.size());
    nodes.push_back({name, parent, {}, {}});
    expect("{");
    expect("OFFSET");
    const double x = number(), y = number(), z = number();
    nodes.back().offset = {x, y, z};
    for (std::string next = word(); next != "}"; next = word()) {
      if (next == "CHANNELS") {
        const double count = number();
        for (int n = 0; n < count; ++n)
          nodes[static_cast<std::size_t>(self)].channels.push_back(word());
        channel_count_ += nodes[static_cast<std::size_t>(self)].channels.size();
      } else if (next == "JOINT") {
        read_node(self, word());
      } else if (next == "End") {
        expect("Site");
        read_node(self, "");
      } else {
        throw std::runtime_error("unknown word " + next);
      }
    }
  }
  void read_frame(const std::string& line) {
    std::istringstream words(line);
    std::vector<double> values;
    for (std::string next; words >> next;)
      values.push_back(to_number(next));
    if (values.size() != channel_count_) throw std::runtime_error("a frame of wrong length");
    frames.push_back(std::move(values));
  }

  static Eigen::Matrix4d shift(const Eigen::Vector3d& by) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    for (int row = 0; row < 3; ++row)
      m(row, 3) = by[row];
    return m;
  }
  static Eigen::Matrix4d applied(const std::string& channel, double value) {
    const int axis = channel.at(0) - 'X';
    if (axis < 0 || axis > 2) throw std::runtime_error("unknown channel " + channel);
    if (channel.substr(1) == "position") return shift(value * Eigen::Vector3d::Unit(axis));
    if (channel.substr(1) != "rotation") throw std::runtime_error("unknown channel " + channel);
    const double angle = value * std::acos(-1.0) / 180.0;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m(a, a) = m(b, b) = std::cos(angle);
    m(b, a) = std::sin(angle);
    m(a, b) = -std::sin(angle);
    return m;
  }

  std::istringstream in_;
  std::size_t channel_count_ = 0;
};

} // namespace nendo::test
