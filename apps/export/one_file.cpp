#include "export/one_file.hpp"

namespace nendo::exporting {

Result<Exported> export_to_one_file(ChosenFrames& frames, const std::filesystem::path& path,
                                    const PutFrame& put) {
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  Exported done{{path.string()}, 0, frames.first_s(), frames.first_s()};
  for (;;) {
    const auto more = frames.next();
    if (!more) return more.error();
    if (!*more) break;
    if (const auto written = put(*file); !written) return written.error();
    done.last_s = frames.time_s();
  }
  if (const auto finished = file->finish(); !finished) return finished.error();
  done.frames = frames.made();
  done.bytes = file->size();
  done.rate_hz = frames.rate_hz();
  done.exact = frames.source().is_exact();
  return done;
}

} // namespace nendo::exporting
