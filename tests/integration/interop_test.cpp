// The recording in other people's hands: the official TypeScript reader decodes every message, and what the official
// writer writes is read.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "mcap/reader.hpp"
#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

namespace fs = std::filesystem;

Finished node(const Bench& bench, const std::string& script, const std::string& argument) {
  return runProgram("/bin/sh", {"-c", "node '" BATON_TEST_INTEROP "/" + script + "' '" + argument + "'"},
                    bench.folder());
}

/// What the official reader finds in a file, by its index and as a stream, with every message decoded.
nlohmann::json readOfficially(const Bench& bench, const std::string& file) {
  const Finished reader = node(bench, "read_mcap.mjs", file);
  EXPECT_EQ(reader.exit_code, 0) << file << "\n" << reader.out << reader.err;
  if (reader.exit_code != 0) return {};
  nlohmann::json summary = nlohmann::json::parse(reader.out);
  EXPECT_EQ(summary.at("decoded"), summary.at("messages")) << file;
  return summary;
}

TEST(Interop, TheOfficialReaderDecodesEveryMessage) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  const nlohmann::json run =
      bench.batonJson({"run", bench.write("short.yaml", shortContact()), "--out", file, "--json"});
  ASSERT_EQ(run.at("exit_code"), 0) << run;
  const nlohmann::json summary = readOfficially(bench, file);
  EXPECT_EQ(summary.at("messages"), run.at("recording").at("messages"));
  EXPECT_EQ(summary.at("topics").at("plant_state").at("count"), kShortSteps + 1);
  EXPECT_EQ(summary.at("topics").at("plant_state").at("type"), "baton::msg::PlantState");

  // And so it does with what is made of it, wherever it was cut.
  const std::string out = (bench.folder() / "out.mcap").string();
  ASSERT_EQ(bench.baton({"bag", "cut", file, out, "--topics", "plant_state"}).exit_code, 0);
  EXPECT_EQ(readOfficially(bench, out).at("messages"), kShortSteps + 1);
  ASSERT_EQ(bench.baton({"bag", "merge", file, out, "--overwrite"}).exit_code, 0);
  EXPECT_EQ(readOfficially(bench, out).at("topics"), summary.at("topics"));
  const std::uint64_t size = fs::file_size(file);
  for (const std::uint64_t part : {0U, 3U, 6U, 9U}) {
    const std::string cut = (bench.folder() / "cut.mcap").string();
    fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, std::max<std::uint64_t>(8, size * part / 10));
    const mcap::Reader reader(cut);
    EXPECT_EQ(bench.baton({"bag", "recover", cut, out, "--overwrite"}).exit_code, reader.info().has_all_data ? 0 : 1);
    EXPECT_EQ(readOfficially(bench, out).at("messages"), reader.statistics().message_count) << part;
  }
}

TEST(Interop, FilesOfTheOfficialWriterAreRead) {
  const Bench bench;
  const Finished writer = node(bench, "write_mcap.mjs", bench.folder().string());
  ASSERT_EQ(writer.exit_code, 0) << writer.out << writer.err;
  const nlohmann::json expected = nlohmann::json::parse(std::ifstream(bench.folder() / "expected.json"));
  ASSERT_EQ(expected.size(), 7U) << "none, lz4, zstd, without chunks, without summary, unknown records, overlapping";
  for (const auto& item : expected.items()) {
    const std::string& name = item.key();
    const nlohmann::json& contents = item.value();
    SCOPED_TRACE(name);
    const mcap::Reader reader(bench.folder() / name);
    EXPECT_TRUE(reader.info().is_complete) << reader.info().problem;
    EXPECT_EQ(reader.info().has_summary, name != "no_summary.mcap" && name != "unchunked.mcap");
    // Sound, but nobody says what was sent. The records put between the writer's are not in its CRC: that shows.
    const Finished verified = bench.baton({"bag", "verify", (bench.folder() / name).string(), "--json"});
    const bool is_as_written = name != "unknown_record.mcap";
    EXPECT_EQ(verified.exit_code, is_as_written ? 1 : 2) << verified.out << verified.err;
    EXPECT_EQ(nlohmann::json::parse(verified.out).at("damage").size(), is_as_written ? 0U : 1U) << verified.out;
    EXPECT_EQ(reader.statistics().message_count, contents.at("messages"));
    std::map<std::string, std::set<std::uint32_t>> sequences;  // by topic
    std::set<std::uint64_t> steps;
    std::uint64_t latest = 0;
    reader.forEachMessage({}, [&](const mcap::MessageView& message) {
      EXPECT_GE(message.log_time_ns, latest);
      latest = message.log_time_ns;
      ASSERT_NE(message.schema, nullptr);
      EXPECT_EQ(message.schema->name, contents.at("topics").at(message.channel->topic).at("type").get<std::string>());
      EXPECT_EQ(message.channel->metadata.at("service"), "plant");
      EXPECT_TRUE(sequences[message.channel->topic].insert(message.sequence).second);
      mcap::ByteReader payload(message.data);
      (void)payload.bytes(4);
      const auto step = payload.number<std::uint64_t>();
      EXPECT_EQ(message.publish_time_ns, step * 1'000'000);
      steps.insert(step);
    });
    EXPECT_EQ(steps.size(), contents.at("messages")) << "each once";
    for (const auto& [topic, one] : contents.at("topics").items()) {
      EXPECT_EQ(sequences[topic].size(), one.at("count"));
      EXPECT_EQ(*sequences[topic].rbegin() + 1, one.at("count"));
    }
    ASSERT_EQ(reader.attachments().size(), 1U);
    EXPECT_EQ(reader.readAttachment(reader.attachments()[0]).size(), std::string("robot: rpp\n").size());
    ASSERT_EQ(reader.metadata().size(), 1U);
    EXPECT_EQ(reader.metadata()[0].values, (mcap::StringMap{{"seed", "7"}}));

    const std::string out = (bench.folder() / "out.mcap").string();
    // The unknown records were put in behind the back of the official writer, whose data CRC does not know of them.
    EXPECT_EQ(bench.baton({"bag", "recover", (bench.folder() / name).string(), out, "--overwrite"}).exit_code,
              name == "unknown_record.mcap" ? 1 : 0);
    const nlohmann::json copied = readOfficially(bench, out);
    for (const char* what : {"topics", "messages", "attachments", "metadata"}) {
      EXPECT_EQ(copied.at(what), contents.at(what)) << what;
    }
    EXPECT_EQ(bench.baton({"bag", "verify", out}).exit_code, 1) << "nobody vouches for it";
  }
}

}  // namespace
}  // namespace baton::test
