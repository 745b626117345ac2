/// Talks to a run from outside: reads the latest word on a topic, sends a request and waits for its answer. Waiting is
/// always bounded, and what did not come is said.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/typed.hpp"
#include "runtime/admission.hpp"
#include "runtime/cell.hpp"
#include "runtime/service_options.hpp"

namespace baton {

class CellClient {
 public:
  /// Long enough for a lost datagram of discovery to be sent again more than once; what answers is not waited for.
  static constexpr std::chrono::seconds kPatience{15};

  static constexpr std::chrono::seconds kRecorderPatience{3};

  /// Somebody may be stopped or gone: what the others say is worth more than the wait.
  static constexpr std::chrono::seconds kStatusPatience{5};

  explicit CellClient(const RunInfo& info);

  /// The run in a cell of this machine. Throws UnavailableError, listing what runs, when there is none.
  [[nodiscard]] static RunInfo find(int domain, const std::string& cell);

  /// Collects samples of a topic until `enough(all so far)`, at most `patience`. Returns what came.
  template <class T>
  std::vector<T> collect(
      const dds::Topic<T>& topic, const std::function<bool(const std::vector<T>&)>& enough,
      std::chrono::milliseconds patience = kPatience,
      const std::function<bool(const T&, const dds::RawSample&)>& accept = [](const auto&, const auto&) {
        return true;
      });

  /// The newest sample of a topic with one writer, or nothing within `patience`.
  template <class T>
  std::optional<T> latest(const dds::Topic<T>& topic, std::chrono::milliseconds patience = kPatience);

  /// Sends all `requests` once `service` listens and talks back, then waits for as many answers that `is_answer`
  /// accepts; returns those that came in time. Throws UnavailableError when nobody listens.
  template <class Request, class Answer>
  std::vector<Answer> askAll(const dds::Topic<Request>& request_topic, const std::vector<Request>& requests,
                             const dds::Topic<Answer>& answer_topic,
                             const std::function<bool(const Answer&)>& is_answer, const std::string& service,
                             std::chrono::milliseconds patience = kPatience);

  /// The same for one; returns nothing when no answer came in time.
  template <class Request, class Answer>
  std::optional<Answer> ask(const dds::Topic<Request>& request_topic, const Request& request,
                            const dds::Topic<Answer>& answer_topic, const std::function<bool(const Answer&)>& is_answer,
                            const std::string& service, std::chrono::milliseconds patience = kPatience);

  /// Whether the writer of this sample is that service, or the supervisor.
  [[nodiscard]] bool speaksFor(const dds::RawSample& sample, std::string_view service) const {
    return admission_.speaksFor(sample.writer, service);
  }
  /// The processes of the domain that discovery has told of so far.
  [[nodiscard]] std::vector<dds::Peer> peers() const { return participant_.peers(); }
  [[nodiscard]] const RunInfo& info() const { return info_; }
  /// Unlike any other of this run.
  [[nodiscard]] static std::uint64_t newRequestId();

 private:
  [[nodiscard]] bool isMatchedWith(const std::set<dds::GuidPrefix>& matched, const std::string& service) const;

  RunInfo info_;
  std::mutex mutex_;
  std::condition_variable changed_;
  dds::Participant participant_;
  Admission admission_;
};

template <class T>
std::vector<T> CellClient::collect(const dds::Topic<T>& topic, const std::function<bool(const std::vector<T>&)>& enough,
                                   std::chrono::milliseconds patience,
                                   const std::function<bool(const T&, const dds::RawSample&)>& accept) {
  std::vector<T> samples;
  const dds::Reader<T> reader(
      participant_, topic,
      [&](const T& message, const dds::RawSample& sample) {
        if (!accept(message, sample)) return;
        const std::lock_guard lock(mutex_);
        samples.push_back(message);
        changed_.notify_all();
      },
      {}, admission_.filter(topic));
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [&] { return enough(samples); });
  return samples;
}

template <class T>
std::optional<T> CellClient::latest(const dds::Topic<T>& topic, std::chrono::milliseconds patience) {
  const std::vector<T> samples = collect<T>(
      topic, [](const std::vector<T>& all) { return !all.empty(); }, patience,
      [this](const T&, const dds::RawSample& sample) { return !participant_.isSecondCopy(sample.writer); });
  return samples.empty() ? std::nullopt : std::optional(samples.back());
}

template <class Request, class Answer>
std::vector<Answer> CellClient::askAll(const dds::Topic<Request>& request_topic, const std::vector<Request>& requests,
                                       const dds::Topic<Answer>& answer_topic,
                                       const std::function<bool(const Answer&)>& is_answer, const std::string& service,
                                       std::chrono::milliseconds patience) {
  const auto wake = [this] {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  };
  std::vector<Answer> answers;
  const dds::Reader<Answer> reader(
      participant_, answer_topic,
      [&](const Answer& message, const dds::RawSample&) {
        const std::lock_guard lock(mutex_);
        if (is_answer(message)) answers.push_back(message);
        changed_.notify_all();
      },
      wake, admission_.filter(answer_topic));
  dds::Writer<Request> writer(participant_, request_topic, wake);
  // Writer and reader are matched at different times: both have to be before a request is worth sending.
  std::unique_lock lock(mutex_);
  const bool is_heard = changed_.wait_for(lock, kPatience, [&] {
    return isMatchedWith(writer.raw().matched(), service) && isMatchedWith(reader.raw().matched(), service);
  });
  lock.unlock();
  if (!is_heard) {
    throw UnavailableError("the " + service + " of run " + info_.run + " does not listen: see `baton status`");
  }
  for (const Request& request : requests) writer.write(request);
  lock.lock();
  changed_.wait_for(lock, patience, [&] { return answers.size() >= requests.size(); });
  if (!info_.recording.empty()) {
    // The recorder learns of this writer when it sees it, and what is asked belongs into the recording.
    changed_.wait_for(lock, kRecorderPatience, [&] { return isMatchedWith(writer.raw().matched(), kRecorderName); });
    lock.unlock();
    writer.raw().waitForAcknowledgments(static_cast<int>(std::chrono::milliseconds(kRecorderPatience).count()));
    lock.lock();
  }
  return answers;
}

template <class Request, class Answer>
std::optional<Answer> CellClient::ask(const dds::Topic<Request>& request_topic, const Request& request,
                                      const dds::Topic<Answer>& answer_topic,
                                      const std::function<bool(const Answer&)>& is_answer, const std::string& service,
                                      std::chrono::milliseconds patience) {
  const auto answers = askAll<Request, Answer>(request_topic, {request}, answer_topic, is_answer, service, patience);
  return answers.empty() ? std::nullopt : std::optional(answers.front());
}

}  // namespace baton
