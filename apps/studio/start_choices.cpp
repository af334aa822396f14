#include "studio/start_choices.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "session/kept_state.hpp"

namespace nendo::studio {

namespace fs = std::filesystem;

namespace {

struct ModeCard {
  const char* title;
  const char* picture; ///< a file of share/nendo/pictures
  const char* mode;    ///< empty: a puppet is played
  const char* puppet;  ///< that is played without a chosen model
  const char* help;
};
constexpr std::array modes{
    ModeCard{"Puppet", "puppet.png", "", "face",
             "Each finger plays an action of a face or a figure."},
    ModeCard{"Pull", "pull.png", "type1", "",
             "Fingertips hold the surface and pull it; from rest, it follows them."},
    ModeCard{"Strokes", "strokes.png", "type2", "",
             "Strokes of the fingertips add up; brushes push, smooth, pinch and more."},
    ModeCard{"Clay", "clay.png", "clay", "", "Whole hands press clay, which keeps its volume."},
    ModeCard{"Parts", "parts.png", "parts", "",
             "Closing hands take separate parts of a model, move and turn them."},
};

const char* const state_words[] = {"opening", "streaming", "silent", "not usable", "tracker"};

} // namespace

std::vector<StartChoices::Model> StartChoices::models() {
  const auto with = [](const char* title, const char* file, const char* puppet) {
    return Model{title, cli::shipped_model(file).string(), puppet};
  };
  std::vector<Model> all{with("Moai", "moai.obj", "moai"), with("Head", "head.obj", ""),
                         with("Face", "face.obj", "face"), with("Spot", "spot.obj", "spot"),
                         with("Ball of clay", "clay.ply", "")};
  constexpr std::array endings{".obj", ".ply", ".stl", ".gltf", ".glb"};
  for (const std::string& file : session::recent_files()) {
    const bool is_model = std::ranges::any_of(
        endings, [&](const char* ending) { return fs::path(file).extension() == ending; });
    if (is_model) all.push_back({printable(fs::path(file).filename().string()), file, ""});
  }
  return all;
}

std::vector<std::string> StartChoices::files_of(const std::vector<Model>& models) {
  std::vector<std::string> files;
  for (const Model& model : models)
    files.push_back(model.file);
  return files;
}

StartChoices::StartChoices(const StartOptions& options)
    : models_(models()), gallery_(files_of(models_)), board_(options.gloves, options.calibration),
      chosen_(models_.size()) {
  if (options.gloves.empty())
    simulated_.emplace(
        std::vector<NamedGlove>{{"sim:wave?hand=left"}, {"sim:wave?hand=right&seed=2"}},
        gloves::CalibrationOptions{});
  for (const ModeCard& card : modes) {
    auto image = render::read_png(cli::shipped_model("").parent_path().parent_path() / "pictures" /
                                  card.picture);
    modes_.push_back(image ? std::optional(*std::move(image)) : std::nullopt);
  }
}

const render::SceneFrame& StartChoices::update() {
  board_.update();
  if (simulated_) simulated_->update();
  scene_frame_.hands = {};
  if (simulated_ && !board_.has_gloves()) simulated_->pose(scene_frame_);
  board_.pose(scene_frame_);
  return scene_frame_;
}

/// A model that was chosen is played by its own puppet, or by one that is begun beside it.
Shape StartChoices::shape_of(std::size_t mode) const {
  Shape shape;
  shape.mode = modes[mode].mode;
  shape.puppet = modes[mode].puppet;
  if (hands_ == 1) shape.hands = Hands::moving;
  if (hands_ == 2) shape.hands = Hands::still;
  if (chosen_ == models_.size()) {
    if (shape.mode == "type2") shape.model = models_[1].file; // strokes show on a head
    return shape;
  }
  const Model& model = models_[chosen_];
  shape.model = model.file;
  if (shape.puppet.empty()) return shape;
  shape.puppet = model.puppet.empty()
                     ? fs::path(model.file).replace_extension(".puppet.toml").string()
                     : model.puppet;
  if (!model.puppet.empty()) shape.model.clear(); // the puppet names it
  return shape;
}

Wish StartChoices::describe_ways(Form& form, std::string_view opening) {
  constexpr std::size_t in_line = 5;
  Wish wish;
  form.title("Start", "A click on one of these begins.");
  form.lines_of(modes.size());
  for (std::size_t at = 0; at < modes.size(); ++at)
    if (form.card(modes[at].title, modes_[at] ? &*modes_[at] : nullptr, modes[at].help))
      wish = shape_of(at);
  form.title("With this model", "If none is chosen, each way takes its own.");
  form.lines_of(in_line);
  for (std::size_t at = 0; at < models_.size(); ++at) {
    if (at == shipped) form.title("Recent", "");
    if (form.card(models_[at].title, gallery_.picture(at), models_[at].file, at == chosen_))
      chosen_ = at == chosen_ ? models_.size() : at;
  }
  form.lines_of(0);
  if (form.button("Open a file...", "")) wish = Open{};
  form.lines_of(1);
  form.text(opening, Form::Tone::faint);
  return wish;
}

void StartChoices::describe_device(Form& form, const DeviceCard& card, Wish& wish) {
  using State = DeviceCard::State;
  const bool is_fine = card.state == State::streaming || card.state == State::tracker;
  form.text(card.title);
  form.text(state_words[static_cast<std::size_t>(card.state)],
            is_fine ? Form::Tone::plain : Form::Tone::warning);
  form.text(card.words, Form::Tone::faint);
  if (!card.remedy.empty()) form.text(card.remedy, Form::Tone::warning);
  form.lines_of(0);
  if (card.side && card.state == State::streaming) {
    const char* const words = card.is_uncalibrated ? "Calibrate..." : "Calibrate again...";
    if (form.button(words, "Takes a minute. Each finger then moves as yours does."))
      wish = Go{Screen::calibration, card.glove};
  }
  form.separator();
}

Wish StartChoices::describe_hands(Form& form) {
  Wish wish;
  for (const DeviceCard& card : board_.cards())
    describe_device(form, card, wish);
  if (board_.cards().empty())
    form.text("No glove is plugged in. Simulated hands play in its place; plug one in at any "
              "time.");
  const bool any = board_.has_gloves() || !simulated_;
  const std::array<std::string_view, 3> names{any ? "the gloves" : "gloves, if one comes",
                                              "simulated, moving", "simulated, still"};
  form.choice("Hands", "The hands of the run. The right mouse button moves a simulated one.", names,
              hands_);
  return wish;
}

NamedGlove StartChoices::found_glove() const {
  for (const DeviceCard& card : board_.cards())
    if (card.side && card.state == DeviceCard::State::streaming) return card.glove;
  return {};
}

} // namespace nendo::studio
