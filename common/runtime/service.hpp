/// What every service of a run is made of: the DDS participant, endpoints, the start barrier, the executor, the end of
/// the run. A service's own code declares its topics, reacts to samples and calls run().
///
/// Threads. Handlers given to input() run in DDS's receive thread, one at a time under mutex(): take, compute, write,
/// and block on nothing else (waking another thread would cost 10 to 35 us a hop). Everything else, timers and handlers
/// posted to executor(), runs in the thread that called run(); it takes mutex() when it touches what the handlers
/// touch.
#pragma once

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dds/participant.hpp"
#include "dds/typed.hpp"
#include "messages/loop.hpp"
#include "runtime/admission.hpp"
#include "runtime/announcer.hpp"
#include "runtime/barrier.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"
#include "time/request_line.hpp"
#include "time/request_pace.hpp"

namespace baton {

class Service {
 public:
  Service(ServiceOptions options, Scenario scenario);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// A writer on `topic`; the service is not ready before every service in `readers` reads it.
  template <class T>
  dds::Writer<T>& output(const dds::Topic<T>& topic, const std::vector<std::string>& readers = {});

  /// A reader on `topic`, likewise with `writers`. `handler(message, sample)` runs under mutex(). Requests that come
  /// faster than a recorder could follow what they cause are handled later, or not at all: see RequestPace.
  template <class T>
  void input(const dds::Topic<T>& topic, const std::vector<std::string>& writers,
             typename dds::Reader<T>::Callback handler);

  /// What was written there last is for somebody: the process does not leave before its readers have it, or too late.
  void leavesAfter(dds::RawWriter& writer) { last_words_.push_back(&writer); }

  /// Keeps something of the caller's own (the recorder's readers) in the barrier.
  void require(const std::string& topic, std::function<std::set<dds::GuidPrefix>()> matched,
               std::vector<std::string> peers);

  /// Looks at the barrier again soon; any thread.
  void matchesChanged();

  /// Publishes an event and logs it, from the executor; any thread may ask.
  void event(msg::Severity severity, const std::string& kind, const std::string& text);
  /// Where the run is, for events; before the step is answered. A fault that the scenario wants on this process strikes
  /// here.
  void at(std::uint64_t step) {
    if (!process_faults_.empty()) strikeWhenReached(step);
    step_ = step;
  }
  /// A sample of the loop cannot be used. The first one is published as an event and in this service's status; what
  /// follows from it, the plant decides. From handlers.
  void refuse(const dds::TopicFacts& topic, std::uint64_t step, const Reading& reading);
  /// The service has answered this step for good; after the last one its manifest goes out. From handlers.
  void stepDone(std::uint64_t step);
  /// The run ended at `step`: from the plant itself, or from SimStatus for all others. `clean` when every service will
  /// still answer that step. From handlers.
  void runEnded(std::uint64_t step, bool clean);
  /// The manifest is out: what is published from now on is not part of the run. From handlers.
  [[nodiscard]] bool isOver() const { return manifest_out_; }
  /// Takes part in resets. `is_quiet(step)`: everything of that step is here and answered, so nothing of the run so far
  /// can still arrive. `forget` goes back to the state from before the first step. Both are called under mutex().
  void onRewind(std::function<bool(std::uint64_t)> is_quiet, std::function<void()> forget);
  /// Of the run: how often it had been reset, as far as is known here. From handlers.
  [[nodiscard]] std::uint32_t take() const { return take_; }
  /// Something has arrived that is_quiet() may have waited for. From handlers.
  void considerRewind();
  /// This service takes no part in the steps: at the end of the run nothing more is waited for.
  void answersNoSteps() { answers_steps_ = false; }
  /// Each word of the plant on the run, before its end has consequences here. From handlers; not in the plant itself.
  void onSimStatus(std::function<void(const msg::SimStatus&)> handler) {
    const std::lock_guard lock(mutex_);  // the plant may speak already
    on_sim_status_ = std::move(handler);
  }
  /// Called once on the executor when the run has ended and this service's manifest is out.
  void onEnd(std::function<void()> handler) { on_end_ = std::move(handler); }

  /// Instead of ending run(), a signal calls this on the executor, each time.
  void onSignal(std::function<void()> handler) { on_signal_ = std::move(handler); }

  /// Repeats `action` on the executor until the service stops.
  void every(std::chrono::milliseconds period, std::function<void()> action);
  /// Ends run(); any thread.
  void stop(ExitCode code = ExitCode::kOk);
  /// Serves until stop() or a signal. Returns the exit code.
  ExitCode run();

  [[nodiscard]] const ServiceOptions& options() const { return options_; }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  [[nodiscard]] dds::Participant& participant() { return participant_; }
  [[nodiscard]] boost::asio::io_context& executor() { return executor_; }
  [[nodiscard]] std::mutex& mutex() { return mutex_; }
  [[nodiscard]] StepStamp stampOf(std::uint64_t step) const;
  /// Whether a sample was written before this process began: meant for one that it has been started in the place of.
  /// DDS delivers what it remembers to whoever comes late.
  [[nodiscard]] bool isFromBefore(const dds::RawSample& sample) const {
    return sample.source_timestamp_ns < participant_.self().started_ns;
  }
  /// Ends run() because another process has this one's place; what was sent until then stands in a manifest, as when it
  /// leaves on a signal. Any thread.
  void giveWay(const std::string& why);
  /// Who is heard on which topic; any thread.
  [[nodiscard]] Admission& admission() { return admission_; }
  /// Matched with everybody it needs; any thread.
  [[nodiscard]] bool isReady() const { return ready_; }
  /// Who is missing for that, by topic; any thread, once all endpoints are declared.
  [[nodiscard]] std::string missing() const { return barrier_.missing(); }
  /// Called once on the executor when the service becomes ready.
  void onReady(std::function<void()> handler) { on_ready_ = std::move(handler); }

 private:
  void awaitSignal();
  void leave();
  [[nodiscard]] bool isRecorded() const { return scenario_.recording.enabled; }
  [[nodiscard]] bool isRival(const dds::Peer& peer) const;
  void giveWayToElders();
  void peerJoined(const dds::Peer& peer);
  void buryLater(const dds::Peer& peer);
  void tellLosses();
  [[nodiscard]] std::optional<std::chrono::nanoseconds> pauseBefore(const dds::Guid& asker);
  void handleLater(const dds::Guid& asker, std::chrono::nanoseconds pause, std::function<void()> action);
  void strikeWhenReached(std::uint64_t step);
  void checkBarrier();
  void publishManifest();
  void sayManifest();
  void onRewindMessage(const msg::Rewind& rewind);
  void publishStatus(msg::ServiceState state, const std::string& text);
  void addToManifest(dds::Profile profile, std::function<msg::StreamManifest()> manifest);

  ServiceOptions options_;
  Scenario scenario_;
  boost::asio::io_context executor_{1};
  // HeldSignals keeps signals waiting until the constructor has added them here.
  boost::asio::signal_set signals_{executor_};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{executor_.get_executor()};
  boost::asio::steady_timer end_limit_{executor_};
  std::mutex mutex_;
  dds::Participant participant_;
  Announcer announcer_{executor_, participant_};
  Admission admission_;
  Barrier barrier_{participant_};
  std::vector<std::shared_ptr<void>> endpoints_;  // destroyed before the participant, in reverse order of opening
  std::vector<std::function<msg::StreamManifest()>> manifests_;
  std::vector<std::function<std::string()>> losses_;  // one sentence each, empty when there are none
  dds::Writer<msg::ServiceStatus>* status_ = nullptr;
  dds::Writer<msg::Event>* events_ = nullptr;
  dds::Writer<msg::ServiceManifest>* manifest_ = nullptr;
  std::vector<dds::RawWriter*> last_words_, outputs_;
  struct Rewinding {
    std::function<bool(std::uint64_t)> is_quiet;
    std::function<void()> forget;
    dds::Writer<msg::RewindAck>* ack = nullptr;
    std::optional<msg::Rewind> owed;  // an answer to this, once quiet
  };
  Rewinding rewinding_;
  std::string told_missing_ = "?";  // what the status said last
  std::function<void(const msg::SimStatus&)> on_sim_status_;
  std::function<void()> on_end_;
  std::function<void()> on_ready_;
  std::function<void()> on_signal_;
  std::atomic<std::uint64_t> step_{0};
  std::vector<Fault> process_faults_;  // that the scenario wants on this process
  bool has_begun_ = false;             // at() was called: a process that was started again is spared
  struct Refusal {
    std::string topic;  // empty: there is none
    std::uint64_t step = 0;
    std::string why;
  };
  Refusal refusal_;           // for the status
  RequestPace pace_;          // guarded by mutex_
  RequestLine line_;          // likewise: those that the pace lets wait
  bool told_flood_ = false;   // likewise
  bool has_refused_ = false;  // guarded by mutex_
  std::uint32_t take_ = 0;    // guarded by mutex_
  bool answers_steps_ = true;
  std::optional<std::uint64_t> last_done_;
  std::optional<std::uint64_t> end_step_;
  std::atomic<bool> ready_{false};
  std::atomic<bool> gave_way_{false};
  std::size_t rivals_told_ = 0;
  bool is_closed_ = false;     // guarded by mutex_: no input is handled any more
  bool manifest_out_ = false;  // guarded by mutex_
  ExitCode exit_code_ = ExitCode::kOk;
};

/// What an input did not take, as a sentence; empty when it took everything. Of a status only the latest word counts,
/// and what it replaced is not missing.
[[nodiscard]] std::string lossText(const dds::TopicFacts& topic, std::uint64_t lost, std::uint64_t unreadable,
                                   std::uint64_t of_strangers);

/// How a stream of a writer went, for the manifest.
template <class T>
[[nodiscard]] msg::StreamManifest manifestOf(const dds::Writer<T>& writer) {
  msg::StreamManifest manifest;
  manifest.topic(writer.topic());
  manifest.writer(writer.raw().guid().bytes);
  manifest.count(writer.raw().count());
  manifest.first_sequence(writer.raw().count() > 0 ? 1 : 0);
  manifest.last_sequence(writer.raw().count());
  manifest.stream_hash(writer.streamHash());
  return manifest;
}

template <class T>
dds::Writer<T>& Service::output(const dds::Topic<T>& topic, const std::vector<std::string>& readers) {
  auto writer = std::make_shared<dds::Writer<T>>(participant_, topic, [this] { matchesChanged(); });
  require(
      topic.name, [raw = &writer->raw()] { return raw->matched(); }, readers);
  addToManifest(topic.profile, [raw = writer.get()] { return manifestOf(*raw); });
  losses_.push_back([raw = writer.get()]() -> std::string {
    if (raw->refused() == 0) return {};
    return "DDS refused " + std::to_string(raw->refused()) + " samples on " + raw->topic();
  });
  outputs_.push_back(&writer->raw());
  endpoints_.push_back(writer);
  return *writer;
}

template <class T>
void Service::input(const dds::Topic<T>& topic, const std::vector<std::string>& writers,
                    typename dds::Reader<T>::Callback handler) {
  auto reader = std::make_shared<dds::Reader<T>>(
      participant_, topic,
      [this, handler = std::move(handler), is_paced = topic.profile == dds::Profile::kRequest && isRecorded()](
          const T& message, const dds::RawSample& sample) {
        const std::lock_guard lock(mutex_);
        if (is_closed_) return;
        if (!is_paced) return handler(message, sample);
        const auto pause = pauseBefore(sample.writer);
        if (!pause) return;
        const bool is_due = pause->count() == 0 && !line_.isWaiting(dds::prefixOf(sample.writer));
        if (is_due) return handler(message, sample);
        dds::RawSample later = sample;
        later.payload = {};  // it is DDS's
        handleLater(sample.writer, *pause, [handler, message, later] { handler(message, later); });
      },
      [this] { matchesChanged(); }, admission_.filter(topic));
  require(
      topic.name, [raw = &reader->raw()] { return raw->matched(); }, writers);
  losses_.push_back([raw = reader.get(), facts = static_cast<const dds::TopicFacts&>(topic)] {
    return lossText(facts, raw->raw().lost(), raw->rejected(), raw->raw().refused());
  });
  endpoints_.push_back(reader);
}

}  // namespace baton
