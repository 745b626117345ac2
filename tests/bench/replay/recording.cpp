#include "recording.hpp"

#include <cstring>

#include "base/splitmix64.hpp"
#include "mcap/writer.hpp"

namespace baton::bench {

void writeRecording(const std::string& file, const RecordingPlan& plan) {
  constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000;
  mcap::WriterOptions options;
  options.chunk_bytes = std::size_t{256} << 10;  // as the recorder's
  options.sync_on_close = false;
  mcap::Writer writer(file, options);
  const mcap::ChannelId channel =
      writer.addChannel(kTopic, "cdr", writer.addSchema(kType, "omgidl", {}),
                        {{"qos", "reliability: reliable\ndurability: volatile\nownership: shared\nkeyed: false\n"}});
  mcap::Bytes payload(plan.payload_bytes);
  payload.at(1) = std::byte{1};  // the header of plain CDR, little endian
  std::uint64_t random = 1;
  for (std::uint64_t i = 0; i < plan.messages; ++i) {
    for (std::size_t at = 4; at + sizeof random <= payload.size(); at += sizeof random) {
      const std::uint64_t word = splitmix(random += kSplitmixStep);
      std::memcpy(payload.data() + at, &word, sizeof word);
    }
    const std::uint64_t time_ns = kStart_ns + i * plan.period_ns;
    writer.write(channel, static_cast<std::uint32_t>(i + 1), time_ns, time_ns, payload);
  }
  writer.close();
}

}  // namespace baton::bench
