// The table of commands: its keys and names make the same commands in the terminal, in windows and
// on the page, and the pages list what it has.

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/flow/setting.hpp>

#include "commands/commands.hpp"
#include "viewer/command_widgets.hpp"
#include "web/client_commands.hpp"
#include "web/wire.hpp"
#ifdef NENDO_WINDOW
#endif

namespace commands_test {

using namespace nendo;
using commands::EditFacts;
using commands::Row;

namespace {

/// A run in one of two states: nothing is possible or on, or all is.
struct State {
  flow::Frame frame;
  commands::RunFacts facts;

  explicit State(bool all) : facts{all, all, all, all} {
    frame.settings.radius_m.fill(0.1);
    frame.settings.mode = all ? flow::Mode::type2 : flow::Mode::type1;
    if (all) frame.settings.brushes.fill(deform::Brush::twist);
    frame.undo_steps = frame.redo_steps = all ? 1 : 0;
    frame.held = frame.symmetric = all;
    frame.function_count = all ? 3 : 0;
    frame.hands[0].tracked = all;
    frame.parts.count = all ? 2 : 0;
    frame.parts.chosen = all ? 0 : deform::no_index;
    if (all) frame.wire.begin(1.0);
  }
  commands::Situation now() const { return {frame, facts}; }
};

commands::Answer press(const Row& row, const State& state) {
  flow::PendingSettings pending;
  pending.follow(state.frame.settings);
  return commands::press(row, state.now(), pending);
}

/// What a user types in the terminal: one character, or nothing if that cannot be.
const Row* typed(std::string_view key) {
  return key.size() == 1 ? commands::with_key(key, commands::in_terminal) : nullptr;
}

const Row* sent(std::string_view name) {
  const auto asked = web::parse_command(name);
  const auto* const row = asked ? std::get_if<const Row*>(&*asked) : nullptr;
  return row != nullptr ? *row : nullptr;
}

#ifdef NENDO_WINDOW
/// The row of a key of a keyboard in a window: all that fit are one.
const Row* struck(int key, bool control, bool shift, std::uint8_t place = commands::in_window) {
  std::set<const Row*> found;
  for (const Row& row : commands::table())
    for (const std::string_view name : row.keys) {
      const viewer::KeyStroke stroke = viewer::stroke_of(name);
      if ((row.places & place) != 0 && stroke.key == key && stroke.fits(control, shift))
        found.insert(&row);
    }
  return found.size() == 1 ? *found.begin() : nullptr;
}
#endif

bool is_sentence(std::string_view text) {
  return text.size() > 10 && std::isupper(static_cast<unsigned char>(text.front())) != 0 &&
         text.ends_with('.') && text.find(". ") == std::string_view::npos &&
         text.find_first_of("\"\\<\n") == std::string_view::npos;
}

std::string content_of(const std::string& file) {
  std::ifstream in(std::string(NENDO_SOURCE) + "/" + file);
  REQUIRE(in);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The values of an attribute in a text of HTML, in their order.
std::vector<std::string> attributes_in(const std::string& html, const std::string& attribute) {
  std::vector<std::string> values;
  const std::string mark = " " + attribute + "=\"";
  for (auto at = html.find(mark); at != std::string::npos; at = html.find(mark, at)) {
    at += mark.size();
    values.push_back(html.substr(at, html.find('"', at) - at));
  }
  return values;
}

std::string places_of(const Row& row) {
  std::string text;
  for (const auto& [bit, name] : {std::pair{commands::in_terminal, "terminal"},
                                  {commands::in_window, "window"},
                                  {commands::on_page, "page"}})
    if ((row.places & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  return text == "terminal, window, page" ? "everywhere" : text;
}

std::string keys_as_code(const Row& row) {
  std::string text;
  for (const std::string_view key : row.keys)
    if (!key.empty()) text += (text.empty() ? "`" : ", `") + std::string(key) + '`';
  return text;
}

} // namespace

TEST_SUITE("commands") {
  TEST_CASE("each command is the same by its key in the terminal and the window, and by its name") {
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      if (!row.is_for_run()) continue;
      const std::string_view key = row.keys.front();
      REQUIRE(key.size() == 1);
      CHECK(typed(key) == ((row.places & commands::in_terminal) != 0 ? &row : nullptr));
      CHECK(sent(row.name) == ((row.places & commands::on_page) != 0 ? &row : nullptr));
#ifdef NENDO_WINDOW
      const auto letter = static_cast<unsigned char>(key.front()); // GLFW has ASCII's numbers
      const int number = std::isalpha(letter) != 0 ? std::toupper(letter) : letter;
      CHECK(struck(number, false, std::isupper(letter) != 0) ==
            ((row.places & commands::in_window) != 0 ? &row : nullptr));
#endif
      CHECK(press(row, State(true)).command);
    }
#ifdef NENDO_WINDOW
    CHECK(struck('Z', true, false) == commands::named("undo"));
    CHECK(struck('Y', true, false) == commands::named("redo"));
    CHECK(struck('Z', true, true) == commands::named("redo"));
    CHECK(struck('=', false, true) == commands::named("stronger brush")); // as "+" is typed
    CHECK(struck('G', true, false) == nullptr);
    CHECK(struck('G', false, true) == nullptr);
#endif
    CHECK(typed("h") == nullptr);
    CHECK(sent("end run") == nullptr);
    CHECK(sent("show hands") == nullptr);
  }

#ifdef NENDO_WINDOW
  TEST_CASE("each key of a row is one that windows know, and asks for that row alone") {
    for (const std::uint8_t place : {commands::in_window, commands::in_timeline})
      for (const Row& row : commands::table())
        for (const std::string_view key : row.keys) {
          if (key.empty() || (row.places & place) == 0) continue;
          CAPTURE(row.name);
          CAPTURE(key);
          const viewer::KeyStroke stroke = viewer::stroke_of(key);
          CHECK(stroke.key != 0);
          CHECK(struck(stroke.key, stroke.control, stroke.shift, place) == &row);
        }
  }
#endif

  TEST_CASE("what begins something also ends it, and settings are asked for by the same rows") {
    const State off(false), all(true);
    const auto asked = [](const char* name, const State& state) {
      return *press(*commands::named(name), state).command;
    };
    CHECK(asked("take", off) == flow::Command(flow::SetRecording{true}));
    CHECK(asked("take", all) == flow::Command(flow::SetRecording{false}));
    CHECK(asked("wire", off) == flow::Command(flow::DrawWire{true}));
    CHECK(asked("wire", all) == flow::Command(flow::DrawWire{false}));
    CHECK(asked("knife", off) == flow::Command(flow::DrawWire{true, flow::Blade::knife}));
    CHECK(asked("symmetry", off) == flow::Command(flow::SetSymmetry{true}));
    CHECK(asked("symmetry", all) == flow::Command(flow::SetSymmetry{false}));
    CHECK(asked("clutch left", all) ==
          flow::Command(flow::SetClutch{Side::left, puppet::RigPlayer::all_fingers, false}));
    for (const Row& row : commands::table()) {
      if (row.choose == nullptr) continue;
      CAPTURE(row.name);
      const auto command = press(row, off).command;
      REQUIRE(command);
      const auto* const change = std::get_if<flow::ChangeSettings>(&*command);
      REQUIRE(change != nullptr);
      CHECK(change->settings.are_usable());
      CHECK(change->settings != off.frame.settings);
    }
  }

  TEST_CASE("each command is named by the row that makes it, whatever its numbers") {
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      if (row.make == nullptr) continue;
      CHECK(commands::name_of(row.make(false)) == row.name);
      CHECK(commands::name_of(row.make(true)) == row.name);
    }
    CHECK(commands::name_of(flow::SetClutch{Side::right, 2, true}) == "clutch right");
    CHECK(commands::name_of(flow::Refine{7}) == "refine");
    CHECK(commands::name_of(flow::SetLayer{3, true}) == "punch");
    CHECK(commands::name_of(flow::SetRole{}) == "role");
  }

  TEST_CASE("the filter's row turns it on and off, and leaves its cutoffs alone") {
    flow::Frame frame;
    frame.settings.filter.min_cutoff_hz = 3.5;
    const commands::RunFacts facts;
    for (const auto kind : {hand::FilterKind::one_euro, hand::FilterKind::off}) {
      flow::PendingSettings pending;
      pending.follow(frame.settings);
      const auto answer =
          commands::press(*commands::with_key("A", commands::in_terminal), {frame, facts}, pending);
      REQUIRE(answer.command);
      const auto* const change = std::get_if<flow::ChangeSettings>(&*answer.command);
      REQUIRE(change != nullptr);
      CHECK(change->settings.filter.kind == kind);
      CHECK(change->settings.filter.min_cutoff_hz == 3.5);
      frame.settings = change->settings;
    }
  }

  TEST_CASE("a command that is not possible says why, and only the loop's requests are passed on") {
    const State none(false);
    int refused = 0;
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      State all(true);
      if (row.name == "set strength") all.frame.function_count = 0; // a puppet has no brushes
      CHECK(row.refusal_in(all.now()) == nullptr);
      if (const char* const refusal = row.refusal_in(none.now())) CHECK(is_sentence(refusal));
      if (!row.is_for_run()) continue;
      const auto answer = press(row, none);
      const bool is_request =
          answer.command && std::holds_alternative<flow::Request>(*answer.command);
      CHECK(answer.command.has_value() == (answer.refusal == nullptr || is_request));
      if (answer.refusal == nullptr) continue;
      ++refused;
    }
    CHECK(refused == 11);
  }

  TEST_CASE("a timeline's command that is not possible says why, and each command has its row") {
    EditFacts possible;
    possible.can_undo = possible.can_redo = possible.key_selected = true;
    EditFacts impossible;
    impossible.exporting = true;
    int refused = 0;
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      CHECK(row.refusal_in(possible) == nullptr);
      if (row.edit) CHECK(&commands::row_of(row.edit->command) == &row);
      const char* const refusal = row.refusal_in(impossible);
      if (refusal == nullptr) continue;
      ++refused;
      CHECK(is_sentence(refusal));
    }
    CHECK(refused == 5); // undo, redo, export, and copy and delete of no key
  }

  TEST_CASE("each row has a sentence, and each button a text") {
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      CHECK(is_sentence(row.help));
      CHECK(row.button.empty() == (row.group == commands::Buttons::none));
      CHECK((row.is_for_run() || (row.places & commands::in_terminal) == 0 ||
             row.name == "list keys"));
      CHECK_FALSE((row.make != nullptr && row.choose != nullptr));
    }
  }

  TEST_CASE("the page has each row, and executes itself what is not for the run") {
    const std::string list = web::page_commands();
    const std::string panel = content_of("apps/web/page/panel.js");
    for (const Row& row : commands::table()) {
      CAPTURE(row.name);
      const bool in_run = (row.places & commands::on_page) != 0;
      const bool is_there = in_run || row.edit;
      const std::string name(row.name);
      CHECK((list.find("{ name: \"" + name + "\", ") != std::string::npos) == is_there);
      if (!row.is_for_run() && !row.name.starts_with("show ")) // which are all boxes
        CHECK((panel.find("\n  '" + name + "': panel => ") != std::string::npos) == in_run);
    }
    for (const std::string& name :
         attributes_in(content_of("apps/web/page/index.html"), "data-own")) {
      CAPTURE(name);
      REQUIRE(commands::named(name) != nullptr);
      CHECK_FALSE(commands::named(name)->is_for_run());
    }
  }

  TEST_CASE("the page has the window's hints, and no id occurs twice in it") {
    CHECK(web::page_hints().find("{ keys: \"drag\", text: \"Turns the view; ") !=
          std::string::npos);
    const auto ids = attributes_in(content_of("apps/web/page/index.html"), "id");
    CHECK(std::set<std::string>(ids.begin(), ids.end()).size() == ids.size());
  }

  TEST_CASE(
      "clients get the commands that are on, and the reasons of those that are not possible") {
    for (const bool all : {false, true}) {
      const State state(all);
      std::string lines;
      for (const Row& row : commands::table()) {
        if (!row.is_for_run() || (row.places & commands::on_page) == 0) continue;
        const char* const refusal = row.refusal_in(state.now());
        if (row.is_on_in(state.now()))
          lines += std::string(row.name) + "\ton\t" + (refusal != nullptr ? refusal : "") + "\n";
        else if (row.is_shown != nullptr && !row.is_shown(state.now()))
          lines +=
              std::string(row.name) + "\thidden\t" + (refusal != nullptr ? refusal : "") + "\n";
        else if (refusal != nullptr)
          lines += std::string(row.name) + "\toff\t" + refusal + "\n";
      }
      CHECK(web::command_states(state.now()) == lines);
    }
    const std::string none = web::command_states(State(false).now());
    CHECK(none.find("punch\thidden\t") != std::string::npos);
    CHECK(none.find("undo\toff\tThere is nothing to undo.\n") != std::string::npos);
    CHECK(web::command_states(State(true).now()).find("take\ton\t\n") != std::string::npos);
  }

  TEST_CASE("the protocol's page has the version and the settings that a client gets") {
    const std::string protocol = content_of("apps/web/PROTOCOL.md");
    const std::string version = std::to_string(web::ModelHead{}.version);
    CHECK(protocol.find("| 8 | u32 | version, " + version + " |") != std::string::npos);
    CHECK(content_of("apps/web/page/wire.js").find("from.u32() !== " + version + ')') !=
          std::string::npos);
    flow::for_each_setting([&](const auto& setting) {
      CAPTURE(setting.name);
      CHECK(protocol.find("\n| `" + std::string(setting.name) + "` | ") != std::string::npos);
    });
  }

  TEST_CASE("the pages list what the table has, and nothing else") {
    std::string keys = "| key | what it does | where |\n|---|---|---|\n";
    std::string edit_keys = "| key | what it does |\n|---|---|\n";
    std::string protocol = "| command | |\n|---|---|\n";
    for (const Row& row : commands::table()) {
      const std::string help(row.help);
      const std::string line = "| " + keys_as_code(row) + " | " + help + " |";
      if ((row.places & commands::everywhere) != 0) keys += line + ' ' + places_of(row) + " |\n";
      if ((row.places & commands::in_timeline) != 0) edit_keys += line + '\n';
      if (row.is_for_run() && (row.places & commands::on_page) != 0)
        protocol += "| `" + std::string(row.name) + "` | " + help + " |\n";
    }
    CAPTURE(keys);
    CAPTURE(edit_keys);
    CAPTURE(protocol);
    CHECK(content_of("apps/session/README.md").find("\n\n" + keys + "\n") != std::string::npos);
    CHECK(content_of("apps/edit/README.md").find("\n\n" + edit_keys + "\n") != std::string::npos);
    CHECK(content_of("apps/web/PROTOCOL.md").find("\n\n" + protocol + "\n") != std::string::npos);
  }
}

} // namespace commands_test
