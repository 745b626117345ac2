// The recording in other people's hands: the official TypeScript reader decodes every message.
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(Interop, TheOfficialReaderDecodesEveryMessage) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  const nlohmann::json run =
      bench.batonJson({"run", bench.write("short.yaml", shortContact()), "--out", file, "--json"});
  ASSERT_EQ(run.at("exit_code"), 0) << run;
  const Finished reader =
      runProgram("/bin/sh", {"-c", "node '" BATON_TEST_INTEROP "/read_mcap.mjs' '" + file + "'"}, bench.folder());
  ASSERT_EQ(reader.exit_code, 0) << reader.out << reader.err;
  const nlohmann::json summary = nlohmann::json::parse(reader.out);
  EXPECT_EQ(summary.at("messages"), run.at("recording").at("messages"));
  EXPECT_EQ(summary.at("decoded"), summary.at("messages"));
  EXPECT_EQ(summary.at("topics").at("plant_state").at("count"), kShortSteps + 1);
  EXPECT_EQ(summary.at("topics").at("plant_state").at("type"), "baton::msg::PlantState");
}

}  // namespace
}  // namespace baton::test
