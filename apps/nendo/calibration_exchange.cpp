// nendo calibration import and export, which convert from and to the formats of other programs.

#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"
#include "nendo/model_output.hpp"

namespace nendo::app::calibration_exchange {
namespace {

using hand::WearerCalibration;

struct ImportOptions {
  std::string file;
  std::string user;
  std::string hand;
  std::string glove;
  std::string model;
};

struct ExportOptions {
  std::string name;
  std::string format = "toml";
  std::string out;
};

/// Returns the hand that a file's name has as a word of its own, as in GloveCalibrationLeft.cal or
/// kit_right.cal, but not in copyright.cal. Returns nothing if it has both or none.
std::optional<Side> likely_side(const std::string& path) {
  bool left = false, right = false;
  std::string word;
  const auto end_word = [&] {
    left = left || word == "left";
    right = right || word == "right";
    word.clear();
  };
  const auto is_small = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_large = [](char c) { return c >= 'A' && c <= 'Z'; };
  char before = '.';
  for (const char c : std::filesystem::path(path).stem().string()) {
    if (!is_small(c) && !is_large(c)) end_word();
    if (is_large(c) && is_small(before)) end_word();
    if (is_small(c) || is_large(c)) word += is_large(c) ? static_cast<char>(c - 'A' + 'a') : c;
    before = c;
  }
  end_word();
  if (left == right) return std::nullopt;
  return left ? Side::left : Side::right;
}

// The option and the file must not disagree, because a left hand's gains are wrong for a right
// hand, which would be hard to notice.
Result<Side> side_of(const ImportOptions& options, std::optional<Side> in_file) {
  if (options.hand.empty()) {
    if (in_file) return *in_file;
    // A name is no proof, so it is offered and not taken.
    const auto likely = likely_side(options.file);
    const std::string word(likely ? name_of(*likely) : "");
    return Error{Errc::usage, options.file + ": does not name its hand; " +
                                  (likely ? "its file name has the word " + word +
                                                "; if that is correct, add --hand " + word
                                          : "add --hand left or right")};
  }
  const Side wanted = side_named(options.hand).value_or(Side::right); // the option is one of these
  if (in_file && *in_file != wanted) {
    return Error{Errc::bad_input, options.file + ": is for a " + std::string(name_of(*in_file)) +
                                      " hand; leave --hand out or choose another file"};
  }
  return wanted;
}

Result<hand::ImportedCalibration> parsed(const std::string& text, const std::string& file,
                                         hand::CalibrationFormat format) {
  using hand::CalibrationFormat;
  switch (format) {
  case CalibrationFormat::two_point:
    return hand::parse_two_point(text, file);
  case CalibrationFormat::csv:
    return hand::parse_calibration_csv(text, file);
  case CalibrationFormat::ros_yaml:
    return hand::parse_ros_yaml(text, file);
  case CalibrationFormat::ros_xml:
    return hand::parse_ros_xml(text, file);
  case CalibrationFormat::virtualhand:
  case CalibrationFormat::toml: // has a reader of its own
    break;
  }
  return hand::parse_virtualhand(text, file);
}

Result<WearerCalibration> converted(const ImportOptions& options, const std::string& text,
                                    hand::CalibrationFormat format) {
  auto read = parsed(text, options.file, format);
  if (!read) return read.error();
  const auto side = side_of(options, read->side);
  if (!side) return side.error();
  if (options.user.empty())
    return Error{Errc::usage, options.file + ": does not name its wearer; add --user NAME"};
  for (const auto& note : read->notes)
    cli::note(options.file + ": " + note);
  WearerCalibration wearer;
  wearer.user = options.user;
  wearer.glove_model = options.model;
  wearer.glove_serial = options.glove;
  wearer.side = *side;
  wearer.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  wearer.method = "imported";
  wearer.calibration = read->calibration;
  return wearer;
}

Result<WearerCalibration> read_foreign(const ImportOptions& options) {
  const auto text = hand::read_calibration_text(options.file);
  if (!text) return text.error();
  const auto format = hand::format_of(*text);
  if (format != hand::CalibrationFormat::toml) return converted(options, *text, format);
  auto wearer = hand::parse_calibration(*text, options.file);
  if (!wearer) return wearer;
  const auto side = side_of(options, wearer->side);
  if (!side) return side.error();
  if (!options.user.empty()) wearer->user = options.user;
  if (!options.glove.empty()) wearer->glove_serial = options.glove;
  if (!options.model.empty()) wearer->glove_model = options.model;
  return wearer;
}

Result<void> import_calibration(const ImportOptions& options) {
  const auto wearer = read_foreign(options);
  if (!wearer) return wearer.error();
  const auto path = hand::own_calibration_path(wearer->user, wearer->glove_serial, wearer->side);
  if (!path) return path.error();
  const auto kept = hand::write_calibration(*path, *wearer);
  if (!kept) return kept.error();
  std::cout << "imported for " << sculpting::title_of(*wearer) << ": " << printable(path->string())
            << '\n';
  if (!kept->empty())
    std::cout << "the previous one is kept as " << printable(kept->string()) << '\n';
  return {};
}

Result<hand::ExportedCalibration> exported(const WearerCalibration& wearer,
                                           const std::string& format) {
  if (format == "cal") return hand::virtualhand_text(wearer.calibration, wearer.counts);
  if (format == "csv") return hand::calibration_csv_text(wearer.calibration);
  if (format == "yaml") return hand::ros_yaml_text(wearer.calibration, wearer.counts);
  if (format == "xml") return hand::ros_xml_text(wearer.calibration, wearer.counts);
  auto text = hand::calibration_text(wearer);
  if (!text) return text.error();
  return hand::ExportedCalibration{*std::move(text), {}};
}

Result<void> export_calibration(const ExportOptions& options) {
  const auto file = sculpting::named_calibration(options.name, cli::note);
  if (!file) return file.error();
  const auto result = exported(file->wearer, options.format);
  if (!result) {
    return Error{result.error().code, printable(options.name) + ": " + result.error().message};
  }
  for (const auto& lost : result->notes)
    cli::note(lost);
  if (options.out.empty()) {
    std::cout << result->text;
    return {};
  }
  if (auto done = replace_file(options.out, result->text); !done) return done;
  report_written(options.out);
  return {};
}

} // namespace
} // namespace nendo::app::calibration_exchange

void nendo::app::add_calibration_exchange(cli::Command& calibration) {
  using namespace calibration_exchange;
  cli::Command importing =
      calibration.add_command("import", "Stores another program's calibration");
  ImportOptions& in = importing.on_chosen<ImportOptions>(import_calibration);
  importing.set_footer(
      "Reads TOML, VirtualHand's .cal (also of the Device Configuration Utility and\n"
      "of MotorControl), asr_cyberglove's two-point .cal, CSV, and the YAML and XML of ROS\n"
      "drivers (cyberglove_calibration).");
  importing.add_option("FILE", in.file, "The file to read").required();
  importing.add_option("--user", in.user, "The wearer; a TOML file names it");
  importing.add_option("--hand", in.hand, "left or right; a TOML file names it")
      .one_of({"left", "right"});
  importing.add_option("--glove", in.glove, "The glove's serial number; without it, for any glove");
  importing.add_option("--model", in.model, "The glove's model, as `nendo info` shows it");

  cli::Command exporting =
      calibration.add_command("export", "Writes a calibration for other programs");
  ExportOptions& out = exporting.on_chosen<ExportOptions>(export_calibration);
  exporting.add_option("NAME", out.name, "Path, stored name or wearer").required();
  exporting
      .add_option("--format", out.format,
                  "cal, csv, toml, or the formats of ROS drivers: yaml, xml")
      .one_of({"cal", "csv", "toml", "yaml", "xml"});
  exporting.add_option("--out", out.out, "Where to write it; without it, standard output");
}
