#include "viewer/value_gesture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <nendo/base/text.hpp>

#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr float disc_em = 5.0F; // the radius of the disc at the range's end

} // namespace

void ValueGesture::begin(const Quantity& quantity, std::function<void(double)> use) {
  const ImGuiIO& io = ImGui::GetIO();
  quantity_ = quantity;
  use_ = std::move(use);
  typed_.clear();
  value_ = quantity.value;
  // Before the pointer has moved, it is nowhere.
  begun_ = ImGui::IsMousePosValid() ? io.MousePos
                                    : ImVec2(io.DisplaySize.x / 2.0F, io.DisplaySize.y / 2.0F);
  x_ = begun_.x;
}

void ValueGesture::follow() {
  const ImGuiIO& io = ImGui::GetIO();
  // A window over all others, so that no other one gets a click.
  ImGui::SetNextWindowPos(ImVec2(0.0F, 0.0F));
  ImGui::SetNextWindowSize(io.DisplaySize);
  ImGui::SetNextWindowFocus();
  ImGui::Begin("value", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoNav);
  const double step = std::pow(10.0, -quantity_.decimals);
  const double per_px = quantity_.per_px > 0.0
                            ? quantity_.per_px
                            : quantity_.range.max / static_cast<double>(em(disc_em));
  if (ImGui::IsMousePosValid()) x_ = io.MousePos.x;
  const double way_px = static_cast<double>(x_ - begun_.x);
  const double moved = step * std::round((quantity_.value + per_px * way_px) / step);
  read_keys();
  if (const auto typed = to_finite_number(typed_))
    value_ = quantity_.range.nearest(*typed);
  else
    value_ = way_px == 0.0 ? quantity_.value : quantity_.range.nearest(moved);
  draw();
  ImGui::End();
  const bool is_confirmed = ImGui::IsMouseClicked(ImGuiMouseButton_Left) || pressed(GLFW_KEY_ENTER);
  const bool is_cancelled =
      ImGui::IsMouseClicked(ImGuiMouseButton_Right) || pressed(GLFW_KEY_ESCAPE);
  if (!is_confirmed && !is_cancelled) return;
  const auto use = std::exchange(use_, nullptr);
  if (!is_cancelled) use(value_);
}

void ValueGesture::read_keys() {
  constexpr std::size_t longest = 12;
  for (const ImWchar letter : ImGui::GetIO().InputQueueCharacters) {
    const char c = letter == ',' ? '.' : static_cast<char>(letter);
    const bool is_number = (c >= '0' && c <= '9') || c == '.' || (c == '-' && typed_.empty());
    if (letter < 128 && is_number && typed_.size() < longest) typed_ += c;
  }
  if (pressed(GLFW_KEY_BACKSPACE, true) && !typed_.empty()) typed_.pop_back();
}

std::string ValueGesture::value_text() const {
  char number[32];
  std::snprintf(number, sizeof number, "%.*f", quantity_.decimals, value_);
  const std::string unit = quantity_.unit.empty() ? "" : " " + quantity_.unit;
  return quantity_.name + " " + number + unit + (typed_.empty() ? "" : " (" + typed_ + ")");
}

std::string ValueGesture::message() const {
  return value_text() + ": move sideways or type; a click or Enter confirms, Esc cancels.";
}

void ValueGesture::draw() const {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const bool is_disc = quantity_.per_px == 0.0;
  const auto inner = static_cast<float>(is_disc ? std::abs(value_) / quantity_.range.max *
                                                      static_cast<double>(em(disc_em))
                                                : value_ / quantity_.per_px);
  const float outer = is_disc ? em(disc_em) : inner;
  list.AddCircleFilled(begun_, inner, ImGui::GetColorU32(accent(is_disc ? 0.45F : 0.12F)), 96);
  constexpr ImU32 dark = IM_COL32(0, 0, 0, 110), white = IM_COL32(255, 255, 255, 255);
  list.AddCircle(begun_, outer, dark, 96, 4.0F * scale()); // seen on any ground
  list.AddCircle(begun_, outer, white, 96, 2.0F * scale());
  const std::string words = value_text();
  const ImVec2 size = ImGui::CalcTextSize(words.c_str()), all = ImGui::GetIO().DisplaySize;
  const float pad = em(0.4F);
  const ImVec2 at(std::clamp(begun_.x + outer + em(0.8F), pad, all.x - size.x - pad),
                  std::clamp(begun_.y - size.y / 2.0F, pad, all.y - size.y - pad));
  list.AddRectFilled({at.x - pad, at.y - pad}, {at.x + size.x + pad, at.y + size.y + pad},
                     ImGui::GetColorU32(ImGuiCol_PopupBg), ImGui::GetStyle().FrameRounding);
  list.AddText(at, ImGui::GetColorU32(ImGuiCol_Text), words.c_str());
}

} // namespace nendo::viewer
