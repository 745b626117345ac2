/// Who is heard on which topic of a run. In one place for every input of every service: a sample counts when its writer
/// has the run's key and its role is one whose topic it is.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "dds/endpoint.hpp"
#include "dds/participant.hpp"
#include "dds/topics.hpp"

namespace baton {

/// How many an event is written of, for each thing that they do: a flood of them must not flood the recording.
inline constexpr std::size_t kMaxStrangersTold = 20;

/// "trajectory sent reference of step 601, which cannot be used: its position is not finite"; empty for a topic that
/// is not one service's alone.
[[nodiscard]] std::string badInputText(std::string_view topic, std::uint64_t step, std::string_view why);

/// Whether a process leaves its place to another: the younger of two copies of a service of one run; and a plant that
/// has not begun to that of an elder run in the cell. How old the other one is, is its own word, so it counts only when
/// the other one is believed.
/// @param is_believed  it has our run's key, or that of another run of this user's; or our run has none.
[[nodiscard]] bool yieldsTo(const dds::Peer& self, const dds::Peer& other, bool is_believed, bool has_begun);

class Admission {
 public:
  /// Called once for each stranger and thing that it does, on the thread that asks, with a sentence that names it.
  using Tell = std::function<void(const std::string& text)>;

  /// @param is_open  whether requests are taken from anybody.
  Admission(const dds::Participant& participant, bool is_open, Tell tell)
      : participant_(participant), is_open_(is_open), tell_(std::move(tell)) {}

  /// Any thread. Without a key everybody is heard.
  [[nodiscard]] bool admits(const dds::TopicFacts& topic, const dds::Guid& writer);
  /// The same as a filter for a reader of that topic, which does not outlive this. Of services it asks once for each
  /// writer, and again when somebody has left; of operators each time.
  [[nodiscard]] dds::WriterFilter filter(const dds::TopicFacts& topic);
  /// Whether the word of this writer counts where it concerns `service`: it is that one, or the supervisor.
  [[nodiscard]] bool speaksFor(const dds::Guid& writer, std::string_view service) const;
  /// It is there and says that it is of our run.
  void met(const dds::Peer& stranger);
  /// The participant's gate has turned it away.
  void turnedAway(const dds::GuidPrefix& stranger, dds::Trespass what);

 private:
  enum class Deed { kIsThere, kSpeaks, kAsks };
  void tellOnce(Deed deed, const dds::GuidPrefix& prefix, const std::function<std::string()>& text);

  const dds::Participant& participant_;
  bool is_open_;
  Tell tell_;
  std::mutex mutex_;
  std::map<Deed, std::set<dds::GuidPrefix>> told_;
};

}  // namespace baton
