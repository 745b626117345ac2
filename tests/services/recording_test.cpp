/// Recordings on the disk: parts, what each says of itself, and the account in the last.
#include "recording.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "dds/hash.hpp"
#include "mcap/reader.hpp"
#include "mcap/repeated.hpp"
#include "runtime/recording_parts.hpp"
#include "runtime/yaml.hpp"
#include "support/allocation_guard.hpp"
#include "support/file_size_limit.hpp"
#include "support/short_contact.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

using Payload = std::array<std::byte, 600>;

/// Bytes that no compression makes smaller.
Payload payloadOf(std::uint64_t seed) {
  Payload payload;
  std::uint64_t state = seed * 0x9E3779B97F4A7C15U + 1;
  for (std::byte& byte : payload) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    byte = static_cast<std::byte>(state);
  }
  return payload;
}

class RecordingTest : public testing::Test {
 protected:
  void open(const std::string& recording) {
    const std::string text =
        test::shortContact("recording: {compression: none, chunk_kB: 10, min_free_MB: 0" + recording + "}\n");
    const std::string robot = readYamlFile((test::deployFolder() / "robots/rpp.yaml").string());
    config_ = parseScenario("test.yaml", text, "rpp.yaml", robot).recording;
    recording_ = std::make_unique<Recording>(file(), config_, origin_, 0, 0, &latched_);
  }
  Stream& stream(std::size_t index, const std::string& type = "baton::msg::PlantState") {
    Stream& stream = streams_[index];
    if (stream.received != nullptr) return stream;
    dds::Guid guid;
    guid.bytes.fill(static_cast<std::uint8_t>(index + 1));
    stream.index = index;
    stream.received = &ledger_.streamOf({"topic" + std::to_string(index), guid});
    stream.type = type;
    stream.metadata = {{"type", type}};
    return stream;
  }
  /// The next sample of a stream is booked and written.
  void write(std::size_t index) {
    Stream& to = stream(index);
    const Payload payload = payloadOf(++sent_);
    const std::uint64_t sequence = to.received->second.last_sequence + 1;
    ASSERT_TRUE(ledger_.book(*to.received, sequence, payload));
    recording_->write(to, {.sequence = sequence,
                           .log_time_ns = static_cast<std::int64_t>(sent_),
                           .source_timestamp_ns = static_cast<std::int64_t>(sent_),
                           .payload = payload});
    latched_.keep(index, "", depths_[index], {.stream = &to, .sequence = sequence, .source_timestamp_ns = 7}, payload);
  }
  Json finish(const Ending& ending = {.run_is_over = false}, const std::vector<Hole>& holes = {}) {
    Certificate certificate(ledger_, ending);
    recording_->finish(certificate, 100, holes, {{"events.json", "application/json", "{}"}});
    return Json::parse(certificate.text());
  }
  [[nodiscard]] fs::path file() const { return bench_.folder() / "run.mcap"; }
  [[nodiscard]] std::vector<fs::path> parts() const {
    std::vector<fs::path> all{file()};
    const std::vector<fs::path> further = furtherPartsOf(file());
    all.insert(all.end(), further.begin(), further.end());
    return all;
  }

  test::Bench bench_;
  RecordingConfig config_;
  Origin origin_{.run = {{"run", "the-run"}, {"scenario", "short"}},
                 .attachments = {{"scenario.yaml", "application/yaml", "name: short"},
                                 {"robot.yaml", "application/yaml", "name: rpp"}}};
  Ledger ledger_{{}};
  std::map<std::size_t, Stream> streams_;
  std::map<std::size_t, std::size_t> depths_;  // of what late joiners are given, by stream
  Latched latched_{kMostLatchedBytes};
  std::unique_ptr<Recording> recording_;
  std::uint64_t sent_ = 0;
};

struct Sums {
  std::uint64_t count = 0;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::uint64_t hash = 0;
};

/// What a certificate's rows say, done again from the files. Sequence numbers have to go on from file to file.
std::map<std::string, Sums> sumsOf(const std::vector<fs::path>& files, const Json& certificate) {
  std::map<std::string, Sums> sums;
  for (const Json& row : certificate.at("streams")) {
    if (row.at("count") == 0) continue;
    sums[row.at("topic")].hash = std::stoull(row.value("hash_seed", "0"));
  }
  for (const fs::path& file : files) {
    const mcap::Reader reader(file);
    EXPECT_TRUE(reader.info().is_complete) << file;
    mcap::Repeated repeated(reader);  // counts where it was recorded
    reader.forEachMessage({}, [&](const mcap::MessageView& message) {
      if (repeated.takes(message)) return;
      Sums& of = sums[message.channel->topic];
      if (of.count > 0) {
        EXPECT_EQ(message.sequence, of.last + 1) << file;
      }
      if (of.count++ == 0) of.first = message.sequence;
      of.last = message.sequence;
      of.hash = dds::chainHash(of.hash, message.data);
    });
  }
  return sums;
}

void expectAccount(const std::vector<fs::path>& files, const Json& certificate) {
  const std::map<std::string, Sums> sums = sumsOf(files, certificate);
  std::size_t rows = 0;
  for (const Json& row : certificate.at("streams")) {
    if (row.at("count") == 0) continue;  // came, and is not in the files
    ++rows;
    const Sums& of = sums.at(row.at("topic"));
    EXPECT_EQ(row.at("count"), of.count) << row;
    EXPECT_EQ(row.at("first_sequence"), of.first) << row;
    EXPECT_EQ(row.at("last_sequence"), of.last) << row;
    EXPECT_EQ(row.at("stream_hash"), std::to_string(of.hash)) << row;
  }
  EXPECT_EQ(sums.size(), rows);
}

std::map<std::string, mcap::StringMap> metadataOf(const fs::path& file) {
  std::map<std::string, mcap::StringMap> all;
  for (const mcap::Metadata& one : mcap::Reader(file).metadata()) all[one.name] = one.values;
  return all;
}

TEST_F(RecordingTest, WithoutASplitIsOneFileThatSaysAllOfItself) {
  open("");
  for (int i = 0; i < 100; ++i) write(i % 2);
  recording_->splitWhenFull(1'000'000, 5);
  const Json certificate = finish();
  EXPECT_EQ(parts().size(), 1u);
  expectAccount(parts(), certificate);
  EXPECT_EQ(certificate.at("complete"), true);
  const auto metadata = metadataOf(file());
  EXPECT_FALSE(metadata.contains("baton.part"));
  EXPECT_EQ(metadata.at("baton.certificate").at("complete"), "true");
  EXPECT_EQ(metadata.at("baton.run").at("run"), "the-run");
  std::set<std::string> names;
  const mcap::Reader reader(file());
  for (const mcap::AttachmentIndex& one : reader.attachments()) names.insert(one.name);
  EXPECT_EQ(names, (std::set<std::string>{"scenario.yaml", "robot.yaml", "events.json", "certificate.json"}));
}

TEST_F(RecordingTest, PartsFollowEachOtherWithoutASeam) {
  open(", split_MB: 0.05");
  for (int i = 0; i < 600; ++i) {
    recording_->splitWhenFull(0, static_cast<std::uint64_t>(i));
    write(i % 3);
  }
  const Json certificate = finish();
  const std::vector<fs::path> files = parts();
  ASSERT_GT(files.size(), 3u);
  expectAccount(files, certificate);
  ASSERT_EQ(certificate.at("parts").size(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(certificate.at("parts").at(i), files[i].filename().string());
    const auto metadata = metadataOf(files[i]);
    EXPECT_EQ(metadata.at("baton.part").at("index"), std::to_string(i));
    EXPECT_EQ(metadata.at("baton.part").at("run"), "the-run");
    EXPECT_EQ(metadata.at("baton.part").at("first"), "run.mcap");
    const bool is_last = i + 1 == files.size();
    EXPECT_EQ(metadata.contains("baton.certificate"), is_last);
    if (!is_last) {
      EXPECT_EQ(metadata.at("baton.part_end").at("next"), files[i + 1].filename().string());
    }
    // Each stands for itself.
    const mcap::Reader reader(files[i]);
    std::set<std::string> attachments;
    for (const mcap::AttachmentIndex& one : reader.attachments()) attachments.insert(one.name);
    EXPECT_TRUE(attachments.contains("scenario.yaml") && attachments.contains("robot.yaml"));
    reader.forEachMessage({}, [&](const mcap::MessageView& message) {
      ASSERT_NE(message.schema, nullptr);
      EXPECT_FALSE(message.schema->data.empty());
    });
    EXPECT_LT(fs::file_size(files[i]), 100'000u) << files[i];
  }
}

TEST_F(RecordingTest, WhatAPartBeginsWithFillsNone) {
  origin_.attachments.push_back({"checkpoint.mcap", "application/mcap", std::string(20'000, 'x')});
  open(", split_MB: 0.01");
  for (int i = 0; i < 100; ++i) {
    recording_->splitWhenFull(0, static_cast<std::uint64_t>(i));
    write(0);
  }
  const Json certificate = finish();
  expectAccount(parts(), certificate);
  ASSERT_GT(parts().size(), 1u);
  for (std::size_t i = 0; i + 1 < parts().size(); ++i) {
    EXPECT_GE(mcap::Reader(parts()[i]).statistics().message_count, 10u) << "a chunk at least";
  }
}

TEST_F(RecordingTest, PartsEndByTheRunsTimeToo) {
  open(", split_s: 0.005");  // ten steps
  for (std::uint64_t step = 0; step < 35; ++step) {
    recording_->splitWhenFull(step, step);
    write(0);
  }
  const Json certificate = finish();
  ASSERT_EQ(parts().size(), 4u);
  expectAccount(parts(), certificate);
  std::size_t messages = 0;
  mcap::Reader(parts()[1]).forEachMessage({}, [&](const mcap::MessageView&) { ++messages; });
  EXPECT_EQ(messages, 10u);
  EXPECT_EQ(metadataOf(parts()[3]).at("baton.part").at("from_step"), "30");
}

TEST_F(RecordingTest, WhereTheOldestPartsHaveGoneTheAccountIsOfTheRest) {
  open(", split_MB: 0.05, max_MB: 0.2, when_full: drop_oldest");
  write(7);  // a writer that is in the first part alone
  for (int i = 0; i < 900; ++i) {
    recording_->splitWhenFull(0, static_cast<std::uint64_t>(i));
    while (judgeStorage(config_, recording_->storage()) == StorageVerdict::kDropOldest) {
      recording_->dropOldestPart();
    }
    write(i < 500 ? i % 3 : 1);  // and some that fall silent
  }
  write(7);  // it was gone altogether, and is back
  const Json certificate = finish();
  EXPECT_FALSE(fs::exists(file()));
  const std::vector<fs::path> files = furtherPartsOf(file());
  ASSERT_GE(files.size(), 2u);
  ASSERT_EQ(certificate.at("parts").size(), files.size());
  EXPECT_EQ(certificate.at("parts").at(0), files.front().filename().string());
  expectAccount(files, certificate);
  std::uint64_t bytes = 0;
  for (const fs::path& one : files) bytes += fs::file_size(one);
  EXPECT_LE(bytes, 200'000u);
  EXPECT_EQ(certificate.at("complete"), true);
  ASSERT_EQ(certificate.at("holes").size(), 1u);
  EXPECT_EQ(certificate.at("holes").at(0).at("from_step"), 0u);
  std::uint64_t held = 0;
  for (const Json& row : certificate.at("streams")) held += row.at("count").get<std::uint64_t>();
  EXPECT_EQ(certificate.at("holes").at(0).at("samples").get<std::uint64_t>() + held, 902u);
}

TEST_F(RecordingTest, APartThatBeginsInTheMiddleBeginsWithWhatALateJoinerWouldBeGiven) {
  depths_ = {{0, 1}, {1, 3}};
  open(", split_s: 0.01");  // twenty steps
  for (std::uint64_t step = 0; step < 60; ++step) {
    recording_->splitWhenFull(step, step);
    write(step % 4);
  }
  const Json certificate = finish();
  ASSERT_EQ(parts().size(), 3u);
  expectAccount(parts(), certificate);
  EXPECT_FALSE(metadataOf(parts()[0]).contains(mcap::kRepeatedRecord)) << "nothing was before it";
  for (std::size_t i = 1; i < 3; ++i) {
    const mcap::Reader reader(parts()[i]);
    std::vector<std::pair<std::string, std::uint32_t>> first;
    reader.forEachMessage({}, [&](const mcap::MessageView& message) {
      if (first.size() == 4) return;
      EXPECT_EQ(message.log_time_ns, i * 20 + 1) << "that of the first sample of the part";
      EXPECT_EQ(message.publish_time_ns, 7u);
      first.emplace_back(message.channel->topic, message.sequence);
    });
    const auto n = static_cast<std::uint32_t>(i * 5);  // of each stream, so far
    EXPECT_EQ(first, (std::vector<std::pair<std::string, std::uint32_t>>{
                         {"topic1", n - 2}, {"topic1", n - 1}, {"topic0", n}, {"topic1", n}}));
    EXPECT_EQ(mcap::Repeated(reader).count(), 4u);
    EXPECT_EQ(reader.statistics().message_count, 24u);
  }
}

TEST_F(RecordingTest, WhatIsRepeatedFillsNoPartAndIsInNoAccountWhereTheOldestGo) {
  depths_ = {{0, 1000}};
  open(", split_MB: 0.02, max_MB: 0.6, when_full: drop_oldest");
  for (int i = 0; i < 600; ++i) {
    recording_->splitWhenFull(0, static_cast<std::uint64_t>(i));
    while (judgeStorage(config_, recording_->storage()) == StorageVerdict::kDropOldest) {
      recording_->dropOldestPart();
    }
    write(i % 5 == 0 ? 0 : 1);
  }
  const Json certificate = finish();
  const std::vector<fs::path> files = furtherPartsOf(file());
  ASSERT_GE(files.size(), 2u);
  EXPECT_FALSE(fs::exists(file()));
  expectAccount(files, certificate);
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    const mcap::Reader reader(files[i]);
    EXPECT_GE(reader.statistics().message_count - mcap::Repeated(reader).count(), 10u) << "a chunk at least";
  }
}

TEST_F(RecordingTest, APartThatCannotBeClosedIsTheLast) {
  open(", split_MB: 0.02");
  while (recording_->storage().part_bytes < 20'000) write(0);
  recording_->flush();
  {
    // There is room for the beginning of the next part, and none for the summary of this one.
    const test::FileSizeLimit limit(recording_->storage().part_bytes + 10);
    EXPECT_THROW(recording_->splitWhenFull(1, 1), mcap::WriteError);
  }
  recording_.reset();
  EXPECT_EQ(parts(), std::vector<fs::path>{file()});
  EXPECT_FALSE(mcap::Reader(file()).info().is_complete);
}

TEST_F(RecordingTest, TheNextPartIsNotMadeOfWhatLiesThereAlready) {
  std::ofstream(bench_.folder() / "run_0001.mcap") << "somebody else's";
  open(", split_MB: 0.02");
  for (int i = 0; i < 100; ++i) write(0);
  EXPECT_THROW(recording_->splitWhenFull(0, 0), UnavailableError);
  write(0);
  expectAccount({file()}, finish());
}

TEST_F(RecordingTest, ATypeNobodyKnowsIsKeptAsBytesUnderItsName) {
  open("");
  Stream& foreign = stream(0, "other::Thing");
  const Payload payload = payloadOf(1);
  ASSERT_TRUE(ledger_.book(*foreign.received, 1, payload));
  recording_->write(foreign, {.sequence = 1, .log_time_ns = 1, .payload = payload});
  finish();
  mcap::Reader(file()).forEachMessage({}, [&](const mcap::MessageView& message) {
    ASSERT_NE(message.schema, nullptr);
    EXPECT_EQ(message.schema->name, "other::Thing");
    EXPECT_EQ(message.schema->encoding, "") << "the specification's word for: not available";
    EXPECT_TRUE(message.schema->data.empty());
    EXPECT_EQ(message.channel->metadata.at("type"), "other::Thing");
    EXPECT_TRUE(std::ranges::equal(message.data, payload));
  });
}

TEST_F(RecordingTest, AHoleIsToldAndTheRowsAreOfTheFile) {
  open("");
  Holes holes;
  for (int i = 0; i < 30; ++i) {
    if (i == 10) holes.open(0, 10, "paused");
    if (i == 20) holes.close(19);
    if (!holes.isOpen()) {
      write(0);
      continue;
    }
    ASSERT_TRUE(ledger_.book(*stream(0).received, stream(0).received->second.last_sequence + 1, payloadOf(++sent_)));
    holes.leaveOut();
  }
  const Json certificate = finish({.run_is_over = false}, holes.between(0, 100));
  EXPECT_EQ(certificate.at("complete"), true);
  ASSERT_EQ(certificate.at("holes").size(), 1u);
  EXPECT_EQ(certificate.at("holes").at(0).at("from_step"), 10u);
  EXPECT_EQ(certificate.at("holes").at(0).at("to_step"), 19u);
  EXPECT_EQ(certificate.at("holes").at(0).at("samples"), 10u);
  const Json row = certificate.at("streams").at(0);
  EXPECT_EQ(row.at("count"), 20u);
  EXPECT_EQ(row.at("received"), 30u);
  EXPECT_EQ(row.at("missing"), 0u);
  EXPECT_EQ(row.at("left_out"), 10u);
  std::uint64_t hash = 0, count = 0;
  mcap::Reader(file()).forEachMessage({}, [&](const mcap::MessageView& message) {
    hash = dds::chainHash(hash, message.data);
    ++count;
  });
  EXPECT_EQ(count, 20u);
  EXPECT_EQ(row.at("stream_hash"), std::to_string(hash));
}

TEST_F(RecordingTest, WhatIsLostIsAGapOfItsWriter) {
  open("");
  Stream& to = stream(0);
  for (int i = 0; i < 3; ++i) write(0);
  ledger_.dropped(*to.received, 4, 6);
  const Payload payload = payloadOf(9);
  ASSERT_TRUE(ledger_.book(*to.received, 9, payload));
  recording_->write(to, {.sequence = 9, .log_time_ns = 9, .lost_before = 5, .payload = payload});
  const Json certificate = finish();
  EXPECT_EQ(certificate.at("complete"), false);
  EXPECT_EQ(certificate.at("streams").at(0).at("missing"), 5u);
  ASSERT_EQ(certificate.at("gaps").size(), 2u);
  EXPECT_EQ(certificate.at("gaps").at(0).at("topic"), "topic0");
  EXPECT_EQ(certificate.at("gaps").at(0).at("first_sequence"), 4u);
  EXPECT_EQ(certificate.at("gaps").at(0).at("last_sequence"), 6u);
  EXPECT_EQ(certificate.at("gaps").at(0).at("reason"), "came faster than it could be written");
  EXPECT_EQ(certificate.at("gaps").at(1).at("first_sequence"), 7u);
  EXPECT_EQ(certificate.at("gaps").at(1).at("reason"), "never came");
}

TEST_F(RecordingTest, WhatWasLostBeforeItBeganIsNoLossOfIt) {
  open("");
  Stream& to = stream(0);
  ledger_.dropped(*to.received, 1, 3);
  for (int i = 0; i < 5; ++i) write(0);
  EXPECT_EQ(recording_->missing(to), 0u);
  to.received->second.excused = 3;
  const Json certificate = finish();
  EXPECT_EQ(certificate.at("complete"), true) << certificate.at("problems");
  EXPECT_TRUE(certificate.at("gaps").empty());
  EXPECT_EQ(certificate.at("streams").at(0).at("lost_before"), 3u);
  EXPECT_EQ(certificate.at("streams").at(0).at("missing"), 0u);

  // Who reads it does the sums again.
  msg::StreamManifest sent;
  sent.topic(to.topic());
  sent.writer(to.writer().bytes);
  sent.count(8);
  msg::ServiceManifest manifest;
  manifest.name("plant");
  manifest.streams().push_back(sent);
  Ledger reader{{"plant"}};
  reader.addManifest(manifest);
  mcap::Reader(file()).forEachMessage({}, [&](const mcap::MessageView& message) {
    ASSERT_TRUE(reader.book({to.topic(), to.writer()}, message.sequence, message.data));
  });
  EXPECT_FALSE(reader.isComplete());
  Json at_the_end = certificate;
  at_the_end["run_is_over"] = true;
  reader.excuse(at_the_end.dump());
  EXPECT_TRUE(reader.isComplete()) << reader.problems()[0];
}

TEST_F(RecordingTest, ARecordingThatEndsOtherwiseThanWantedIsIncomplete) {
  open("");
  write(0);
  const Json certificate = finish({.run_is_over = false, .is_wanted = false, .reason = "ended early: no room"});
  EXPECT_EQ(certificate.at("complete"), false);
  EXPECT_EQ(certificate.at("problems").at(0), "ended early: no room");
  EXPECT_EQ(metadataOf(file()).at("baton.certificate").at("summary"), "incomplete: ended early: no room");
}

TEST_F(RecordingTest, NothingIsAllocatedForASample) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  open(", split_MB: 100, max_MB: 1000");
  for (int i = 0; i < 700; ++i) write(0);
  const Stream& to = stream(0);
  const std::uint64_t first = to.received->second.last_sequence + 1;
  bool are_new = true;
  constexpr std::uint64_t kSamples = 100;  // seven chunks
  const test::AllocationGuard guard;
  for (std::uint64_t sequence = first; sequence < first + kSamples; ++sequence) {
    const Payload payload = payloadOf(sequence);
    are_new = ledger_.book(*to.received, sequence, payload) && are_new;
    recording_->write(to, {.sequence = sequence, .log_time_ns = 1000, .payload = payload});
  }
  const std::size_t allocations = guard.count();
  EXPECT_TRUE(are_new);
  EXPECT_LE(allocations, 2 * kSamples / 14) << "index entries of the chunks";
}

}  // namespace
}  // namespace baton
