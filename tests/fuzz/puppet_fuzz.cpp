// Whatever the text is, parse_puppet gives an error of one line, or a puppet within its limits that
// can be played: its points are finite wherever its functions are between their limits.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/puppet/rig.hpp>

#include "laws.hpp"
#include "support/test_meshes.hpp"

namespace {

using nendo::puppet::Puppet;

void play(Puppet puppet) {
  static const nendo::deform::Mesh model = nendo::test::sphere(6, 8, 1.0);
  if (!nendo::puppet::check_fits(puppet, model)) return;
  const nendo::puppet::Rig rig(std::move(puppet), model);
  nendo::deform::Points points = rig.starts();
  std::vector<double> values;
  for (const auto& function : rig.puppet().functions)
    values.push_back(values.size() % 2 == 0 ? function.most : function.least);
  rig.place(values, points);
  require(points.allFinite());
  if (rig.puppet().is_played()) rig.supports();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  auto puppet = nendo::puppet::parse_puppet(text, "fuzz");
  if (!puppet) {
    require_one_line(puppet.error());
    return 0;
  }
  require(puppet->points.size() <= Puppet::max_points);
  require(puppet->functions.size() <= Puppet::max_functions);
  require(puppet->text == text);
  play(*std::move(puppet));
  return 0;
}
