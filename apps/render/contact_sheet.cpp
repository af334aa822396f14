#include <algorithm>
#include <cmath>

#include "render/picture.hpp"

namespace nendo::render {
namespace {

constexpr Pixel paper{250, 250, 249};
constexpr Pixel ink{52, 52, 56};
constexpr int gap = 10;                   // pixels between panels and about them
constexpr double letter_fraction = 0.030; // of a panel's height
constexpr double min_letters = 9.0;
constexpr double max_letters = 20.0;

} // namespace

Image contact_sheet(const std::vector<Panel>& panels, int columns) {
  if (panels.empty()) return Image({16, 16}, paper);
  const auto count = static_cast<int>(panels.size());
  if (columns <= 0) columns = static_cast<int>(std::ceil(std::sqrt(double(count))));
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;
  const Size panel = panels.front().image.size();
  const bool captions = std::any_of(panels.begin(), panels.end(),
                                    [](const Panel& one) { return !one.caption.empty(); });
  const double letters = std::clamp(letter_fraction * panel.height, min_letters, max_letters);
  const int caption = captions ? static_cast<int>(2.4 * letters) : 0;
  Image sheet({gap + columns * (panel.width + gap), gap + rows * (panel.height + caption + gap)},
              paper);
  for (int at = 0; at < count; ++at) {
    const int x = gap + (at % columns) * (panel.width + gap);
    const int y = gap + (at / columns) * (panel.height + caption + gap);
    const Panel& one = panels[static_cast<std::size_t>(at)];
    sheet.paste(one.image, x, y);
    const double words = width_of_words(one.caption, letters);
    const double room = panel.width - 4.0;
    const double height = words > room ? letters * room / words : letters;
    write_words(sheet, x + (panel.width - width_of_words(one.caption, height)) / 2,
                y + panel.height + 1.65 * letters, height, one.caption, ink);
  }
  return sheet;
}

} // namespace nendo::render
