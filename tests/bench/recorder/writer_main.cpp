// One of the writers of `baton bench recorder`: a process that is no part of the run, publishes at a steady rate in its
// partition, and says at the end what it has sent.
#include <chrono>
#include <condition_variable>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "base/error.hpp"
#include "dds/endpoint.hpp"
#include "payload.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/run.hpp"

namespace baton::bench {
namespace {
using Clock = std::chrono::steady_clock;

constexpr auto kTick = std::chrono::milliseconds(1);  // what is due in one goes out in one
constexpr auto kMatchPatience = std::chrono::seconds(30);
constexpr int kAcknowledgmentPatience_ms = 10'000;

struct Plan {
  int domain = 0;
  std::string partition, name;
  int topics = 1;
  std::size_t bytes = 0;
  double rate = 0.0, seconds = 0.0;
  std::int64_t begin_ns = 0;  // of the steady clock, the same for all processes
};

/// Its members find a writer of their cell at once.
std::string cellOf(const Plan& plan) { return plan.partition.substr(0, plan.partition.find('/')); }

class LoadWriters {
 public:
  explicit LoadWriters(const Plan& plan)
      : participant_({.domain = plan.domain,
                      .partition = plan.partition,
                      .cell = cellOf(plan),
                      .run = "",
                      .service = plan.name}) {
    for (int i = 0; i < plan.topics; ++i) {
      writers_.push_back(std::make_unique<dds::RawWriter>(
          participant_,
          dds::EndpointOptions{
              .topic = loadTopic(i), .type = kLoadType, .max_payload = static_cast<std::uint32_t>(plan.bytes)},
          [this] {
            { const std::lock_guard lock(mutex_); }  // whoever looks has seen it, or is told
            matched_.notify_all();
          }));
    }
  }

  void waitForRecorder() {
    std::unique_lock lock(mutex_);
    const bool is_heard = matched_.wait_for(lock, kMatchPatience, [this] {
      return std::ranges::none_of(writers_, [](const auto& writer) { return writer->matched().empty(); });
    });
    if (!is_heard) throw UnavailableError("nobody reads " + loadTopic(0) + " and the topics after it");
  }

  /// The topics take turns.
  void write(Payloads& payloads) {
    dds::RawWriter& writer = *writers_[turn_++ % writers_.size()];
    if (!writer.write(payloads.make(writer.count() + 1))) throw UnavailableError("DDS refuses a sample");
  }

  void waitForAcknowledgments() {
    for (const auto& writer : writers_) writer->waitForAcknowledgments(kAcknowledgmentPatience_ms);
  }
  [[nodiscard]] std::vector<std::uint64_t> counts() const {
    std::vector<std::uint64_t> counts;
    for (const auto& writer : writers_) counts.push_back(writer->count());
    return counts;
  }
  [[nodiscard]] std::vector<std::string> guids() const {
    std::vector<std::string> guids;
    for (const auto& writer : writers_) guids.push_back(dds::toString(writer->guid()));
    return guids;
  }

 private:
  std::mutex mutex_;
  std::condition_variable matched_;
  dds::Participant participant_;
  std::vector<std::unique_ptr<dds::RawWriter>> writers_;
  std::size_t turn_ = 0;
};

/// A writer that was held up sends at once what has come due: the rate is kept as long as the machine can.
nlohmann::ordered_json publish(const Plan& plan) {
  LoadWriters writers(plan);
  Payloads payloads(plan.bytes);
  writers.waitForRecorder();
  const auto begin = std::max(Clock::now(), Clock::time_point(std::chrono::nanoseconds(plan.begin_ns)));
  const auto total = static_cast<std::uint64_t>(plan.rate * plan.seconds);
  std::uint64_t sent = 0;
  for (auto tick = begin; sent < total; tick += kTick) {
    std::this_thread::sleep_until(tick);
    const double elapsed_s = std::chrono::duration<double>(tick + kTick - begin).count();
    for (const auto due = std::min(total, static_cast<std::uint64_t>(plan.rate * elapsed_s)); sent < due; ++sent) {
      writers.write(payloads);
    }
  }
  const auto end = Clock::now();
  writers.waitForAcknowledgments();  // before the run is told to end; what is not, is counted as lost
  return {{"name", plan.name},
          {"begin_ns", begin.time_since_epoch() / std::chrono::nanoseconds(1)},
          {"end_ns", end.time_since_epoch() / std::chrono::nanoseconds(1)},
          {"sent", writers.counts()},
          {"guids", writers.guids()}};
}

ExitCode run(int argc, char** argv) {
  Plan plan;
  CLI::App app{"Publishes at a steady rate, and prints what it has sent as JSON."};
  app.add_option("--domain", plan.domain, "DDS domain")->required();
  app.add_option("--partition", plan.partition, "of the run; may be a pattern")->required();
  app.add_option("--name", plan.name, "by which the recording knows it")->required();
  app.add_option("--topics", plan.topics, "that take turns")->required();
  app.add_option("--bytes", plan.bytes, "of a payload")->required();
  app.add_option("--rate", plan.rate, "messages a second, over all topics")->required();
  app.add_option("--seconds", plan.seconds, "for so long")->required();
  app.add_option("--begin-ns", plan.begin_ns, "not before this time of the steady clock")->required();
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  std::cout << toText(publish(plan)) << '\n';
  return ExitCode::kOk;
}

}  // namespace
}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-writer", [&] { return baton::bench::run(argc, argv); });
}
