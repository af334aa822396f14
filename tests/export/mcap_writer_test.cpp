// The format of recordings for ROS 2, read by a reader that was written from its specification.

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "export/mcap_writer.hpp"
#include "support/mcap_reader.hpp"

namespace mcap_writer_test {

using namespace nendo;
using exporting::McapWriter;
using test::Mcap;

namespace {

std::vector<exporting::McapChannel> any_channels() {
  return {{"/one", "a_msgs/msg/A", "string data\n", {{"key", "value"}, {"", "two\nlines"}}},
          {"/two", "a_msgs/msg/A", "string data\n", {}},
          {"/three", "b_msgs/msg/B", "float64 x\n", {{"key", std::string(70'000, 'v')}}},
          {"/silent", "b_msgs/msg/B", "float64 x\n", {}}};
}

struct Written {
  std::string file;
  std::vector<Mcap::Message> messages;
};

/// Random messages, of which some compress well. Times may fall.
Written any_file(unsigned seed, std::size_t count, std::size_t max_bytes) {
  std::mt19937 random(seed);
  Written written;
  McapWriter writer("a test", any_channels());
  const auto collect = [&] {
    const auto bytes = writer.take();
    written.file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  std::vector<std::uint32_t> sequences(3);
  std::uint64_t time_ns = 1'700'000'000'000'000'000;
  for (std::size_t at = 0; at < count; ++at) {
    const auto channel = static_cast<std::uint16_t>(random() % 3);
    time_ns += random() % 1000;
    time_ns -= random() % 500;
    Mcap::Message message{any_channels()[channel].topic, time_ns, time_ns, sequences[channel]++,
                          std::string(random() % (max_bytes + 1), 'x')};
    if (random() % 2 == 0)
      std::ranges::generate(message.data, [&] { return static_cast<char>(random()); });
    writer.add(channel, time_ns, std::as_bytes(std::span(message.data)));
    written.messages.push_back(message);
    if (random() % 3 == 0) collect();
  }
  CHECK(writer.messages() == count);
  writer.finish();
  collect();
  return written;
}

std::vector<Mcap::Message> by_time(std::vector<Mcap::Message> messages) {
  std::ranges::stable_sort(messages, [](const auto& a, const auto& b) {
    return std::tie(a.log_ns, a.topic, a.sequence) < std::tie(b.log_ns, b.topic, b.sequence);
  });
  return messages;
}

} // namespace

TEST_SUITE("mcap_writer") {
  TEST_CASE("a stream has each message once, in order, with its channel and schema") {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Written written = any_file(seed, 300 * seed, 20'000);
      const Mcap read = Mcap::streamed(written.file);
      CHECK(read.is_whole);
      CHECK(read.messages == written.messages);
      CHECK(read.chunks >= 3 * seed / 2);
      CHECK(read.profile == "ros2");
      CHECK(read.library == "a test");
      REQUIRE(read.channels.size() == 4);
      for (std::uint16_t at = 0; at < 4; ++at) {
        const auto expected = any_channels()[at];
        CHECK(read.channels.at(at).topic == expected.topic);
        CHECK(read.channels.at(at).schema_name == expected.type);
        CHECK(read.channels.at(at).schema == expected.schema);
        CHECK(read.channels.at(at).metadata ==
              Mcap::Map(expected.metadata.begin(), expected.metadata.end()));
      }
    }
  }

  TEST_CASE("the indices find each message of any time once") {
    const Written written = any_file(7, 1500, 9000);
    const auto all = by_time(written.messages);
    const Mcap read = Mcap::indexed(written.file);
    CHECK(by_time(read.messages) == all);
    CHECK(read.channels.size() == 4);
    std::mt19937 random(8);
    std::size_t found = 0;
    for (int round = 0; round < 20; ++round) {
      const std::uint64_t a = all[random() % all.size()].log_ns;
      const std::uint64_t b = all[random() % all.size()].log_ns;
      std::vector<Mcap::Message> expected;
      std::ranges::copy_if(all, std::back_inserter(expected), [&](const auto& message) {
        return message.log_ns >= std::min(a, b) && message.log_ns <= std::max(a, b);
      });
      CHECK(by_time(Mcap::indexed(written.file, std::min(a, b), std::max(a, b)).messages) ==
            expected);
      found += expected.size();
    }
    CHECK(found > 1000);
  }

  TEST_CASE("the statistics count what is in the file") {
    const Written written = any_file(9, 700, 8000);
    const Mcap read = Mcap::indexed(written.file);
    CHECK(read.statistics.messages == 700);
    CHECK(read.statistics.schemas == 2);
    CHECK(read.statistics.channels == 4);
    CHECK(read.statistics.metadata == 1);
    CHECK(read.statistics.chunks == read.chunks);
    CHECK(read.chunks == Mcap::streamed(written.file).chunks);
    const auto all = by_time(written.messages);
    CHECK(read.statistics.first_ns == all.front().log_ns);
    CHECK(read.statistics.last_ns == all.back().log_ns);
    for (const auto& [id, count] : read.statistics.counts)
      CHECK(count == static_cast<std::uint64_t>(std::ranges::count(all, read.channels.at(id).topic,
                                                                   &Mcap::Message::topic)));
    CHECK(read.metadata.at("rosbag2").at("ROS_DISTRO") == "humble");
  }

  TEST_CASE("a file without a message is whole") {
    const Written written = any_file(1, 0, 0);
    CHECK(Mcap::streamed(written.file).is_whole);
    const Mcap read = Mcap::indexed(written.file);
    CHECK(read.messages.empty());
    CHECK(read.statistics.messages == 0);
    CHECK(read.statistics.first_ns == 0);
  }

  TEST_CASE("a file that is cut anywhere has the messages of its whole chunks") {
    const Written written = any_file(11, 250, 30'000);
    const Mcap whole = Mcap::streamed(written.file);
    REQUIRE(whole.chunk_ends.size() >= 3);
    std::mt19937 random(12);
    std::vector<std::size_t> cuts;
    for (const auto& [end, count] : whole.chunk_ends)
      cuts.insert(cuts.end(), {end - 1, end, end + 1});
    for (std::size_t byte = 0; byte < 100; ++byte)
      cuts.insert(cuts.end(),
                  {byte, written.file.size() - 1 - byte, random() % written.file.size()});
    for (const std::size_t cut : cuts) {
      std::size_t expected = 0;
      for (const auto& [end, count] : whole.chunk_ends)
        if (end <= cut) expected = count;
      const Mcap read = Mcap::streamed(std::string_view(written.file).substr(0, cut));
      CHECK_FALSE(read.is_whole);
      CHECK(read.messages.size() == expected);
      CHECK(std::equal(read.messages.begin(), read.messages.end(), written.messages.begin()));
    }
  }

  TEST_CASE("a changed byte in a chunk does not pass") {
    Written written = any_file(13, 50, 30'000);
    const std::size_t end = Mcap::streamed(written.file).chunk_ends.front().first;
    written.file[end - 100] = static_cast<char>(written.file[end - 100] ^ 1);
    CHECK_THROWS(Mcap::streamed(written.file));
  }
}

} // namespace mcap_writer_test
