// Drawings of a form, the pointer in them, and pictures.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "web/page_form.hpp"

namespace nendo::web {
namespace {

constexpr const char* colour_names[] = {"window", "control", "field",  "line", "ink",
                                        "soft",   "chart",   "accent", "shade"};
constexpr const char* kind_names[] = {"area", "line", "diamond", "words", "picture"};
constexpr std::size_t min_points[] = {3, 2, 1, 1, 4};

using Points = std::vector<Eigen::Vector2f>;

/// Tenths of a pixel, as a short text.
nlohmann::ordered_json rounded(float length) {
  constexpr float max_length = 1e5F;
  const double tenths =
      std::round(10.0 * static_cast<double>(std::clamp(length, -max_length, max_length)));
  if (std::fmod(tenths, 10.0) == 0.0) return static_cast<int>(tenths / 10.0);
  return tenths / 10.0;
}

void add_lengths(nlohmann::ordered_json& all, std::initializer_list<float> lengths) {
  for (const float length : lengths)
    all.push_back(rounded(length));
}

float distance_to_segment(const Eigen::Vector2f& point, const Eigen::Vector2f& from,
                          const Eigen::Vector2f& to) {
  const Eigen::Vector2f way = to - from;
  const float squared = way.squaredNorm();
  const float share =
      squared > 0.0F ? std::clamp((point - from).dot(way) / squared, 0.0F, 1.0F) : 0.0F;
  return (point - from - share * way).norm();
}

/// Returns a line without the points that are on it anyway, to a quarter of a pixel: curves of
/// functions have hundreds of points, of which many are on straight lines.
Points thinned(const Points& line) {
  constexpr float tolerance = 0.25F;
  constexpr std::size_t max_left_out = 32; // limits the time
  Points kept{line.front()};
  std::size_t first = 1; // after the last point that is kept
  for (std::size_t at = 1; at + 1 < line.size(); ++at) {
    bool is_needed = at - first >= max_left_out;
    for (std::size_t one = first; one <= at && !is_needed; ++one)
      is_needed = distance_to_segment(line[one], kept.back(), line[at + 1]) > tolerance;
    if (!is_needed) continue;
    kept.push_back(line[at]);
    first = at + 1;
  }
  kept.push_back(line.back());
  return kept;
}

std::shared_ptr<const std::string> contents_of(const render::Image& picture) {
  auto png = render::png_of(picture);
  return std::make_shared<const std::string>(png ? *std::move(png) : std::string());
}

/// Changes what is known about the pointer by an input.
void follow(forms::Pointer& pointer, const PointerInput& input) {
  using Event = PointerInput::Event;
  if (input.event == Event::size) {
    pointer.width = std::max(0.0, input.x);
    return;
  }
  pointer.at = Eigen::Vector2d(input.x, input.y);
  if (input.event == Event::leave) pointer.at.reset();
  pointer.is_pressed = input.event == Event::down;
  // A move without the button ends a drag, whose release was lost with a connection.
  pointer.is_held = pointer.is_pressed || (pointer.is_held && input.event == Event::drag);
  pointer.panned = input.panned;
  pointer.wheel = input.wheel;
  pointer.has_control = input.has_control;
}

} // namespace

std::size_t PageForm::add_picture(std::shared_ptr<const std::string> contents) {
  static std::atomic<std::size_t> next{first_form_picture};
  const std::size_t number = next++;
  pictures_.emplace(number, std::move(contents));
  has_new_pictures_ = true;
  return number;
}

/// A card's picture that is as one before has its number, so that their list does not grow.
std::size_t PageForm::number_of(const render::Image& picture) {
  const auto [known, is_new] = numbers_.try_emplace(&picture);
  if (!is_new) return known->second;
  auto contents = contents_of(picture);
  const auto same = std::ranges::find_if(
      cards_, [&](std::size_t card) { return *pictures_.at(card) == *contents; });
  if (same != cards_.end()) return known->second = *same;
  return known->second = cards_.emplace_back(add_picture(std::move(contents)));
}

/// The picture is held as long as it has its number, so that no other one can have its address.
std::size_t PageForm::number_of(const std::shared_ptr<const render::Image>& picture) {
  const auto [known, is_new] = drawn_.try_emplace(picture);
  if (is_new) known->second.value = add_picture(contents_of(*picture));
  known->second.is_described = true;
  return known->second.value;
}

/// Forgets the drawings that the last description does not have, and their pictures.
void PageForm::forget_drawings() {
  const auto has_ended = [](auto& one) { return !std::exchange(one.second.is_described, false); };
  for (auto one = pointers_.begin(); one != pointers_.end();)
    one = has_ended(*one) ? pointers_.erase(one) : std::next(one);
  for (auto one = drawn_.begin(); one != drawn_.end();) {
    const std::size_t number = one->second.value;
    const bool is_gone = has_ended(*one);
    one = is_gone ? drawn_.erase(one) : std::next(one);
    if (is_gone) gone_.push_back(number);
  }
  for (; gone_.size() > max_gone; gone_.pop_front()) {
    pictures_.erase(gone_.front());
    has_new_pictures_ = true;
  }
}

/// Returns null for a shape that cannot be drawn.
PageForm::Json PageForm::shape_of(const forms::Drawing::Shape& shape) {
  using Kind = forms::Drawing::Kind;
  const auto kind = static_cast<std::size_t>(shape.kind);
  const auto is_finite = [](const Eigen::Vector2f& point) { return point.allFinite(); };
  if (shape.points.size() < min_points[kind] || !std::ranges::all_of(shape.points, is_finite))
    return nullptr;
  if (shape.kind == Kind::picture) return picture_of(shape);
  Json all = Json::array({kind_names[kind], colour_names[static_cast<std::size_t>(shape.colour)]});
  if (shape.kind == Kind::words) {
    add_lengths(all, {shape.points[0].x(), shape.points[0].y()});
    all.push_back(shape.words);
    return all;
  }
  for (const auto& point : shape.kind == Kind::line ? thinned(shape.points) : shape.points)
    add_lengths(all, {point.x(), point.y()});
  if (shape.kind == Kind::diamond) all.push_back(colour_names[static_cast<std::size_t>(shape.rim)]);
  return all;
}

/// Returns the visible part of the rectangle, and the columns of the picture that are in it.
PageForm::Json PageForm::picture_of(const forms::Drawing::Shape& shape) {
  const auto& points = shape.points;
  const Eigen::Vector2f low = points[0].cwiseMin(points[1]), high = points[0].cwiseMax(points[1]);
  if (!shape.picture || low.y() >= high.y()) return nullptr;
  const auto width = static_cast<float>(shape.picture->size().width);
  const auto rows = static_cast<float>(shape.picture->size().height);
  const float scale = (high.y() - low.y()) / rows, middle = (low.x() + high.x()) / 2.0F;
  const float half = scale * width / 2.0F;
  const auto [from, to] = std::minmax(points[2].x(), points[3].x());
  const float left = std::max({low.x(), from, middle - half});
  const float right = std::min({high.x(), to, middle + half});
  if (!(left < right)) return nullptr;
  const auto column = [&](float x) { return width / 2.0F + (x - middle) / scale; };
  Json all = Json::array({kind_names[static_cast<std::size_t>(shape.kind)]});
  all.push_back(number_of(shape.picture));
  add_lengths(all, {left, low.y(), right, high.y(), column(left), column(right)});
  return all;
}

forms::Pointer PageForm::drawing(std::string_view name, std::string_view help,
                                 const forms::Drawing& drawing) {
  Json one = control("drawing", name, drawing.tooltip.empty() ? help : drawing.tooltip);
  one["width"] = std::isfinite(drawing.width) ? std::max(1.0, std::round(drawing.width)) : 1.0;
  one["height"] = std::isfinite(drawing.height) ? std::max(1.0, std::round(drawing.height)) : 1.0;
  one["listens"] = drawing.takes_pointer;
  one["shapes"] = Json::array();
  for (const forms::Drawing::Shape& shape : drawing.shapes)
    if (Json some = shape_of(shape); !some.is_null()) one["shapes"].push_back(std::move(some));
  auto& [pointer, is_described] = pointers_[one["id"].get<std::string>()];
  one["asks"] = drawing.takes_pointer && pointer.width == 0.0;
  is_described = true;
  pointer.is_pressed = false;
  pointer.panned = pointer.wheel = 0.0;
  const auto input = taken(std::move(one));
  if (input && input->pointer) follow(pointer, *input->pointer);
  return drawing.takes_pointer ? pointer : forms::Pointer{.width = pointer.width};
}

} // namespace nendo::web
