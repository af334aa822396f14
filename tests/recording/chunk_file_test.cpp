#include <nendo/recording/chunk_file.hpp>

#include <fstream>
#include <random>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/base/byte_writer.hpp>
#include <nendo/base/crc32c.hpp>

#include "support/temporary_folder.hpp"

namespace chunk_file_test {

using namespace nendo;
using namespace nendo::recording;

namespace {

constexpr ChunkType text_chunk = chunk_type("TEXT");

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

struct Sample {
  std::vector<std::byte> file;
  std::vector<std::vector<std::byte>> payloads;
  std::vector<std::size_t> ends; ///< end of each chunk

  explicit Sample(std::initializer_list<std::string_view> contents) {
    ByteWriter(file).bytes(file_header());
    for (const auto text : contents)
      add(bytes_of(text));
  }
  void add(std::vector<std::byte> payload) {
    append_chunk(file, text_chunk, static_cast<std::uint32_t>(payloads.size()), payload);
    payloads.push_back(std::move(payload));
    ends.push_back(file.size());
  }
};

struct Read {
  std::vector<std::vector<std::byte>> payloads;
  std::vector<std::uint32_t> numbers;
  std::uint64_t damages = 0;
  std::uint64_t good_end = 0;
};

Read read_all(ChunkReader reader) {
  Read read;
  while (const auto chunk = reader.next()) {
    read.payloads.emplace_back(chunk->payload.begin(), chunk->payload.end());
    read.numbers.push_back(chunk->number);
    CHECK(chunk->type == text_chunk);
  }
  read.damages = reader.damage_count();
  read.good_end = reader.good_end();
  for (const auto& damage : reader.damages())
    CHECK_FALSE(damage.what.empty());
  CHECK(reader.damages().size() == std::min<std::uint64_t>(read.damages, 100));
  return read;
}

Read read_all(const std::vector<std::byte>& file) {
  auto reader = ChunkReader::of(file, "test");
  REQUIRE(reader);
  return read_all(*std::move(reader));
}

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

std::string error_of(const Result<ChunkReader>& reader) {
  REQUIRE_FALSE(reader);
  CHECK(reader.error().code == Errc::bad_input);
  CHECK(reader.error().message.find('\n') == std::string::npos);
  return reader.error().message;
}

} // namespace

TEST_SUITE("chunk_file") {
  TEST_CASE("what was written is read again, from memory and from a file") {
    Sample sample{"first", "", "third"};
    std::mt19937 random(1);
    for (const std::size_t size : {300000UL, 1UL, 262144UL, 1000000UL}) {
      std::vector<std::byte> payload(size);
      for (auto& byte : payload)
        byte = static_cast<std::byte>(random() & 0xFFU);
      sample.add(std::move(payload));
    }
    const test::TemporaryFolder folder;
    write(folder.path() / "take", sample.file);
    auto opened = ChunkReader::open(folder.path() / "take");
    REQUIRE(opened);
    for (const Read& read : {read_all(sample.file), read_all(*std::move(opened))}) {
      CHECK(read.payloads == sample.payloads);
      CHECK(read.damages == 0);
      CHECK(read.good_end == sample.file.size());
    }
  }

  TEST_CASE("a file that ends anywhere is good up to its last whole chunk") {
    const Sample sample{"one", "", "the third", "four"};
    for (std::size_t size = file_header_bytes; size < sample.file.size(); ++size) {
      std::vector<std::byte> cut = sample.file;
      cut.resize(size);
      std::size_t whole = 0;
      while (sample.ends[whole] <= size)
        ++whole;
      const Read read = read_all(cut);
      CHECK(read.payloads.size() == whole);
      const std::size_t good = whole == 0 ? file_header_bytes : sample.ends[whole - 1];
      CHECK(read.good_end == good);
      CHECK(read.damages == (size > good ? 1 : 0));
    }
    for (std::size_t size = 0; size < file_header_bytes; ++size) {
      std::vector<std::byte> cut = sample.file;
      cut.resize(size);
      CHECK_FALSE(error_of(ChunkReader::of(cut, "test")).empty());
    }
  }

  TEST_CASE("a bit that turns over costs its own chunk and no other") {
    const Sample sample{"one", "", "the third", "four"};
    for (std::size_t at = file_header_bytes; at < sample.file.size(); ++at) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        std::vector<std::byte> damaged = sample.file;
        damaged[at] ^= static_cast<std::byte>(1U << bit);
        std::size_t hit = 0;
        while (sample.ends[hit] <= at)
          ++hit;
        auto others = sample.payloads;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(hit));
        const Read read = read_all(damaged);
        CHECK(read.payloads == others);
        CHECK(read.damages >= 1);
      }
    }
  }

  TEST_CASE("bytes that are missing or too many, and chunks that are, are reported") {
    const Sample sample{"one", "the second", "three", "four"};
    for (std::size_t at = sample.ends[0]; at < sample.ends[1]; ++at) {
      std::vector<std::byte> shorter = sample.file;
      shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(at));
      std::vector<std::byte> longer = sample.file;
      longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(at), std::byte{'N'});
      for (const auto& file : {shorter, longer}) {
        const Read read = read_all(file);
        CHECK(read.damages >= 1);
        CHECK(read.payloads.size() >= 3);
        CHECK(read.payloads.back() == sample.payloads.back());
      }
    }
    std::vector<std::byte> without = sample.file;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(sample.ends[0]),
                  without.begin() + static_cast<std::ptrdiff_t>(sample.ends[1]));
    const Read read = read_all(without);
    CHECK(read.numbers == std::vector<std::uint32_t>{0, 2, 3});
    CHECK(read.damages == 1);
  }

  TEST_CASE("hostile lengths, and headers within headers, cost no more than the file") {
    Sample sample{"one"};
    // A header that is whole, and says that a payload of 4 GiB follows.
    std::vector<std::byte> huge = sample.file;
    std::vector<std::byte> header;
    ByteWriter writer(header);
    writer.u32_le(chunk_type("NCHK"));
    writer.u32_le(text_chunk);
    writer.u32_le(UINT32_MAX);
    writer.u32_le(1);
    writer.u32_le(crc32c(header));
    huge.insert(huge.end(), header.begin(), header.end());
    CHECK(read_all(huge).payloads == sample.payloads);
    // Each of these says that all of the rest is its payload.
    std::vector<std::byte> nested = sample.file;
    constexpr std::size_t headers = 50'000;
    const std::vector<std::byte> rest(headers * chunk_header_bytes);
    for (std::size_t left = headers; left > 0; --left) {
      const auto next = chunk_header(text_chunk, 1, std::span(rest).first(left * 20));
      nested.insert(nested.end(), next.begin(), next.end());
    }
    nested.insert(nested.end(), 64, std::byte{0});
    const Read read = read_all(nested);
    CHECK(read.payloads.size() == 1);
    CHECK(read.damages >= 1);
  }

  TEST_CASE("what is no recording is reported in a line that says why") {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "take";
    write(path, {});
    CHECK(error_of(ChunkReader::open(path)).find("is empty") != std::string::npos);
    write(path, bytes_of("v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"));
    CHECK(error_of(ChunkReader::open(path)).find("is no recording") != std::string::npos);
    std::vector<std::byte> file = Sample{"one"}.file;
    file[13] ^= std::byte{1};
    write(path, file);
    CHECK(error_of(ChunkReader::open(path)).find("repair") != std::string::npos);
    CHECK(ChunkReader::open_damaged(path)); // for `repair`
    CHECK_FALSE(error_of(ChunkReader::open(folder.path())).empty());
    CHECK_FALSE(error_of(ChunkReader::open("/dev/zero")).empty());
    CHECK_FALSE(error_of(ChunkReader::open(folder.path() / "missing")).empty());
  }

  TEST_CASE("a newer minor version is read, and a newer major one and older ones are refused") {
    Sample sample{"one"};
    const auto with_version = [&](unsigned major, unsigned minor) {
      std::vector<std::byte> file(sample.file.begin(), sample.file.begin() + 8);
      ByteWriter writer(file);
      writer.u16_le(static_cast<std::uint16_t>(major));
      writer.u16_le(static_cast<std::uint16_t>(minor));
      writer.u32_le(crc32c(file));
      file.insert(file.end(), sample.file.begin() + 16, sample.file.end());
      return file;
    };
    CHECK(read_all(with_version(1, 99)).payloads == sample.payloads);
    for (const unsigned minor : {0U, 12U}) {
      const auto older = with_version(1, minor);
      CHECK(error_of(ChunkReader::of(older, "t")).find("record it again") != std::string::npos);
    }
    const auto newer = with_version(2, 0);
    CHECK(error_of(ChunkReader::of(newer, "t")).find("newer nendo") != std::string::npos);
    const test::TemporaryFolder folder;
    write(folder.path() / "take", newer);
    CHECK_FALSE(ChunkReader::open_damaged(folder.path() / "take"));
  }
}

} // namespace chunk_file_test
