#pragma once
// A reader of ROS 2's messages that knows no type: it takes the fields from a schema in the
// encoding `ros2msg`, and reads messages in CDR by them. It also computes the hash of a type from
// its schema (REP-2016). Written from the specifications.

#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/sha256.hpp"

namespace nendo::test {

class Ros2Schema {
public:
  struct Field {
    std::string type; ///< without []
    bool is_sequence = false;
    std::string name;
  };

  /// name: of the message, as "sensor_msgs/msg/JointState".
  Ros2Schema(std::string name, std::string_view text) : own_(std::move(name)) {
    std::string current = own_;
    while (!text.empty()) {
      const std::string line(text.substr(0, text.find('\n')));
      text.remove_prefix(line.size() + 1);
      if (line == std::string(80, '=')) continue;
      if (line.starts_with("MSG: ")) {
        current = with_msg(line.substr(5));
        continue;
      }
      const std::size_t space = line.find(' ');
      Field field{line.substr(0, space), false, line.substr(space + 1)};
      field.is_sequence = field.type.ends_with("[]");
      if (field.is_sequence) field.type.resize(field.type.size() - 2);
      if (!is_primitive(field.type)) field.type = with_msg(field.type);
      types_[current].push_back(field);
    }
  }

  /// "RIHS01_" and the SHA-256 of the type's description in JSON.
  std::string hash() const {
    std::set<std::string> used;
    collect(own_, used);
    std::string all;
    for (const auto& one : used)
      all += (all.empty() ? "" : ", ") + description_of(one);
    return "RIHS01_" + sha256("{\"type_description\": " + description_of(own_) +
                              ", \"referenced_type_descriptions\": [" + all + "]}");
  }

  /// The leaves of a message, in their order, with paths like "transforms[3].header.frame_id".
  struct Leaf {
    std::string path;
    double number = 0.0;
    std::string text{};
  };
  /// Throws std::runtime_error unless the bytes are exactly one message.
  std::vector<Leaf> decode(std::span<const std::byte> bytes) const {
    Cursor cursor{bytes, {}};
    if (bytes.size() < 4 || std::memcmp(bytes.data(), "\0\1\0\0", 4) != 0)
      throw std::runtime_error("is not CDR, version 1, little-endian");
    cursor.bytes = bytes.subspan(4);
    std::vector<Leaf> leaves;
    read(own_, "", cursor, leaves);
    if (cursor.at != cursor.bytes.size()) throw std::runtime_error("bytes follow the message");
    return leaves;
  }

private:
  struct Cursor {
    std::span<const std::byte> bytes;
    std::size_t at = 0;

    template <class T>
    T number() {
      at = (at + sizeof(T) - 1) / sizeof(T) * sizeof(T);
      if (at + sizeof(T) > bytes.size()) throw std::runtime_error("ends too early");
      T value;
      std::memcpy(&value, &bytes[at], sizeof value);
      at += sizeof value;
      return value;
    }
    std::string text() {
      const auto length = number<std::uint32_t>();
      if (length == 0 || at + length > bytes.size() || bytes[at + length - 1] != std::byte{0})
        throw std::runtime_error("has a string without an end");
      std::string value(reinterpret_cast<const char*>(&bytes[at]), length - 1);
      at += length;
      return value;
    }
  };

  static bool is_primitive(const std::string& type) { return type.find('/') == std::string::npos; }
  static std::string with_msg(const std::string& name) {
    const std::size_t slash = name.find('/');
    return name.substr(0, slash) + "/msg" + name.substr(slash);
  }
  void collect(const std::string& type, std::set<std::string>& used) const {
    for (const Field& field : types_.at(type))
      if (!is_primitive(field.type) && used.insert(field.type).second) collect(field.type, used);
  }
  std::string description_of(const std::string& type) const {
    static const std::map<std::string, int> ids{{"uint8", 3},    {"int32", 6}, {"uint32", 7},
                                                {"float64", 11}, {"bool", 15}, {"byte", 16},
                                                {"string", 17}};
    std::string fields;
    for (const Field& field : types_.at(type)) {
      const bool nested = !is_primitive(field.type);
      const int id = (nested ? 1 : ids.at(field.type)) + (field.is_sequence ? 144 : 0);
      fields += (fields.empty() ? "" : ", ");
      fields += "{\"name\": \"" + field.name + "\", \"type\": {\"type_id\": " + std::to_string(id) +
                ", \"capacity\": 0, \"string_capacity\": 0, \"nested_type_name\": \"" +
                (nested ? field.type : "") + "\"}}";
    }
    return "{\"type_name\": \"" + type + "\", \"fields\": [" + fields + "]}";
  }
  void read(const std::string& type, const std::string& path, Cursor& cursor,
            std::vector<Leaf>& leaves) const {
    for (const Field& field : types_.at(type)) {
      const std::string here = path.empty() ? field.name : path + "." + field.name;
      if (!field.is_sequence) {
        read_one(field.type, here, cursor, leaves);
        continue;
      }
      const auto count = cursor.number<std::uint32_t>();
      for (std::uint32_t at = 0; at < count; ++at)
        read_one(field.type, here + "[" + std::to_string(at) + "]", cursor, leaves);
    }
  }
  void read_one(const std::string& type, const std::string& path, Cursor& cursor,
                std::vector<Leaf>& leaves) const {
    if (type == "string") {
      leaves.push_back({path, 0.0, cursor.text()});
    } else if (type == "float64") {
      leaves.push_back({path, cursor.number<double>()});
    } else if (type == "uint8" || type == "bool") {
      leaves.push_back({path, static_cast<double>(cursor.number<std::uint8_t>())});
    } else if (type == "int32") {
      leaves.push_back({path, static_cast<double>(cursor.number<std::int32_t>())});
    } else if (type == "uint32") {
      leaves.push_back({path, static_cast<double>(cursor.number<std::uint32_t>())});
    } else {
      read(type, path, cursor, leaves);
    }
  }

  std::string own_;
  std::map<std::string, std::vector<Field>> types_;
};

} // namespace nendo::test
