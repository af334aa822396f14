#include "export/hands_bvh.hpp"

#include <cassert>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/hand/bvh_file.hpp>

namespace nendo::exporting {
namespace {

struct HandFile {
  std::size_t slot;
  std::filesystem::path path;
  hand::BvhFormat format;
  FileReplacement file;
};

Result<std::vector<HandFile>> begin(const ChosenFrames& frames, const Skeletons& skeletons,
                                    const std::filesystem::path& path) {
  const bool alone = !(skeletons[0] && skeletons[1]);
  std::vector<HandFile> files;
  for (std::size_t slot = 0; slot < skeletons.size(); ++slot) {
    if (!skeletons[slot]) continue;
    const auto named = alone ? path : path_of_hand(path, skeletons[slot]->side());
    auto file = FileReplacement::begin(named);
    if (!file) return file.error();
    hand::BvhFormat format(*skeletons[slot]);
    const std::string head =
        format.hierarchy() + hand::BvhFormat::motion_head(*frames.count(), 1.0 / frames.period_s());
    if (const auto written = file->write(head); !written) return written.error();
    files.push_back({slot, named, std::move(format), *std::move(file)});
  }
  if (files.empty())
    return Error{Errc::bad_input, path.string() + ": there is no hand in the take"};
  return files;
}

} // namespace

std::filesystem::path path_of_hand(const std::filesystem::path& path, Side side) {
  auto name = path.parent_path() / path.stem();
  name += "-" + std::string(name_of(side));
  name += path.extension();
  return name;
}

Result<Exported> export_hands_bvh(ChosenFrames& frames, const Skeletons& skeletons,
                                  const std::filesystem::path& path) {
  assert(frames.count());
  auto files = begin(frames, skeletons, path);
  if (!files) return files.error();
  Exported done;
  done.first_s = frames.first_s();
  std::string line;
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) break;
    for (HandFile& hand : *files) {
      line.clear();
      if (!hand.format.append_frame(frames.frame().hands[hand.slot].pose, line)) {
        return Error{Errc::bad_input, hand.path.string() + ": a pose at " +
                                          std::to_string(frames.time_s()) + " s is not finite"};
      }
      if (const auto written = hand.file.write(line); !written) return written.error();
    }
    done.last_s = frames.time_s();
  }
  for (HandFile& hand : *files) // both hands, or what was there stays
    if (const auto synced = hand.file.sync(); !synced) return synced.error();
  for (HandFile& hand : *files) {
    if (const auto finished = hand.file.finish(); !finished) return finished.error();
    done.files.push_back(hand.path.string());
    done.bytes += hand.file.size();
  }
  done.frames = frames.made();
  done.rate_hz = frames.rate_hz();
  done.exact = frames.source().is_exact();
  return done;
}

} // namespace nendo::exporting
