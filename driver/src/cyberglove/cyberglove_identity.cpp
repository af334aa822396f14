#include "cyberglove/cyberglove_identity.hpp"

#include <bit>
#include <type_traits>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include <nendo/driver/glove_options.hpp>

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

/// Time for an answer on a line with other traffic, and on a quiet one. The second is the time that
/// drivers of authors with the manual allow for a command: a Bluetooth link that was asleep takes
/// more than half of it.
constexpr auto needed_answer = 400ms;
constexpr auto needed_answer_quiet = 1000ms;
/// The caller's deadline is for units that answer at once. One that has shown that it is there may
/// take this number of its slowest answers more; there are some twenty queries.
constexpr int max_answers = 30;
constexpr int tries = 2; ///< because noise on the line may explain a failure

bool is_final(Answer answer) noexcept {
  return answer == Answer::good || answer == Answer::gone || answer == Answer::no_glove;
}

Error no_device(const std::string& source, const std::string& what) {
  return {Errc::no_device, source + ": " + what};
}

Error bad_answer(const std::string& source, Answer answer, const std::string& question) {
  switch (answer) {
  case Answer::silent:
    return no_device(source,
                     "no answer to " + question +
                         "; is the glove's interface unit switched on, and is this its port?");
  case Answer::gone:
    return no_device(source, "the port went away at " + question + "; is the cable loose?");
  case Answer::no_glove:
    return no_device(source, "the interface unit answers, but no glove is plugged into it");
  default:
    return no_device(source, "what is there does not answer " + question +
                                 " like a CyberGlove; is this its port, and the baud rate right?");
  }
}

/// The meaning of an error with which the unit refuses an option, or nullptr.
const char* refusal(Answer answer) noexcept {
  switch (answer) {
  case Answer::unknown:
    return "the interface unit does not know this (e?); leave the option out";
  case Answer::bad_number:
    return "the interface unit refuses the number (en); choose another";
  case Answer::bad_rate:
    return "the interface unit cannot sample as fast (es); lower the rate, or say filter=off";
  case Answer::other_value:
    return "the interface unit took another value; leave the option out";
  default:
    return nullptr;
  }
}

std::string hexadecimal(SensorMask mask) {
  return fmt::format("0x{:06X}", mask.bits);
}

std::string text_of(double number) {
  return fmt::format("{:.6g}", number);
}

// The time that drivers of authors with the manual allow for a command; less where success is
// unlikely.
constexpr auto first_answer = 1000ms;
constexpr auto unlikely_answer = 500ms;
constexpr auto unlikely_drain = 200ms;

/// An answer of the unit itself, good or not.
bool is_of_unit(Answer answer) noexcept {
  return answer == Answer::good || answer == Answer::no_glove;
}

/// `last`: there is no other rate to try, so that a slow unit gets another chance.
Reply<GloveState> ask_state_twice(Commands& commands, bool last) noexcept {
  Reply<GloveState> reply = commands.ask(ask_state);
  const bool hopeless = reply.answer == Answer::gone || (reply.answer == Answer::silent && !last);
  // An e? may still be the answer to the previous program.
  return is_of_unit(reply.answer) || hopeless ? reply : commands.ask(ask_state);
}

std::string list_of(const std::vector<int>& bauds) {
  std::string text;
  for (std::size_t k = 0; k < bauds.size(); ++k) {
    if (k > 0) text += k + 1 == bauds.size() ? " or " : ", ";
    text += std::to_string(bauds[k]);
  }
  return text;
}

/// Makes an Identity of a greeted unit; the functions are called in their order.
class SetUp {
public:
  SetUp(Dialogue& dialogue, const std::string& source, const Request& request)
      : commands_(dialogue, needed_answer), dialogue_(dialogue), source_(source), request_(request),
        options_(request.options) {}

  Result<Identity> run() {
    dialogue_.prolong(HostClock::now() + max_answers * dialogue_.slowest_answer());
    dialogue_.wait_on_quiet_line(needed_answer_quiet);
    for (const auto step :
         {&SetUp::ask_channels, &SetUp::ask_hand, &SetUp::set_switches, &SetUp::set_records}) {
      if (auto done = (this->*step)(); !done) return done.error();
    }
    dialogue_.wait_on_quiet_line(0ms);
    ask_facts(dialogue_, request_, identity_);
    return std::move(identity_);
  }

private:
  Result<void> set_mask(SensorMask hardware) {
    if (!options_.mask) return {};
    const std::string text = "mask=" + hexadecimal(*options_.mask);
    const unsigned sent = hardware.bits & options_.mask->bits;
    if (sent == 0) {
      return Error{Errc::usage, source_ + ": " + text +
                                    ": the glove has none of these sensors; it has " +
                                    hexadecimal(hardware)};
    }
    if (auto done = apply(text, [&] { return commands_.set_software_mask(*options_.mask); }); !done)
      return done;
    // Otherwise the count of an earlier, smaller mask would cut this one. ?N reports the result.
    const auto count = static_cast<std::uint8_t>(std::popcount(sent));
    const Answer answer = commands_.send(set_value_count, count);
    return answer == Answer::gone ? Result<void>(bad_answer(source_, answer, text))
                                  : Result<void>();
  }

  Result<void> ask_channels() {
    const auto count = needed(ask_sensor_count, {});
    if (!count) return count.error();
    if (*count == 0 || *count > sensor_slots) {
      return no_device(source_, "says that it has " + std::to_string(*count) +
                                    " sensors; no CyberGlove has");
    }
    const auto hardware = needed(ask_hardware_mask, *count == 18 ? sensors_18 : sensors_22);
    if (!hardware) return hardware.error();
    if (auto done = set_mask(*hardware); !done) return done;
    const auto software = needed(ask_software_mask, SensorMask{0xFFFFFF});
    if (!software) return software.error();
    const auto values = needed(ask_value_count, std::uint8_t{sensor_slots});
    if (!values) return values.error();
    const ChannelMap map = make_channel_map(*hardware, *software, *values);
    if (map.count == 0) {
      return no_device(source_,
                       "all its sensors are masked off; switch its interface unit off and on");
    }
    identity_.sensors = *count;
    identity_.channels = map;
    add("sensors", std::to_string(*count));
    add("hardware_mask", hexadecimal(*hardware));
    add("software_mask", hexadecimal(*software));
    add("values", std::to_string(map.count));
    return {};
  }

  Result<void> ask_hand() {
    const auto side = needed(ask_side, Side::right);
    if (!side) return side.error();
    const SideOptions wishes{options_.hand, std::nullopt};
    const ChosenHand chosen = choose_hand(*side, wishes);
    identity_.side = chosen.side;
    add("hand", std::string(name_of(*side)));
    add("hand_source", std::string(chosen.source));
    if (auto note = hand_override(*side, wishes); !note.empty())
      identity_.notes.push_back(std::move(note));
    return {};
  }

  Result<void> set_switches() {
    struct Switch {
      const char* name;
      Setting setting;
      const std::optional<bool>& wanted;
    };
    for (const Switch& one : {Switch{"filter=", Setting::filter, options_.filter},
                              Switch{"quantised=", Setting::quantised, options_.quantised}}) {
      if (!one.wanted) continue;
      const bool on = *one.wanted;
      if (auto done = apply(std::string(one.name) + (on ? "on" : "off"),
                            [&] { return commands_.set(one.setting, on); });
          !done) {
        return done;
      }
    }
    return {};
  }

  Result<void> set_records() {
    identity_.word_order = request_.word_order;
    identity_.sync = options_.sync;
    if (options_.hires) return set_hires();
    if (!options_.rate_hz) identity_.rate_hz = ask_present_rate();
    const auto plan =
        plan_records(options_, identity_.channels.count, request_.baud, identity_.rate_hz);
    if (!plan) return Error{plan.error().code, source_ + ": " + plan.error().message};
    if (plan->stamps_dropped) {
      identity_.notes.push_back("records come without time stamp and status byte, with which the "
                                "line at " +
                                std::to_string(request_.baud) + " baud would be too slow");
    }
    const auto time_stamp = set_stamp(Setting::time_stamp, plan->stamps);
    if (!time_stamp) return time_stamp.error();
    const auto status = set_stamp(Setting::status_byte, plan->stamps);
    if (!status) return status.error();
    identity_.shape = {identity_.channels.count, *time_stamp, *status};
    if (plan->period) {
      if (auto done = set_period(*plan->period); !done) return done;
    }
    if (options_.sync) identity_.rate_hz = 0.0; // the pulses determine it
    add("rate_hz", text_of(identity_.rate_hz));
    return {};
  }

  Result<void> set_hires() {
    if (identity_.sensors != hi_res_values) {
      return Error{Errc::usage, source_ +
                                    ": hires=on: these records carry 22 sensors, the glove has " +
                                    std::to_string(identity_.sensors) + "; leave the option out"};
    }
    const auto steps = plan_hires(options_, request_.baud);
    if (!steps) return Error{steps.error().code, source_ + ": " + steps.error().message};
    if (auto done = apply("hires=on", [&] { return commands_.send(third_enable_usb); }); !done)
      return done;
    if (*steps) {
      identity_.rate_hz = **steps * third_frame_step_hz;
      if (auto done = apply("rate=" + text_of(identity_.rate_hz),
                            [&] { return commands_.send(third_frame_rate, **steps); });
          !done) {
        return done;
      }
      add("rate_hz", text_of(identity_.rate_hz));
    }
    identity_.hires = true;
    identity_.channels = hi_res_channels;
    identity_.shape = {hi_res_values, false, false, RecordForm::hi_res};
    return {};
  }

  Result<void> set_period(Period period) {
    Reply<std::optional<WordOrder>> reply;
    const std::string text = "rate=" + text_of(*options_.rate_hz);
    auto done = apply(text, [&] { return (reply = commands_.set_period(period)).answer; });
    if (!done) return done;
    if (reply.value) identity_.word_order = reply.value;
    identity_.rate_hz = rate_of(period);
    add("period_ticks", std::to_string(period.ticks) + " " + std::to_string(period.times));
    return {};
  }

  /// Returns whether records carry it now. A unit that does not know it sends records without.
  Result<bool> set_stamp(Setting setting, bool on) {
    Answer answer = Answer::silent;
    for (int k = 0; k < tries && !is_final(answer); ++k)
      answer = commands_.set(setting, on);
    if (answer == Answer::good) return on;
    if (answer == Answer::unknown || answer == Answer::bad_number) return false;
    return bad_answer(source_, answer, std::string("the setting ") + static_cast<char>(setting));
  }

  /// Records per second by the unit's present settings; 0: as fast as it can, or unknown.
  double ask_present_rate() {
    const auto bytes = commands_.ask(ask_period);
    if (!bytes) return 0.0;
    const auto period = request_.word_order ? decode_period(bytes.value, *request_.word_order)
                                            : guess_period(bytes.value);
    if (!period) return 0.0;
    add("period_ticks", std::to_string(period->ticks) + " " + std::to_string(period->times));
    return rate_of(*period);
  }

  void add(const char* name, std::string value) {
    identity_.facts.push_back({name, std::move(value)});
  }

  /// Returns the reply, or `otherwise` if the unit does not know the query.
  template <class T>
  Result<T> needed(Query<T> query, std::optional<std::type_identity_t<T>> otherwise) {
    Reply<T> reply;
    for (int k = 0; k < tries && !is_final(reply.answer); ++k)
      reply = commands_.ask(query);
    if (reply.answer == Answer::unknown && otherwise) return *otherwise;
    if (!reply) return bad_answer(source_, reply.answer, {'?', query.letter});
    return reply.value;
  }

  /// Applies an option; `text` is the option.
  template <class Set>
  Result<void> apply(const std::string& text, Set&& set) {
    Answer answer = Answer::silent;
    for (int k = 0; k < tries && !is_final(answer); ++k)
      answer = set();
    if (answer == Answer::good) return {};
    if (const char* why = refusal(answer); why != nullptr)
      return Error{Errc::usage, source_ + ": " + text + ": " + why};
    return bad_answer(source_, answer, text);
  }

  Commands commands_;
  Dialogue& dialogue_;
  const std::string& source_;
  const Request& request_;
  const Options& options_;
  Identity identity_;
};

} // namespace

Result<void> check_state(const std::string& source, const Reply<GloveState>& reply,
                         const std::string& query) {
  if (!reply) return bad_answer(source, reply.answer, query);
  if (!reply.value.connected) return bad_answer(source, Answer::no_glove, query);
  if (!reply.value.initialised) {
    return no_device(source,
                     "the glove is plugged in but not ready; switch its interface unit off and on");
  }
  return {};
}

Result<Identity> identify(Dialogue& dialogue, const std::string& source, const Request& request) {
  return SetUp(dialogue, source, request).run();
}

Greeting greet(Transport& transport, Dialogue& dialogue, const std::vector<int>& bauds) {
  Greeting greeting;
  std::vector<int> tried;
  for (const int baud : bauds) {
    const bool first = tried.empty();
    if (!transport.set_baud(baud) && !first) break;
    tried.push_back(baud);
    // Other bytes on the line are no reason to give up: the answer may be among them.
    Reply<GloveState> reply;
    reply.answer = dialogue.stop_stream(first ? Dialogue::max_drain : unlikely_drain);
    if (reply.answer != Answer::gone) {
      Commands commands(dialogue, first ? first_answer : unlikely_answer);
      reply = first ? ask_state_twice(commands, bauds.size() == 1) : commands.ask(ask_state);
    }
    if (first || reply.answer != Answer::silent) greeting.reply = reply;
    if (is_of_unit(reply.answer) || reply.answer == Answer::gone) {
      greeting.baud = baud;
      tried = {baud};
      break;
    }
  }
  greeting.query = "?G at " + list_of(tried) + " baud";
  return greeting;
}

std::vector<int> bauds_to_try(int known, bool guess) {
  std::vector<int> bauds{known};
  for (const int usual : usual_bauds) {
    if (guess && usual != known) bauds.push_back(usual);
  }
  return bauds;
}

} // namespace nendo::driver::cyberglove
