#pragma once
// The timeline of the studio, in its window or on its page: read from its file, or made from a
// recording, in a thread of its own. It stays while other screens are shown, and its unsaved edits
// are not lost without a question. Main thread.

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edit/edit_session.hpp"
#include "studio/wish.hpp"
#include "takes/timeline_frames.hpp"

namespace nendo::studio {

/// A timeline that was read already, and what is shown of it first.
struct FirstTimeline {
  std::string file;
  std::string out; ///< where it is saved
  std::shared_ptr<takes::TimelineFrames> frames;
  std::optional<timeline::KeyRef> key{}; ///< selected
  std::optional<double> at_s{};          ///< position of the play head
};

class StudioTimeline {
public:
  using Frames = Result<std::unique_ptr<takes::TimelineFrames>>;
  /// Returns the frames of a timeline, or those of a recording as a timeline that is to be saved in
  /// `out`. Blocks.
  using ReadFile = std::function<Frames(const std::string& file, const std::string& out)>;
  /// Errors: those of takes::TimelineFrames::open() and edit::timeline_of_take().
  static Frames read_file(const std::string& file, const std::string& out);

  explicit StudioTimeline(ReadFile read_file = &StudioTimeline::read_file)
      : read_file_(std::move(read_file)) {}
  /// Waits for the files that are being read, because no thread may read on while the program ends.
  /// Removes a file that a browser sent, if the user has not decided about it or it cannot be read.
  ~StudioTimeline();
  StudioTimeline(const StudioTimeline&) = delete;
  StudioTimeline& operator=(const StudioTimeline&) = delete;

  /// Closes what was open, and begins to read a timeline or a recording. A recording is replayed
  /// for it, which takes a small part of its duration. Does not wait for a file that was being
  /// read; two are read at once, and a further one when one of them has been read.
  void open(const Open& wanted);
  void open(const FirstTimeline& first);
  void close();
  bool is_open() const noexcept { return !file_.empty(); }
  const std::string& file() const noexcept { return file_; } ///< empty: none

  /// Returns the session, which begins when the file has been read; null: it has not, or nothing is
  /// open. On an error, nothing is open any more. Errors: those of read_file().
  Result<edit::EditSession*> read();
  edit::EditSession* session() const noexcept { return session_.get(); } ///< may be null
  /// Returns the model before the hands, of a session.
  const std::shared_ptr<const flow::ModelVersion>& model() const noexcept { return model_; }
  /// Returns what is to be shown without a session.
  std::string waiting_words() const;

  /// Returns where the timeline is saved; empty: nothing is open.
  const std::string& out() const noexcept { return out_; }
  bool is_modified() const noexcept;
  /// Returns whether edits are unsaved or a file is being exported, so that no recording may
  /// replace the timeline unasked.
  bool is_in_use() const;
  /// Returns whether there are edits that the user has neither saved nor discarded.
  bool has_edits_to_lose() const noexcept;
  /// Returns whether the wish loses no such edits. Otherwise it waits until the user is asked about
  /// unsaved(), and settle() has the answer.
  bool lets(const Wish& wish);
  bool is_asking() const noexcept { return is_wish(waiting_); }
  std::string unsaved() const; ///< "the changes to FILE"
  /// Returns the wish that waited, if it may be followed now. Error: failed, if the edits cannot be
  /// saved.
  Result<Wish> settle(Answer answer);

private:
  using Reading = std::future<Frames>;
  /// A file that was closed before it was read.
  struct Left {
    Reading reading;
    Open file;
  };
  static bool is_ready(const Reading& reading);
  static void end(Left& left);
  void follow_left();
  void begin_reading();
  void begin(takes::TimelineFrames& frames);

  ReadFile read_file_;
  std::string file_;
  std::string out_;       ///< where the timeline is saved
  bool was_sent_ = false; ///< as Open
  Reading reading_;
  std::vector<Left> left_;
  std::unique_ptr<edit::EditSession> session_;
  std::shared_ptr<const flow::ModelVersion> model_;
  std::optional<std::uint64_t> discarded_; ///< the revision that the user does not want to save
  Wish waiting_;
};

} // namespace nendo::studio
