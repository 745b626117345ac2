// A large recording, read: opening it, going to any time in it, and `bag verify`, `recover` and `cut` as they are
// typed.
#include <algorithm>
#include <random>

#include "base/error.hpp"
#include "bench/statistics.hpp"
#include "mcap/reader.hpp"
#include "measure.hpp"
#include "support/recorded_files.hpp"

namespace baton::bench {
namespace {

constexpr double kMaxSeek_ms = 5.0;
constexpr double kMinVerify = 300.0;          // MB of file in a second
constexpr double kMaxSizeGrowth_MB = 8.0;     // of the process, where the file is ten times as large
constexpr std::uint64_t kBytesASample = 151;  // what three messages of the recording take in the file

std::filesystem::path makeRecording(const std::filesystem::path& folder, const std::string& name, double megabytes) {
  const auto samples = static_cast<std::uint64_t>(megabytes * 1e6 / kBytesASample);
  return test::writeRecording(folder, name, {.samples = samples, .chunk_bytes = std::size_t{256} << 10}).front();
}

void measureSeek(const std::filesystem::path& file, const Report& report) {
  const Stopwatch opening;
  const mcap::Reader reader(file);
  report({"open", opening.seconds() * 1e3, "ms"});
  const mcap::Statistics& statistics = reader.statistics();
  std::mt19937_64 generator(3);
  std::vector<double> times_ms;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t time =
        statistics.start_time_ns + generator() % (statistics.end_time_ns - statistics.start_time_ns + 1);
    const Stopwatch watch;
    mcap::MessageCursor cursor = reader.messages({.start_time_ns = time});
    mcap::MessageView message;
    if (!cursor.next(message) || message.log_time_ns < time) throw Error(ExitCode::kFailed, "a seek missed its time");
    times_ms.push_back(watch.seconds() * 1e3);
  }
  report({"seek, median", median(times_ms), "ms"});
  report({"seek, longest", *std::max_element(times_ms.begin(), times_ms.end()), "ms", kMaxSeek_ms, true});
}

}  // namespace

void measureReader(const Plan& plan, const Report& report) {
  const Scratch disk(plan.disk);
  const std::filesystem::path file = makeRecording(disk.folder(), "large", static_cast<double>(plan.megabytes));
  const std::filesystem::path tenth = makeRecording(disk.folder(), "small", static_cast<double>(plan.megabytes) / 10.0);
  const double megabytes = static_cast<double>(std::filesystem::file_size(file)) * 1e-6;
  report({"file that is read", megabytes, "MB"});
  measureSeek(file, report);

  const auto measured = [&](const std::vector<std::string>& arguments) {
    std::vector<double> seconds;
    double peak_MB = 0.0;
    for (int round = 0; round < plan.rounds; ++round) {
      const Ended ended = runProgram("baton", arguments);
      if (ended.exit_code != 0) throw Error(ExitCode::kFailed, "baton bag " + arguments[1] + " failed");
      seconds.push_back(ended.seconds);
      peak_MB = std::max(peak_MB, ended.peak_MB);
    }
    return std::pair(median(seconds), peak_MB);
  };
  const auto [small_s, small_MB] = measured({"bag", "verify", tenth.string()});
  const auto [verify_s, verify_MB] = measured({"bag", "verify", file.string()});
  report({"bag verify", megabytes / verify_s, "MB/s", kMinVerify});
  report({"bag verify: memory", verify_MB, "MB"});
  report({"bag verify: memory beyond that for a tenth", verify_MB - small_MB, "MB", kMaxSizeGrowth_MB, true});
  const std::string out = disk.file("out.mcap").string();
  const auto [recover_s, recover_MB] = measured({"bag", "recover", file.string(), out, "--overwrite"});
  report({"bag recover", megabytes / recover_s, "MB/s"});
  report({"bag recover: memory", recover_MB, "MB"});
}

}  // namespace baton::bench
