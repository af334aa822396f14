#pragma once
// Pictures of models, drawn in a thread of its own. Main thread otherwise.

#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "render/image.hpp"

namespace nendo::studio {

class ModelGallery {
public:
  static constexpr render::Size picture_size{264, 198};

  /// Begins to draw a picture of each of these files, in this order.
  explicit ModelGallery(const std::vector<std::string>& files);
  /// Ends after the picture that is being drawn.
  ~ModelGallery();
  ModelGallery(const ModelGallery&) = delete;
  ModelGallery& operator=(const ModelGallery&) = delete;

  /// Returns the picture of file `at`; null: it is not drawn yet, or the file cannot be read, or is
  /// too large to be read for a picture.
  const render::Image* picture(std::size_t at) const;
  /// Returns whether all pictures are drawn.
  bool is_complete() const;

private:
  struct Item {
    std::string file;
    std::optional<render::Image> drawn{}; ///< the picture
  };
  void draw_all(std::stop_token over);

  mutable std::mutex mutex_; ///< guards Item::drawn and done_
  std::vector<Item> items_;
  std::size_t done_ = 0;
  std::jthread thread_;
};

} // namespace nendo::studio
