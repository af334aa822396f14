#pragma once
// The server's thread, and all that it owns.

#include <array>
#include <atomic>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "web/client_commands.hpp"
#include "web/connection.hpp"
#include "web/foxglove_feed.hpp"
#include "web/http_request.hpp"
#include "web/server.hpp"

struct pollfd;

namespace nendo::web {

class Server::Work {
public:
  Work(Endpoint endpoint, std::string token, UniqueFd listener, UniqueFd waker,
       ServerLimits limits);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  /// The served loop. Connections share its model while they send it.
  struct Presented {
    std::shared_ptr<FrameStream> stream;
    SharedBytes model;
    Pictures pictures;
    std::uint16_t loop = 0; ///< the loop's number within the run, in model and shape messages
  };

  void wake() noexcept;
  /// Presents a loop, whose id this sets, or with `is_beside` something in its place.
  void present(Presented next, std::vector<std::byte> model, bool is_beside);
  void report(std::string message, bool is_error);

  const Endpoint endpoint;
  const std::string token;
  // The server's thread writes or shares the following members.
  /// Enough for commands of 16 clients in half a second. Further commands are dropped.
  SpscRing<ClientCommand> commands{1024};
  struct Counts {
    std::atomic<std::uint64_t> clients{0}, accepted{0}, refused{0}, dropped{0}, updates{0},
        update_bytes{0}, shapes{0}, shape_bytes{0}, weights{0}, skipped{0};
  } counts;

  struct Weights {
    std::uint64_t number = 0;
    SharedBytes message;
  };

  /// Data from other threads for the server's thread.
  struct Inbox {
    std::mutex mutex;                ///< guards the other members
    std::optional<Presented> next;   ///< set by present(), not taken yet
    std::optional<Presented> beside; ///< set by present_beside(), not taken yet
    std::uint16_t loops = 0;
    std::string report;           ///< the newest report; empty: already sent
    bool is_report_error = false; ///< the newest report is one
    HostTime next_marks{};        ///< the earliest time of the next message about clay or a wire
    Facts facts;                  ///< messages; null until they are set
    std::array<std::uint64_t, fact_count> versions{};     ///< the last versions of versioned facts
    std::optional<FormPictures> pictures;                 ///< set by set_pictures(), not taken yet
    std::array<std::deque<FormInput>, form_kinds> inputs; ///< at most max_inputs each
    std::optional<File> file;
    std::vector<Weights> weights; ///< oldest first
    std::uint64_t weights_in_use = 0;
  } inbox;

private:
  static constexpr std::size_t max_inputs = 64;
  void run();
  void wait();
  void take_presented();
  void send_report(HostTime now);
  void send_facts(HostTime now);
  void end();
  void accept_all(HostTime now);
  void drop_oldest();
  void serve(Connection& connection, short events, HostTime now);
  void read_head(Connection& connection, HostTime now);
  void open_socket(Connection& connection, const HttpRequest& request, const Admission& admission,
                   HostTime now);
  /// Returns a texture of the presented model, or a picture of a form; null: there is none.
  std::shared_ptr<const std::string> picture_of(std::size_t number) const;
  void send_picture(Connection& connection, const HttpRequest& request, HostTime now);
  void read_socket(Connection& connection, HostTime now);
  void begin_file(Connection& connection, const HttpHead& head, HostTime now);
  void take_file(Connection& connection, HostTime now);
  void handle_input(Connection& connection, const std::string& text, HostTime now);
  void handle(Connection& connection, const std::string& text, HostTime now);
  void greet_foxglove(Connection& connection, HostTime now);
  void handle_foxglove(Connection& connection, const std::string& text, HostTime now);
  void send_text(Connection& connection, const std::string& text, HostTime now);
  void begin_foxglove(HostTime now);
  void make_foxglove(HostTime now);
  void send_foxglove(HostTime now);
  /// `allowed`: the method of the path, with the status 405.
  void refuse(Connection& connection, int status, std::string_view why, HostTime now,
              std::string_view allowed = {});
  void send_frames(HostTime now);
  void send_weights(Connection& client, HostTime now);
  void send_frames(Connection& client, const std::optional<FrameStream::Shape>& shape,
                   const SharedBytes& bytes, HostTime now);
  void drop_expired(HostTime now);
  std::size_t clients() const noexcept;
  bool has_pages() const noexcept;

  const ServerLimits limits_;
  UniqueFd listener_, waker_;
  Presented loop_, beside_; ///< beside_ has no stream if there is none
  Presented presented_;     ///< the one of the two that clients get
  FormPictures form_pictures_;
  std::list<Connection> connections_; ///< oldest first
  std::vector<pollfd> polled_;
  std::vector<Record> records_;
  FoxgloveMessages foxglove_;
  const std::string session_ = random_hex(8); ///< names this server to applications of Foxglove
  std::vector<float> drawn_;                  ///< the newest shape for foxglove_
  HostTime next_drawn_{};
  HostTime next_frames_{};
  HostTime next_accept_{};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace nendo::web
