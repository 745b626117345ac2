#include "runtime/service.hpp"

#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <ctime>
#include <stdexcept>
#include <utility>

#include "base/plural.hpp"
#include "runtime/cell.hpp"
#include "runtime/processes.hpp"
#include "runtime/signals.hpp"

namespace baton {
namespace asio = boost::asio;
namespace {

/// Another process has to wake this one: who is stopped does nothing. It goes on calling, since on a busy machine the
/// first call may come before this one stands.
void standStillFor(double seconds) {
  const pid_t sleeper = getpid();
  const timespec pause{static_cast<time_t>(seconds), static_cast<long>(std::fmod(seconds, 1.0) * 1e9)};
  // The child may do no more than what is safe in a signal handler: the parent has other threads.
  const pid_t waker = fork();
  if (waker == 0) {
    ::close_range(3, ~0U, 0);
    timespec rest = pause;
    while (::nanosleep(&rest, &rest) != 0 && errno == EINTR) {
    }
    while (::getppid() == sleeper) {
      ::kill(sleeper, SIGCONT);
      rest = {0, 10'000'000};
      ::nanosleep(&rest, nullptr);
    }
    ::_exit(0);
  }
  ::raise(SIGSTOP);
  if (waker > 0) {
    ::kill(waker, SIGKILL);
    ::waitpid(waker, nullptr, 0);
  }
}

}  // namespace

Service::Service(ServiceOptions options, Scenario scenario)
    : options_(std::move(options)),
      scenario_(std::move(scenario)),
      // A peer's discovery data may come after its endpoints are matched.
      participant_(
          options_.participant(),
          [this](const dds::Peer& peer) { asio::post(executor_, [this, peer] { peerJoined(peer); }); },
          [this](const dds::GuidPrefix& stranger, dds::Trespass what) {
            asio::post(executor_, [this, stranger, what] { admission_.turnedAway(stranger, what); });
          }),
      admission_(participant_, options_.is_open,
                 [this](const std::string& text) { event(msg::SEVERITY_WARNING, "stranger", text); }) {
  for (const int number : endingSignals()) signals_.add(number);
  for (const Fault& fault : scenario_.faults) {
    if (fault.service == options_.name && isOfProcess(fault.kind)) process_faults_.push_back(fault);
  }
  status_ = &output(dds::topics::kServiceStatus);
  events_ = &output(dds::topics::kEvent);
  manifest_ = &output(dds::topics::kServiceManifest);
  leavesAfter(manifest_->raw());
  if (options_.role != kPlantName) {
    input(dds::topics::kSimStatus, {kPlantName}, [this](const msg::SimStatus& status, const dds::RawSample& sample) {
      if (participant_.isSecondCopy(sample.writer)) return;
      if (on_sim_status_) on_sim_status_(status);
      take_ = std::max(take_, status.take());
      const bool finished = status.state() == msg::SIM_STATE_FINISHED;
      if (finished || status.state() == msg::SIM_STATE_ABORTED) runEnded(status.step(), finished);
    });
  }
}

Service::~Service() {
  while (!endpoints_.empty()) endpoints_.pop_back();
}

/// Runs only where the scenario wants a fault of this process. The step is not answered, or late.
void Service::strikeWhenReached(std::uint64_t step) {
  const bool has_begun = std::exchange(has_begun_, true);
  for (const Fault& fault : process_faults_) {
    if (!has_begun || step_ >= fault.from_step || step < fault.from_step) continue;
    if (fault.kind == FaultKind::kKill) ::raise(SIGKILL);
    if (fault.seconds > 0.0) {
      standStillFor(fault.seconds);
    } else {
      ::raise(SIGSTOP);
    }
  }
}

StepStamp Service::stampOf(std::uint64_t step) const { return baton::stampOf(step, scenario_.step_ns); }

void Service::require(const std::string& topic, std::function<std::set<dds::GuidPrefix>()> matched,
                      std::vector<std::string> peers) {
  barrier_.require(topic, std::move(matched), std::move(peers));
}

void Service::addToManifest(dds::Profile profile, std::function<msg::StreamManifest()> manifest) {
  // A status is only ever its latest word: what it replaced is not missing from a recording.
  if (profile == dds::Profile::kStatus) return;
  // One more and the manifest could not be encoded: the recording would be incomplete, with no word why.
  if (manifests_.size() == msg::MAX_STREAMS) {
    throw std::logic_error(
        fmt::format("{}: expected at most {} streams, as many as ServiceManifest in idl/service.idl "
                    "holds, found one more: raise MAX_STREAMS and the bound of streams there",
                    options_.name, static_cast<int>(msg::MAX_STREAMS)));
  }
  manifests_.push_back(std::move(manifest));
}

/// Another one of us: a second copy in our run, or the plant of another run in the cell.
bool Service::isRival(const dds::Peer& peer) const {
  return peer.cell == options_.cell && peer.service == options_.name &&
         (peer.run == options_.run || options_.role == kPlantName);
}

void Service::giveWayToElders() {
  for (const dds::Peer& peer : participant_.peers()) {
    // Whom to believe is dearer to find out than whether it matters.
    if (!yieldsTo(participant_.self(), peer, true, ready_)) continue;
    if (!participant_.isMember(peer.prefix) && !isOfThisUser(peer)) continue;
    return giveWay(peer.run == options_.run ? "run " + peer.run + " has its " + peer.service + " already"
                                            : "cell " + peer.cell + " has a plant of run " + peer.run +
                                                  " already: end that run or choose another --cell");
  }
}

void Service::peerJoined(const dds::Peer& peer) {
  if (peer.is_stranger) return admission_.met(peer);
  if (participant_.hasKey() && participant_.isMember(peer.prefix) && roleCalled(peer.service) != dds::Role::kOperator) {
    whenEnded(executor_, peer, [this, peer] { buryLater(peer); });
  }
  announcer_.greet();
  checkBarrier();
  if (!gave_way_ && isRival(peer) && rivals_told_++ < kMaxStrangersTold) {
    event(msg::SEVERITY_WARNING, "intruder", "a second " + peer.service + " of run " + peer.run + "; this one goes on");
  }
}

/// What it sent before may still wait here in a socket, also where this process was stopped meanwhile.
void Service::buryLater(const dds::Peer& peer) {
  const auto timer = std::make_shared<asio::steady_timer>(executor_, std::chrono::seconds(1));
  timer->async_wait([this, timer, peer](const boost::system::error_code& error) {
    if (error) return;
    participant_.bury(peer.prefix);
    spdlog::info("{} has ended (process {})", peer.service, peer.pid);
  });
}

void Service::giveWay(const std::string& why) {
  if (gave_way_.exchange(true)) return;
  spdlog::error("{}; this one stops", why);
  // Its status says nothing of this: the name is the other one's, who must not be taken for failed.
  asio::post(executor_, [this] {
    exit_code_ = ExitCode::kUnavailable;
    leave();
  });
}

void Service::matchesChanged() {
  asio::post(executor_, [this] { checkBarrier(); });
}

void Service::checkBarrier() {
  giveWayToElders();
  if (ready_ || gave_way_) return;
  const std::string missing = barrier_.missing();
  ready_ = missing.empty();
  if (ready_ || missing != told_missing_) {
    publishStatus(ready_ ? msg::SERVICE_READY : msg::SERVICE_STARTING, ready_ ? "" : "waits for " + missing);
  }
  told_missing_ = missing;
  if (!ready_) return;
  spdlog::info("ready");
  if (on_ready_) on_ready_();
}

void Service::publishStatus(msg::ServiceState state, const std::string& text) {
  msg::ServiceStatus status;
  status.name(options_.name);
  status.role(options_.role);
  status.state(state);
  status.pid(getpid());
  status.text(text);
  if (options_.role == kPlantName) {
    status.plant(participant_.self().prefix);
  } else if (const auto plant = barrier_.eldest(kPlantName)) {
    status.plant(plant->prefix);
  }
  status.refused_topic(refusal_.topic);
  status.refused_step(refusal_.step);
  status.refusal(refusal_.why);
  status_->write(status);
}

void Service::event(msg::Severity severity, const std::string& kind, const std::string& text) {
  asio::post(executor_, [this, stamp = stampOf(step_), severity, kind, text] {
    const auto level = severity == msg::SEVERITY_INFO      ? spdlog::level::info
                       : severity == msg::SEVERITY_WARNING ? spdlog::level::warn
                                                           : spdlog::level::err;
    spdlog::log(level, "step={} sim_time_ns={} {}: {}", stamp.step, stamp.time_ns, kind, text);
    msg::Event message;
    message.step(stamp.step);
    message.time_ns(stamp.time_ns);
    message.severity(severity);
    message.service(options_.name);
    message.kind(kind);
    message.text(text);
    const std::lock_guard lock(mutex_);
    if (!manifest_out_) events_->write(message);  // afterwards the recording is being closed; the log has it
  });
}

void Service::refuse(const dds::TopicFacts& topic, std::uint64_t step, const Reading& reading) {
  if (reading || std::exchange(has_refused_, true)) return;
  asio::post(executor_, [this, name = topic.name, step, reading] {
    refusal_ = {name, step, reading.text()};
    publishStatus(ready_ ? msg::SERVICE_READY : msg::SERVICE_STARTING, "");
    event(msg::SEVERITY_ERROR, "bad_input", badInputText(name, step, refusal_.why));
  });
}

void Service::stepDone(std::uint64_t step) {
  last_done_ = std::max(last_done_.value_or(0), step);
  considerRewind();
  if (end_step_ && step >= *end_step_) asio::post(executor_, [this] { publishManifest(); });
}

void Service::onRewind(std::function<bool(std::uint64_t)> is_quiet, std::function<void()> forget) {
  rewinding_.is_quiet = std::move(is_quiet);
  rewinding_.forget = std::move(forget);
  rewinding_.ack = &output(dds::topics::kRewindAck, {kPlantName});
  input(dds::topics::kRewind, {kPlantName},
        [this](const msg::Rewind& rewind, const dds::RawSample&) { onRewindMessage(rewind); });
}

void Service::onRewindMessage(const msg::Rewind& rewind) {
  if (manifest_out_) return;
  rewinding_.owed.reset();
  if (rewind.phase() == msg::REWIND_CANCEL) return;
  if (rewind.phase() == msg::REWIND_COMMIT) {
    take_ = rewind.take();
    rewinding_.forget();
    last_done_.reset();
    step_ = 0;
  }
  rewinding_.owed = rewind;
  considerRewind();
}

void Service::considerRewind() {
  const std::optional<msg::Rewind>& owed = rewinding_.owed;
  if (!owed || (owed->phase() == msg::REWIND_PREPARE && !rewinding_.is_quiet(owed->at_step()))) return;
  msg::RewindAck ack;
  ack.take(owed->take());
  ack.phase(owed->phase());
  ack.name(options_.name);
  rewinding_.ack->write(ack);
  rewinding_.owed.reset();
}

void Service::runEnded(std::uint64_t step, bool clean) {
  if (end_step_) return;
  end_step_ = step;
  const bool is_behind = clean && answers_steps_ && !(last_done_ && *last_done_ >= step);
  asio::post(executor_, [this, is_behind] {
    if (!is_behind) return publishManifest();
    // stepDone() will come, unless inputs were lost to a process that had been stopped for long.
    end_limit_.expires_after(std::chrono::seconds(3));
    end_limit_.async_wait([this](const boost::system::error_code& error) {
      if (!error) publishManifest();
    });
  });
}

std::string lossText(const dds::TopicFacts& topic, std::uint64_t lost, std::uint64_t unreadable,
                     std::uint64_t of_strangers) {
  std::string text;
  const auto add = [&text](std::uint64_t count, const std::string& what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + what;
  };
  add(topic.profile == dds::Profile::kStatus ? 0 : lost, counted(lost, "sample") + " lost on the way");
  add(unreadable, std::to_string(unreadable) + " that could not be read");
  add(of_strangers, std::to_string(of_strangers) + " of strangers, not heard");
  return text.empty() ? text : std::string(topic.name) + ": " + text;
}

/// Zero for a request that is due at once; nothing for one that is left out.
std::optional<std::chrono::nanoseconds> Service::pauseBefore(const dds::Guid& asker) {
  const std::int64_t now_ns = std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  const std::optional<std::int64_t> due_ns = pace_.admit(dds::prefixOf(asker), now_ns);
  if (due_ns) return std::chrono::nanoseconds(*due_ns - now_ns);
  if (!std::exchange(told_flood_, true)) {
    const auto peer = participant_.member(dds::prefixOf(asker));
    event(msg::SEVERITY_WARNING, "flood",
          (peer ? peer->service : dds::toString(dds::prefixOf(asker))) +
              " asks more than 100 times a second: what would wait for more than 1 s is not answered");
  }
  return std::nullopt;
}

/// In the order in which the asker's requests came, though its timers may run out in another one.
void Service::handleLater(const dds::Guid& asker, std::chrono::nanoseconds pause, std::function<void()> action) {
  line_.add(dds::prefixOf(asker), std::move(action));
  const auto timer = std::make_shared<asio::steady_timer>(executor_);
  asio::post(executor_, [this, timer, pause, prefix = dds::prefixOf(asker)] {
    timer->expires_after(pause);
    timer->async_wait([this, timer, prefix](const boost::system::error_code& error) {
      const std::lock_guard lock(mutex_);
      if (!error && !is_closed_) line_.next(prefix)();
    });
  });
}

void Service::tellLosses() {
  for (const auto& loss : losses_) {
    if (const std::string text = loss(); !text.empty()) spdlog::warn("{}", text);
  }
  if (const std::uint64_t count = participant_.turnedAway(); count > 0) {
    spdlog::warn("{} messages of strangers were turned away", count);
  }
}

void Service::publishManifest() {
  const std::lock_guard lock(mutex_);
  sayManifest();
}

void Service::sayManifest() {
  if (manifest_out_) return;
  manifest_out_ = true;
  tellLosses();
  msg::ServiceManifest message;
  message.name(gave_way_ ? kSecondCopyName : options_.name);
  for (const auto& manifest : manifests_) {
    const msg::StreamManifest stream = manifest();
    if (stream.count() > 0) message.streams().push_back(stream);
  }
  if (!gave_way_ || !message.streams().empty()) manifest_->write(message);
  if (on_end_) asio::post(executor_, on_end_);
}

void Service::every(std::chrono::milliseconds period, std::function<void()> action) {
  struct Repeater : std::enable_shared_from_this<Repeater> {
    Repeater(asio::io_context& executor, std::chrono::milliseconds p, std::function<void()> a)
        : timer(executor), period(p), action(std::move(a)) {}
    void arm() {
      timer.expires_after(period);
      timer.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        if (error) return;
        self->action();
        self->arm();
      });
    }
    asio::steady_timer timer;
    std::chrono::milliseconds period;
    std::function<void()> action;
  };
  std::make_shared<Repeater>(executor_, period, std::move(action))->arm();
}

void Service::stop(ExitCode code) {
  asio::post(executor_, [this, code] {
    if (exit_code_ == ExitCode::kOk) exit_code_ = code;
    executor_.stop();
  });
}

void Service::awaitSignal() {
  signals_.async_wait([this](const boost::system::error_code& error, int) {
    if (error) return;
    if (!on_signal_) return leave();
    on_signal_();
    awaitSignal();
  });
}

/// In the middle of a run too what was sent is vouched for, and has arrived: with the process goes what it could send
/// again.
void Service::leave() {
  {
    const std::lock_guard lock(mutex_);
    sayManifest();
    is_closed_ = true;  // what came of another input would not be in it
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point limit = Clock::now() + std::chrono::seconds(1);
  std::vector<dds::RawWriter*> writers = last_words_;
  writers.insert(writers.end(), outputs_.begin(), outputs_.end());
  for (dds::RawWriter* const writer : writers) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(limit - Clock::now());
    if (left.count() <= 0) break;  // somebody who died without a word is not waited for
    writer->waitForAcknowledgments(static_cast<int>(left.count()));
  }
  executor_.stop();
}

ExitCode Service::run() {
  awaitSignal();
  matchesChanged();
  announcer_.repeatUntil([this] { return ready_ || gave_way_; });
  executor_.run();
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  return exit_code_;
}

}  // namespace baton
