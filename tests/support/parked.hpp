#pragma once
// ParkedPeer: a thread that works without end and can be stopped wherever it is, in the middle of
// whatever it does. What another thread can still do meanwhile does not wait for it: that is what
// being lock-free means.

#include <atomic>
#include <functional>
#include <thread>

namespace nendo::test {

class ParkedPeer {
public:
  /// `work` is done over and over by a thread of its own. One peer at a time.
  explicit ParkedPeer(std::function<void()> work);
  ~ParkedPeer();
  ParkedPeer(const ParkedPeer&) = delete;
  ParkedPeer& operator=(const ParkedPeer&) = delete;

  /// Stops the peer at an instruction that chance picks, lets it do some work first, and returns
  /// when it stands still.
  void park();
  void resume();

private:
  std::atomic<bool> done_{false};
  std::atomic<unsigned> rounds_{0};
  std::thread thread_;
};

} // namespace nendo::test
