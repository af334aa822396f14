#include "cyberglove/cyberglove_greeting.hpp"

#include "cyberglove/cyberglove_line.hpp"

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

// What the drivers with the manual at hand allow for a command; less where success is unlikely.
constexpr auto first_answer = 1000ms;
constexpr auto unlikely_answer = 500ms;
constexpr auto unlikely_drain = 200ms;

/// An answer of the unit itself, whatever it says.
bool is_its_own(Answer answer) noexcept {
  return answer == Answer::good || answer == Answer::no_glove;
}

/// `last`: there is no other rate to try, so that a slow unit gets another chance.
Reply<GloveState> ask_patiently(Commands& commands, bool last) noexcept {
  Reply<GloveState> reply = commands.state();
  const bool hopeless = reply.answer == Answer::gone || (reply.answer == Answer::silent && !last);
  // An e? may still be the answer to somebody else's last words.
  return is_its_own(reply.answer) || hopeless ? reply : commands.state();
}

std::string list(const std::vector<int>& bauds) {
  std::string text;
  for (std::size_t k = 0; k < bauds.size(); ++k) {
    if (k > 0) text += k + 1 == bauds.size() ? " or " : ", ";
    text += std::to_string(bauds[k]);
  }
  return text;
}

} // namespace

Greeting greet(Transport& transport, Dialogue& dialogue, const std::vector<int>& bauds) {
  Greeting greeting;
  std::vector<int> tried;
  for (const int baud : bauds) {
    const bool first = tried.empty();
    if (!transport.set_baud(baud) && !first) break;
    tried.push_back(baud);
    // A babbling line is not yet a reason to give up: what is asked for may be among the babble.
    Reply<GloveState> reply;
    reply.answer = dialogue.stop_stream(first ? Dialogue::longest_drain : unlikely_drain);
    if (reply.answer != Answer::gone) {
      Commands commands(dialogue, first ? first_answer : unlikely_answer);
      reply = first ? ask_patiently(commands, bauds.size() == 1) : commands.state();
    }
    if (first || reply.answer != Answer::silent) greeting.reply = reply;
    if (is_its_own(reply.answer) || reply.answer == Answer::gone) {
      greeting.baud = baud;
      tried = {baud};
      break;
    }
  }
  greeting.asked = "?G at " + list(tried) + " baud";
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
