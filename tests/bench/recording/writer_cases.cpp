// The writer alone: messages of 100 B and of 10 KiB, each compression, to memory and to disk; and what it costs to know
// that they are on the storage device.
#include <algorithm>
#include <random>

#include "mcap/writer.hpp"
#include "measure.hpp"

namespace baton::bench {
namespace {

constexpr double kMinMessages = 400e3;     // of 100 B, in a second
constexpr double kMinMegabytes = 500.0;    // of 10 KiB, in a second
constexpr double kMaxFileGrowth_MB = 4.0;  // of the process while a file grows by all that is written

/// Numbers as of a robot: four bytes of each eight are noise, the others change slowly. Longer than a chunk, so that no
/// compressor finds a message again.
const mcap::Bytes& noise() {
  static const mcap::Bytes bytes = [] {
    std::mt19937 generator(1);
    mcap::Bytes made;
    for (std::uint32_t i = 0; made.size() < (std::size_t{16} << 20); ++i) {
      mcap::appendNumber(made, static_cast<std::uint32_t>(generator()));
      mcap::appendNumber(made, 0x3FE0'0000U + i / 100);
    }
    return made;
  }();
  return bytes;
}

struct Written {
  double seconds = 0.0;
  double longest_ms = 0.0;  // that one message took
  double growth_MB = 0.0;   // of the memory, between the first tenth and the end
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;  // of payload
};

/// @param sync_s  how often all is brought to the storage device; 0: never.
Written write(const std::filesystem::path& path, mcap::WriterOptions options, std::size_t size, std::uint64_t megabytes,
              double sync_s = 0.0) {
  options.if_exists = mcap::OutputFile::IfExists::kReplace;
  Written result;
  const mcap::ByteView payloads = noise();
  const std::uint64_t count = megabytes * 1'000'000 / size;
  double resident_MB = 0.0;
  const Stopwatch watch;
  double before = 0.0, synced = 0.0;
  mcap::Writer writer(path, options);
  const mcap::ChannelId channel = writer.addChannel("noise", "cdr", mcap::kNoSchema);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i == count / 10) resident_MB = residentMegabytes();
    writer.write(channel, static_cast<std::uint32_t>(i), i, i,
                 payloads.subspan(i * size % (payloads.size() - size), size));
    const double now = watch.seconds();
    result.longest_ms = std::max(result.longest_ms, (now - before) * 1e3);
    before = now;
    if (sync_s > 0.0 && now - synced > sync_s) {
      writer.sync();
      synced = watch.seconds();
      result.longest_ms = std::max(result.longest_ms, (synced - now) * 1e3);
      before = synced;
    }
  }
  writer.close();
  result.seconds = watch.seconds();
  result.growth_MB = residentMegabytes() - resident_MB;
  result.messages = count;
  result.bytes = count * size;
  return result;
}

Written medianOf(std::vector<Written> runs) {
  std::sort(runs.begin(), runs.end(), [](const Written& a, const Written& b) { return a.seconds < b.seconds; });
  return runs.at(runs.size() / 2);
}

}  // namespace

void measureWriter(const Plan& plan, const Report& report) {
  const auto measured = [&](const std::filesystem::path& path, const mcap::WriterOptions& options, std::size_t size,
                            double sync_s = 0.0) {
    std::vector<Written> runs;
    runs.reserve(static_cast<std::size_t>(plan.rounds));
    for (int round = 0; round < plan.rounds; ++round) {
      runs.push_back(write(path, options, size, plan.written_megabytes, sync_s));
    }
    return medianOf(runs);
  };
  const Scratch ram(plan.ram), disk(plan.disk);
  double growth_MB = 0.0;
  for (const auto* place : {&ram, &disk}) {
    const std::string where = place == &ram ? "memory" : "disk";
    for (const mcap::Compression compression :
         {mcap::Compression::kNone, mcap::Compression::kLz4, mcap::Compression::kZstd}) {
      mcap::WriterOptions options;
      options.compression = compression;
      options.sync_on_close = false;
      const std::string name(compression == mcap::Compression::kNone ? "none" : mcap::compressionName(compression));
      const Written small = measured(place->file("w.mcap"), options, 100);
      report({"write 100 B, " + name + ", to " + where, static_cast<double>(small.messages) / small.seconds,
              "messages/s", kMinMessages});
      const Written large = measured(place->file("w.mcap"), options, 10'240);
      report({"write 10 KiB, " + name + ", to " + where, static_cast<double>(large.bytes) * 1e-6 / large.seconds,
              "MB/s", kMinMegabytes});
      growth_MB = std::max({growth_MB, small.growth_MB, large.growth_MB});
    }
  }
  report({"write: memory gained over a file", growth_MB, "MB", kMaxFileGrowth_MB, true});

  // As the recorder writes, with each of its choices of recording: {sync: ...}.
  mcap::WriterOptions options;
  options.chunk_bytes = std::size_t{256} << 10;
  options.sync_on_close = false;
  const auto reportSync = [&](const std::string& name, double sync_s) {
    const Written run = measured(disk.file("s.mcap"), options, 100, sync_s);
    report({"sync " + name + ": 100 B to disk", static_cast<double>(run.messages) / run.seconds, "messages/s"});
    report({"sync " + name + ": longest wait", run.longest_ms, "ms"});
  };
  reportSync("none", 0.0);
  reportSync("1 s", 1.0);
  reportSync("0.1 s", 0.1);
  options.sync_chunks = true;
  reportSync("chunk", 0.0);
}

}  // namespace baton::bench
