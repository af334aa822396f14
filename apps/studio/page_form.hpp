#pragma once
// A form as a message for a page in a browser (apps/web/PROTOCOL.md, message 12). Main thread.

#include <map>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "studio/form.hpp"
#include "web/client_commands.hpp"
#include "web/model_message.hpp"

namespace nendo::studio {

class PageForm final : public Form {
public:
  /// Begins to describe the controls again. `input`: what a user has done to one of them.
  void begin(std::optional<web::FormInput> input);
  /// The controls that follow are in the part of the page with this name.
  void part(std::string_view name);
  /// A control with which the user chooses a file of the own device.
  void file(std::string_view name, std::string_view help);
  /// A ring that fills, 0 to 1.
  void ring(double share, bool warns);
  /// Returns the message. `screen`: the name of the screen.
  std::string message(std::string_view screen) const;
  /// Returns whether pictures() differs from what it was at the last call.
  bool has_new_pictures() noexcept { return std::exchange(has_new_pictures_, false); }
  /// The pictures of cards, by the numbers in messages.
  const web::Pictures& pictures() const noexcept { return pictures_; }
  /// Forgets the images, which may be destroyed then. Pictures keep their numbers.
  void forget_images() noexcept {
    numbers_.clear();
    has_new_pictures_ = true; // the server may have another model by then
  }

  void lines_of(std::size_t count) override { in_line_ = count; }
  void separator() override;
  void text(std::string_view words, Tone tone = Tone::plain) override;
  void key(std::string_view words, const Eigen::Vector3f& colour) override;
  void title(std::string_view words, std::string_view note) override;
  bool button(std::string_view name, std::string_view help, Look look = Look::plain) override;
  bool card(std::string_view name, const render::Image* picture, std::string_view help,
            bool is_chosen = false) override;
  bool check(std::string_view name, std::string_view help, bool& value) override;
  bool choice(std::string_view name, std::string_view help, std::span<const std::string_view> names,
              std::size_t& chosen) override;
  bool number(std::string_view name, std::string_view help, float& value, float min, float max,
              std::string_view unit) override;
  bool line(std::string_view name, std::string& value) override;

private:
  using Json = nlohmann::ordered_json;
  /// Adds a control that users change. Returns the new value that one gave it.
  std::optional<std::string> changed(Json control);
  std::size_t number_of(const render::Image& picture);
  Json control(const char* kind, std::string_view name, std::string_view help);

  Json parts_ = Json::array();
  std::map<std::string, int, std::less<>> same_; ///< number of controls with this name so far
  std::size_t in_line_ = 1;
  std::optional<web::FormInput> input_;
  std::map<const render::Image*, std::size_t> numbers_;
  web::Pictures pictures_;
  bool has_new_pictures_ = false;
};

} // namespace nendo::studio
