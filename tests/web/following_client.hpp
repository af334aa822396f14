#pragma once
// A client of the WebSocket, written from PROTOCOL.md alone. It follows a shape by the steps that
// it is sent, in float, as a graphics card does.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nlohmann/json.hpp>

namespace nendo::test {

class FollowingClient {
public:
  explicit FollowingClient(const std::vector<std::byte>& model) {
    Bytes in{model};
    const std::string magic(reinterpret_cast<const char*>(model.data()), 8);
    in.at = 8;
    good = magic == "NENDOWEB" && in.take<std::uint32_t>() == 9;
    const auto vertices = in.take<std::uint32_t>();
    const auto triangles = in.take<std::uint32_t>();
    const auto name_bytes = in.take<std::uint32_t>();
    rate_hz = in.take<double>();
    unit = in.take<double>();
    for (double& axis : origin)
      axis = in.take<double>();
    units_per_metre = in.take<double>();
    diagonal = in.take<double>();
    loop = in.take<std::uint16_t>();
    const auto flags = in.take<std::uint8_t>();
    in.at += 1;
    coats.resize(in.take<std::uint32_t>());
    for (unsigned slot = 0; slot < 2; ++slot)
      if ((flags >> slot & 1U) != 0)
        for (Skeleton& skeleton : bones_[slot])
          take_bones(in, skeleton);
    rest = in.take_all<float>(std::size_t{3} * vertices);
    order = in.take_all<std::uint32_t>(vertices);
    corners = in.take_all<std::uint32_t>(std::size_t{3} * triangles);
    for (Coat& coat : coats) {
      coat.triangles = in.take<std::uint32_t>();
      coat.texture = in.take<std::uint32_t>();
      coat.has_colour = in.take<std::uint32_t>() == 1;
      coat.colour = in.take<std::array<float, 3>>();
    }
    if ((flags & 8U) != 0) texcoords = in.take_all<float>(std::size_t{6} * triangles);
    const std::size_t coloured = (flags & 16U) != 0 ? std::size_t{3} * triangles : vertices;
    if ((flags & 4U) != 0) colours = in.take_all<std::uint16_t>(3 * coloured);
    name.assign(reinterpret_cast<const char*>(model.data()) + in.at, name_bytes);
    good = good && in.at + name_bytes == model.size();
  }

  /// Takes a message of the server. False if it is malformed.
  bool take(const std::vector<std::byte>& message) {
    Bytes in{message};
    const auto type = in.take<std::uint8_t>();
    if (type == 1) take_shape(in);
    if (type == 2) take_update(in);
    if (type == 3) take_report(in);
    if (type == 4) take_settings(in);
    if (type == 6) take_weights(in);
    if (type == 7) take_puppet(in);
    if (type == 9) take_commands(in);
    if (type == 12) take_form(in);
    constexpr std::array known{1, 2, 3, 4, 6, 7, 9, 12};
    return std::ranges::find(known, type) != known.end() && in.at == message.size();
  }

  /// The shape, in the mesh's order and units.
  deform::Points vertices() const {
    std::vector<float> shape = base_;
    apply(pending_, shape);
    if (!pending_vectors_.empty()) apply(pending_vectors_, shape);
    deform::Points points(3, static_cast<Eigen::Index>(order.size()));
    for (std::size_t at = 0; at < order.size(); ++at)
      for (std::size_t axis = 0; axis < 3; ++axis)
        points(static_cast<Eigen::Index>(axis), order[at]) =
            origin[axis] + unit * static_cast<double>(shape[3 * at + axis]);
    return points;
  }
  bool follows() const noexcept { return number > 0; }

  // Of the model.
  bool good = false;
  double rate_hz = 0.0, unit = 1.0, units_per_metre = 1.0, diagonal = 0.0;
  std::array<double, 3> origin{};
  unsigned loop = 0;
  std::vector<float> rest;
  std::vector<std::uint32_t> order, corners;
  struct Coat {
    std::uint32_t triangles = 0, texture = 0;
    bool has_colour = false;
    std::array<float, 3> colour{};
  };
  std::vector<Coat> coats;
  std::vector<float> texcoords;
  std::vector<std::uint16_t> colours;
  std::string name;
  // Of the latest messages of settings and of commands, by their names.
  std::map<std::string, std::string> settings;
  int settings_messages = 0;
  std::set<std::string> on;
  std::map<std::string, std::string> refusals;
  /// The latest forms: of a screen, of the run, and of its status bar.
  std::array<nlohmann::json, 3> forms;
  /// Returns the control of the run's panel with that id; null: there is none.
  nlohmann::json control(const std::string& id) const {
    for (const auto& part : forms[1].value("parts", nlohmann::json::array()))
      for (const auto& one : part["controls"])
        if (one.value("id", "") == id) return one;
    return {};
  }
  // Of the latest puppet message.
  std::uint32_t puppet = 0;
  std::vector<std::array<float, 4>> masks;                    ///< x, y, z, radius
  std::vector<std::pair<std::string, std::string>> functions; ///< name, and signal
  // Of the latest messages.
  std::uint64_t number = 0; ///< the frame that vertices() is of; 0: none
  std::uint64_t newest = 0; ///< the frame of the last update
  std::uint64_t tick = 0;
  bool held = false;
  std::uint32_t rest_changes = 0, jumps = 0, lost = 0, skipped = 0;
  std::array<std::array<Eigen::Vector3d, 26>, 2> joints{};
  std::array<std::array<Eigen::Quaterniond, 26>, 2> turns{};
  std::array<Eigen::Quaterniond, 2> forearms{};
  std::array<bool, 2> present{}, other_bones{}, wrist_lost{};
  std::size_t update_bytes = 0;
  int shapes = 0, updates = 0;
  int weights = 0;                ///< messages of them
  std::uint64_t vectors = 0;      ///< that came in steps
  std::array<bool, 2> released{}; ///< released hands of a puppet
  bool symmetric = false, is_puppet = false;
  std::string report;                ///< the last report of the server
  bool is_error = false;             ///< the last report was an error
  std::uint64_t implied_centres = 0; ///< centres that were left out

private:
  struct Bytes {
    const std::vector<std::byte>& bytes;
    std::size_t at = 0;
    template <class T>
    T take() {
      T value{};
      if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
      at += sizeof value;
      return value;
    }
    template <class T>
    std::vector<T> take_all(std::size_t count) {
      std::vector<T> values(count);
      for (T& value : values)
        value = take<T>();
      return values;
    }
  };
  struct Bone {
    Eigen::Vector3d place;
    Eigen::Quaterniond turn;
  };
  using Skeleton = std::array<Bone, 26>;
  struct Function {
    std::array<float, 3> centre{}, coefficient{};
    float inverse_radius = 0;
  };
  struct Field {
    unsigned kernel = 0;
    float keep_volume = 0;
    bool halfway = false;
    std::array<float, 12> polynomial{};
    std::vector<Function> functions;
  };

  static std::string take_text(Bytes& in) {
    in.at = in.bytes.size();
    return {reinterpret_cast<const char*>(in.bytes.data()) + 4, in.bytes.size() - 4};
  }
  void take_report(Bytes& in) {
    is_error = in.bytes[1] == std::byte{1};
    report = take_text(in);
  }

  void take_settings(Bytes& in) {
    ++settings_messages;
    settings.clear();
    std::istringstream words(take_text(in));
    for (std::string setting; std::getline(words, setting, '=');)
      std::getline(words, settings[setting], ' ');
  }

  void take_commands(Bytes& in) {
    on.clear();
    refusals.clear();
    std::istringstream lines(take_text(in));
    for (std::string command, state, why; std::getline(lines, command, '\t');) {
      std::getline(lines, state, '\t');
      std::getline(lines, why);
      if (state == "on") on.insert(command);
      if (!why.empty()) refusals[command] = why;
    }
  }

  void take_form(Bytes& in) {
    const auto kind = std::to_integer<std::size_t>(in.bytes[1]);
    const std::string text = take_text(in);
    good = good && kind < forms.size() && nlohmann::json::accept(text);
    if (good) forms[kind] = nlohmann::json::parse(text);
  }

  void take_puppet(Bytes& in) {
    in.at += 1;
    functions.resize(in.take<std::uint16_t>());
    puppet = in.take<std::uint32_t>();
    for (auto& [function, signal] : functions)
      for (std::string* text : {&function, &signal}) {
        text->clear();
        for (auto left = in.take<std::uint8_t>(); left > 0; --left)
          *text += in.take<char>();
      }
    masks.resize(in.take<std::uint32_t>());
    for (auto& mask : masks)
      for (float& number : mask)
        number = in.take<float>();
  }

  void take_shape(Bytes& in) {
    ++shapes;
    in.at += 1;
    if (in.take<std::uint16_t>() != loop) good = false;
    const auto vertices = in.take<std::uint32_t>();
    number = in.take<std::uint64_t>();
    base_ = in.take_all<float>(std::size_t{3} * vertices);
    pending_.clear();
    pending_vectors_.clear();
  }

  void take_weights(Bytes& in) {
    ++weights;
    in.at += 1;
    weights_.vectors = in.take<std::uint16_t>();
    weights_.number = in.take<std::uint32_t>();
    const auto vertices = in.take<std::uint32_t>();
    const auto terms = in.take<std::uint32_t>();
    weights_.values = in.take_all<float>(terms);
    weights_.counts = in.take_all<std::uint16_t>(vertices);
    weights_.of_vector = in.take_all<std::uint16_t>(terms);
    std::size_t sum = 0;
    for (const std::uint16_t count : weights_.counts)
      sum += count;
    if (vertices != order.size() || sum != terms) good = false;
    for (const std::uint16_t of : weights_.of_vector)
      if (of >= weights_.vectors) good = false;
  }

  static void take_bones(Bytes& in, Skeleton& skeleton) {
    for (Bone& bone : skeleton) {
      const auto numbers = in.take_all<float>(7);
      bone.place = Eigen::Vector3f(numbers.data()).cast<double>();
      bone.turn = Eigen::Quaternionf(numbers.data() + 3).cast<double>();
    }
  }

  void take_update(Bytes& in) {
    ++updates;
    update_bytes = in.bytes.size();
    const auto state = in.take<std::uint8_t>();
    held = (state & 1U) != 0;
    released = {(state & 16U) != 0, (state & 32U) != 0};
    symmetric = (state & 64U) != 0;
    is_puppet = (state & 128U) != 0;
    const auto hands = in.take<std::uint8_t>();
    in.at += 1;
    const auto step_count = in.take<std::uint32_t>();
    newest = in.take<std::uint64_t>();
    tick = in.take<std::uint64_t>();
    in.at = 40;
    rest_changes = in.take<std::uint32_t>();
    jumps = in.take<std::uint32_t>();
    in.at = 60;
    lost = in.take<std::uint32_t>();
    skipped = in.take<std::uint32_t>();
    in.at = 72;
    for (unsigned slot = 0; slot < 2; ++slot) {
      present[slot] = (hands >> slot & 1U) != 0;
      other_bones[slot] = (hands >> slot & 16U) != 0;
      wrist_lost[slot] = (hands >> slot & 64U) != 0;
      if (present[slot]) take_hand(in, slot);
    }
    for (std::uint32_t step = 0; step < step_count; ++step)
      take_step(in);
    if (step_count > 0 && number > 0) number = newest;
  }

  static Eigen::Quaterniond take_turn(Bytes& in) {
    const std::array<unsigned, 3> words{in.take<std::uint16_t>(), in.take<std::uint16_t>(),
                                        in.take<std::uint16_t>()};
    const unsigned largest = words[0] >> 15U | words[1] >> 15U << 1U;
    Eigen::Vector4d parts = Eigen::Vector4d::Zero();
    unsigned next = 0;
    for (unsigned part = 0; part < 4; ++part)
      if (part != largest)
        parts[part] = ((words[next++] & 0x7FFFU) / 32767.0 * 2.0 - 1.0) / std::sqrt(2.0);
    parts[largest] = std::sqrt(std::max(0.0, 1.0 - parts.squaredNorm()));
    return {parts[3], parts[0], parts[1], parts[2]};
  }

  void take_hand(Bytes& in, unsigned slot) {
    const Skeleton& skeleton = bones_[slot][other_bones[slot] ? 1 : 0];
    auto& places = joints[slot];
    auto& turned = turns[slot];
    for (double& axis : places[1])
      axis = static_cast<double>(in.take<float>());
    forearms[slot] = take_turn(in);
    turned[1] = take_turn(in);
    for (std::size_t at = 0; at < 26; ++at) { // the palm hangs on the wrist, too
      if (at == 1) continue;
      const bool on_wrist = at == 0 || at == 2 || at % 5 == 1;
      const bool fixed = at == 0 || at == 6 || at == 11 || at % 5 == 0;
      const std::size_t parent = on_wrist ? 1 : at - 1;
      places[at] = places[parent] + turned[parent] * skeleton[at].place;
      turned[at] = fixed ? turned[parent] * skeleton[at].turn : take_turn(in);
    }
  }

  void take_step(Bytes& in) {
    const bool bakes = in.take<std::uint8_t>() == 1;
    const bool is_of_vectors = in.take<std::uint8_t>() == 1;
    const auto count = in.take<std::uint16_t>();
    if (is_of_vectors) {
      take_vectors(in, bakes, count);
      return;
    }
    std::vector<Field> fields(count);
    for (std::size_t at = 0; at < fields.size(); ++at)
      take_field(in, fields[at], at > 0 ? &fields[at - 1] : nullptr);
    if (number == 0) return; // without a shape there is nothing to apply it to
    pending_.clear();
    pending_vectors_.clear();
    if (!bakes) {
      pending_ = fields;
      return;
    }
    apply(fields, base_);
  }

  /// One after another. What a field that is halfway makes is only asked by the next.
  static void apply(const std::vector<Field>& fields, std::vector<float>& shape) {
    std::vector<float> asked = shape;
    for (const Field& field : fields) {
      const std::vector<float> from = asked;
      apply(field, asked);
      if (field.halfway) continue;
      for (std::size_t at = 0; at < shape.size(); ++at)
        shape[at] += asked[at] - from[at];
      asked = shape;
    }
  }

  void take_vectors(Bytes& in, bool bakes, std::size_t count) {
    const bool is_known =
        in.take<std::uint32_t>() == weights_.number && count == weights_.vectors && count > 0;
    const auto numbers = in.take_all<float>(3 * count);
    vectors += count;
    if (!is_known) good = false; // the weights must have come before
    if (number == 0 || !is_known) return;
    pending_.clear();
    pending_vectors_.clear();
    if (bakes)
      apply(numbers, base_);
    else
      pending_vectors_ = numbers;
  }

  void take_field(Bytes& in, Field& field, const Field* before) {
    field.kernel = in.take<std::uint8_t>();
    const auto flags = in.take<std::uint8_t>();
    field.functions.resize(in.take<std::uint16_t>());
    const bool follows = (flags & 4U) != 0;
    if (follows && (before == nullptr || before->functions.size() != field.functions.size())) {
      good = false;
      return;
    }
    const float shared = (flags & 2U) != 0 ? in.take<float>() : 0.0F;
    field.keep_volume = (flags & 8U) != 0 ? in.take<float>() : 0.0F;
    field.halfway = (flags & 16U) != 0;
    if ((flags & 1U) != 0)
      for (float& part : field.polynomial)
        part = in.take<float>();
    for (std::size_t at = 0; at < field.functions.size(); ++at) {
      Function& function = field.functions[at];
      if (follows) {
        const auto& place = before->functions[at].centre;
        std::vector<float> taken(place.begin(), place.end());
        apply(*before, taken);
        std::copy(taken.begin(), taken.end(), function.centre.begin());
      } else {
        for (float& axis : function.centre)
          axis = in.take<float>();
      }
      for (float& axis : function.coefficient)
        axis = in.take<float>();
      if (follows)
        function.inverse_radius = before->functions[at].inverse_radius;
      else
        function.inverse_radius = (flags & 2U) != 0 ? shared : in.take<float>();
      implied_centres += follows ? 1 : 0;
    }
  }

  static float psi(unsigned kernel, float t) {
    const float u = 1 - t;
    if (kernel == 0) return u * u;
    if (kernel == 1) return std::pow(u, 4.0F) * (4 * t + 1);
    if (kernel == 2) return std::pow(u, 6.0F) * (35 * t * t + 18 * t + 3) / 3;
    return std::pow(u, 8.0F) * (32 * t * t * t + 25 * t * t + 8 * t + 1);
  }

  static void apply(const Field& field, std::vector<float>& shape) {
    for (std::size_t at = 0; at < shape.size(); at += 3) {
      const std::array<float, 3> x{shape[at], shape[at + 1], shape[at + 2]};
      std::array<float, 3> sum{};
      for (std::size_t row = 0; row < 3; ++row) {
        sum[row] = field.polynomial[4 * row];
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[row] += field.polynomial[4 * row + 1 + axis] * x[axis];
      }
      for (const Function& function : field.functions) {
        float squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
          squared += (x[axis] - function.centre[axis]) * (x[axis] - function.centre[axis]);
        const float t = std::sqrt(squared) * function.inverse_radius;
        if (t >= 1) continue;
        std::array<float, 3> u{};
        float along = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          u[axis] = (x[axis] - function.centre[axis]) * function.inverse_radius;
          along += u[axis] * function.coefficient[axis];
        }
        const float clay = field.keep_volume * std::pow(1 - t, 4.0F);
        const float identity =
            (1 - field.keep_volume) * psi(field.kernel, t) + clay * (1 + 4 * t - 20 * t * t);
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[axis] += identity * function.coefficient[axis] + 15 * clay * along * u[axis];
      }
      for (std::size_t axis = 0; axis < 3; ++axis)
        shape[at + axis] += sum[axis];
    }
  }

  /// Each vertex moves by the sum of its terms.
  void apply(const std::vector<float>& numbers, std::vector<float>& shape) const {
    std::size_t term = 0;
    for (std::size_t vertex = 0; vertex < weights_.counts.size(); ++vertex)
      for (unsigned left = weights_.counts[vertex]; left > 0; --left, ++term)
        for (std::size_t axis = 0; axis < 3; ++axis)
          shape[3 * vertex + axis] +=
              weights_.values[term] * numbers[3 * std::size_t{weights_.of_vector[term]} + axis];
  }

  struct Weights {
    std::uint32_t number = 0;
    std::size_t vectors = 0;
    std::vector<float> values;
    std::vector<std::uint16_t> counts, of_vector;
  };
  Weights weights_;
  std::vector<float> pending_vectors_;
  std::array<std::array<Skeleton, 2>, 2> bones_{}; ///< left and right hand; first and other glove
  std::vector<float> base_;
  std::vector<Field> pending_;
};

} // namespace nendo::test
