// What EditSession does to keys: tries, and steps.

#include <limits>
#include <utility>

#include "edit/edit_session.hpp"
#include "edit/edit_words.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/edit.hpp"

namespace nendo::edit {

using namespace timeline;

namespace {

using Selection = std::optional<KeyRef>;

Result<Selection> after(const Result<void>& done, const Selection& selected) {
  if (!done) return done.error();
  return selected;
}

Error nothing_selected() {
  return {Errc::usage, commands::no_key};
}

} // namespace

void EditSession::try_out(const viewer::KeyDrag& drag) {
  const auto key = key_of(drag.key);
  if (!key) return;
  const auto done = history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    const auto moved = drag.copy ? timeline::copy_key(timeline, key->side, key->key, drag.to_s)
                                 : move_key(timeline, key->side, key->key, drag.to_s);
    return after(moved, key_at(timeline, key->side, drag.to_s));
  });
  report(done, (drag.copy ? "copied to " : "moved to ") + fixed(drag.to_s, 3) + " s");
  if (done) seek(drag.to_s);
}

void EditSession::try_out(const viewer::TipDrag& drag) {
  const Selection key = history_.selected();
  TipSet set;
  const auto done = history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    if (!key) return nothing_selected();
    // Out of reach is told, and the finger goes as far as it can.
    const auto bent = timeline::set_tip(timeline, key->side, key->key, drag.finger, drag.target_m,
                                        std::numeric_limits<double>::infinity());
    if (!bent) return bent.error();
    set = *bent;
    return key;
  });
  constexpr double fine_m = 1e-3;
  report(done, std::string(name_of(drag.finger)) +
                   (set.off_m > fine_m ? " tip: out of reach, " : " tip: ") +
                   fixed(1e3 * set.off_m, 3) + " mm off");
}

void EditSession::try_out(const viewer::KeyBlend& blend) {
  const Selection key = history_.selected();
  report(history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    if (!key) return nothing_selected();
    return after(blend_key(timeline, key->side, key->key, blend.factor), key);
  }),
         "blended with its neighbours, " + fixed(blend.factor, 2));
}

/// Of the selected key's hand; with none selected, of all hands that have none there.
void EditSession::add_keys() {
  const Selection selected = history_.selected();
  const double at_s = head_.time_s();
  report(history_.apply([&](Timeline& timeline) -> Result<Selection> {
    Result<Selection> added = nothing_selected(); // replaced, for there is a hand
    for (const HandTrack& hand : std::vector(timeline.hands)) {
      if (selected && selected->side != hand.side) continue;
      const auto done = add_key(timeline, hand.side, at_s);
      if (done)
        added = Selection(key_at(timeline, hand.side, at_s));
      else if (!added)
        added = done.error();
    }
    return added;
  }),
         "a key more, at " + fixed(at_s, 3) + " s");
}

void EditSession::delete_key() {
  const KeyRef key = *history_.selected();
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::delete_key(timeline, key.side, key.key), std::nullopt);
  }),
         "deleted");
}

void EditSession::copy_key() {
  const KeyRef key = *history_.selected();
  const double to_s = head_.time_s();
  report(history_.apply([&](Timeline& timeline) {
    const auto copied = timeline::copy_key(timeline, key.side, key.key, to_s);
    return after(copied, key_at(timeline, key.side, to_s));
  }),
         "copied to " + fixed(to_s, 3) + " s");
}

void EditSession::mirror() {
  Selection key = history_.selected();
  if (key) key->side = key->side == Side::left ? Side::right : Side::left;
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::mirror(timeline, takes::middle_plane_m(timeline, model_)), key);
  }),
         "mirrored");
}

void EditSession::retime(const viewer::Retiming& times) {
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::retime(timeline, times.scale, times.from_s, times.to_s),
                 history_.selected());
  }),
         "re-timed, " + fixed(times.scale, 3) + " times as long");
}

} // namespace nendo::edit
