#pragma once
// The start: the hands of the gloves that were found, live, the models and the modes as pictures.
// One click starts. Main thread.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene_frame.hpp"
#include "studio/glove_board.hpp"
#include "studio/model_gallery.hpp"
#include "studio/wish.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

/// What the command line says about the hands.
struct StartOptions {
  std::vector<std::string> gloves; ///< those that were named
  gloves::CalibrationOptions calibration;
};

class StartScreen {
public:
  /// Begins to look for gloves, and to draw the models.
  StartScreen(viewer::SceneWindow& window, const StartOptions& options);
  ~StartScreen();

  /// Draws one picture, below the window's bar, and returns what was clicked.
  Wish show(viewer::SceneWindow& window);
  /// Returns whether the pictures of the models are drawn.
  bool is_complete() const { return gallery_.is_complete(); }
  /// Returns the GLOVE of the first glove that streams; empty: none.
  std::string found_glove() const;

private:
  struct Model {
    std::string title;
    std::string file;
    std::string puppet; ///< the shipped puppet of this model; empty: none
  };
  static constexpr std::size_t shipped = 5; ///< the number of shipped models, the first ones
  static std::vector<Model> models();
  static std::vector<std::string> files_of(const std::vector<Model>& models);

  void load_pictures();
  void draw_modes(Wish& wish);
  void draw_models(Wish& wish);
  void draw_hands(const viewer::SceneWindow& window, Wish& wish);
  void draw_device(const DeviceCard& card, Wish& wish);
  void draw_choice_of_hands();
  Shape shape_of(std::size_t mode) const;

  std::vector<Model> models_;
  ModelGallery gallery_;
  std::vector<std::unique_ptr<gl::Picture>> modes_; ///< their pictures; null: unreadable
  GloveBoard board_;
  std::optional<GloveBoard> simulated_; ///< the hands shown without gloves; none: gloves are named
  std::size_t chosen_;                  ///< index of models_; as many: none is chosen
  std::size_t hands_ = 0;
  render::SceneFrame scene_frame_;
};

} // namespace nendo::studio
