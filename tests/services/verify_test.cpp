/// Completeness proven again from the bytes, and every way in which it is not.
#include "bag/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/error.hpp"
#include "mcap/writer.hpp"
#include "support/processes.hpp"
#include "support/recorded_files.hpp"

namespace baton::test {
namespace {

bool mentions(const std::vector<std::string>& sentences, const std::string& words) {
  return std::any_of(sentences.begin(), sentences.end(),
                     [&](const std::string& s) { return s.find(words) != std::string::npos; });
}

std::string all(const Verification& found) {
  std::string text;
  for (const auto* list : {&found.damage, &found.cuts, &found.missing}) {
    for (const std::string& sentence : *list) text += sentence + "\n";
  }
  return text;
}

class VerifyTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> write(const RecordingPlan& plan = {}) const {
    return writeRecording(bench.folder(), "run", plan);
  }
  static Verification verify(const std::vector<std::string>& files) {
    return verifyRecording(files, [](double) {});
  }
  [[nodiscard]] Verification verifyWith(const RecordingPlan& plan) const { return verify(write(plan)); }

  Bench bench;
};

TEST_F(VerifyTest, AWholeRecordingIsProvenComplete) {
  const Verification found = verifyWith({});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kComplete) << all(found);
  EXPECT_EQ(all(found), "");
  EXPECT_EQ(found.ledger.servicesHeard(), 3U);
  EXPECT_EQ(found.messages, 3 * 200U + 3U);
  EXPECT_EQ(found.ledger.streams().size(), 6U);
}

TEST_F(VerifyTest, WhoeverIsNoServiceOfTheRunIsAFaultOnItsTopics) {
  for (const auto& [topic, claim] : {std::pair{"contact", "friend"},
                                     {"contact", ""},
                                     {"contact", "plant"},
                                     {"joint_command", "friend"},
                                     {"plant_state", "trajectory"},
                                     {"service_manifest", "friend"},
                                     {"sim_status", "operator-1"}}) {
    const Verification found = verifyWith({.stranger = topic, .claim = claim});
    EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete) << topic << " " << claim;
    EXPECT_TRUE(mentions(found.missing, std::string(topic) + ": a writer that is none of the run's services"))
        << all(found);
  }
  for (const auto& [topic, claim] : {std::pair{"plant_state", "plant"},
                                     {"joint_command", "pd"},
                                     {"swap_request", "operator-1"},
                                     {"sim_status", "supervisor"},
                                     {"somebody's own", "friend"}}) {
    const Verification found = verifyWith({.stranger = topic, .claim = claim});
    EXPECT_FALSE(mentions(found.missing, "none of the run's services")) << topic << " " << claim << all(found);
  }
}

TEST_F(VerifyTest, WhatTheRecorderSawMissingIsMissing) {
  for (const std::uint64_t at : {1U, 100U, 200U}) {
    const Verification found = verifyWith({.leave_out = at});
    EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete) << at;
    EXPECT_TRUE(mentions(found.missing, "200 samples sent, 199 recorded")) << all(found);
    EXPECT_FALSE(mentions(found.missing, "certificate")) << "it says the same\n" << all(found);
  }
}

TEST_F(VerifyTest, WhatIsLostOfAForeignTopicIsANote) {
  const Verification found = verifyWith({.stranger = "their_topic", .stranger_lost = 3});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kComplete) << all(found);
  ASSERT_EQ(found.remarks.size(), 1U);
  EXPECT_TRUE(mentions(found.remarks, "their_topic of ")) << found.remarks[0];
  EXPECT_TRUE(mentions(found.remarks, "3 samples are missing")) << found.remarks[0];
  EXPECT_TRUE(verifyWith({.stranger = "their_topic"}).remarks.empty());
}

TEST_F(VerifyTest, ACertificateThatSaysMoreThanTheBytesIsNotBelieved) {
  for (const RecordingPlan& plan :
       {RecordingPlan{.leave_out = 100, .is_seen = false}, RecordingPlan{.change = 100, .is_seen = false}}) {
    const Verification found = verifyWith(plan);
    EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete);
    EXPECT_TRUE(mentions(found.missing, "the certificate says complete, the bytes do not")) << all(found);
    EXPECT_TRUE(mentions(found.missing, "the certificate says otherwise of plant_state")) << all(found);
  }
}

TEST_F(VerifyTest, OtherBytesThanThoseSentAreNoticed) {
  const Verification found = verifyWith({.change = 7});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete);
  EXPECT_TRUE(mentions(found.missing, "the recorded bytes are not those sent")) << all(found);
}

TEST_F(VerifyTest, MessagesThatComeTwiceAreNoticed) {
  const Verification found = verifyWith({.repeat = 7});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete);
  EXPECT_TRUE(mentions(found.missing, "1 message comes twice")) << all(found);
}

TEST_F(VerifyTest, WithoutTheWordOfEverybodyNothingIsProven) {
  EXPECT_TRUE(mentions(verifyWith({.silent = "plant"}).missing, "plant sent no manifest"));
  EXPECT_TRUE(mentions(verifyWith({.has_certificate = false}).missing, "it has no certificate"));
  const Verification dropped = verifyWith({.dropped = 3});
  EXPECT_EQ(dropped.verdict(), RecordingVerdict::kIncomplete) << "the bytes cannot tell, the certificate does";
  EXPECT_TRUE(mentions(dropped.missing, "last_sequence 203, the bytes give 200")) << all(dropped);
}

TEST_F(VerifyTest, SequenceNumbersMayOutgrowTheirFieldInTheFile) {
  const Verification found = verifyWith({.first_sequence = 0xFFFF'FFF0});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kComplete) << all(found);
}

TEST_F(VerifyTest, PartsAreBookedAsOneInWhateverOrderTheyAreGiven) {
  std::vector<std::string> files = write({.parts = 4});
  ASSERT_EQ(files.size(), 4U);
  EXPECT_EQ(verify(files).verdict(), RecordingVerdict::kComplete) << all(verify(files));
  std::swap(files[0], files[3]);
  std::swap(files[0], files[1]);
  const Verification found = verify(files);
  EXPECT_EQ(found.verdict(), RecordingVerdict::kComplete) << all(found);
  EXPECT_TRUE(std::is_sorted(found.files.begin() + 1, found.files.end()));
}

TEST_F(VerifyTest, APartThatIsMissingIsNamed) {
  const std::vector<std::string> files = write({.parts = 4});
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    std::vector<std::string> some = files;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(left_out));
    const Verification found = verify(some);
    EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete) << left_out;
    const std::string part = left_out == 3 ? "run_0003.mcap, in which it goes on," : "part " + std::to_string(left_out);
    const std::string words = part + " is not among";
    EXPECT_TRUE(mentions(found.missing, words)) << all(found);
  }
}

TEST_F(VerifyTest, APartThatCannotBeOpenedIsDamage) {
  const std::vector<std::string> files = write({.parts = 3});
  const Verification found = verifyRecording({files[0], files[2]}, [](double) {}, {"run_0001.mcap cannot be read"});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kDamaged);
  EXPECT_TRUE(mentions(found.damage, "run_0001.mcap")) << all(found);
  EXPECT_TRUE(mentions(found.missing, "part 1 is not among")) << all(found);
}

TEST_F(VerifyTest, APartAloneSaysWhichOneItIsAndWhereTheOthersAre) {
  const std::vector<std::string> files = write({.parts = 4});
  const auto wordsOf = [](const std::string& file) {
    const Verification found = verify({file});
    EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete);
    return found.missing.at(0);
  };
  EXPECT_TRUE(
      wordsOf(files[0]).starts_with("it is part 0 of run.mcap, which was split; it goes on in run_0001.mcap: "));
  EXPECT_TRUE(
      wordsOf(files[1]).starts_with("it is part 1 of run.mcap, which was split; before it comes run.mcap; it "
                                    "goes on in run_0002.mcap: "));
  EXPECT_TRUE(
      wordsOf(files[3]).starts_with("it is part 3 of run.mcap, which was split; before it comes run_0002.mcap: "));
  for (const std::string& file : files) {
    EXPECT_EQ(verify({file}).missing.size(), 1U) << "what its writers sent went elsewhere too";
  }
}

TEST_F(VerifyTest, FilesThatAreNotPartsOfOneRecordingAreRefused) {
  const std::vector<std::string> files = write({.parts = 2}),
                                 others = writeRecording(bench.folder(), "other", {.parts = 2});
  EXPECT_THROW(verify({files[0], files[0]}), UsageError);
  EXPECT_THROW(verify({files[0], others[1]}), UsageError);
  const std::string single = writeRecording(bench.folder(), "single")[0];
  EXPECT_THROW(verify({single, files[0]}), UsageError);
  EXPECT_THROW(verify({bench.write("text.mcap", "hello")}), UsageError);
  EXPECT_THROW(verify({(bench.folder() / "absent.mcap").string()}), UnavailableError);
}

TEST_F(VerifyTest, ARecordingOfSomebodyElseIsNotProven) {
  const std::string file = (bench.folder() / "foreign.mcap").string();
  {
    mcap::Writer writer(file);
    writer.write(writer.addChannel("pose", "cdr", mcap::kNoSchema), 1, 1, 1, {});
    writer.close();
  }
  const Verification found = verify({file});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kIncomplete);
  EXPECT_TRUE(mentions(found.missing, "not recorded by Baton")) << all(found);
}

TEST_F(VerifyTest, AFileThatContradictsItselfIsNamed) {
  const std::string file = (bench.folder() / "redefined.mcap").string();
  mcap::Bytes bytes(mcap::kMagic.begin(), mcap::kMagic.end());
  mcap::appendHeader(bytes, {});
  for (const char* topic : {"one", "other"}) {
    mcap::appendChannel(
        bytes, {.id = mcap::ChannelId{1}, .schema_id = mcap::kNoSchema, .topic = topic, .message_encoding = "cdr"});
    mcap::appendMessage(bytes, {.channel_id = mcap::ChannelId{1}});
  }
  mcap::appendDataEnd(bytes, {});
  mcap::appendFooter(bytes, {});
  mcap::append(bytes, mcap::kMagic);
  std::ofstream(file, std::ios::binary) << std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const Verification found = verify({file});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kDamaged);
  EXPECT_TRUE(mentions(found.damage, "channel 1 is declared again")) << all(found);
  EXPECT_EQ(found.messages, 2U);
}

/// Every byte counts: whichever is changed, the recording is not proven any more.
TEST_F(VerifyTest, AnyChangedByteIsFound) {
  const std::string file = write({.samples = 12, .chunk_bytes = 4096})[0];  // several chunks, and seconds for all bytes
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file));
  std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
  const auto change = [&](std::streamoff at) {
    bytes.seekg(at);
    const int value = bytes.get();
    bytes.seekp(at);
    bytes.put(static_cast<char>(value ^ 0x04));
    bytes.flush();
  };
  for (std::streamoff at = 0; at < size; ++at) {
    SCOPED_TRACE("byte " + std::to_string(at) + " of " + std::to_string(size));
    change(at);
    try {
      const RecordingVerdict verdict = verify({file}).verdict();
      EXPECT_NE(verdict, RecordingVerdict::kComplete);
    } catch (const UsageError&) {  // not a recording any more
    }
    change(at);
  }
  EXPECT_EQ(verify({file}).verdict(), RecordingVerdict::kComplete);
}

TEST_F(VerifyTest, ACutRecordingIsCut) {
  const std::string file = write()[0];
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  const Verification found = verify({file});
  EXPECT_EQ(found.verdict(), RecordingVerdict::kCut) << "all messages are there, but it does not end as it should";
  EXPECT_TRUE(found.missing.empty()) << all(found);
}

}  // namespace
}  // namespace baton::test
