#include "files/mtl_file.hpp"

#include <algorithm>
#include <set>
#include <system_error>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/drawn_faces.hpp>

#include "files/number_text.hpp"

namespace nendo::deform {
namespace {

namespace fs = std::filesystem;

/// How material files of this program begin. Others are never replaced.
constexpr std::string_view mtl_mark = "# nendo\n";

std::optional<std::string> contents_of(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown)) return std::nullopt;
  auto contents = read_file(path, ModelFolder::max_texture_bytes, "part of a model");
  if (!contents) return std::string();
  return *std::move(contents);
}

/// Where an .mtl may be written.
fs::path material_file(const fs::path& obj, const fs::path& wanted) {
  fs::path file = wanted.empty() ? fs::path(obj).replace_extension(".mtl") : wanted;
  if (const auto there = contents_of(file); there && !there->starts_with(mtl_mark))
    file.replace_extension(".nendo.mtl");
  return file;
}

/// Writes the texture, unless it is there, and gives it the name that it has there.
Result<void> write_texture(const fs::path& obj, Texture& texture) {
  if (!texture.contents) return {};
  const fs::path folder = obj.parent_path();
  if (name_in_folder(texture.file) == texture.file &&
      contents_of(folder / texture.file) == *texture.contents)
    return {};
  std::string name = line_name(texture.file);
  std::replace(name.begin(), name.end(), '/', '_');
  std::replace(name.begin(), name.end(), '\\', '_');
  if (name.empty() || name == "." || name == "..") name = "texture";
  auto there = contents_of(folder / name);
  const fs::path own(line_name(obj.stem().string() + "-" + name));
  for (int next = 1; there && *there != *texture.contents; ++next) {
    const std::string number = next > 1 ? "-" + std::to_string(next) : std::string();
    name = line_name(own.stem().string() + number + own.extension().string());
    there = contents_of(folder / name);
  }
  texture.file = name;
  if (there) return {};
  return replace_file(folder / name, *texture.contents);
}

/// Reads the files that one mtllib names: one whose name may have blanks, or several. At most
/// `left` files are tried.
void read_library(const ModelFolder& folder, std::string_view library, std::size_t& left,
                  MtlReader& reader, NoteSum& notes) {
  const auto read = [&](std::string_view named) {
    FolderFile file = folder.find(named, ModelFolder::max_material_bytes);
    if (file.contents) reader.read(*file.contents, file.name);
    --left;
    return file;
  };
  const FolderFile whole = read(library);
  if (whole.contents) return;
  std::vector<std::pair<std::string, std::string>> lacking;
  const auto names = fields_of(library, left);
  for (const std::string_view name : names)
    if (const FolderFile file = names.size() == 1 ? whole : read(name); !file.contents)
      lacking.emplace_back(name, file.lack);
  if (lacking.size() == names.size()) lacking = {{std::string(library), whole.lack}};
  for (const auto& [name, lack] : lacking)
    notes.add("file of materials", name, lack);
}

std::optional<float> part_of_one(std::string_view field) {
  const auto number = to_finite_number(field);
  if (!number) return std::nullopt;
  return static_cast<float>(std::clamp(*number, 0.0, 1.0));
}

/// What a map_ statement says.
struct MapStatement {
  std::string file;
  bool is_moved = false; ///< options scale or move the texture
};

MapStatement map_statement(TextScanner& scanner) {
  // How many values each option has at the most. Those that may have fewer have numbers only.
  static const std::map<std::string_view, int> options{
      {"-blendu", 1}, {"-blendv", 1},  {"-boost", 1}, {"-bm", 1}, {"-cc", 1},
      {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},    {"-o", 3},  {"-s", 3},
      {"-t", 3},      {"-texres", 1},  {"-type", 1}};
  MapStatement statement;
  std::string_view field = scanner.field();
  while (options.contains(field)) {
    const bool of_numbers = options.at(field) == 3;
    const double usual = field == "-s" ? 1.0 : 0.0;
    int left = options.at(field);
    field = scanner.field();
    while (left-- > 0 && !field.empty() && (!of_numbers || to_number(field))) {
      if (of_numbers && to_number(field) != usual) statement.is_moved = true;
      field = scanner.field();
    }
  }
  statement.file = std::string(field);
  if (const std::string more = joined_fields(scanner); !more.empty()) statement.file += " " + more;
  return statement;
}

/// The materials, under the names that unique_names() gives them.
std::string mtl_text(const Appearance& look) {
  std::string text(mtl_mark);
  const std::vector<std::string> names = unique_names(look.materials);
  for (std::size_t at = 0; at < names.size(); ++at) {
    const Material& material = look.materials[at];
    text += "\nnewmtl " + names[at] + "\n";
    if (material.colour) {
      text += "Kd";
      append_numbers(text, material.colour->head<3>());
      text += '\n';
    }
    if (material.colour || !material.drawn) {
      text += "d ";
      append_number(text, material.drawn ? (*material.colour)[3] : 0.0F);
      text += '\n';
    }
    const bool has_texture =
        material.texture != no_index && look.textures[material.texture].contents;
    if (has_texture) text += "map_Kd " + line_name(look.textures[material.texture].file) + "\n";
  }
  return text;
}

} // namespace

MtlReader::MtlReader(Appearance& look, NoteSum& notes)
    : look_(look), notes_(notes), stated_(look.materials.size()),
      first_texture_(look.textures.size()), material_(look.materials.size()) {
  for (std::size_t at = 0; at < look.materials.size(); ++at)
    by_name_.emplace(look.materials[at].name, at);
}

void MtlReader::read(std::string_view text, std::string_view file) {
  has_read_ = true;
  file_ = file;
  material_ = stated_.size();
  TextScanner scanner(without_mark(text), TextScanner::Dialect::obj);
  do
    statement(scanner);
  while (scanner.next_line());
}

void MtlReader::begin_material(const std::string& name) {
  const auto found = by_name_.find(name);
  material_ = found == by_name_.end() ? stated_.size() : found->second;
  if (material_ < stated_.size()) stated_[material_].described = true;
}

void MtlReader::statement(TextScanner& line) {
  const std::string keyword = to_lower(std::string(line.field()));
  if (keyword == "newmtl") return begin_material(joined_fields(line));
  if (material_ == stated_.size()) return;
  Stated& stated = stated_[material_];
  if (keyword == "kd") {
    std::array<double, 3> kd{};
    for (double& channel : kd) {
      const auto number = to_finite_number(line.field());
      if (!number && &channel == kd.data()) return;
      channel = number.value_or(kd[0]); // one number is all three
      colours_.see(channel);
    }
    stated.kd = kd;
  } else if (keyword == "d" || keyword == "tr") {
    std::string_view field = line.field();
    if (field == "-halo") field = line.field();
    if (const auto number = part_of_one(field)) (keyword == "d" ? stated.d : stated.tr) = number;
  } else if (keyword == "map_kd") {
    add_texture(line);
  } else if (keyword == "map_d") {
    notes_.add("opacity texture", map_statement(line).file,
               ": is left out, so what it cuts away is seen");
  } else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "norm" ||
             keyword == "disp") {
    notes_.add("texture statement", keyword, ": is left out; of textures, map_Kd is read");
  }
}

void MtlReader::add_texture(TextScanner& line) {
  MapStatement statement = map_statement(line);
  auto name = name_in_folder(statement.file);
  if (!name) {
    if (!statement.file.empty())
      notes_.add("texture", statement.file, ": cannot be the name of a file");
    return;
  }
  if (statement.is_moved)
    notes_.add("texture", statement.file,
               ": its options -o, -s and -t are left out, so it is neither moved nor scaled");
  const auto next = to_index(look_.textures.size());
  Named named{std::move(statement.file), file_};
  const auto [place, is_new] = textures_.emplace(named, next);
  if (is_new) {
    look_.textures.push_back({*std::move(name), nullptr});
    named_.push_back(std::move(named));
  }
  look_.materials[material_].texture = place->second;
}

void MtlReader::finish() {
  for (std::size_t at = 0; at < stated_.size(); ++at) {
    settle_colour(at);
    settle_opacity(at);
    if (has_read_ && !stated_[at].described)
      notes_.add("material", look_.materials[at].name,
                 ": no MTL file describes it, so it has no colour of its own");
  }
  if (const std::string note = colours_.note(); !note.empty()) notes_.add("Kd: " + note);
  settle_hidden(look_, notes_);
}

void MtlReader::settle_colour(std::size_t at) {
  if (!stated_[at].kd) return;
  Material& material = look_.materials[at];
  Eigen::Vector4f colour = Eigen::Vector4f::Ones();
  for (std::size_t channel = 0; channel < 3; ++channel)
    colour[static_cast<Eigen::Index>(channel)] = colours_.part_of((*stated_[at].kd)[channel]);
  if (material.texture != no_index && colour.head<3>().isZero()) {
    colour.setOnes();
    notes_.add("material", material.name,
               ": its Kd of 0 0 0 would make its texture black, so the texture is shown as it is");
  }
  material.colour = colour;
}

/// d wins over Tr, wherever it is. Tr is 1 - d, but some programs write d's value there; of
/// these two meanings, `Tr 1` has the one in which something can be seen.
void MtlReader::settle_opacity(std::size_t at) {
  const Stated& stated = stated_[at];
  if (!stated.d && !stated.tr) return;
  Material& material = look_.materials[at];
  if (!material.colour) material.colour = Eigen::Vector4f::Ones();
  float opacity = stated.d ? *stated.d : 1.0F - *stated.tr;
  if (!stated.d && *stated.tr == 1.0F) {
    opacity = 1.0F;
    notes_.add("material", material.name,
               ": 'Tr 1' without 'd' is taken as opaque, as MeshLab and openMVS mean it; write "
               "'d 0' if it is not to be seen");
  }
  (*material.colour)[3] = opacity;
  material.drawn = opacity > 0.0F;
}

void MtlReader::read_textures(const ModelFolder& folder) {
  TextureFiles files(notes_);
  for (std::size_t at = first_texture_; at < look_.textures.size(); ++at) {
    const Named& named = named_[at - first_texture_];
    files.read(folder, look_.textures[at], named.name, named.file);
  }
}

void settle_hidden(Appearance& look, NoteSum& notes) {
  const bool all_hidden =
      !look.face_materials.empty() &&
      std::all_of(look.face_materials.begin(), look.face_materials.end(),
                  [&](std::uint32_t of) { return of != no_index && !look.materials[of].drawn; });
  if (all_hidden) notes.add("all materials have the opacity 0; they are taken as opaque");
  std::vector<bool> is_used(look.materials.size(), false);
  for (const std::uint32_t of : look.face_materials)
    if (of != no_index) is_used[of] = true;
  for (std::size_t at = 0; at < look.materials.size(); ++at) {
    Material& material = look.materials[at];
    if (all_hidden && !material.drawn) {
      material.drawn = true;
      if (material.colour) (*material.colour)[3] = 1.0F;
    }
    if (is_used[at] && material.drawn && !is_drawn(material))
      notes.add("material", material.name,
                ": is more than half transparent, so its faces are not drawn");
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

void read_materials(const ModelFolder& folder, const std::vector<std::string>& libraries,
                    Mesh& mesh, ReadNotes& notes) {
  NoteSum sum;
  if (mesh.look.materials.empty()) {
    for (const std::string& library : libraries)
      sum.add("file of materials", library, ": is not used, because no face has one (usemtl)");
    return sum.append_to(notes);
  }
  if (libraries.empty()) {
    for (const Material& material : mesh.look.materials)
      sum.add("material", material.name,
              ": no file of materials is named (mtllib), so it has no colour of its own");
    return sum.append_to(notes);
  }
  MtlReader reader(mesh.look, sum);
  std::size_t left = 64; // a hostile model could name one a line
  for (const std::string& library : libraries)
    if (left > 0) read_library(folder, library, left, reader, sum);
  reader.finish();
  reader.read_textures(folder);
  note_unplaced_textures(mesh, sum);
  sum.append_to(notes);
}

Result<std::string> write_materials(const fs::path& obj, const Appearance& look,
                                    const fs::path& wanted) {
  if (look.materials.empty()) return std::string();
  Appearance written;
  written.materials = look.materials;
  written.textures = look.textures;
  for (Texture& texture : written.textures)
    if (auto done = write_texture(obj, texture); !done) return done.error();
  const fs::path file = material_file(obj, wanted);
  const std::string text = mtl_text(written);
  if (contents_of(file) != text)
    if (auto done = replace_file(file, text); !done) return done.error();
  return line_name(file.filename().string());
}

} // namespace nendo::deform
