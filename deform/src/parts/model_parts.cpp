#include <nendo/deform/part_mover.hpp>

#include "cut/cut_assembly.hpp"

namespace nendo::deform {

ModelParts::ModelParts(const Mesh& mesh, const BlockLayout& layout) {
  std::vector<std::uint32_t> of_vertex;
  const std::uint32_t count = number_parts(mesh, of_vertex);
  of_place_.reserve(layout.vertex_count());
  for (const std::uint32_t vertex : layout.order())
    of_place_.push_back(of_vertex[vertex]);

  std::vector<std::vector<Block>> blocks(count);
  for (std::size_t place = 0; place < of_place_.size(); ++place) {
    if (of_place_[place] == no_index) continue;
    auto& of_part = blocks[of_place_[place]];
    const auto number = static_cast<std::uint32_t>(place / block_size);
    if (of_part.empty() || of_part.back().number != number) of_part.push_back({number, 0});
    of_part.back().lanes |= std::uint64_t{1} << (place % block_size);
  }
  starts_.assign(1, 0);
  for (const auto& of_part : blocks) {
    blocks_.insert(blocks_.end(), of_part.begin(), of_part.end());
    starts_.push_back(blocks_.size());
  }
}

} // namespace nendo::deform
