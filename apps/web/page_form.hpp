#pragma once
// A form as a message for a page in a browser (apps/web/PROTOCOL.md, message 12). Main thread.

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/units.hpp>

#include "forms/form.hpp"
#include "web/client_commands.hpp"
#include "web/model_message.hpp"

namespace nendo::web {

class PageForm final : public forms::Form {
public:
  /// Begins to describe the controls again. `input`: what a user has done to one of them.
  void begin(std::optional<FormInput> input);
  /// Returns the command of the timeline editor that the input asks for, and takes it; null: it
  /// asks for something else. Call it before the controls are described.
  const commands::Row* take_edit_command();
  /// The controls that follow are in the part of the page with this name.
  void part(std::string_view name);
  /// A control with which the user chooses a file of the own device.
  void file(std::string_view name, std::string_view help);
  /// A ring that fills, 0 to 1.
  void ring(double share, bool warns);
  /// Returns the message. `screen`: the name of the screen; empty: the form is no screen's.
  std::string message(std::string_view screen = {}) const;
  /// Returns whether pictures() differs from what it was at the last call.
  bool has_new_pictures() noexcept { return std::exchange(has_new_pictures_, false); }
  /// The pictures by the numbers in messages. No form has the number of another one's picture.
  const FormPictures& pictures() const noexcept { return pictures_; }
  /// Forgets the images of cards, which may be destroyed then. Their pictures keep their numbers.
  void forget_images() noexcept {
    numbers_.clear();
    has_new_pictures_ = true; // the server may have those of another form by then
  }

  void lines_of(std::size_t count) override { in_line_ = count; }
  void separator() override;
  void text(std::string_view words, Tone tone = Tone::plain, std::string_view help = {}) override;
  void key(std::string_view words, const Eigen::Vector3f& colour) override;
  void title(std::string_view words, std::string_view note) override;
  bool section(std::string_view name, std::string_view help, bool is_open_at_first) override;
  void chart(std::string_view name, std::string_view help, std::span<const float> values) override;
  void bends(Side side, std::string_view help, std::span<const float> degrees) override;
  bool button(std::string_view name, std::string_view help, Look look = Look::plain) override;
  bool card(std::string_view name, const render::Image* picture, std::string_view help,
            bool is_chosen = false) override;
  bool command(const commands::Row& row, const commands::State& now) override;
  bool box(std::string_view name, const commands::Row& row, const commands::State& now,
           bool is_on) override;
  bool check(std::string_view name, std::string_view help, bool& value) override;
  bool choice(std::string_view name, std::string_view help, std::span<const std::string_view> names,
              std::size_t& chosen) override;
  bool one_of(std::string_view name, std::span<const Choice> choices, std::size_t& chosen) override;
  bool number(std::string_view name, std::string_view help, float& value, float min, float max,
              std::string_view unit, int decimals = 0) override;
  bool line(std::string_view name, std::string& value) override;
  std::optional<std::size_t> list(std::string_view name, std::string_view help,
                                  std::span<const Row> rows, std::size_t present) override;
  forms::Pointer drawing(std::string_view name, std::string_view help,
                         const forms::Drawing& drawing) override;
  /// True for a while after a number was changed, because a page does not report its release.
  bool is_changing() const override;

  /// The number of pictures of drawings that are kept when no drawing shows them any more: pages
  /// may not have fetched them yet.
  static constexpr std::size_t max_gone = 64;

private:
  using Json = nlohmann::ordered_json;
  void add(Json control);
  /// Adds a control that users change. Returns what one did to it.
  std::optional<FormInput> taken(Json control);
  /// Does the same, and returns the new value.
  std::optional<std::string> changed(Json control);
  /// Does the same for a choice of one of so many. Returns its number.
  std::optional<std::size_t> chosen_of(Json control, std::size_t count);
  std::size_t number_of(const render::Image& picture);
  std::size_t number_of(const std::shared_ptr<const render::Image>& picture);
  std::size_t add_picture(std::shared_ptr<const std::string> contents);
  Json shape_of(const forms::Drawing::Shape& shape);
  Json picture_of(const forms::Drawing::Shape& shape);
  void forget_drawings();
  Json control(const char* kind, std::string_view name, std::string_view help);
  Json control_of(const char* kind, std::string_view name, const commands::Row& row,
                  const commands::State& now) const;

  Json parts_ = Json::array();
  std::map<std::string, int, std::less<>> same_; ///< number of controls with this name so far
  std::size_t in_line_ = 1;
  std::optional<FormInput> input_;
  HostTime number_changed_{};
  /// A drawing's pointer or a picture of drawings, and whether the last description has it.
  template <class T>
  struct Described {
    T value{};
    bool is_described = false;
  };
  std::map<std::string, Described<forms::Pointer>> pointers_; ///< key: a drawing's id
  std::map<std::shared_ptr<const render::Image>, Described<std::size_t>> drawn_; ///< their numbers
  std::deque<std::size_t> gone_; ///< numbers of pictures that drawings had, the oldest first
  std::map<const render::Image*, std::size_t> numbers_; ///< numbers of cards
  std::vector<std::size_t> cards_;                      ///< all numbers of cards
  FormPictures pictures_;
  bool has_new_pictures_ = false;
};

} // namespace nendo::web
