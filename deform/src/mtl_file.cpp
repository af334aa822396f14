#include "mtl_file.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include <nendo/base/text.hpp>

#include "number_text.hpp"
#include "text_scanner.hpp"

namespace nendo::deform {

namespace {

std::optional<float> part_of_one(std::string_view field) {
  const auto number = to_finite_number(field);
  if (!number) return std::nullopt;
  return static_cast<float>(std::clamp(*number, 0.0, 1.0));
}

/// The file of a map_ statement, behind its options.
std::string texture_of(TextScanner& scanner) {
  // How many values each option has at the most. Those that may have fewer have numbers only.
  static const std::map<std::string_view, int> options{
      {"-blendu", 1}, {"-blendv", 1},  {"-boost", 1}, {"-bm", 1}, {"-cc", 1},
      {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},    {"-o", 3},  {"-s", 3},
      {"-t", 3},      {"-texres", 1},  {"-type", 1}};
  std::string_view field = scanner.field();
  while (options.contains(field)) {
    const bool of_numbers = options.at(field) == 3;
    int left = options.at(field);
    field = scanner.field();
    while (left-- > 0 && !field.empty() && (!of_numbers || to_number(field)))
      field = scanner.field();
  }
  std::string name(field);
  const std::string more = joined_fields(scanner);
  return more.empty() ? name : name + " " + more;
}

class MtlReader {
public:
  MtlReader(std::string_view text, Appearance& look)
      : scanner_(text, TextScanner::Dialect::obj), look_(look) {
    for (Material& material : look.materials)
      by_name_.emplace(material.name, &material);
    for (std::size_t at = 0; at < look.textures.size(); ++at)
      textures_.emplace(look.textures[at].file, static_cast<std::uint32_t>(at));
  }

  void read() {
    do
      statement();
    while (scanner_.next_line());
  }

private:
  void statement() {
    const std::string_view keyword = scanner_.field();
    if (keyword == "newmtl") {
      const auto found = by_name_.find(joined_fields(scanner_));
      material_ = found == by_name_.end() ? nullptr : found->second;
    } else if (material_ == nullptr) {
      return;
    } else if (keyword == "Kd") {
      read_colour();
    } else if (keyword == "d" || keyword == "Tr") {
      if (const auto number = part_of_one(scanner_.field()))
        set_opacity(keyword == "d" ? *number : 1.0F - *number);
    } else if (keyword == "map_Kd") {
      if (auto name = name_in_folder(texture_of(scanner_)))
        material_->texture = texture_named(*std::move(name));
    }
  }

  Eigen::Vector4f& colour() {
    if (!material_->colour) material_->colour = Eigen::Vector4f::Ones();
    return *material_->colour;
  }

  void read_colour() {
    Eigen::Vector3f kd = Eigen::Vector3f::Zero();
    for (float& channel : kd) {
      const auto number = part_of_one(scanner_.field());
      if (!number && &channel == kd.data()) return;
      channel = number.value_or(kd[0]); // one number is all three
    }
    colour().head<3>() = kd;
  }

  void set_opacity(float opacity) {
    colour()[3] = opacity;
    material_->drawn = opacity > 0.0F;
  }

  std::uint32_t texture_named(std::string name) {
    const auto next = static_cast<std::uint32_t>(look_.textures.size());
    const auto [place, is_new] = textures_.emplace(name, next);
    if (is_new) look_.textures.push_back({std::move(name), nullptr});
    return place->second;
  }

  TextScanner scanner_;
  Appearance& look_;
  std::map<std::string, Material*, std::less<>> by_name_;
  std::map<std::string, std::uint32_t> textures_;
  Material* material_ = nullptr;
};

} // namespace

void apply_mtl(std::string_view text, Appearance& look) {
  MtlReader(without_mark(text), look).read();
}

void read_textures(const ModelFolder& folder, Appearance& look) {
  std::uint64_t left = ModelFolder::most_texture_bytes; // of all together
  for (Texture& texture : look.textures) {
    if (texture.contents) continue;
    auto contents = folder.read(texture.file, left);
    if (!contents) continue;
    left -= contents->size();
    texture.contents = std::make_shared<const std::string>(*std::move(contents));
  }
}

std::string line_name(std::string_view name) {
  std::string line;
  for (const char c : trimmed(name)) {
    const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    const bool begins_comment = c == '#' && (line.empty() || line.back() == ' ');
    const bool is_second_blank = c == ' ' && !line.empty() && line.back() == ' ';
    if (!is_second_blank) line += is_control || begins_comment ? '_' : c;
  }
  if (line.ends_with('\\')) line.back() = '_'; // it would continue the line
  return line;
}

std::vector<std::string> unique_names(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : materials) {
    std::string wanted = line_name(material.name);
    if (wanted.empty()) wanted = "material";
    std::string name = wanted;
    for (std::size_t next = 2; !taken.insert(name).second; ++next)
      name = wanted + "." + std::to_string(next);
    names.push_back(std::move(name));
  }
  return names;
}

std::string mtl_text(const Appearance& look) {
  std::string text(mtl_mark);
  const std::vector<std::string> names = unique_names(look.materials);
  for (std::size_t at = 0; at < names.size(); ++at) {
    const Material& material = look.materials[at];
    text += "\nnewmtl " + names[at] + "\n";
    if (material.colour) {
      text += "Kd";
      for (const float channel : material.colour->head<3>()) {
        text += ' ';
        append_number(text, channel);
      }
      text += '\n';
    }
    if (material.colour || !material.drawn) {
      text += "d ";
      append_number(text, material.drawn ? (*material.colour)[3] : 0.0F);
      text += '\n';
    }
    if (material.texture != no_index)
      text += "map_Kd " + line_name(look.textures[material.texture].file) + "\n";
  }
  return text;
}

} // namespace nendo::deform
