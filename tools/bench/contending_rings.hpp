#pragma once
// The rings of `nendo bench rt`, behind one interface. send() waits until the whole batch is in the
// ring. receive() hands over the elements that it finds, and returns how many. Rings of other
// libraries take part if their headers are installed.

#include <array>
#include <cstdint>
#include <span>

#include <nendo/base/spsc_ring.hpp>

#include "bench/plain_ring.hpp"
#include "bench/two_threads.hpp"

#ifdef NENDO_READERWRITERQUEUE
#include <readerwriterqueue/readerwriterqueue.h>
#endif
#ifdef NENDO_BOOST_LOCKFREE
#include <boost/lockfree/spsc_queue.hpp>
#endif

namespace nendo::bench {

using Element = std::array<std::uint64_t, 8>;
inline constexpr std::size_t contenders_capacity = 1024;

template <std::size_t offset_bytes>
struct PlainContender {
  static constexpr const char* name =
      offset_bytes == 0 ? "plain ring, slots on lines" : "plain ring";
  void send(std::span<const Element> batch) noexcept {
    for (const Element& element : batch)
      while (!ring.try_push(element)) {
      }
  }
  template <class Sink>
  std::size_t receive(const Sink& sink) noexcept {
    const Element* element = ring.front();
    if (element == nullptr) return 0;
    sink(*element);
    ring.pop();
    return 1;
  }
  PlainRing<Element> ring{contenders_capacity, offset_bytes};
};

struct SingleContender {
  static constexpr const char* name = "SpscRing";
  void send(std::span<const Element> batch) noexcept {
    for (const Element& element : batch)
      while (!ring.try_push(element)) {
      }
  }
  template <class Sink>
  std::size_t receive(const Sink& sink) noexcept {
    Element element;
    if (!try_pop_or_pause(ring, element)) return 0;
    sink(element);
    return 1;
  }
  SpscRing<Element> ring{contenders_capacity};
};

/// The ring as the loop uses it, with all elements taken at once.
struct DrainedContender : SingleContender {
  static constexpr const char* name = "SpscRing, drained";
  template <class Sink>
  std::size_t receive(const Sink& sink) noexcept {
    return ring.drain(sink);
  }
};

struct BatchContender {
  static constexpr const char* name = "SpscRing, batched";
  void send(std::span<const Element> batch) noexcept {
    while (!batch.empty())
      batch = batch.subspan(ring.push_n(batch));
  }
  template <class Sink>
  std::size_t receive(const Sink& sink) noexcept {
    return ring.drain(sink);
  }
  SpscRing<Element> ring{contenders_capacity};
};

#ifdef NENDO_READERWRITERQUEUE
struct ReaderWriterQueueContender {
  static constexpr const char* name = "readerwriterqueue";
  void send(std::span<const Element> batch) {
    for (const Element& element : batch)
      while (!queue.try_enqueue(element)) {
      }
  }
  template <class Sink>
  std::size_t receive(const Sink& sink) {
    const Element* element = queue.peek();
    if (element == nullptr) return 0;
    sink(*element);
    queue.pop();
    return 1;
  }
  moodycamel::ReaderWriterQueue<Element> queue{contenders_capacity};
};
#endif

#ifdef NENDO_BOOST_LOCKFREE
struct BoostContender {
  static constexpr const char* name = "boost::lockfree::spsc_queue";
  void send(std::span<const Element> batch) {
    for (const Element& element : batch)
      while (!queue.push(element)) {
      }
  }
  template <class Sink>
  std::size_t receive(const Sink& sink) {
    return queue.consume_one(sink);
  }
  boost::lockfree::spsc_queue<Element, boost::lockfree::capacity<contenders_capacity>> queue;
};
#endif

} // namespace nendo::bench
