#include "load.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>

#include "base/error.hpp"
#include "dds/typed.hpp"
#include "mcap/reader.hpp"
#include "payload.hpp"
#include "scenario.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;
using Stream = std::pair<std::string, std::string>;  // topic, writer

constexpr double kCrawl = 0.05;                           // simulated seconds per second: 100 steps
constexpr int kEndless_steps = 1'000'000'000;             // the run is told to end
constexpr auto kMatch = std::chrono::milliseconds(1500);  // in which writers find the recorder
constexpr double kAsAsked = 0.99;
constexpr const char* kWriter = "baton-bench-writer";

/// Until the first state has come: the services have found each other, and the load disturbs no start.
void waitForRun(const std::string& cell, Programs& programs) {
  std::atomic<bool> has_begun{false};
  dds::Participant participant(
      {.domain = programs.domain(), .partition = cell + "/*", .cell = cell, .run = "", .service = "bench"});
  const dds::Reader<msg::PlantState> states(participant, dds::topics::kPlantState,
                                            [&](const msg::PlantState&, const dds::RawSample&) { has_begun = true; });
  programs.waitUntil([&] { return has_begun.load(); });
}

void startWriters(const Load& load, const std::string& cell, Programs& programs) {
  const auto begin = std::chrono::steady_clock::now() + kMatch;
  for (int i = 0; i < load.writers; ++i) {
    programs.start(kWriter, {"--domain", std::to_string(programs.domain()), "--partition", cell + "/*", "--name",
                             "writer-" + std::to_string(i), "--topics", std::to_string(load.topics), "--bytes",
                             std::to_string(load.bytes), "--rate", std::to_string(load.rate / load.writers),
                             "--seconds", std::to_string(load.seconds), "--begin-ns",
                             std::to_string(begin.time_since_epoch() / std::chrono::nanoseconds(1))});
  }
}

/// A sample counts when its number is its writer's own for it, and higher than all before.
std::map<Stream, std::uint64_t> countIn(const std::filesystem::path& file, const Load& load) {
  std::map<Stream, std::uint64_t> counts, latest;
  mcap::MessageFilter filter;
  for (int i = 0; i < load.topics; ++i) filter.topics.push_back(loadTopic(i));
  mcap::Reader(file).forEachMessage(filter, [&](const mcap::MessageView& message) {
    const Stream stream{message.channel->topic, message.channel->metadata.at("writer")};
    const std::uint64_t number = Payloads::numberIn(message.data);
    if (number != message.sequence || number <= latest[stream]) return;
    if (message.data.size() < static_cast<std::size_t>(load.bytes)) return;
    latest[stream] = number;
    ++counts[stream];
  });
  return counts;
}

}  // namespace

std::uint64_t Recorded::lost() const {
  std::uint64_t lost = 0;
  for (const WriterCount& writer : writers) lost += writer.sent - writer.recorded;
  return lost;
}

bool Recorded::isKept() const { return lost() == 0 && is_complete && sent_per_s >= kAsAsked * asked; }

Recorded recordUnder(const Load& load, const std::filesystem::path& file, Programs& programs) {
  const std::string cell = "bench-" + std::to_string(getpid()), domain = std::to_string(programs.domain());
  programs.start("baton",
                 {"run", programs.write("load.yaml", scenarioText(false, 0, kEndless_steps, kCrawl)), "--out",
                  file.string(), "--overwrite", "--cell", cell, "--domain", domain, "--json"},
                 static_cast<int>(ExitCode::kFailed));  // which is how a run ends whose own samples were lost
  waitForRun(cell, programs);
  startWriters(load, cell, programs);
  programs.waitUntil([&] { return !programs.anyRunning(kWriter); });
  programs.start("baton", {"sim", "stop", "--cell", cell, "--domain", domain});
  const std::vector<std::string> printed = programs.finish();

  const Json result = jsonIn(printed.front());
  if (result.at("exit_code") != 0 && result.at("recording").at("complete") == true) {
    throw UnavailableError("the run failed: " + result.at("reason").get<std::string>());
  }
  Recorded recorded{.asked = load.rate,
                    .is_complete = result.at("recording").at("complete"),
                    .recorder_MB = result.at("resident_kB").at("recorder").get<double>() * 1e-3};
  const auto counts = countIn(file, load);
  std::vector<std::int64_t> begins_ns, ends_ns;
  std::uint64_t sent = 0;
  for (int i = 0; i < load.writers; ++i) {
    const Json told = jsonIn(printed[static_cast<std::size_t>(i) + 1]);
    WriterCount writer{.name = told.at("name")};
    for (int topic = 0; topic < load.topics; ++topic) {
      writer.sent += told.at("sent").at(static_cast<std::size_t>(topic)).get<std::uint64_t>();
      const auto guid = told.at("guids").at(static_cast<std::size_t>(topic)).get<std::string>();
      const auto found = counts.find({loadTopic(topic), guid});
      if (found != counts.end()) writer.recorded += found->second;
    }
    begins_ns.push_back(told.at("begin_ns"));
    ends_ns.push_back(told.at("end_ns"));
    sent += writer.sent;
    recorded.writers.push_back(std::move(writer));
  }
  recorded.sent_per_s = static_cast<double>(sent) * 1e9 /
                        static_cast<double>(*std::ranges::max_element(ends_ns) - *std::ranges::min_element(begins_ns));
  return recorded;
}

}  // namespace baton::bench
