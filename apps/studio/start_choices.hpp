#pragma once
// What the start offers: gloves, ways to shape, and models as pictures. Main thread.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forms/form.hpp"
#include "render/scene_frame.hpp"
#include "studio/glove_board.hpp"
#include "studio/model_gallery.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

using forms::Form;

/// What the command line says about the hands.
struct StartOptions {
  std::vector<NamedGlove> gloves; ///< those that were named
  gloves::CalibrationOptions calibration;
};

class StartChoices {
public:
  /// Begins to look for gloves, and to draw the models.
  explicit StartChoices(const StartOptions& options);

  /// Reads what the gloves have sent, and returns their hands. To be called for each picture.
  const render::SceneFrame& update();
  // Each describes controls, and returns what was clicked.
  /// Ways to shape, which begin at once, and models. `opening`: how a file is opened.
  Wish describe_ways(Form& form, std::string_view opening);
  /// Gloves and trackers, and the hands of the run.
  Wish describe_hands(Form& form);
  /// Returns whether the pictures of the models are drawn.
  bool is_complete() const { return gallery_.is_complete(); }
  /// Returns the first glove that streams, or none.
  NamedGlove found_glove() const;

private:
  struct Model {
    std::string title;
    std::string file;
    std::string puppet; ///< the shipped puppet of this model; empty: none
  };
  static constexpr std::size_t shipped = 5; ///< the number of shipped models, the first ones
  static std::vector<Model> models();
  static std::vector<std::string> files_of(const std::vector<Model>& models);

  void describe_device(Form& form, const DeviceCard& card, Wish& wish);
  Shape shape_of(std::size_t mode) const;

  std::vector<Model> models_;
  ModelGallery gallery_;
  std::vector<std::optional<render::Image>> modes_; ///< their pictures; nothing: unreadable
  GloveBoard board_;
  std::optional<GloveBoard> simulated_; ///< the hands shown without gloves; none: gloves are named
  std::size_t chosen_;                  ///< index of models_; as many: none is chosen
  std::size_t hands_ = 0;
  render::SceneFrame scene_frame_;
};

} // namespace nendo::studio
