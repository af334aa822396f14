#pragma once
// The server's thread and what it has.

#include <atomic>
#include <list>
#include <mutex>
#include <thread>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/triple_buffer.hpp>
#include <nendo/web/server.hpp>

#include "connection.hpp"
#include "http_request.hpp"

struct pollfd;

namespace nendo::web {

class Server::Work {
public:
  Work(Endpoint endpoint, std::string token, Descriptor listener, Descriptor waker,
       ServerLimits limits);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  void present(std::shared_ptr<FrameStream> tap, std::vector<std::byte> model);
  void tell(std::string words);

  const Endpoint endpoint;
  const std::string token;
  // From this thread.
  SpscRing<flow::Request> requests{64};
  SpscRing<flow::LoopChange> changes{64};
  SpscRing<flow::SaveRequest> save_request{64};
  /// By flow::Placement::index_of(side). Only the newest counts: who moves a hand all the time
  /// fills nothing up.
  std::array<TripleBuffer<flow::WristMove>, 2> wrists{TripleBuffer(flow::WristMove{}),
                                                      TripleBuffer(flow::WristMove{})};
  std::atomic<std::uint64_t> bad_records{0}; ///< two numbers of 32 bits
  struct Counts {
    std::atomic<std::uint64_t> clients{0}, accepted{0}, refused{0}, dropped{0}, updates{0},
        update_bytes{0}, shapes{0}, shape_bytes{0}, skipped{0};
  } counts;

private:
  /// What is shown; the model stays while somebody is sent it.
  struct Show {
    std::shared_ptr<FrameStream> tap;
    SharedBytes model;
    std::uint16_t loop = 0; ///< which of a run; stands in the model and in shapes
  };

  void run();
  void wait();
  void wake() noexcept;
  void take_show();
  void pass_on_words(HostTime now);
  void end();
  void accept_all(HostTime now);
  void make_place();
  void look_at(Connection& connection, short events, HostTime now);
  void read_head(Connection& connection, HostTime now);
  void open_socket(Connection& connection, const HttpRequest& request, HostTime now);
  void read_socket(Connection& connection, HostTime now);
  void handle(Connection& connection, const std::string& text, HostTime now);
  void refuse(Connection& connection, int status, std::string_view why, HostTime now);
  void send_frames(HostTime now);
  void send_frames(Connection& client, const std::optional<FrameStream::Shape>& shape,
                   const SharedBytes& bytes, HostTime now);
  void drop_overdue(HostTime now);
  std::size_t clients() const noexcept;

  const ServerLimits limits_;
  Descriptor listener_, waker_;
  std::mutex show_mutex_;    ///< between present(), tell() and this thread
  std::optional<Show> next_; ///< guarded by it
  std::uint16_t loops_ = 0;  ///< likewise
  std::string words_;        ///< likewise; the newest, and empty if they have been passed on
  Show show_;
  std::list<Connection> connections_; ///< in the order in which they came
  std::vector<pollfd> polled_;
  std::vector<Record> records_;
  FeedCounters feed_counters_;
  HostTime next_frames_{};
  HostTime next_accept_{};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace nendo::web
