// `baton bag cat`, `export` and `diff` as a person runs them, on small files and on a run's recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/processes.hpp"
#include "support/short_contact.hpp"
#include "support/small_recording.hpp"

namespace baton::test {
namespace {

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Five samples of "plain", a millisecond apart, and after each one of "opaque", which has no schema.
std::string smallFile(const Bench& bench, const std::string& name = "small.mcap", double last = 4.0) {
  std::string path = (bench.folder() / name).string();
  SmallRecording recording(path);
  for (int i = 0; i < 5; ++i) {
    recording.addBytes("plain", "maker", "Sample", "struct Sample { long n; @unit(\"m\") sequence<double> x; };",
                       Bytes().number(i).number(std::uint32_t{1}).number(i == 4 ? last : i).bytes);
    recording.addBytes("opaque", "maker", "Other", "", Bytes().number(std::uint8_t{0xAB}).bytes);
  }
  recording.close();
  return path;
}

TEST(BagCat, PrintsMessagesOrBytes) {
  const Bench bench;
  const std::string file = smallFile(bench);
  const Finished cat = bench.baton({"bag", "cat", file});
  ASSERT_EQ(cat.exit_code, 0) << cat.err;
  const std::vector<std::string> lines = linesOf(cat.out);
  ASSERT_EQ(lines.size(), 10U);
  const nlohmann::json plain = nlohmann::json::parse(lines[2]);
  EXPECT_EQ(plain.at("topic"), "plain");
  EXPECT_EQ(plain.at("service"), "maker");
  EXPECT_EQ(plain.at("sequence"), 2);
  EXPECT_EQ(plain.at("message"), nlohmann::json::parse(R"({"n":1,"x":[1.0]})"));
  const nlohmann::json opaque = nlohmann::json::parse(lines[3]);
  EXPECT_EQ(opaque.at("type"), "Other");
  EXPECT_EQ(opaque.at("data"), "00010000ab");
}

TEST(BagCat, TakesTopicsTimesAndALimit) {
  const Bench bench;
  const std::string file = smallFile(bench);
  const auto count = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"bag", "cat", file});
    const Finished cat = bench.baton(options);
    EXPECT_EQ(cat.exit_code, 0) << cat.err;
    return linesOf(cat.out).size();
  };
  EXPECT_EQ(count({"--topics", "plain"}), 5U);
  EXPECT_EQ(count({"--topics", "plain,opaque"}), 10U);
  EXPECT_EQ(count({"--from", "0.002"}), 8U);
  EXPECT_EQ(count({"--from", "0.002", "--to", "0.004"}), 3U);
  EXPECT_EQ(count({"--limit", "3"}), 3U);
  const Finished raw = bench.baton({"bag", "cat", file, "--raw", "--topics", "plain", "--limit", "1"});
  EXPECT_TRUE(nlohmann::json::parse(raw.out).contains("data")) << raw.out;
  EXPECT_EQ(bench.baton({"bag", "cat", file, "--topics", "plan"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "cat", file, "--from", "2", "--to", "1"}).exit_code, 2);
  const Finished beyond = bench.baton({"bag", "cat", file, "--from", "2"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_NE(beyond.err.find("which ends 0.009000 s after its first message, found 2"), std::string::npos) << beyond.err;
  for (const std::string limit : {"0", "-1", "1.5", "many"}) {
    const Finished refused = bench.baton({"bag", "cat", file, "--limit", limit});
    EXPECT_EQ(refused.exit_code, 2) << limit;
    EXPECT_NE(refused.err.find("--limit: expected a whole number from 1 on, found '" + limit + "'"), std::string::npos)
        << refused.err;
  }
  EXPECT_EQ(bench.baton({"bag", "cat", bench.write("no.mcap", "nothing")}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "cat", (bench.folder() / "none.mcap").string()}).exit_code, 3);
}

TEST(BagCat, AReaderThatHasHadEnoughIsNoError) {
  const Bench bench;
  const std::string file = smallFile(bench);
  const Finished head = runProgram(
      "/bin/sh", {"-c", "('" + (programFolder() / "baton").string() + "' bag cat '" + file + "'; echo $? >&2) | :"},
      bench.folder());
  EXPECT_EQ(head.err, "0\n");
}

/// Where a small recording has its messages: its header takes less, its first chunk reaches beyond.
constexpr std::size_t kInFirstChunk = 150;

TEST(BagCat, PrintsWhatIsLeftOfADamagedOrCutFileAndSaysSo) {
  const Bench bench;
  const std::string file = (bench.folder() / "odd.mcap").string();
  SmallRecording recording(file);
  const char* idl = "struct Sample { long a; long b; };";
  recording.addBytes("t", "s", "Sample", idl, Bytes().number(1).number(2).bytes);
  recording.addBytes("t", "s", "Sample", idl, Bytes().number(1).bytes);
  recording.addBytes("u", "s", "Odd", "@mutable struct Odd { long a; };", Bytes().number(1).bytes);
  recording.close();
  const Finished cat = bench.baton({"bag", "cat", file});
  EXPECT_EQ(cat.exit_code, 1);
  ASSERT_EQ(linesOf(cat.out).size(), 3U);
  EXPECT_EQ(nlohmann::json::parse(linesOf(cat.out)[1]).at("error"), "b: expected 4 bytes, found 0");
  EXPECT_NE(cat.err.find("line 1: expected a final or an appendable type, found a mutable one"), std::string::npos)
      << cat.err;

  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 20);
  const Finished cut = bench.baton({"bag", "cat", file, "--topics", "u"});
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_EQ(linesOf(cut.out).size(), 1U);
  EXPECT_NE(cut.err.find("cut"), std::string::npos) << cut.err;

  // Damage that is found while the file is opened, as it has no index any more.
  std::string bytes = contentOf(file);
  bytes.at(kInFirstChunk) ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  const Finished damaged = bench.baton({"bag", "cat", file});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_NE(damaged.err.find("cannot be read"), std::string::npos) << damaged.err;
}

/// Ten messages of one topic, and an index that gives their first chunk the wrong times.
std::string misindexedFile(const Bench& bench) {
  std::string path = smallFile(bench, "misindexed.mcap");
  std::string bytes = contentOf(path);
  // The summary's statistics and chunk index begin with what they say of the times: 1.001 s becomes 0.
  std::string time(8, '\0');
  const std::uint64_t start_ns = 1'001'000'000;
  std::memcpy(time.data(), &start_ns, time.size());
  const std::size_t at = bytes.rfind(time);
  EXPECT_NE(at, std::string::npos);
  bytes.replace(at, time.size(), std::string(8, '\0'));
  // Without a CRC of the summary: nothing but its contents is wrong.
  bytes.replace(bytes.size() - 8 - 4, 4, std::string(4, '\0'));
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

TEST(BagCommands, AgreeOnAFileWhoseIndexContradictsItsData) {
  const Bench bench;
  const std::string file = misindexedFile(bench);
  const nlohmann::json info = bench.batonJson({"bag", "info", file, "--json"});
  EXPECT_EQ(info.at("messages"), 10);
  ASSERT_FALSE(info.at("notes").empty()) << info;
  const Finished verified = bench.baton({"bag", "verify", file});
  EXPECT_EQ(verified.exit_code, 2);
  EXPECT_NE(verified.out.find("its summary contradicts its data: it gives the messages in the chunk"),
            std::string::npos)
      << verified.out;
  EXPECT_EQ(linesOf(bench.baton({"bag", "cat", file}).out).size(), 10U);
  EXPECT_EQ(linesOf(bench.baton({"bag", "cat", file, "--from", "0"}).out).size(), 10U);
  const std::string out = (bench.folder() / "tables").string();
  const Finished exported = bench.baton({"bag", "export", file, "--json", "--out", out});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_EQ(linesOf(contentOf(out + "/plain.jsonl")).size(), 5U);
  const std::string cut = (bench.folder() / "cut.mcap").string(), sound = (bench.folder() / "sound.mcap").string();
  EXPECT_EQ(bench.batonJson({"bag", "cut", file, cut, "--from", "0", "--json"}).at("messages"), 10);
  EXPECT_EQ(bench.batonJson({"bag", "recover", file, sound, "--json"}).at("messages"), 10);
}

TEST(BagCommands, ReadRecordingsThatWereJoinedInOneFile) {
  const Bench bench;
  const std::string file = (bench.folder() / "joined.mcap").string();
  const std::string one = contentOf(smallFile(bench));
  std::ofstream(file, std::ios::binary) << one << one;
  const Finished info = bench.baton({"bag", "info", file});
  EXPECT_NE(info.out.find("messages    20 in"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("another recording begins at byte " + std::to_string(one.size())), std::string::npos)
      << info.out;
  EXPECT_EQ(linesOf(bench.baton({"bag", "cat", file}).out).size(), 20U);
  const Finished recovered = bench.baton({"bag", "recover", file, (bench.folder() / "out.mcap").string()});
  EXPECT_EQ(recovered.exit_code, 0) << recovered.out;
  EXPECT_NE(recovered.out.find("20 messages"), std::string::npos) << recovered.out;
  EXPECT_EQ(recovered.out.find("nothing was lost"), std::string::npos) << recovered.out;
  EXPECT_NE(bench.baton({"bag", "verify", file}).exit_code, 0);

  std::ofstream(file, std::ios::binary) << one << std::string(4096, '\0') << one;
  const Finished padded = bench.baton({"bag", "info", file});
  EXPECT_EQ(padded.exit_code, 1);
  EXPECT_NE(padded.out.find("messages    20 in"), std::string::npos) << padded.out;
  EXPECT_NE(padded.out.find("4096 zero bytes follow the end of the recording"), std::string::npos) << padded.out;
  EXPECT_EQ(linesOf(bench.baton({"bag", "cat", file}).out).size(), 20U);

  std::ofstream(file, std::ios::binary) << one << "something else";
  EXPECT_EQ(bench.baton({"bag", "info", file}).exit_code, 1);
  const Finished lossy = bench.baton({"bag", "recover", file, (bench.folder() / "lossy.mcap").string()});
  EXPECT_EQ(lossy.exit_code, 1) << lossy.out;
  EXPECT_NE(lossy.out.find("14 bytes follow the end of the recording"), std::string::npos) << lossy.out;
}

TEST(BagCommands, ShowNamesThatChangeNoTerminal) {
  const Bench bench;
  const std::string file = (bench.folder() / "hostile.mcap").string();
  const std::string name = "a\x1b[2J\a\nb\xc2\x9b\xff";
  {
    mcap::Writer writer(file);
    const mcap::SchemaId schema = writer.addSchema(name, "omgidl", mcap::asBytes("struct"));
    const mcap::ChannelId channel = writer.addChannel(name, "cdr", schema, {{"service", name}, {"writer", name}});
    for (std::uint32_t i = 0; i < 3; ++i) writer.write(channel, i, i, i, {});
    writer.addMetadata("baton.run", {{"scenario", name}, {"run", name}});
    writer.addAttachment(name, name, 0, 0, {});
    writer.close();
  }
  const std::string out = (bench.folder() / "tables").string(), copy = (bench.folder() / "copy.mcap").string();
  using Words = std::vector<std::string>;
  for (const Words& words :
       {Words{"info", file}, Words{"verify", file}, Words{"cat", file}, Words{"cat", file, "--topics", "x"},
        Words{"export", file, "--csv", "--out", out}, Words{"recover", file, copy}, Words{"hash", file},
        Words{"diff", file, file}, Words{"diff", file, file, "--topics", "x"}, Words{"info", file, "--json"},
        Words{"verify", file, "--json"}, Words{"diff", file, file, "--json"}}) {
    Words arguments{"bag"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Finished shown = bench.baton(arguments);
    SCOPED_TRACE(words[0] + ": " + shown.out + shown.err);
    for (const char* part : {"\x1b", "\a", "\nb\xc2"}) {
      EXPECT_EQ((shown.out + shown.err).find(part), std::string::npos);
    }
    EXPECT_TRUE(words.back() != "--json" || nlohmann::json::accept(shown.out));
  }
}

TEST(BagInfo, CountsGapsOnlyWhereSequenceNumbersAreAWriters) {
  const Bench bench;
  const std::string file = (bench.folder() / "gaps.mcap").string();
  {
    mcap::Writer writer(file);
    // Two writers of a topic whose messages lie in the file by another order than theirs, and one that counts for all.
    const auto channel = [&](const std::string& topic, const std::string& guid) {
      return writer.addChannel(topic, "cdr", mcap::kNoSchema, {{"type", "T"}, {"writer", guid}});
    };
    const mcap::ChannelId a = channel("dds", "010f00000000000000000000.00000103");
    const mcap::ChannelId b = channel("dds", "010f00000000000000000000.00000203");
    const mcap::ChannelId foreign = channel("foreign", "");
    std::uint64_t time_ns = 0;
    for (const std::uint32_t sequence : {1U, 3U, 2U, 4U}) writer.write(a, sequence, ++time_ns, 0, {});
    for (const std::uint32_t sequence : {7U, 10U}) writer.write(b, sequence, ++time_ns, 0, {});
    for (const std::uint32_t sequence : {1U, 50U, 20U}) writer.write(foreign, sequence, ++time_ns, 0, {});
    writer.close();
  }
  const nlohmann::json info = bench.batonJson({"bag", "info", file, "--json"});
  EXPECT_EQ(info.at("topics").at(0).at("gaps"), 2) << info;
  EXPECT_TRUE(info.at("topics").at(1).at("gaps").is_null()) << info;
}

TEST(BagExport, WritesATableForEachTopicAndNothingOverAnother) {
  const Bench bench;
  const std::string file = smallFile(bench);
  const std::string out = (bench.folder() / "tables").string();
  const Finished first = bench.baton({"bag", "export", file, "--csv", "--out", out});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string table = contentOf(out + "/plain.csv");
  EXPECT_TRUE(
      table.starts_with("service,writer,sequence,log_time_ns,publish_time_ns,n,x[0] [m]\r\n"
                        "maker,of maker,1,1001000000,1001000000,0,0.0\r\n"))
      << table;
  EXPECT_EQ(std::ranges::count(table, '\n'), 6);
  EXPECT_TRUE(contentOf(out + "/opaque.csv")
                  .starts_with("service,writer,sequence,log_time_ns,publish_time_ns,data\r\n"
                               "maker,of maker,1,1002000000,1002000000,00010000ab\r\n"));

  std::ofstream(out + "/plain.csv") << "mine";
  const Finished again = bench.baton({"bag", "export", file, "--csv", "--out", out});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_NE(again.err.find("--overwrite"), std::string::npos) << again.err;
  EXPECT_EQ(contentOf(out + "/plain.csv"), "mine");
  ASSERT_EQ(bench.baton({"bag", "export", file, "--csv", "--out", out, "--overwrite"}).exit_code, 0);
  EXPECT_EQ(contentOf(out + "/plain.csv"), table);
  for (const auto& entry : std::filesystem::directory_iterator(out)) EXPECT_EQ(entry.path().extension(), ".csv");
}

TEST(BagExport, WritesJsonLinesAsCatPrintsThem) {
  const Bench bench;
  const std::string file = smallFile(bench);
  const std::string out = (bench.folder() / "lines").string();
  ASSERT_EQ(bench.baton({"bag", "export", file, "--json", "--topics", "plain", "--out", out}).exit_code, 0);
  EXPECT_EQ(contentOf(out + "/plain.jsonl"), bench.baton({"bag", "cat", file, "--topics", "plain"}).out);
  EXPECT_FALSE(std::filesystem::exists(out + "/opaque.jsonl"));
  EXPECT_EQ(bench.baton({"bag", "export", file, "--json", "--csv", "--out", out}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "export", file, "--out", out}).exit_code, 2);
}

TEST(BagExport, TopicsCannotNameFilesElsewhere) {
  const Bench bench;
  const std::string file = (bench.folder() / "odd.mcap").string();
  SmallRecording recording(file);
  for (const char* topic : {"../up", "/abs", "rt/a", "rt_a", ".hidden", ""}) {
    recording.addBytes(topic, "s", "T", "", Bytes().bytes);
  }
  recording.close();
  const std::string out = (bench.folder() / "out").string();
  ASSERT_EQ(bench.baton({"bag", "export", file, "--csv", "--out", out}).exit_code, 0);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  EXPECT_EQ(names,
            (std::vector<std::string>{"_.._up.csv", "_.csv", "_.hidden.csv", "_abs.csv", "rt_a-2.csv", "rt_a.csv"}));
}

TEST(BagDiff, ExitCodesSayWhatItFound) {
  const Bench bench;
  const std::string a = smallFile(bench, "a.mcap"), b = smallFile(bench, "b.mcap"), c = smallFile(bench, "c.mcap", 4.5);
  const Finished same = bench.baton({"bag", "diff", a, b});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  const Finished other = bench.baton({"bag", "diff", a, c});
  EXPECT_EQ(other.exit_code, 1) << other.err;
  EXPECT_NE(other.out.find("plain of maker, message 5, x[0]: 4.0 | 4.5"), std::string::npos) << other.out;
  EXPECT_EQ(bench.baton({"bag", "diff", a, c, "--tolerance", "x=0.5"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "diff", a, c, "--ignore", "plain.x", "opaque"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "diff", a, c, "--topics", "opaque"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "diff", a, c, "--ignore", "plain.y"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "diff", a, bench.write("no.mcap", "nothing")}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "diff", a, (bench.folder() / "none.mcap").string()}).exit_code, 3);
  const nlohmann::json json = bench.batonJson({"bag", "diff", a, c, "--json"});
  EXPECT_EQ(json.at("same"), false);
  EXPECT_EQ(json.at("first").at("topic"), "plain");
  EXPECT_EQ(json.at("streams").at(1).at("first").at("field"), "x[0]");
}

/// Every message with its times, by topic, writer and sequence number.
std::map<std::string, nlohmann::json> messagesOf(const std::string& lines) {
  std::map<std::string, nlohmann::json> messages;
  for (const std::string& line : linesOf(lines)) {
    const nlohmann::json json = nlohmann::json::parse(line);
    const std::string key = json.at("topic").get<std::string>() + " " + json.at("writer").get<std::string>() + " " +
                            json.at("sequence").dump();
    messages[key] = {json.at("log_time_ns"), json.at("publish_time_ns"), json.at("message")};
  }
  return messages;
}

TEST(BagCat, ARunsRecordingReadsLikeThroughTheOfficialReaderAndIsTheSameAsAnother) {
  const Bench bench;
  const std::string scenario = bench.write("short.yaml", shortContact());
  const auto record = [&](const std::string& name) {
    std::string file = (bench.folder() / name).string();
    EXPECT_EQ(bench.baton({"run", scenario, "--out", file}).exit_code, 0);
    return file;
  };
  const std::string a = record("a.mcap"), b = record("b.mcap");

  // The same values, through another parser and another decoder. Both print numbers that read back exactly.
  const Finished ours = bench.baton({"bag", "cat", a});
  ASSERT_EQ(ours.exit_code, 0) << ours.err;
  const Finished theirs =
      runProgram("/bin/sh", {"-c", "node '" BATON_TEST_INTEROP "/print_mcap.mjs' '" + a + "'"}, bench.folder());
  ASSERT_EQ(theirs.exit_code, 0) << theirs.err;
  const auto our_messages = messagesOf(ours.out), their_messages = messagesOf(theirs.out);
  ASSERT_GT(our_messages.size(), static_cast<std::size_t>(7 * kShortSteps));
  ASSERT_EQ(our_messages.size(), their_messages.size());
  for (const auto& [key, message] : our_messages) ASSERT_EQ(message, their_messages.at(key)) << key;

  const nlohmann::json same = bench.batonJson({"bag", "diff", a, b, "--json"});
  EXPECT_TRUE(same.at("same")) << same;
  EXPECT_EQ(same.at("streams").size(), 10U);
  EXPECT_EQ(bench.baton({"bag", "diff", a, b, "--topics", "service_status"}).exit_code, 1);

  const std::string out = (bench.folder() / "tables").string();
  ASSERT_EQ(
      bench.baton({"bag", "export", a, "--csv", "--topics", "plant_state,shadow_command", "--out", out}).exit_code, 0);
  const std::vector<std::string> states = linesOf(contentOf(out + "/plant_state.csv"));
  ASSERT_EQ(states.size(), kShortSteps + 2U);
  EXPECT_NE(states[0].find(",position[2],"), std::string::npos);
  EXPECT_EQ(states[0].find(",position[3],"), std::string::npos);  // three joints
  EXPECT_NE(states[0].find(",tip_velocity[1] [m/s],"), std::string::npos);
  const auto commas = std::ranges::count(states[0], ',');
  for (const std::string& row : states) ASSERT_EQ(std::ranges::count(row, ','), commas) << row;

  // Another gain at one step is found at the next.
  std::string changed = shortContact("changes:\n  - {at_s: 0.1, controller: tracking, set: {kp: 60}}\n");
  const std::string c = (bench.folder() / "c.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("changed.yaml", changed), "--out", c}).exit_code, 0);
  const nlohmann::json other = bench.batonJson({"bag", "diff", a, c, "--json"});
  EXPECT_FALSE(other.at("same"));
  EXPECT_EQ(other.at("first").at("topic"), "joint_command");
  for (const auto& stream : other.at("streams")) {
    if (stream.at("topic") == "joint_command" && stream.at("service") == "tracking") {
      EXPECT_EQ(stream.at("first").at("step"), 200) << stream;
    }
  }
}

}  // namespace
}  // namespace baton::test
