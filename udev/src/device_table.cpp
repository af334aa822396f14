#include <nendo/udev/device_table.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include <nendo/base/endings.hpp>

namespace nendo::udev {
namespace {

constexpr std::string_view ultra = "5DT Data Glove Ultra";

// Bits of a 5DT Ultra's product number (VRPN's driver): 0 is the left hand, 1 and 2 are its link,
// where 2 is unused, and 4 is five sensors.
constexpr std::array models{
    UsbGloveModel{{0x0D7F, 0x0100}, "Essential Reality P5"},
    UsbGloveModel{{0x5D70, 0x0000}, ultra},
    UsbGloveModel{{0x5D70, 0x0001}, ultra},
    UsbGloveModel{{0x5D70, 0x0002}, ultra},
    UsbGloveModel{{0x5D70, 0x0003}, ultra},
    UsbGloveModel{{0x5D70, 0x0006}, ultra},
    UsbGloveModel{{0x5D70, 0x0007}, ultra},
    UsbGloveModel{{0x5D70, 0x0010}, ultra},
    UsbGloveModel{{0x5D70, 0x0011}, ultra},
    UsbGloveModel{{0x5D70, 0x0012}, ultra},
    UsbGloveModel{{0x5D70, 0x0013}, ultra},
    UsbGloveModel{{0x5D70, 0x0016}, ultra},
    UsbGloveModel{{0x5D70, 0x0017}, ultra},
};

// 0403:6001 is also a CyberGlove III itself. Prolific's adapter is what early users plug gloves
// into. The other two are the chips of hobbyists' gloves.
constexpr std::array adapters{
    UsbAdapter{{0x0403, 0x6001}, "FTDI", "ftdi_sio"},
    UsbAdapter{{0x067B, 0x2303}, "Prolific", "pl2303"},
    UsbAdapter{{0x10C4, 0xEA60}, "Silicon Labs", "cp210x"},
    UsbAdapter{{0x1A86, 0x7523}, "WCH", "ch341"},
};

// 3Dconnexion, and what it made as a part of Logitech: c603 to c640 (spacenavd, usb.ids).
constexpr std::array space_mice{SpaceMouseNumbers{"256f", "????"},
                                SpaceMouseNumbers{"046d", "c6??"}};

// Not "Immersion": that maker also made digitisers with a serial port.
constexpr std::array<std::string_view, 2> names{"cyberglove", "cybertouch"};

bool matches(std::string_view text, std::string_view pattern) noexcept {
  return std::equal(text.begin(), text.end(), pattern.begin(), pattern.end(),
                    [](char c, char wanted) { return wanted == '?' || c == wanted; });
}

} // namespace

std::string to_string(UsbId id) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04x:%04x", unsigned{id.vendor}, unsigned{id.product});
  return text.data();
}

std::span<const UsbGloveModel> usb_glove_models() noexcept {
  return models;
}

std::span<const UsbAdapter> usb_adapters() noexcept {
  return adapters;
}

std::span<const SpaceMouseNumbers> space_mouse_numbers() noexcept {
  return space_mice;
}

std::span<const std::string_view> glove_names() noexcept {
  return names;
}

std::string_view usb_glove_name(UsbId id) noexcept {
  const auto* const found = std::find_if(
      models.begin(), models.end(), [&](const UsbGloveModel& model) { return model.id == id; });
  return found != models.end() ? found->name : std::string_view{};
}

const UsbAdapter* find_usb_adapter(UsbId id) noexcept {
  const auto* const found =
      std::find_if(adapters.begin(), adapters.end(),
                   [&](const UsbAdapter& adapter) { return adapter.id == id; });
  return found != adapters.end() ? found : nullptr;
}

bool names_a_glove(std::string text) {
  text = to_lower(std::move(text));
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return text.find(name) != std::string::npos; });
}

bool numbers_a_space_mouse(std::string_view vendor, std::string_view product) noexcept {
  return std::any_of(space_mice.begin(), space_mice.end(), [&](const SpaceMouseNumbers& numbers) {
    return matches(vendor, numbers.vendor) && matches(product, numbers.products);
  });
}

} // namespace nendo::udev
