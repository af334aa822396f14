#pragma once
// A ParkedPeer is a thread that works without end and can be stopped at any instruction. What
// another thread can do meanwhile does not wait for it, so it is lock-free.

#include <atomic>
#include <functional>
#include <thread>

namespace nendo::test {

class ParkedPeer {
public:
  /// Starts a thread that does `work` repeatedly. There may be one peer at a time.
  explicit ParkedPeer(std::function<void()> work);
  ~ParkedPeer();
  ParkedPeer(const ParkedPeer&) = delete;
  ParkedPeer& operator=(const ParkedPeer&) = delete;

  /// Lets the peer do some work, stops it at a random instruction, and returns when it has stopped.
  void park();
  void resume();

private:
  std::atomic<bool> done_{false};
  std::atomic<unsigned> rounds_{0};
  std::thread thread_;
};

} // namespace nendo::test
