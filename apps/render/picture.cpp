#include "render/picture.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/lettering.hpp"
#include "render/lights.hpp"
#include "render/parallel.hpp"
#include "render/raster.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

/// A grid of samples, in bands that each have `band_rows` rows; the last one may have fewer.
struct BandedGrid {
  int width = 0;
  int height = 0;
  int band_rows = 1;
  int bands() const noexcept { return (height + band_rows - 1) / band_rows; }
  Rows rows_of(int band) const noexcept {
    return {band * band_rows, std::min(height, (band + 1) * band_rows)};
  }
};

/// The triangles whose samples are in a band, for each band of a grid.
class TriangleBands {
public:
  TriangleBands() = default;
  /// `places` are those of the vertices on the grid, and `corners` has three for each triangle.
  /// Triangles without a sample in their box are left out.
  TriangleBands(std::span<const GridCorner> places, std::span<const std::uint32_t> corners,
                const BandedGrid& grid)
      : ends_(static_cast<std::size_t>(grid.bands())) {
    const auto each = [&](const auto& visit) { // visit(band, triangle)
      for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
        const std::array<GridCorner, 3> on{places[corners[at]], places[corners[at + 1]],
                                           places[corners[at + 2]]};
        const SampleBox box = sample_box(on, grid.width, {0, grid.height});
        if (box.is_empty()) continue;
        for (int band = box.y0 / grid.band_rows; band <= box.y1 / grid.band_rows; ++band)
          visit(static_cast<std::size_t>(band), static_cast<std::uint32_t>(at));
      }
    };
    each([&](std::size_t band, std::uint32_t) { ++ends_[band]; });
    std::size_t all = 0;
    for (std::size_t& end : ends_) { // where it begins, until its triangles are put there
      const std::size_t count = end;
      end = all;
      all += count;
    }
    triangles_.resize(all);
    each([&](std::size_t band, std::uint32_t triangle) { triangles_[ends_[band]++] = triangle; });
  }

  /// Returns where the corners of the band's triangles begin, in the order of the triangles.
  std::span<const std::uint32_t> of(int band) const noexcept {
    const auto at = static_cast<std::size_t>(band);
    if (at >= ends_.size()) return {};
    const std::size_t begin = at == 0 ? 0 : ends_[at - 1];
    return std::span(triangles_).subspan(begin, ends_[at] - begin);
  }

private:
  std::vector<std::size_t> ends_;        ///< in triangles_, of each band
  std::vector<std::uint32_t> triangles_; ///< band by band
};

constexpr int samples_across = 2; // of a pixel
constexpr int band_pixels = 32;   // rows that one thread draws at a time
constexpr double nearest_m = 0.01;

// A surface as the camera sees it.
struct Seen {
  const Surface* surface = nullptr;
  const std::vector<float>* sky = nullptr; ///< nullptr: lit as if nothing were about
  std::vector<GridCorner> corners;         ///< beyond the grid: behind the camera
  std::vector<float> inverse_depth;
  TriangleBands bands;
};

class Projection {
public:
  /// Bands have as many rows as `band_rows` says, of samples.
  Projection(const Camera& camera, Size size, int samples, int band_rows)
      : rows_(camera.axes()), eye_(camera.eye()),
        grid_{samples * size.width, samples * size.height, band_rows},
        scale_(grid_.height / (2.0 * camera.tangent())),
        middle_x_(grid_.width * (1.0 + camera.centre) / 2.0), middle_y_(grid_.height / 2.0) {}

  Seen see(const Surface& surface, const std::vector<float>* sky) const {
    Seen seen{&surface, sky, {}, {}, {}};
    seen.corners.assign(surface.places.size(), {beyond_grid, beyond_grid});
    seen.inverse_depth.resize(surface.places.size());
    for (std::size_t at = 0; at < surface.places.size(); ++at) {
      const Eigen::Vector3d along = rows_ * (surface.places[at].cast<double>() - eye_);
      const double depth = -along.z();
      if (!(depth > nearest_m && std::isfinite(depth))) continue;
      seen.inverse_depth[at] = static_cast<float>(1.0 / depth);
      if (!(seen.inverse_depth[at] > 0.0F)) continue; // so far away that it is none
      seen.corners[at] = {on_grid(middle_x_ + scale_ * along.x() / depth),
                          on_grid(middle_y_ - scale_ * along.y() / depth)};
    }
    seen.bands = TriangleBands(seen.corners, surface.corners, grid_);
    return seen;
  }
  Vector3f eye() const { return eye_.cast<float>(); }
  float footprint_m(float depth) const noexcept { return depth / static_cast<float>(scale_); }
  const BandedGrid& grid() const noexcept { return grid_; }

private:
  Eigen::Matrix3d rows_;
  Eigen::Vector3d eye_;
  BandedGrid grid_;
  double scale_;
  double middle_x_;
  double middle_y_;
};

// The place of a surface that a sample shows.
struct Hit {
  float inverse_depth = 0.0F; ///< 0: nothing
  std::uint32_t surface = 0;
  std::uint32_t triangle = 0;    ///< where its corners begin
  std::array<float, 3> shares{}; ///< the weights of the corners
};

using Hits = std::vector<Hit>;

/// hits: one for each sample of the band.
void cover(const Seen& seen, std::uint32_t number, const BandedGrid& grid, int band, Hits& hits) {
  const auto& corners = seen.surface->corners;
  const Rows rows = grid.rows_of(band);
  for (const std::uint32_t at : seen.bands.of(band)) {
    std::array<GridCorner, 3> on;
    std::array<double, 3> inverse{};
    for (std::size_t k = 0; k < 3; ++k) {
      on[k] = seen.corners[corners[at + k]];
      inverse[k] = static_cast<double>(seen.inverse_depth[corners[at + k]]);
    }
    const SampleBox box = sample_box(on, grid.width, rows);
    each_covered(on, box, [&](int x, int y, const std::array<double, 3>& b) {
      const double depth = b[0] * inverse[0] + b[1] * inverse[1] + b[2] * inverse[2];
      Hit& hit = hits[index_in_grid(x, y - rows.first, grid.width)];
      if (static_cast<float>(depth) <= hit.inverse_depth) return;
      hit = {static_cast<float>(depth), number, at, {}};
      for (std::size_t k = 0; k < 3; ++k)
        hit.shares[k] = static_cast<float>(b[k] * inverse[k] / depth);
    });
  }
}

ShadedPlace place_of(const Hit& hit, const Seen& seen) {
  const Surface& surface = *seen.surface;
  ShadedPlace at{Vector3f::Zero(), Vector3f::Zero(), seen.sky != nullptr ? 0.0F : 0.9F,
                 seen.sky != nullptr};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = surface.corners[hit.triangle + k];
    at.place += hit.shares[k] * surface.places[corner];
    at.normal += hit.shares[k] * surface.normals[corner];
    if (seen.sky != nullptr) at.sky += hit.shares[k] * (*seen.sky)[corner];
  }
  return at;
}

/// footprint_m: the size of a sample at that place.
Vector3f painted_colour(const Hit& hit, const Surface& surface, float footprint_m) {
  const std::uint32_t* const corner = &surface.corners[hit.triangle];
  const Vector3f& first = surface.places[corner[0]];
  const float area =
      0.5F * (surface.places[corner[1]] - first).cross(surface.places[corner[2]] - first).norm();
  return surface.paint->colour_at(hit.triangle / 3, {corner[0], corner[1], corner[2]}, hit.shares,
                                  std::sqrt(area) / footprint_m);
}

struct View3d {
  const Lighting* lighting;
  Projection projection;
  Size size;
  std::vector<Seen> opaque; ///< grounds last
  std::size_t grounds_from;
  std::vector<Seen> veils; ///< the farthest first
};

View3d seen_by(const Lighting& lighting, const Camera& camera, Size size) {
  const Scene& scene = lighting.scene();
  const auto& maps = lighting.maps();
  View3d view{&lighting, Projection(camera, size, samples_across, samples_across * band_pixels),
              size,      {},
              0,         {}};
  view.opaque.push_back(view.projection.see(scene.model, &maps.skies.model));
  for (const Surface& solid : scene.solids)
    view.opaque.push_back(view.projection.see(solid, nullptr));
  view.grounds_from = view.opaque.size();
  for (std::size_t at = 0; at < scene.grounds.size(); ++at)
    view.opaque.push_back(view.projection.see(scene.grounds[at], &maps.skies.grounds[at]));
  std::vector<std::pair<float, std::size_t>> order;
  for (std::size_t at = 0; at < scene.veils.size(); ++at) {
    Vector3f sum = Vector3f::Zero();
    for (const Vector3f& place : scene.veils[at].places)
      sum += place;
    const auto count = static_cast<float>(std::max<std::size_t>(1, scene.veils[at].places.size()));
    order.emplace_back(-(sum / count - view.projection.eye()).norm(), at);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [away, at] : order) {
    const bool is_reach = maps.skies.veils[at].empty();
    view.veils.push_back(
        view.projection.see(scene.veils[at], is_reach ? nullptr : &maps.skies.veils[at]));
  }
  return view;
}

Vector3f opaque_colour(const View3d& view, const Hit& hit, float height) {
  const Vector3f behind = background(height);
  if (!(hit.inverse_depth > 0.0F)) return behind;
  const Seen& seen = view.opaque[hit.surface];
  const auto& maps = view.lighting->maps();
  const ShadedPlace at = place_of(hit, seen);
  Material material = seen.surface->material;
  if (seen.surface->paint)
    material.colour =
        painted_colour(hit, *seen.surface, view.projection.footprint_m(1.0F / hit.inverse_depth));
  if (hit.surface < view.grounds_from) return shade(at, material, view.projection.eye(), maps);
  return ground_brightness(at, material, view.projection.footprint_m(1.0F / hit.inverse_depth),
                           maps) *
         behind;
}

// One band of pixel rows, into the picture.
void draw_band(const View3d& view, int band, Image& image) {
  const BandedGrid& grid = view.projection.grid();
  const int width = grid.width;
  const Rows rows = grid.rows_of(band);
  const Rows pixel_rows{rows.first / samples_across, rows.end / samples_across};
  const std::size_t count =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(rows.end - rows.first);
  Hits hits(count);
  for (std::uint32_t number = 0; number < view.opaque.size(); ++number)
    cover(view.opaque[number], number, grid, band, hits);
  std::vector<Vector3f> colours(count);
  for (std::size_t at = 0; at < count; ++at) {
    const std::size_t row_of_band = at / static_cast<std::size_t>(width);
    const float row = static_cast<float>(rows.first) + static_cast<float>(row_of_band);
    colours[at] =
        opaque_colour(view, hits[at], row / static_cast<float>(samples_across * view.size.height));
  }
  for (const Seen& veil : view.veils) {
    Hits over(count);
    cover(veil, 0, grid, band, over);
    for (std::size_t at = 0; at < count; ++at) {
      if (over[at].inverse_depth <= hits[at].inverse_depth) continue;
      const ShadedPlace place = place_of(over[at], veil);
      const Material& material = veil.surface->material;
      const bool before_ground =
          !(hits[at].inverse_depth > 0.0F) || hits[at].surface >= view.grounds_from;
      const float part = material.opaque_before_ground && before_ground
                             ? 1.0F
                             : opacity_of(place, material, view.projection.eye());
      const Vector3f colour = veil.sky == nullptr ? material.colour
                                                  : shade(place, material, view.projection.eye(),
                                                          view.lighting->maps());
      colours[at] += part * (colour - colours[at]);
      if (veil.sky != nullptr) hits[at].inverse_depth = over[at].inverse_depth;
    }
  }
  constexpr float share = 1.0F / (samples_across * samples_across);
  for (int y = pixel_rows.first; y < pixel_rows.end; ++y)
    for (int x = 0; x < view.size.width; ++x) {
      Vector3f sum = Vector3f::Zero();
      for (int dy = 0; dy < samples_across; ++dy)
        for (int dx = 0; dx < samples_across; ++dx) {
          const int row = samples_across * (y - pixel_rows.first) + dy;
          sum += colours[index_in_grid(samples_across * x + dx, row, width)].cwiseMin(1.2F);
        }
      image.at(x, y) = encoded(share * sum);
    }
}

} // namespace

Image draw(const Lighting& lighting, const Camera& camera, Size size, unsigned threads) {
  const View3d view = seen_by(lighting, camera, size);
  Image image(size);
  each_in_parallel(static_cast<std::size_t>(view.projection.grid().bands()), threads,
                   [&](std::size_t band) { draw_band(view, static_cast<int>(band), image); });
  return image;
}

Image silhouette(const Scene& scene, const Camera& camera, Size size) {
  const Projection projection(camera, size, 1, size.height);
  Hits hits(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  const auto add = [&](const Surface& surface) {
    if (surface.material.opacity > 0.0F)
      cover(projection.see(surface, nullptr), 0, projection.grid(), 0, hits);
  };
  add(scene.model);
  for (const auto* surfaces : {&scene.solids, &scene.veils})
    for (const Surface& surface : *surfaces)
      add(surface);
  Image image(size, {0, 0, 0});
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (hits[index_in_grid(x, y, size.width)].inverse_depth > 0.0F)
        image.at(x, y) = {255, 255, 255};
  return image;
}

Image contact_sheet(const std::vector<Panel>& panels, int columns) {
  constexpr Pixel paper{250, 250, 249};
  constexpr Pixel ink{52, 52, 56};
  constexpr int gap = 10;                   // pixels between panels and about them
  constexpr double letter_fraction = 0.030; // of a panel's height
  constexpr double min_letters = 9.0;
  constexpr double max_letters = 20.0;
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
    const double space = panel.width - 4.0;
    const double height = words > space ? letters * space / words : letters;
    write_words(sheet, x + (panel.width - width_of_words(one.caption, height)) / 2,
                y + panel.height + 1.65 * letters, height, one.caption, ink);
  }
  return sheet;
}

} // namespace nendo::render
